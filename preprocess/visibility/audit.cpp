#include "preprocess/visibility/audit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>

#include "preprocess/visibility/eyes.h"

namespace promenade {
namespace {

constexpr double kSlitM = 0.002;  // what is as wide is none
constexpr int kSlitSteps = 8;     // in which the width is measured: what is two steps narrower is a slit for certain

/// A narrow picture: everything of the sphere about `at` is in it.
RasterView aimed_view(const glm::dvec3& eye, const glm::dvec3& at, double radius_m, uint32_t side_px) {
  constexpr double kWidestTan = 0.6, kNarrowestTan = 1e-4;
  RasterView view;
  view.eye = eye;
  const glm::dvec3 way = at - eye;
  const double distance_m = std::max(glm::length(way), EyeFinder::kNearM);
  view.forward = distance_m > EyeFinder::kNearM ? way / distance_m : glm::dvec3(0, 1, 0);
  const glm::dvec3 any = std::abs(view.forward.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  view.right = glm::normalize(glm::cross(view.forward, any));
  view.up = glm::cross(view.right, view.forward);
  view.width_px = view.height_px = side_px;
  view.near_m = EyeFinder::kNearM;
  view.scale_px = side_px / 2.0 / std::clamp(radius_m / distance_m, kNarrowestTan, kWidestTan);
  return view;
}

/// The middle of a random triangle. The mesh has some.
glm::dvec3 random_place_on(const PreparedMesh& mesh, Random& random) {
  const raster_kernel::Block& block = mesh.blocks[random.below(static_cast<uint32_t>(mesh.blocks.size()))];
  const size_t triangle = block.first_triangle + random.below(block.triangle_count);
  glm::dvec3 sum(0);
  for (const std::vector<uint8_t>& corner : mesh.corners) {
    const size_t vertex = block.first_vertex + corner[triangle];
    sum += glm::dvec3(mesh.x[vertex], mesh.y[vertex], mesh.z[vertex]);
  }
  return sum / 3.0;
}

/// What a ray meets first when everything is drawn at full detail.
class FullDetail {
 public:
  FullDetail(const NodeMeshes& meshes, std::span<const NodeId> front) : meshes_(meshes), front_(front) {}

  /// The node of the front that stands for what is met: an index into the front, or none.
  Result<std::optional<size_t>> first_on(const RasterView& view, uint32_t x, uint32_t y) {
    RasterView ray = view;  // a picture of one pixel around the ray
    ray.forward = glm::normalize(ray_direction(view, x + 0.5, y + 0.5));
    ray.right = glm::normalize(glm::cross(ray.forward, view.up));
    ray.up = glm::cross(ray.right, ray.forward);
    ray.width_px = ray.height_px = 1;
    const Model& model = meshes_.model().model();
    std::vector<NodeId> leaves, open = model.tables.roots;
    while (!open.empty()) {
      const NodeId id = open.back();
      open.pop_back();
      const NodeRecord& node = model.tables.nodes[index_of(id)];
      if (!meets(node.box.grown(0.01F), ray.eye, ray.forward)) continue;
      if (node.child_count == 0) leaves.push_back(id);
      for (const NodeId child : model.children_of(id)) open.push_back(child);
    }
    const Result<HeldNodes> held = hold_nodes(meshes_, leaves);
    if (!held) return held.error();
    PROMENADE_TRY(buffer_.draw(ray, held->items));
    const uint32_t item = buffer_.item(0, 0);
    if (item == kNoTriangle) return std::optional<size_t>();
    for (NodeId id = leaves[item]; id != kNoNode; id = model.tables.nodes[index_of(id)].parent)
      if (const auto at = std::lower_bound(front_.begin(), front_.end(), id); at != front_.end() && *at == id)
        return std::optional<size_t>(static_cast<size_t>(at - front_.begin()));
    return std::optional<size_t>();
  }

 private:
  static bool meets(const Box& box, const glm::dvec3& eye, const glm::dvec3& way) {
    double first = 0, last = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (double(box.min[axis]) - eye[axis]) / way[axis],
                   b = (double(box.max[axis]) - eye[axis]) / way[axis];
      if (std::isnan(a) || std::isnan(b)) continue;  // along a face of the box
      first = std::max(first, std::min(a, b)), last = std::min(last, std::max(a, b));
    }
    return first <= last;
  }

  const NodeMeshes& meshes_;
  std::span<const NodeId> front_;
  VisibilityBuffer buffer_;
};

class CellLooks {
 public:
  CellLooks(const Box& cell, HeldNodes held, const NodeMeshes& meshes, std::span<const NodeId> front,
            std::span<const uint8_t> hidden, const LookOptions& options)
      : held_(std::move(held)),
        front_(front),
        hidden_(hidden),
        full_(meshes, front),
        options_(options),
        random_(numbers_of(options.seed, cell)),
        finder_(cell, held_.items, !meshes.model().model().objects.footprints.empty(), random_.fork(1)) {
    looks_.pixels_of.assign(front.size(), 0);
    looks_.truly_seen.assign(front.size(), 0);
    for (size_t i = 0; i < hidden.size(); ++i)
      if (hidden[i] != 0 && !held_.items[i].mesh->blocks.empty()) targets_.push_back(static_cast<uint32_t>(i));
  }

