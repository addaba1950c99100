#include "preprocess/visibility/visibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "codec/frame.h"
#include "layout/cell_faces.h"
#include "preprocess/unit_io.h"
#include "preprocess/visibility/rooms.h"
#include "preprocess/visibility/slots.h"
#include "preprocess/visibility/view_cells.h"
#include "preprocess/visibility/wall_planes.h"

namespace promenade {

namespace {

constexpr uint64_t kVoxels = 8 << 20;  // 72 MiB, within the least memory that a build takes
/// Air above the model that belongs to viewing space, in heights of the model.
constexpr float kSky = 0.25F;
/// The uniform grid that division starts from takes at most this part of the cells.
constexpr uint32_t kStartPart = 4;
constexpr uint32_t kFewestCells = 256, kMostCells = 4096;
constexpr float kLeastRoomPart = 32;  // of the model's length: one made small is not all slots

Box viewing_space(const Model& model) {
  Box box;
  for (const NodeId root : model.tables.roots) box.add(model.tables.nodes[index_of(root)].box);
  // A flat model has no volume to walk in: give it some.
  const float least = std::max(box.diagonal() * 1e-3F, 1e-3F);
  for (int i = 0; i < 3; ++i)
    if (box.size()[i] < least) box.min[i] -= least, box.max[i] += least;
  box.max.z += kSky * box.size().z;
  return box;
}

float top_of(const Model& model) {
  float top_m = std::numeric_limits<float>::lowest();
  for (const NodeId root : model.tables.roots) top_m = std::max(top_m, model.tables.nodes[index_of(root)].box.max.z);
  return top_m;
}

/// Division of viewing space under way: the plan, and the vLODs of its cells.
class Division {
 public:
  Division(const ModelReader& reader, const ViewVolume& volume, CellUnits& units, const CellOptions& options,
           JobMonitor& monitor)
      : reader_(reader),
        monitor_(monitor),
        volume_(volume),
        units_(units),
        options_(options),
        plan_(viewing_space(reader.model())),
        top_m_(top_of(reader.model())) {
    const glm::vec3 size = plan_.box_of(CellPlan::kRoot).size();
    least_room_m_ =
        std::min(static_cast<float>(options.least_room_m), std::max({size.x, size.y, size.z}) / kLeastRoomPart);
    const uint64_t nodes = reader.model().tables.nodes.size();
    most_ = options.max_cells != 0 ? options.max_cells
                                   : static_cast<uint32_t>(std::clamp<uint64_t>(nodes, kFewestCells, kMostCells));
  }

  /// patches: what to divide along; empty: evenly.
  Status run(const std::vector<AxialPatch>& patches) {
    const Result<std::vector<uint32_t>> start = patches.empty() ? start_grid() : start_rooms(patches);
    if (!start.ok()) return start.error();
    cells_ = start->size();
    PROMENADE_TRY(evaluate(*start));
    while (true) {
      const std::vector<uint32_t> chosen = choose();
      if (chosen.empty()) break;
      PROMENADE_TRY(divide(chosen));
    }
    return Done{};
  }

  /// Makes one cell of two halves from which the same is seen at the same detail, and one dead space of two: their
  /// borders tell nobody anything.
  void join_alike(const Model& model, const FrontBound& bound) {
    std::vector<uint32_t> nodes = plan_.nodes();
    std::reverse(nodes.begin(), nodes.end());  // parts before what they are parts of
    for (const uint32_t node : nodes) {
      if (plan_.is_dead(node)) plan_.drop(node);
      const Box joined = plan_.joined_cells(node);
      if (joined.empty()) continue;
      const uint32_t below = plan_.below(node), above = plan_.above(node);
      if (!alike(vlods_.at(below), vlods_.at(above)) ||
          cell_front(model, plan_.cell_of(below), bound) != cell_front(model, plan_.cell_of(above), bound))
        continue;
      vlods_[node] = std::move(vlods_.at(below));
      vlods_.erase(below), vlods_.erase(above);
      plan_.merge(node);
      plan_.set_cell(node, joined);
      --cells_;
    }
  }

