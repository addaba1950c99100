#pragma once
// Tiny sources written by hand, for the tests of import.

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "preprocess/import.h"
#include "tests/temporary_folder.h"

namespace promenade {

/// Imports bytes as a file of this name.
Result<Scene> import_bytes(const std::string& name, std::string_view bytes, const ImportOptions& options = {});
Result<Scene> import_file(const std::filesystem::path& path, const ImportOptions& options = {});

/// The bytes of a GLB, put together piece by piece.
class GlbFixture {
 public:
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};

  /// Appends values as a buffer view of their own; its index.
  size_t add_view(std::span<const std::byte> bytes, size_t stride = 0);
  /// Appends values with an accessor of their own; its index.
  size_t add_floats(const std::vector<float>& values, const char* type);
  template <class T>
  size_t add_values(const std::vector<T>& values, const char* type, int component_type, bool normalized = false) {
    const size_t view = add_view(std::as_bytes(std::span(values)));
    return add_accessor(view, values.size() / components(type), type, component_type, normalized);
  }
  size_t add_accessor(size_t view, size_t count, const char* type, int component_type, bool normalized = false);
  /// A mesh of one primitive; its index.
  size_t add_mesh(size_t positions, size_t indices);
  std::string bytes() const;
  /// The JSON with the buffer in a file of the given name.
  std::string gltf(const std::string& uri) const;
  std::string binary() const { return binary_; }

  static size_t components(std::string_view type);

 private:
  std::string binary_;
};

/// A tetrahedron with a corner at the origin and the others one metre along the axes; closed, fronts outwards.
GlbFixture tetrahedron_glb();

/// Whether everything that Scene promises holds; otherwise what does not.
std::string find_scene_defect(const Scene& scene);

}  // namespace promenade
