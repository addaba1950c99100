#pragma once
// What stands in the city many times: cars, trees, street furniture. Each kind is one mesh, shown by instances.

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "geometry/mesh.h"

namespace promenade {

enum class PropClass : uint8_t { car, tree, bush, lamp, bench, hydrant, bin, bus_stop, sign, traffic_light };
constexpr size_t kPropClasses = 10;
constexpr int kPropLevels = 4;  ///< of detail; each has about four times the triangles of the one before

std::string_view name_of(PropClass prop);
/// Different looks of a class.
uint32_t variants_of(PropClass prop);

/// One look of one class at one level.
struct PropKind {
  PropClass prop = PropClass::car;
  uint32_t variant = 0;
  int level = 1;
  auto operator<=>(const PropKind&) const =
      default;  // NOLINT(modernize-use-nullptr): what it writes inside is not ours
};

/// Standing on z = 0 at the origin; cars along x, signs and benches facing -y. With normals and colours.
Mesh make_prop(const PropKind& kind);
/// The parts of it; level as above.
Mesh make_car(uint32_t variant, int level);
Mesh make_tree(uint32_t variant, int level);
Mesh make_bush(uint32_t variant, int level);

/// Every kind's mesh, made when first asked for. Thread-safe.
class PropLibrary {
 public:
  const Mesh& mesh(const PropKind& kind);

 private:
  static constexpr size_t kMaxVariants = 16;
  struct Entry {
    std::once_flag made;
    Mesh mesh;
  };
  std::array<Entry, kPropClasses * kMaxVariants * kPropLevels> entries_;
};

}  // namespace promenade