  Result<Visibility> result(const FrontBound& bound) {
    Visibility made;
    std::vector<uint32_t> leaves;
    made.cells = tables_of(plan_, bound, leaves);
    PROMENADE_TRY(find_faces(made.cells));
    for (const uint32_t leaf : leaves) made.vlods.push_back(std::move(vlods_[leaf]));
    return made;
  }

 private:
  /// Halves everything until the next halving would make too many cells.
  std::vector<uint32_t> start_grid() {
    std::vector<uint32_t> leaves = {CellPlan::kRoot};
    mark(leaves);
    while (true) {
      std::vector<uint32_t> finer, divided;
      for (const uint32_t leaf : leaves) {
        // From the air above everything there is little that a division could hide.
        const bool air = plan_.box_of(leaf).min.z >= top_m_;
        std::vector<uint32_t> parts = divisible(leaf) && !air ? plan_.split_octants(leaf) : std::vector<uint32_t>();
        if (parts.empty())
          parts = {leaf};
        else
          divided.push_back(leaf);
        mark(parts);
        finer.insert(finer.end(), parts.begin(), parts.end());
      }
      if (divided.empty()) return leaves;
      if (finer.size() > std::max(1U, most_ / kStartPart)) {
        for (const uint32_t leaf : divided) plan_.merge(leaf);
        return leaves;
      }
      leaves = std::move(finer);
    }
  }

  /// Divides along walls; what lies in a wall, or between walls that nobody fits between, is dropped.
  Result<std::vector<uint32_t>> start_rooms(const std::vector<AxialPatch>& patches) {
    WallSplitOptions split;
    split.thin_m = least_room_m_;  // what is left of a slot beside the window that goes through it is one
    std::vector<uint32_t> leaves = split_along_walls(plan_, CellPlan::kRoot, patches, split);
    if (least_room_m_ > 0) PROMENADE_TRY(drop_slots(leaves));
    std::erase_if(leaves, [this](uint32_t leaf) { return !volume_.holds_open(plan_.box_of(leaf)); });
    for (const uint32_t leaf : leaves) plan_.set_cell(leaf, plan_.box_of(leaf));
    return leaves;
  }

  Status drop_slots(std::vector<uint32_t>& leaves) {
    CellPlan rooms_plan = plan_;
    for (const uint32_t leaf : leaves) rooms_plan.set_cell(leaf, rooms_plan.box_of(leaf));
    std::vector<uint32_t> leaf_of_room;
    CellTables space = tables_of(rooms_plan, FrontBound(), leaf_of_room);
    PROMENADE_TRY(find_faces(space));
    const Result<Rooms> rooms = find_rooms_in(reader_, std::move(space), RoomOptions(), monitor_);
    if (!rooms.ok()) return rooms.error();
    const std::vector<uint8_t> slots = find_slots(*rooms, least_room_m_);
    std::vector<uint32_t> dropped;
    for (size_t i = 0; i < slots.size(); ++i)
      if (slots[i] != 0) dropped.push_back(leaf_of_room[i]);
    std::sort(dropped.begin(), dropped.end());
    std::erase_if(leaves, [&](uint32_t leaf) { return std::binary_search(dropped.begin(), dropped.end(), leaf); });
    return Done{};
  }

  /// Makes cells of the leaves in which somebody may stand, and drops the others.
  void mark(std::vector<uint32_t>& leaves) {
    std::erase_if(leaves, [this](uint32_t leaf) { return !volume_.is_open(plan_.box_of(leaf)); });
    for (const uint32_t leaf : leaves) plan_.set_cell(leaf, volume_.above_ground(plan_.box_of(leaf)));
  }

  static bool alike(const CodedVlod& a, const CodedVlod& b) {
    return a.front_nodes == b.front_nodes && a.front_triangles == b.front_triangles && a.ids == b.ids;
  }

