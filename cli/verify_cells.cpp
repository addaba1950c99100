#include "cli/verify_cells.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <random>

#include "cli/console.h"
#include "cli/node_picture.h"
#include "preprocess/visibility/hider_trial.h"
#include "preprocess/visibility/study_cells.h"

namespace promenade {
namespace {

/// A cell with what is drawn from it and what is left out.
struct CheckedCell {
  Box cell;
  std::vector<NodeId> front;
  std::vector<uint8_t> hidden;
  Looks looks;
  CellVerdict verdict;
};

/// Where the answers come from: the model's own cells, or a chain of hiders asked now.
class Answers {
 public:
  Answers(const VerifyCellsOptions& options, const ModelReader& reader, const NodeMeshes& meshes)
      : options_(options), reader_(reader), meshes_(meshes), bound_{options.pixel_error, pixel_scale(1280, 720, 60)} {}

  Status prepare(JobMonitor& monitor) {
    const CellsReader* stored = reader_.cells();
    if (!options_.hiders.empty()) {
      const Result<std::vector<std::string>> names = parse_hiders(options_.hiders);
      if (!names) return names.error();
      const Result<std::vector<std::string>> chain = chain_for_model(*names, reader_, monitor);
      if (!chain) return chain.error();
      Result<std::vector<std::unique_ptr<Hider>>> hiders =
          HiderMaker(reader_, HiderBuildOptions(), monitor).make(*chain);
      if (!hiders) return hiders.error();
      hiders_ = std::move(*hiders);
    }
    if (stored != nullptr) {
      bound_ = stored->tables().bound;
      pick_stored(stored->tables().cells.size());
      return Done{};
    }
    StudyCellOptions study;
    study.seed = options_.looks.seed, study.cells = (options_.cells + 1) / 2;
    for (const StudyPlace place : {StudyPlace::street, StudyPlace::roof}) {
      study.place = place;
      const Result<std::vector<Box>> made = study_cells(meshes_, study);
      if (!made) return made.error();
      boxes_.insert(boxes_.end(), made->begin(), made->end());
      study.cells = options_.cells / 2, study.side_m = 16;
    }
    return Done{};
  }

  size_t count() const { return boxes_.size(); }

  Result<CheckedCell> check(size_t i) const {
    const Model& model = reader_.model();
    CheckedCell cell{boxes_[i], cell_front(model, boxes_[i], bound_), {}, {}, {}};
    cell.hidden.assign(cell.front.size(), 0);
    if (options_.hiders.empty()) {
      const Result<Vlod> vlod = reader_.cells()->read_vlod(ids_[i]);
      if (!vlod) return vlod.error();
      for (size_t k = 0; k < cell.front.size(); ++k)
        cell.hidden[k] = std::binary_search(vlod->nodes.begin(), vlod->nodes.end(), cell.front[k]) ? 0 : 1;
    }
    for (const std::unique_ptr<Hider>& hider : hiders_)
      PROMENADE_TRY(hider->hide({cell.cell, cell.front}, cell.hidden));
    LookOptions how = options_.looks;
    if (!ids_.empty()) how.seed += i / reader_.cells()->tables().cells.size();
    Result<Looks> looks = look_from_cell(meshes_, cell.cell, cell.front, cell.hidden, how);
    if (!looks) return looks.error();
    cell.looks = std::move(*looks);
    cell.verdict = judge(model, cell.front, cell.hidden, cell.looks);
    return cell;
  }

 private:
  /// Every cell once before any twice, and then from other eyes.
  void pick_stored(size_t available) {
    std::mt19937_64 random(options_.looks.seed);
    std::vector<CellId> round(available);
    for (uint32_t i = 0; i < available; ++i) round[i] = CellId{i};
    const size_t count = available == 0 ? 0 : options_.cells;
    ids_.reserve(count), boxes_.reserve(count);
    for (size_t i = 0; i < count; ++i) {
      const size_t left = available - i % available;
      std::swap(round[left - 1], round[random() % left]);
      ids_.push_back(round[left - 1]);
      boxes_.push_back(reader_.cells()->tables().cells[index_of(ids_.back())].box);
    }
  }

  const VerifyCellsOptions& options_;
  const ModelReader& reader_;
  const NodeMeshes& meshes_;
  FrontBound bound_;
  std::vector<std::unique_ptr<Hider>> hiders_;
  std::vector<CellId> ids_;  ///< of stored cells, else empty
  std::vector<Box> boxes_;
};

struct Totals {
  uint64_t cells = 0, solid_cells = 0, pixels = 0, aimed_rays = 0, false_nodes = 0, false_pixels = 0, ratios = 0;
  uint64_t missed_nodes = 0, missed_pixels = 0, slit_pixels = 0;
  double ratio_sum = 0;

