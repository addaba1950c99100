#pragma once
// Several boxes around the eye, each with far pictures of what lies between it and the next: larger cells, fewer
// pictures. Source: [xiong1996] chapter 4.

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/parallax.h"

namespace promenade {

/// How the boxes grow outwards.
enum class ShellSpacing : uint8_t {
  linear,       ///< each is `factor` times as long as the one within
  exponential,  ///< each has the length of the one within to the power of `factor`
};

struct ShellSetup {
  double bound_rad = 0;    ///< of each shell
  double inner_box_m = 0;  ///< length of the innermost box
  glm::dvec3 model_m{0};   ///< size of the model; its longest side is how far away anything is
  ParallaxRule rule = ParallaxRule::everywhere;
};

struct Shell {
  double cell_m = 0, box_m = 0;
  uint64_t cells = 0;  ///< that fill the model
};

/// Shells, the innermost first: boxes up to the longest side of the model, the last one's pictures reaching to its end.
/// Refuses what view_cell_length_m refuses, factors of 1 or less, exponential growth from a box of a metre or less, and
/// more than 1000 shells. Source: [xiong1996] equation 4.1, "general case".
Result<std::vector<Shell>> shells_of(const ShellSetup& setup, ShellSpacing spacing, double factor);

uint64_t cells_of(const std::vector<Shell>& shells);

/// The model filled with the cells of a single box.
Result<Shell> single_shell(const ShellSetup& setup);

struct ShellOptimum {
  double factor = 0;
  std::vector<Shell> shells;
};
/// The factor, of so many evenly between from and to, with the fewest cells; of equal ones the largest.
Result<ShellOptimum> best_shells(const ShellSetup& setup, ShellSpacing spacing, double from, double to, uint32_t tried);

}  // namespace promenade