  bool divisible(uint32_t leaf) const { return divisible(plan_.box_of(leaf)); }
  bool divisible(const Box& box) const {
    return box.size()[box.longest_axis()] >= 2 * static_cast<float>(options_.smallest_cell_m);
  }

  /// Computes what new cells see and, for those that may be divided, what the smallest of their parts sees, to foretell
  /// whether that helps. (The paper divides and looks at the parts. In a city these still see over the roofs where
  /// their parts, down in a street, do not, and division would end before it could help.)
  Status evaluate(const std::vector<uint32_t>& leaves) {
    std::vector<Box> boxes;
    boxes.reserve(leaves.size());
    for (const uint32_t leaf : leaves) boxes.push_back(plan_.cell_of(leaf));
    std::vector<uint32_t> probed;
    for (const uint32_t leaf : leaves)
      if (divisible(leaf)) {
        probed.push_back(leaf);
        boxes.push_back(smallest_part(plan_.box_of(leaf)));
      }
    const Result<std::vector<CodedVlod>> made = units_.run(fmt::format("{:03}", round_++), boxes);
    if (!made.ok()) return made.error();
    for (size_t i = 0; i < leaves.size(); ++i) vlods_[leaves[i]] = (*made)[i];
    for (size_t i = 0; i < probed.size(); ++i) {
      const uint64_t sees = vlods_[probed[i]].triangles, least = (*made)[leaves.size() + i].triangles;
      if (sees > options_.cell_triangles && double(sees) > options_.cell_gain * double(least))
        open_.push_back({sees - least, probed[i]});
    }
    return Done{};
  }

  /// The cells to divide next: those from which division takes most away, as many as half of what may still be made, so
  /// that their parts compete with the rest.
  std::vector<uint32_t> choose() {
    std::sort(open_.begin(), open_.end(),
              [](const Open& a, const Open& b) { return a.gain != b.gain ? a.gain > b.gain : a.leaf < b.leaf; });
    constexpr size_t kParts = 8;
    const size_t left = most_ > cells_ ? (most_ - cells_) / (kParts - 1) : 0;
    const size_t count = std::min(open_.size(), (left + 1) / 2);
    std::vector<uint32_t> chosen;
    for (size_t i = 0; i < count; ++i) chosen.push_back(open_[i].leaf);
    open_.erase(open_.begin(), open_.begin() + static_cast<std::ptrdiff_t>(count));
    return chosen;
  }

  Status divide(const std::vector<uint32_t>& leaves) {
    std::vector<uint32_t> all;
    for (const uint32_t leaf : leaves) {
      std::vector<uint32_t> parts = plan_.split_octants(leaf);
      mark(parts);
      if (parts.empty()) {
        plan_.merge(leaf);
        continue;
      }
      vlods_.erase(leaf);
      cells_ += parts.size() - 1;
      all.insert(all.end(), parts.begin(), parts.end());
    }
    return evaluate(all);
  }

  /// The part that halving would reach in the end, on the way always the lowest in which somebody may stand, and of
  /// these the nearest to the middle.
  Box smallest_part(const Box& box) const {
    CellPlan plan(box);
    const glm::vec3 middle = box.center();
    uint32_t at = CellPlan::kRoot;
    while (divisible(plan.box_of(at))) {
      const auto rank = [&](uint32_t part) {
        return std::pair(plan.box_of(part).min.z, plan.box_of(part).distance(middle));
      };
      std::vector<uint32_t> parts = plan.split_octants(at);
      std::erase_if(parts, [&](uint32_t part) { return !volume_.is_open(plan.box_of(part)); });
      if (parts.empty()) break;
      at = *std::min_element(parts.begin(), parts.end(), [&](uint32_t a, uint32_t b) { return rank(a) < rank(b); });
    }
    return volume_.above_ground(plan.box_of(at));
  }