  Result<Looks> run() {
    const uint32_t a_point = options_.around ? 6 : 1;
    const uint32_t eyes = std::max(1U, options_.views / a_point);
    std::vector<glm::dvec3> found;
    found.reserve(eyes);
    for (uint32_t i = 0; i < eyes; ++i) {
      const Result<std::optional<glm::dvec3>> eye = finder_.next();
      if (!eye) return eye.error();
      if (!*eye) continue;
      ++looks_.eyes;
      found.push_back(**eye);
      for (uint32_t k = 0; k < a_point; ++k)
        PROMENADE_TRY(look(options_.around
                               ? cube_face_view(**eye, static_cast<int>(k), options_.picture_px, EyeFinder::kNearM)
                               : random_view(**eye, options_.picture_px, random_)));
    }
    if (found.empty() || targets_.empty()) return std::move(looks_);
    for (uint32_t i = 0; i < options_.aimed_views; ++i) {
      const glm::dvec3& eye = found[random_.below(static_cast<uint32_t>(found.size()))];
      const PreparedMesh& target = *held_.items[targets_[random_.below(static_cast<uint32_t>(targets_.size()))]].mesh;
      const RasterView view =
          aimed_view(eye, random_place_on(target, random_), glm::length(target.box.size()) / 2, LookOptions::kAimedPx);
      PROMENADE_TRY(look(view));
      looks_.aimed_rays += uint64_t(view.width_px) * view.height_px;
    }
    return std::move(looks_);
  }

 private:
  Status look(const RasterView& view) {
    VisibilityOptions options;
    options.threads = 1;
    PROMENADE_TRY(buffer_.draw(view, held_.items, options));
    uint64_t wrong = 0;
    for (uint32_t y = 0; y < view.height_px; ++y)
      for (uint32_t x = 0; x < view.width_px; ++x) {
        const uint32_t item = buffer_.item(x, y);
        if (item == kNoTriangle) continue;
        ++looks_.pixels_of[item];
        if (hidden_.empty() || hidden_[item] == 0) continue;
        ++wrong;
        PROMENADE_TRY(explain(view, x, y, item));
      }
    ++looks_.views;
    looks_.pixels += uint64_t(view.width_px) * view.height_px;
    if (wrong > looks_.worst_pixels) looks_.worst_pixels = wrong, looks_.worst = view;
    return Done{};
  }

  /// Whether a ray ends on a hidden node when everything is drawn at full detail.
  Result<bool> meets_hidden(const RasterView& view, uint32_t x, uint32_t y) {
    const Result<std::optional<size_t>> met = full_.first_on(view, x, y);
    if (!met) return met.error();
    return met->has_value() ? hidden_[**met] != 0 : true;  // what no node of the front stands for explains nothing
  }

