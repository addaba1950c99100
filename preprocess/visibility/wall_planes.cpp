#include "preprocess/visibility/wall_planes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "preprocess/visibility/leaf_meshes.h"

namespace promenade {

namespace {

constexpr float kAxial = 0.9998F;  // cosine of about a degree
constexpr double kPlaneM = 1e-3;   // surfaces this near each other lie in one plane
constexpr double kTiles = 256;     // along a model's longest side

struct PatchKey {
  uint32_t axis;
  int64_t plane, u, v;
  auto operator<=>(const PatchKey&) const = default;
};
using Patches = std::map<PatchKey, AxialPatch>;

void gather(const Mesh& mesh, double tile_m, Patches& patches) {
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::vec3 cross = triangle_cross(mesh, t);
    const float length = glm::length(cross);
    if (!(length > 0)) continue;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis), u = (a + 1) % 3, v = (a + 2) % 3;
      if (std::abs(cross[a]) < kAxial * length) continue;
      Box extent;
      for (size_t corner = 0; corner < 3; ++corner) extent.add(mesh.positions[mesh.indices[3 * t + corner]]);
      const glm::vec3 center = extent.center();
      const auto step = [](float x, double size) { return static_cast<int64_t>(std::floor(double(x) / size)); };
      const PatchKey key{axis, std::llround(double(center[a]) / kPlaneM), step(center[u], tile_m),
                         step(center[v], tile_m)};
      AxialPatch& patch = patches[key];
      patch.axis = axis, patch.at_m = static_cast<float>(double(key.plane) * kPlaneM);
      patch.extent.add(extent);
      patch.area_m2 += double(length) / 2;
    }
  }
}

/// The k-d tree under way.
class WallSplitter {
 public:
  WallSplitter(CellPlan& plan, const std::vector<AxialPatch>& patches, const WallSplitOptions& options)
      : plan_(plan), patches_(patches), options_(options) {}

  std::vector<uint32_t> run(uint32_t leaf) {
    std::vector<uint32_t> all(patches_.size());
    for (uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    split(leaf, all, 0);
    return std::move(leaves_);
  }

 private:
  struct Plane {
    uint32_t axis = 0;
    float at_m = 0;
    double cover = 0;  ///< of the box's cross-section
  };

  void split(uint32_t leaf, const std::vector<uint32_t>& above, int depth) {
    const Box box = plan_.box_of(leaf);
    std::vector<uint32_t> inside;
    for (const uint32_t i : above)
      if (patches_[i].extent.overlaps(box)) inside.push_back(i);
    std::optional<Plane> best;
    if (depth < options_.deepest) best = best_plane(box, inside);
    if (best && best->cover < options_.least_cover) {
      best = side_of_hole(box, inside);
      if (!best) best = widest_margin(box, inside);
    }
    if (!best) {
      leaves_.push_back(leaf);
      return;
    }
    plan_.split(leaf, best->axis, best->at_m);
    const uint32_t below_part = plan_.below(leaf), above_part = plan_.above(leaf);
    split(below_part, inside, depth + 1);
    split(above_part, inside, depth + 1);
  }

  /// Patches are sorted by axis and place, so that a plane's are contiguous. Ties go to the lower plane.
  Plane best_plane(const Box& box, const std::vector<uint32_t>& inside) const {
    Plane best;
    const glm::dvec3 size = box.size();
    for (size_t first = 0; first < inside.size();) {
      const AxialPatch& patch = patches_[inside[first]];
      const int a = static_cast<int>(patch.axis);
      double covered_m2 = 0;
      size_t next = first;
      for (; next < inside.size(); ++next) {
        const AxialPatch& other = patches_[inside[next]];
        if (other.axis != patch.axis || other.at_m != patch.at_m) break;
        covered_m2 += clipped_area_m2(other, box);
      }
      first = next;
      if (patch.at_m - box.min[a] < options_.thinnest_m || box.max[a] - patch.at_m < options_.thinnest_m) continue;
      const double cover = covered_m2 / (size.x * size.y * size.z / size[a]);
      if (cover > best.cover) best = {patch.axis, patch.at_m, cover};
    }
    return best;
  }

  /// In a thin box, the plane with the longest surface that goes through it from side to side.
  std::optional<Plane> side_of_hole(const Box& box, const std::vector<uint32_t>& inside) const {
    constexpr float kThrough = 0.8F, kShortestM = 0.3F;
    const glm::vec3 size = box.size();
    const int thin = size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2;
    if (size[thin] >= options_.thin_m) return std::nullopt;
    std::optional<Plane> best;
    float longest_m = kShortestM;
    for (size_t first = 0; first < inside.size();) {
      const AxialPatch& patch = patches_[inside[first]];
      const int a = static_cast<int>(patch.axis);
      Box covered;
      double area_m2 = 0;
      for (; first < inside.size(); ++first) {
        const AxialPatch& other = patches_[inside[first]];
        if (other.axis != patch.axis || other.at_m != patch.at_m) break;
        covered.add(Box{glm::max(other.extent.min, box.min), glm::min(other.extent.max, box.max)});
        area_m2 += clipped_area_m2(other, box);
      }
      if (a == thin || covered.size()[thin] < kThrough * size[thin]) continue;
      if (patch.at_m - box.min[a] < options_.thinnest_m || box.max[a] - patch.at_m < options_.thinnest_m) continue;
      const float length_m = static_cast<float>(area_m2) / size[thin];
      if (length_m > longest_m) longest_m = length_m, best = Plane{patch.axis, patch.at_m, 0};
    }
    return best;
  }

  /// Where the surfaces between the box's faces end, on the side that has most space beside them.
  std::optional<Plane> widest_margin(const Box& box, const std::vector<uint32_t>& inside) const {
    Box surfaces;
    for (const uint32_t i : inside) {
      const AxialPatch& patch = patches_[i];
      const int a = static_cast<int>(patch.axis);
      if (patch.at_m - box.min[a] >= options_.thinnest_m && box.max[a] - patch.at_m >= options_.thinnest_m)
        surfaces.add(Box{glm::max(patch.extent.min, box.min), glm::min(patch.extent.max, box.max)});
    }
    if (surfaces.empty()) return std::nullopt;
    std::optional<Plane> widest;
    double most = options_.least_margin;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      for (const bool upper : {false, true}) {
        const float at_m = upper ? surfaces.max[a] : surfaces.min[a];
        const float margin_m = upper ? box.max[a] - at_m : at_m - box.min[a];
        const double share = double(margin_m) / double(box.size()[a]);
        if (share <= most || margin_m < options_.thinnest_m || box.size()[a] - margin_m < options_.thinnest_m) continue;
        most = share;
        widest = Plane{axis, at_m, 0};
      }
    }
    return widest;
  }