  const ModelReader& reader_;
  JobMonitor& monitor_;
  const ViewVolume& volume_;
  CellUnits& units_;
  const CellOptions& options_;
  CellPlan plan_;
  float top_m_;
  float least_room_m_ = 0;
  uint32_t most_ = 0;
  size_t cells_ = 0;
  uint32_t round_ = 0;
  std::map<uint32_t, CodedVlod> vlods_;  ///< by leaf of the plan
  struct Open {
    uint64_t gain = 0;  ///< triangles
    uint32_t leaf = 0;
  };
  std::vector<Open> open_;  ///< leaves whose division helps
};

Result<ViewVolume> volume_of(const ModelReader& reader, const CellOptions& options, JobMonitor& monitor) {
  Result<ViewVolume> volume = survey_volume(reader, viewing_space(reader.model()), kVoxels, monitor);
  if (!volume.ok()) return volume;
  if (options.walk_height_m) volume->keep_walkable(static_cast<float>(*options.walk_height_m));
  if (!options.inside.empty()) {
    std::vector<Box> boxes;
    const glm::dvec3& origin = reader.model().manifest.origin;
    for (const DBox& box : options.inside) boxes.push_back({box.min - origin, box.max - origin});
    volume->keep_inside(boxes);
  }
  return volume;
}

CellStyle style_of(const CellOptions& options, const ViewVolume& volume) {
  constexpr double kIndoors = 0.5;
  if (options.cells != CellStyle::automatic) return options.cells;
  return volume.roofed_share() > kIndoors ? CellStyle::kd : CellStyle::octree;
}

uint64_t hash_of(const FrontBound& bound, uint64_t hash) {
  UnitWriter writer;
  writer.value(hash), writer.value(bound.pixel_error), writer.value(bound.scale.focal_px);
  writer.value(bound.scale.tan_corner);
  return checksum(writer.bytes());
}

VisibilityFigures figures_of(const Visibility& made, const CellUnitCounts& units) {
  VisibilityFigures figures;
  figures.cells = made.vlods.size();
  for (const CodedVlod& vlod : made.vlods) {
    figures.vlod_nodes_mean += vlod.nodes, figures.vlod_triangles_mean += double(vlod.triangles);
    figures.front_nodes_mean += vlod.front_nodes, figures.front_triangles_mean += double(vlod.front_triangles);
  }
  const double count = std::max<double>(1, double(made.vlods.size()));
  for (double* mean : {&figures.vlod_nodes_mean, &figures.vlod_triangles_mean, &figures.front_nodes_mean,
                       &figures.front_triangles_mean})
    *mean /= count;
  figures.units = units;
  figures.ms_per_cell = units.cells > 0 ? units.busy_ms / double(units.cells) : 0;
  return figures;
}

}  // namespace

Result<ViewSpace> survey_view_space(const ModelReader& reader, const CellOptions& options, JobMonitor& monitor) {
  Result<ViewVolume> volume = volume_of(reader, options, monitor);
  if (!volume.ok()) return volume.error();
  const CellStyle style = style_of(options, *volume);
  return ViewSpace{std::move(*volume), style};
}

Result<Visibility> compute_visibility(const ModelReader& reader, const ViewSpace& space, HiderChain hiders,
                                      const CellOptions& options, uint64_t hash, const WorkFolder& folder,
                                      JobMonitor& monitor) {
  const FrontBound bound = bound_of(options);
  CellUnits units(reader.model(), hiders, bound, hash_of(bound, hash), folder, monitor);
  std::vector<AxialPatch> patches;
  if (space.style == CellStyle::kd) {
    Result<std::vector<AxialPatch>> found = find_axial_patches(reader, monitor);
    if (!found.ok()) return found.error();
    patches = std::move(*found);
  }
  Division division(reader, space.volume, units, options, monitor);
  PROMENADE_TRY(division.run(patches));
  division.join_alike(reader.model(), bound);
  Result<Visibility> made = division.result(bound);
  if (!made) return made;
  made->figures = figures_of(*made, units.counts());
  made->figures.style = space.style;
  made->figures.roofed_share = space.volume.roofed_share();
  return made;
}

}  // namespace promenade
