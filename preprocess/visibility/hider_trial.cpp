#include "preprocess/visibility/hider_trial.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "geometry/random.h"
#include "layout/cell_front.h"

namespace promenade {
namespace {

constexpr uint32_t kTrialCells = 24;
constexpr uint32_t kTries = 200'000;  // for as many places; a world may be nearly solid
constexpr uint64_t kLeastPart = 100;  // a hider is worth it from one triangle in so many on
constexpr double kWorthWalls = 0.1;   // cells lie along walls where so much hides; in a furnished building it is 0.9

/// Random boxes around open space that is not above everything.
std::vector<Box> trial_cells(const Model& model, const ViewVolume& volume, float side_m) {
  float top_m = std::numeric_limits<float>::lowest();
  for (const NodeId root : model.tables.roots) top_m = std::max(top_m, model.tables.nodes[index_of(root)].box.max.z);
  const VoxelGrid& grid = volume.grid();
  Random random(1);
  std::vector<Box> cells;
  cells.reserve(kTrialCells);
  for (uint32_t i = 0; i < kTries && cells.size() < kTrialCells; ++i) {
    const auto below = [&](int axis) {
      return static_cast<int>(random.below(static_cast<uint32_t>(grid.count[axis])));
    };
    const int x = below(0), y = below(1), z = below(2);
    const glm::vec3 center = grid.center({x, y, z});
    if (volume.kind({x, y, z}) != ViewVolume::Kind::open || center.z >= top_m) continue;
    const Box around{glm::max(center - side_m / 2, grid.box.min), glm::min(center + side_m / 2, grid.box.max)};
    cells.push_back(volume.above_ground(around));
  }
  return cells;
}

/// Triangles of one cell's front, and by hider how many of them it hid.
struct Trial {
  uint64_t triangles = 0;
  std::vector<uint64_t> hidden;
};

Result<Trial> try_cell(const Model& model, const std::vector<std::unique_ptr<Hider>>& hiders, const Box& cell,
                       const FrontBound& bound) {
  const std::vector<NodeId> front = cell_front(model, cell, bound);
  std::vector<uint8_t> hidden(front.size(), 0);
  Trial trial;
  trial.hidden.reserve(hiders.size());
  const auto sum = [&] {
    uint64_t triangles = 0;
    for (size_t i = 0; i < front.size(); ++i)
      if (hidden[i] != 0) triangles += model.tables.nodes[index_of(front[i])].triangles;
    return triangles;
  };
  uint64_t before = 0;
  for (const std::unique_ptr<Hider>& hider : hiders) {
    PROMENADE_TRY(hider->hide({cell, front}, hidden));
    const uint64_t after = sum();
    trial.hidden.push_back(after - before);
    before = after;
  }
  for (const NodeId id : front) trial.triangles += model.tables.nodes[index_of(id)].triangles;
  return trial;
}

/// Asks the chain in a few random places where somebody may stand and drops each hider, but for the first and cheapest,
/// that hides less than one in a hundred of the triangles there: in most worlds most hiders find much or next to
/// nothing. Judges by what is hidden, not by time, so that the same model always gets the same chain. Returns the share
/// of the triangles that those left hide beside the first. Runs on the threads of the arena.
Result<double> drop_idle(const Model& model, const ViewSpace& space, const CellOptions& options,
                         std::vector<std::unique_ptr<Hider>>& hiders, JobMonitor& monitor) {
  if (hiders.size() < 2) return 0.0;
  const std::vector<Box> cells = trial_cells(model, space.volume, static_cast<float>(options.smallest_cell_m));
  if (cells.empty()) return 1.0;  // nobody can tell
  const FrontBound bound = bound_of(options);
  std::vector<std::optional<Result<Trial>>> trials(cells.size());
  tbb::parallel_for(size_t(0), cells.size(), [&](size_t i) {
    if (!monitor.cancelled()) trials[i] = try_cell(model, hiders, cells[i], bound);
  });
  if (monitor.cancelled()) return Error{"interrupted"};
  Trial all;
  all.hidden.assign(hiders.size(), 0);
  for (const std::optional<Result<Trial>>& trial : trials) {
    if (!trial->ok()) return trial->error();
    all.triangles += (**trial).triangles;
    for (size_t h = 0; h < hiders.size(); ++h) all.hidden[h] += (**trial).hidden[h];
  }
  uint64_t hidden = 0;
  for (size_t h = hiders.size(); h-- > 1;) {
    if (all.hidden[h] * kLeastPart < all.triangles)
      hiders.erase(hiders.begin() + static_cast<std::ptrdiff_t>(h));
    else
      hidden += all.hidden[h];
  }
  return double(hidden) / std::max(1.0, double(all.triangles));
}

}  // namespace

Result<std::vector<std::unique_ptr<Hider>>> make_hiders_for(const std::vector<std::string>& names,
                                                            const ModelReader& reader, const ViewSpace& space,
                                                            const CellOptions& cells, HiderMaker& maker,
                                                            JobMonitor& monitor) {
  Result<std::vector<std::unique_ptr<Hider>>> hiders = maker.make(resolved_hiders(names, space.style));
  if (!hiders || !hiders_are_auto(names)) return hiders;
  const Result<double> hidden = drop_idle(reader.model(), space, cells, *hiders, monitor);
  if (!hidden) return hidden.error();
  return hiders;
}

Result<ViewPlan> plan_views(const std::vector<std::string>& names, const ModelReader& reader, const CellOptions& cells,
                            const HiderBuildOptions& options, JobMonitor& monitor) {
  Result<ViewSpace> space = survey_view_space(reader, cells, monitor);
  if (!space) return space.error();
  HiderMaker maker(reader, options, monitor);
  if (cells.cells == CellStyle::automatic && hiders_are_auto(names) && space->style == CellStyle::kd) {
    Result<std::vector<std::unique_ptr<Hider>>> along_walls = maker.make(hiders_for(CellStyle::kd));
    if (!along_walls) return along_walls.error();
    const Result<double> hidden = drop_idle(reader.model(), *space, cells, *along_walls, monitor);
    if (!hidden) return hidden.error();
    if (*hidden >= kWorthWalls) return ViewPlan{std::move(*space), std::move(*along_walls)};
    space->style = CellStyle::octree;
  }
  Result<std::vector<std::unique_ptr<Hider>>> hiders = make_hiders_for(names, reader, *space, cells, maker, monitor);
  if (!hiders) return hiders.error();
  return ViewPlan{std::move(*space), std::move(*hiders)};
}

Result<std::vector<std::string>> chain_for_model(const std::vector<std::string>& names, const ModelReader& reader,
                                                 JobMonitor& monitor) {
  if (!hiders_are_auto(names)) return names;
  CellOptions options;
  options.cells = CellStyle::automatic;
  const Result<ViewPlan> plan = plan_views(names, reader, options, HiderBuildOptions(), monitor);
  if (!plan) return plan.error();
  std::vector<std::string> chain;
  chain.reserve(plan->hiders.size());
  for (const std::unique_ptr<Hider>& hider : plan->hiders) chain.emplace_back(hider->name());
  return chain;
}

}  // namespace promenade