  /// A patch's area in the box, as if it lay evenly in its extent.
  static double clipped_area_m2(const AxialPatch& patch, const Box& box) {
    double share = 1;
    for (int i = 0; i < 3; ++i) {
      const double whole = double(patch.extent.max[i]) - double(patch.extent.min[i]);
      if (i == static_cast<int>(patch.axis) || whole <= 0) continue;
      const double part =
          double(std::min(patch.extent.max[i], box.max[i])) - double(std::max(patch.extent.min[i], box.min[i]));
      share *= std::clamp(part / whole, 0.0, 1.0);
    }
    return patch.area_m2 * share;
  }

  CellPlan& plan_;
  const std::vector<AxialPatch>& patches_;
  const WallSplitOptions& options_;
  std::vector<uint32_t> leaves_;
};

}  // namespace

Result<std::vector<AxialPatch>> find_axial_patches(const ModelReader& reader, JobMonitor& monitor) {
  Box box;
  const std::vector<NodeId> leaves = leaves_of(reader.model());
  for (const NodeId root : reader.model().tables.roots)
    if (!reader.model().is_moving(root)) box.add(reader.model().tables.nodes[index_of(root)].box);
  const double tile_m = std::max(double(box.size()[box.longest_axis()]) / kTiles, kPlaneM);
  std::vector<Patches> of_leaves(leaves.size());
  PROMENADE_TRY(
      for_each_mesh(reader, leaves, monitor, [&](size_t i, const Mesh& mesh) { gather(mesh, tile_m, of_leaves[i]); }));
  Patches all;
  for (const Patches& of_leaf : of_leaves)
    for (const auto& [key, patch] : of_leaf) {
      AxialPatch& sum = all[key];
      sum.axis = patch.axis, sum.at_m = patch.at_m;
      sum.extent.add(patch.extent);
      sum.area_m2 += patch.area_m2;
    }
  std::vector<AxialPatch> patches;
  patches.reserve(all.size());
  for (const auto& [key, patch] : all) patches.push_back(patch);
  return patches;
}

std::vector<uint32_t> split_along_walls(CellPlan& plan, uint32_t leaf, const std::vector<AxialPatch>& patches,
                                        const WallSplitOptions& options) {
  return WallSplitter(plan, patches, options).run(leaf);
}

}  // namespace promenade
