#pragma once
// What `study hiders` found, as a page to look at: cost and quality by the size of cells and of models.

#include <string>
#include <vector>

namespace promenade {

/// What a chain cost and was worth in one model and size of cells.
struct ChainFigures {
  std::string name;
  double ms_per_cell = 0, hidden_share = 0, overestimate = 0, nodes_mean = 0, triangles_mean = 0;
  uint64_t false_hidden_nodes = 0, false_hidden_pixels = 0;
};

/// One model with cells of one size.
struct HiderFigures {
  std::string model;
  uint64_t model_triangles = 0, cells = 0;
  double side_m = 0;  ///< 0: the model's own cells
  double reference_ms_per_cell = 0;
  std::vector<ChainFigures> chains;  ///< the same ones in all studies of a page
};

/// A self-contained page: a table, and where sides or models differ, plots of milliseconds a cell and of the
/// overestimate by side and by model, a line a chain. studies: not empty.
std::string html_of(const std::vector<HiderFigures>& studies, const std::string& subtitle);

}  // namespace promenade