  /// Whether what lets a ray through is narrower than a slit along one of four lines across it: a slit in whatever
  /// direction is along one of them.
  Result<bool> comes_through_a_slit(const RasterView& view, uint32_t x, uint32_t y) {
    constexpr double kDiagonal = 0.70710678;
    const glm::dvec3 way = glm::normalize(ray_direction(view, x + 0.5, y + 0.5));
    const glm::dvec3 right = glm::normalize(glm::cross(way, view.up)), up = glm::cross(right, way);
    for (const auto& [a, b] : {std::pair(1.0, 0.0), {0.0, 1.0}, {kDiagonal, kDiagonal}, {kDiagonal, -kDiagonal}}) {
      int open = 0;
      for (const double side : {1.0, -1.0})
        for (int step = 1; open < kSlitSteps - 1; ++step, ++open) {
          RasterView beside = view;
          beside.eye += (right * a + up * b) * (side * step * kSlitM / kSlitSteps);
          const Result<bool> also = meets_hidden(beside, x, y);
          if (!also) return also.error();
          if (!*also) break;
        }
      if (open < kSlitSteps - 1) return true;
    }
    return false;
  }

  Status explain(const RasterView& view, uint32_t x, uint32_t y, uint32_t item) {
    if (looks_.truly_seen[item] != 0) return Done{};
    const Result<bool> seen = meets_hidden(view, x, y);
    if (!seen) return seen.error();
    if (!*seen) {
      ++looks_.crack_pixels;
      return Done{};
    }
    const glm::dvec3 at = view.eye + ray_direction(view, x + 0.5, y + 0.5) * double(buffer_.depth_m(x, y));
    const Result<bool> narrow = comes_through_a_slit(view, x, y);
    if (!narrow) return narrow.error();
    if (*narrow) {
      ++looks_.slit_pixels;
      looks_.slits.push_back({view.eye, at, front_[item]});
      return Done{};
    }
    looks_.truly_seen[item] = 1;
    looks_.missed.push_back({view.eye, at, front_[item]});
    return Done{};
  }

  HeldNodes held_;
  std::span<const NodeId> front_;
  std::span<const uint8_t> hidden_;
  FullDetail full_;
  LookOptions options_;
  Random random_;
  EyeFinder finder_;
  std::vector<uint32_t> targets_;  ///< items of hidden nodes
  VisibilityBuffer buffer_;
  Looks looks_;
};

}  // namespace

Result<Looks> look_from_cell(const NodeMeshes& meshes, const Box& cell, std::span<const NodeId> front,
                             std::span<const uint8_t> hidden, const LookOptions& options) {
  Result<HeldNodes> held = hold_nodes(meshes, front);
  if (!held) return held.error();
  return CellLooks(cell, std::move(*held), meshes, front, hidden, options).run();
}

CellVerdict judge(const Model& model, std::span<const NodeId> front, std::span<const uint8_t> hidden,
                  const Looks& looks) {
  CellVerdict verdict;
  for (size_t i = 0; i < front.size(); ++i) {
    const uint64_t triangles = model.tables.nodes[index_of(front[i])].triangles;
    const bool seen = looks.pixels_of[i] > 0, kept = hidden[i] == 0;
    verdict.front_triangles += triangles, ++verdict.front_nodes;
    if (kept) verdict.kept_triangles += triangles, ++verdict.kept_nodes;
    if (seen) verdict.seen_triangles += triangles, ++verdict.seen_nodes;
    if (seen && !kept) ++verdict.false_hidden_nodes, verdict.false_hidden_pixels += looks.pixels_of[i];
    if (!kept && looks.truly_seen[i] != 0) ++verdict.missed_nodes;
  }
  verdict.missed_pixels =
      verdict.false_hidden_pixels - std::min(looks.crack_pixels + looks.slit_pixels, verdict.false_hidden_pixels);
  verdict.slit_pixels = looks.slit_pixels;
  return verdict;
}

}  // namespace promenade