  void add(const CheckedCell& cell) {
    if (cell.looks.eyes == 0) {
      ++solid_cells;
      return;
    }
    ++cells;
    pixels += cell.looks.pixels, aimed_rays += cell.looks.aimed_rays;
    false_nodes += cell.verdict.false_hidden_nodes, false_pixels += cell.verdict.false_hidden_pixels;
    missed_nodes += cell.verdict.missed_nodes, missed_pixels += cell.verdict.missed_pixels;
    slit_pixels += cell.verdict.slit_pixels;
    if (cell.verdict.seen_triangles == 0) return;
    ++ratios;
    ratio_sum += double(cell.verdict.kept_triangles) / double(cell.verdict.seen_triangles);
  }
};

/// What is left out although it is seen, in red; the rest as it is.
Status draw_worst(const NodeMeshes& meshes, const CheckedCell& cell, const std::filesystem::path& path) {
  const auto color_of = [&](size_t i) {
    return cell.hidden[i] != 0 ? glm::u8vec3(255, 0, 0) : glm::u8vec3(190, 195, 200);
  };
  return write_node_picture(meshes, cell.front, cell.looks.worst, color_of, Box(), path);
}

void add_rays(const std::vector<MissedRay>& rays, const glm::dvec3& origin, Json& list) {
  for (const MissedRay& ray : rays) {
    const glm::dvec3 eye = ray.eye + origin, at = ray.at + origin;
    list.push_back({{"node", index_of(ray.node)}, {"eye", {eye.x, eye.y, eye.z}}, {"at", {at.x, at.y, at.z}}});
  }
}

}  // namespace

Status verify_cells(const VerifyCellsOptions& options, const ModelReader& reader, JobMonitor& monitor, Json& figures) {
  Result<std::unique_ptr<NodeMeshes>> meshes = NodeMeshes::make(reader, uint64_t(1) << 30);
  if (!meshes) return meshes.error();
  Answers answers(options, reader, **meshes);
  PROMENADE_TRY(answers.prepare(monitor));
  std::vector<std::optional<Result<CheckedCell>>> checked(answers.count());
  const size_t first = std::min<size_t>(options.skip_cells, checked.size());
  std::atomic<size_t> next = first, done = first;
  const WallClock clock;
  tbb::parallel_for(first, checked.size(), [&](size_t /*any*/) {
    if (monitor.cancelled() || (options.seconds && clock.seconds() > *options.seconds)) return;
    const size_t i = next++;  // in order, so that what is left is the last cells
    checked[i] = answers.check(i);
    monitor.progress("look around in cells", ++done, checked.size());
  });
  if (monitor.cancelled()) return Error{"interrupted"};
  const size_t end = next;
  Totals totals;
  const CheckedCell* worst = nullptr;
  const glm::dvec3& origin = reader.model().manifest.origin;
  figures["missed"] = figures["slits"] = Json::array();
  for (const std::optional<Result<CheckedCell>>& cell : std::span(checked).subspan(first, end - first)) {
    if (!cell->ok()) return cell->error();
    totals.add(**cell);
    add_rays((*cell)->looks.missed, origin, figures["missed"]);
    add_rays((*cell)->looks.slits, origin, figures["slits"]);
    if (worst == nullptr || (*cell)->looks.worst_pixels > worst->looks.worst_pixels) worst = &**cell;
  }
  const double ratio = totals.ratios == 0 ? 0 : totals.ratio_sum / double(totals.ratios);
  figures["cells_checked"] = totals.cells;
  figures["cells_solid"] = totals.solid_cells;
  figures["rays_or_pixels_checked"] = totals.pixels;
  figures["rays_aimed_at_hidden_nodes"] = totals.aimed_rays;
  figures["false_hidden_nodes"] = totals.false_nodes;
  figures["false_hidden_pixels"] = totals.false_pixels;
  figures["overestimate_ratio_mean"] = ratio;
  const uint64_t crack_pixels = totals.false_pixels - totals.missed_pixels - totals.slit_pixels;
  figures["false_hidden_pixels_at_cracks"] = crack_pixels;
  figures["false_hidden_pixels_at_slits"] = totals.slit_pixels;
  figures["missed_nodes"] = totals.missed_nodes;
  figures["missed_pixels"] = totals.missed_pixels;
  fmt::print("{} cells ({} more are solid), {} pixels, {} of them rays aimed at hidden nodes; overestimate {:.3f}\n",
             totals.cells, totals.solid_cells, totals.pixels, totals.aimed_rays, ratio);
  figures["cells_left"] = checked.size() - end;
  if (end < checked.size())
    fmt::print("  {} cells are left: go on with --skip-cells {} and the same --cells and --seed\n",
               checked.size() - end, end);
  fmt::print(
      "  hidden and yet seen: {} nodes, {} pixels; of these {} pixels through cracks between levels of detail, {} "
      "through\n"
      "  slits that are narrower than 2 mm at full detail\n",
      totals.false_nodes, totals.false_pixels, crack_pixels, totals.slit_pixels);
  if (!options.picture.empty() && worst != nullptr && worst->looks.worst_pixels > 0)
    PROMENADE_TRY(draw_worst(**meshes, *worst, options.picture));
  for (const Json& ray : figures["missed"])
    fmt::print("  hidden node {} is seen from {} at {}\n", ray["node"].dump(), ray["eye"].dump(), ray["at"].dump());
  if (totals.missed_nodes > 0)
    return Error{fmt::format("{}: {} hidden nodes can be seen at full detail, too ({} pixels)", options.model.string(),
                             totals.missed_nodes, totals.missed_pixels)};
  return Done{};
}

}  // namespace promenade
