// Source: [chhugani2003] section 5.2 takes occluders from the nodes themselves; what hides most in them is their solid
// inside.

#include "preprocess/visibility/solid_boxes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>

#include "preprocess/visibility/columns.h"
#include "preprocess/visibility/leaf_meshes.h"

namespace promenade {
namespace {

constexpr uint32_t kThinnestColumns = 2;  // thinner boxes hide nothing from a cell
constexpr double kTaken = 0.6;            // of a span's height: what a box covers so far starts no other

/// Grows boxes in the solid spans of a tile's columns.
class BoxGrower {
 public:
  BoxGrower(const ColumnGrid& grid, const SolidColumns& solid, const Box& core, const Box& model_box)
      : grid_(grid), solid_(solid), core_(core), lowest_m_(model_box.min.z), taken_(solid.spans.size(), 0) {
    first_.assign(grid.count() + 1, 0);
    for (const SolidColumns::Span& span : solid.spans) ++first_[span.column + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
  }

  std::vector<Box> run() {
    std::vector<Box> boxes;
    for (const uint32_t seed : seeds())
      if (taken_[seed] == 0)
        if (const std::optional<Box> box = grow(seed)) boxes.push_back(*box);
    return boxes;
  }

 private:
  struct Rect {
    uint32_t x0, y0, x1, y1;  ///< columns, inclusive
    float base_m, top_m;
    double volume() const { return double(x1 - x0 + 1) * double(y1 - y0 + 1) * double(std::max(0.0F, top_m - base_m)); }
  };

  float base_of(const SolidColumns::Span& span) const { return std::max(span.base_m, lowest_m_); }
  uint32_t x_of(uint32_t span) const { return solid_.spans[span].column % grid_.nx; }
  uint32_t y_of(uint32_t span) const { return solid_.spans[span].column / grid_.nx; }

  /// From the inside of what is solid outwards: by how many columns to each side have a like span.
  std::vector<uint32_t> seeds() const {
    std::vector<uint32_t> reach(solid_.spans.size(), 0), order(solid_.spans.size());
    for (uint32_t i = 0; i < reach.size(); ++i) {
      const Rect own{x_of(i), y_of(i), x_of(i), y_of(i), base_of(solid_.spans[i]), solid_.spans[i].top_m};
      constexpr uint32_t kFarthest = 32;
      uint32_t r = 1;
      const auto like = [&](uint32_t x, uint32_t y) {
        const std::optional<uint32_t> span = span_at(x, y, own);
        if (!span) return false;
        const float height =
            std::min(solid_.spans[*span].top_m, own.top_m) - std::max(base_of(solid_.spans[*span]), own.base_m);
        return double(height) > kTaken * double(own.top_m - own.base_m);
      };
      while (r < kFarthest && own.x0 >= r && own.y0 >= r && own.x0 + r < grid_.nx && own.y0 + r < grid_.ny &&
             like(own.x0 - r, own.y0) && like(own.x0 + r, own.y0) && like(own.x0, own.y0 - r) &&
             like(own.x0, own.y0 + r))
        r = r < 4 ? r + 1 : r * 2;
      reach[i] = r;
    }
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return reach[a] > reach[b]; });
    return order;
  }

  /// The span of a column that has most in common with a rectangle's heights.
  std::optional<uint32_t> span_at(uint32_t x, uint32_t y, const Rect& rect) const {
    const size_t column = size_t(y) * grid_.nx + x;
    std::optional<uint32_t> best;
    float most_m = 0;
    for (uint32_t i = first_[column]; i < first_[column + 1]; ++i) {
      const float height_m =
          std::min(solid_.spans[i].top_m, rect.top_m) - std::max(base_of(solid_.spans[i]), rect.base_m);
      if (height_m > most_m) most_m = height_m, best = i;
    }
    return best;
  }

  /// The rectangle with a strip of columns more; none where one of them is not solid.
  std::optional<Rect> with(const Rect& rect, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1) const {
    Rect more{std::min(rect.x0, x0), std::min(rect.y0, y0), std::max(rect.x1, x1),
              std::max(rect.y1, y1), rect.base_m,           rect.top_m};
    for (uint32_t y = y0; y <= y1; ++y)
      for (uint32_t x = x0; x <= x1; ++x) {
        const std::optional<uint32_t> span = span_at(x, y, more);
        if (!span) return std::nullopt;
        more.base_m = std::max(more.base_m, base_of(solid_.spans[*span]));
        more.top_m = std::min(more.top_m, solid_.spans[*span].top_m);
      }
    return more;
  }

