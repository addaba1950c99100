#pragma once
// Lines of equal depth within a mask: polygons that keep a given distance from everything outside it.

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace promenade {

/// A mask over a grid of square cells, x fastest; its outermost cells must be 0.
struct Mask {
  uint32_t nx = 0, ny = 0;
  std::vector<uint8_t> inside;
};

/// Squared distance, in cells, from each cell's middle to the middle of the nearest cell outside. Exact.
/// Source: P. Felzenszwalb, D. Huttenlocher, Distance Transforms of Sampled Functions, 2012.
std::vector<float> squared_depths(const Mask& mask);

/// A closed polygon in units of cells, (0.5, 0.5) the middle of the first cell.
using Loop = std::vector<glm::vec2>;

/// Loops whose every point (corners and sides alike) lies at least depth_cells from every point of every cell outside
/// the mask. They have few corners: what sticks out by less than loss_cells is cut off. depths: squared_depths(mask).
std::vector<Loop> loops_at_depth(const Mask& mask, std::span<const float> depths, double depth_cells,
                                 double loss_cells);

}  // namespace promenade
