#pragma once
// The catalogue of what stands in a building: every kind of object, made by parametric generators.

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/random.h"

namespace promenade {

/// A kind of object. Its frame: metres, z up; the origin is on the floor (or the surface it stands on) in the middle of
/// its footprint, or, for what hangs on a wall, in the middle of its back. Its front looks towards -y: a sitter looks
/// towards -y, the user of a desk sits at its -y side, a picture is seen from -y.
struct FurnitureItem {
  std::string name;                           ///< unique: "office_chair_2"
  std::string class_name;                     ///< "chair"
  std::function<Mesh(double quality)> build;  ///< closed parts, outward wound. Pure; any thread
};

/// All the kinds, in an order that only the code decides. Variants of a kind stand together: "book_0", "book_1", ...
class FurnitureCatalogue {
 public:
  FurnitureCatalogue();

  std::span<const FurnitureItem> items() const { return items_; }
  /// Index of the item of that name, or of variant `variant` (modulo how many there are) of that kind. The name must
  /// exist: a wrong one is a bug.
  uint32_t find(std::string_view kind, uint32_t variant = 0) const;
  uint32_t variants(std::string_view kind) const;

  /// Adds items as kind_0, kind_1, ...; what the catalogue's own chapters call.
  void add(std::string_view kind, std::string_view class_name, std::vector<std::function<Mesh(double)>> builders);

 private:
  struct Kind {
    std::string name;
    uint32_t first = 0, count = 0;
  };
  std::vector<FurnitureItem> items_;
  std::vector<Kind> kinds_;
};

/// The boards of every bookcase: book ends fit between them. The lowest board's top, the distance of the next, their
/// number, half of the inner width, how far a book's spine stands from the middle of a one-sided and of a two-sided
/// case.
constexpr double kShelfFirstM = 0.1, kShelfPitchM = 0.37, kShelfInnerHalfM = 0.42;
constexpr uint32_t kShelfBoards = 5;
constexpr double kSpineOneSidedM = -0.11, kSpineTwoSidedM = -0.24;

/// Size of a book variant (width along the shelf, depth, height), which the shelving needs. Source: the same
/// parameters that build it.
struct BookSize {
  double width_m, depth_m, height_m;
};
BookSize book_size(uint32_t variant);

// The chapters of the catalogue, one file each.
void add_seating(FurnitureCatalogue& catalogue);
void add_tables(FurnitureCatalogue& catalogue);
void add_storage(FurnitureCatalogue& catalogue);
void add_lamps(FurnitureCatalogue& catalogue);
void add_plants(FurnitureCatalogue& catalogue);
void add_devices(FurnitureCatalogue& catalogue);
void add_small_things(FurnitureCatalogue& catalogue);
void add_fittings(FurnitureCatalogue& catalogue);
void add_outdoors(FurnitureCatalogue& catalogue);

}  // namespace promenade