  std::optional<Box> grow(uint32_t seed) {
    const SolidColumns::Span& span = solid_.spans[seed];
    Rect rect{x_of(seed), y_of(seed), x_of(seed), y_of(seed), base_of(span), span.top_m};
    while (true) {
      std::optional<Rect> best;
      const auto offer = [&](const std::optional<Rect>& more) {
        if (more && more->volume() > (best ? best->volume() : rect.volume())) best = more;
      };
      if (rect.x0 > 0) offer(with(rect, rect.x0 - 1, rect.y0, rect.x0 - 1, rect.y1));
      if (rect.x1 + 1 < grid_.nx) offer(with(rect, rect.x1 + 1, rect.y0, rect.x1 + 1, rect.y1));
      if (rect.y0 > 0) offer(with(rect, rect.x0, rect.y0 - 1, rect.x1, rect.y0 - 1));
      if (rect.y1 + 1 < grid_.ny) offer(with(rect, rect.x0, rect.y1 + 1, rect.x1, rect.y1 + 1));
      if (!best) break;
      rect = *best;
    }
    take(rect);
    taken_[seed] = 1;
    const auto thinnest = static_cast<float>(kThinnestColumns * grid_.column_m);
    if (rect.x1 - rect.x0 + 1 < kThinnestColumns || rect.y1 - rect.y0 + 1 < kThinnestColumns ||
        rect.top_m - rect.base_m < thinnest)
      return std::nullopt;
    const glm::dvec2 low = grid_.low + glm::dvec2(rect.x0, rect.y0) * grid_.column_m;
    const glm::dvec2 high = grid_.low + glm::dvec2(rect.x1 + 1, rect.y1 + 1) * grid_.column_m;
    const Box box{glm::vec3(glm::vec2(low), rect.base_m), glm::vec3(glm::vec2(high), rect.top_m)};
    // What lies in a tile's margin only is its neighbour's.
    return box.overlaps(core_) ? std::optional(box) : std::nullopt;
  }

  void take(const Rect& rect) {
    for (uint32_t y = rect.y0; y <= rect.y1; ++y)
      for (uint32_t x = rect.x0; x <= rect.x1; ++x) {
        const size_t column = size_t(y) * grid_.nx + x;
        for (uint32_t i = first_[column]; i < first_[column + 1]; ++i) {
          const float base_m = base_of(solid_.spans[i]), top_m = solid_.spans[i].top_m;
          const float both_m = std::min(top_m, rect.top_m) - std::max(base_m, rect.base_m);
          if (double(both_m) >= kTaken * double(top_m - base_m)) taken_[i] = 1;
        }
      }
  }

  const ColumnGrid& grid_;
  const SolidColumns& solid_;
  Box core_;
  float lowest_m_;
  std::vector<uint32_t> first_;  ///< span, by column, and the end
  std::vector<uint8_t> taken_;   ///< by span
};

Result<std::vector<Box>> work_tile(const ModelReader& model, const ColumnGrid& grid, const Box& core,
                                   const Box& model_box, JobMonitor& monitor) {
  Box around = model_box;
  around.min.x = static_cast<float>(grid.low.x), around.min.y = static_cast<float>(grid.low.y);
  around.max.x = static_cast<float>(grid.low.x + grid.nx * grid.column_m);
  around.max.y = static_cast<float>(grid.low.y + grid.ny * grid.column_m);
  ColumnOptions options;
  options.rule = SlipRule::open;
  options.spans = true;
  ColumnBuilder builder(grid, options);
  PROMENADE_TRY(for_each_mesh_near(model, around, monitor, [&](const Mesh& mesh) {  // what moves hides nothing
    builder.add(mesh, model.model().tables.materials);
  }));
  const std::optional<SolidColumns> solid = builder.finish();
  return BoxGrower(grid, *solid, core, model_box).run();
}

}  // namespace

Result<std::vector<Box>> find_solid_boxes(const ModelReader& model, const SolidBoxOptions& options,
                                          JobMonitor& monitor) {
  const ModelTables& tables = model.model().tables;
  Box box;
  for (const NodeId root : tables.roots) box.add(tables.nodes[index_of(root)].box);
  if (box.empty()) return std::vector<Box>();
  const glm::dvec2 size(box.size());
  const double column_m = std::max(std::min(options.column_m, std::max(size.x, size.y) / options.most_columns), 1e-4);
  const double tile_m = options.tile_columns * column_m;
  const auto tiles_x = static_cast<size_t>(size.x / tile_m) + 1, tiles_y = static_cast<size_t>(size.y / tile_m) + 1;
  std::vector<std::optional<Result<std::vector<Box>>>> made(tiles_x * tiles_y);
  std::atomic<size_t> done = 0;
  tbb::parallel_for(size_t(0), made.size(), [&](size_t i) {
    const glm::dvec2 low = glm::dvec2(box.min) + glm::dvec2(i % tiles_x, i / tiles_x) * tile_m, high = low + tile_m;
    Box core = box;
    core.min.x = static_cast<float>(low.x), core.min.y = static_cast<float>(low.y);
    core.max.x = static_cast<float>(high.x), core.max.y = static_cast<float>(high.y);
    ColumnGrid grid;
    grid.column_m = column_m;
    const double margin_m = options.margin_columns * column_m;
    // Beyond the model there is only air: a column or two of it.
    const glm::dvec2 from = glm::max(low - margin_m, glm::dvec2(box.min) - 2 * column_m);
    const glm::dvec2 to = glm::min(high + margin_m, glm::dvec2(box.max) + 2 * column_m);
    grid.low = from;
    grid.nx = static_cast<uint32_t>(std::ceil((to.x - from.x) / column_m)) + 1;
    grid.ny = static_cast<uint32_t>(std::ceil((to.y - from.y) / column_m)) + 1;
    made[i] = work_tile(model, grid, core, box, monitor);
    monitor.progress("solid boxes", ++done, made.size());
  });
  std::vector<Box> boxes;
  for (const std::optional<Result<std::vector<Box>>>& tile : made) {
    if (!tile->ok()) return tile->error();
    boxes.insert(boxes.end(), (*tile)->begin(), (*tile)->end());
  }
  return boxes;
}

}  // namespace promenade
