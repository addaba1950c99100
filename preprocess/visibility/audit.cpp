#include "preprocess/visibility/audit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>

namespace promenade {
namespace {

constexpr double kNearM = 0.005;      // what is nearer would be cut off, and seen through
constexpr double kElbowRoomM = 0.01;  // no eye is nearer to a surface: nearer than the corners of the near plane
constexpr double kHairM = 0.002;      // from the cell's faces
constexpr uint32_t kTriesAnEye = 12;
constexpr uint32_t kProbePx = 16;   // side of the small pictures that tell solid from free
constexpr float kProbeReachM = 60;  // how far they look

/// The same numbers everywhere from the seed on (splitmix64).
class Numbers {
 public:
  explicit Numbers(uint64_t seed) : state_(seed) {}
  double unit() {
    uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return double((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
  }
  glm::dvec3 in_box() {
    const double x = unit(), y = unit(), z = unit();
    return {x, y, z};
  }

 private:
  uint64_t state_;
};

uint64_t seed_of(uint64_t seed, const Box& cell) {
  uint64_t hash = seed;
  for (const float v : {cell.min.x, cell.min.y, cell.min.z, cell.max.x, cell.max.y, cell.max.z})
    hash = (hash ^ static_cast<uint64_t>(static_cast<int64_t>(v * 1024.0F))) * 0x9e3779b97f4a7c15ULL;
  return hash;
}

RasterView random_view(const glm::dvec3& eye, uint32_t px, Numbers& numbers) {
  Camera camera;
  camera.pose.eye = eye;
  camera.pose.yaw_deg = numbers.unit() * 360;
  camera.pose.pitch_deg = std::asin(numbers.unit() * 2 - 1) * 180 / std::numbers::pi * 0.7;
  camera.width_px = camera.height_px = px;
  camera.vertical_fov_deg = 60;
  camera.near_m = kNearM;
  return perspective_view(camera, glm::dvec3(0));
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
      : cell_(cell),
        held_(std::move(held)),

        hidden_(hidden),
        full_(meshes, front),
        options_(options),
        numbers_(seed_of(options.seed, cell)) {
    looks_.pixels_of.assign(front.size(), 0);
    looks_.truly_seen.assign(front.size(), 0);
    for (const RasterItem& item : held_.items) touched_ |= item.mesh->box.overlaps(cell);
  }

  Result<Looks> run() {
    const uint32_t a_point = options_.around ? 6 : 1;
    const uint32_t eyes = std::max(1U, options_.views / a_point);
    for (uint32_t i = 0; i < eyes; ++i) {
      std::optional<glm::dvec3> eye;
      PROMENADE_TRY(find_eye(i, eye));
      if (!eye) continue;
      ++looks_.eyes;
      for (uint32_t k = 0; k < a_point; ++k)
        PROMENADE_TRY(look(options_.around ? cube_face_view(*eye, static_cast<int>(k), options_.picture_px, kNearM)
                                           : random_view(*eye, options_.picture_px, numbers_)));
    }
    return std::move(looks_);
  }

 private:
  glm::dvec3 place(uint32_t number) {
    glm::dvec3 at = numbers_.in_box();
    const glm::dvec3 low(cell_.min), size(cell_.size());
    if (number % 2 != 0) return low + at * size;
    // Onto a face, but for a hair: a surface in the face's plane would be seen by nobody, and seen past.
    const auto face = static_cast<int>(numbers_.unit() * 6);
    const int axis = face / 2;
    const double hair_m = std::min(kHairM, size[axis] / 2);
    glm::dvec3 eye = low + at * size;
    eye[axis] = low[axis] + (face % 2 == 0 ? hair_m : size[axis] - hair_m);
    return eye;
  }

  Status find_eye(uint32_t number, std::optional<glm::dvec3>& found) {
    for (uint32_t i = 0; i < kTriesAnEye; ++i) {
      const glm::dvec3 eye = place(number);
      bool solid = free_ == Free::no;
      if (free_ == Free::unknown || touched_) PROMENADE_TRY(is_solid(eye, solid));
      // Where no surface comes into the cell, all of it is as one point of it.
      if (!touched_) free_ = solid ? Free::no : Free::yes;
      if (!solid) {
        found = eye;
        return Done{};
      }
      if (!touched_) break;
    }
    return Done{};
  }

  /// Likewise upwards alone: below the ground, or a roof. Or so near to a surface that no eye is there.
  /// Backs in most directions: with backs drawn more than half of the pixels are nearer than without. Not downwards:
  /// the roof that a tower stands on goes on inside the tower, its front up.
  Status is_solid(const glm::dvec3& eye, bool& solid) {
    std::vector<RasterItem> around;
    for (const RasterItem& item : held_.items)
      if (item.mesh->box.distance(glm::vec3(eye)) < kProbeReachM) around.push_back(item);
    VisibilityOptions fronts;
    fronts.threads = 1;
    VisibilityOptions both = fronts;
    both.cull_back = false;
    constexpr int kUp = 4, kFacesButDown = 5;
    constexpr uint32_t kFacePixels = kProbePx * kProbePx;
    uint32_t backs = 0, backs_above = 0;
    constexpr double kTouchM = 0.0005;
    float nearest_m = std::numeric_limits<float>::infinity();
    for (int face = 0; face < 6; ++face) {
      const RasterView view = cube_face_view(eye, face, kProbePx, kTouchM);
      PROMENADE_TRY(buffer_.draw(view, around, fronts));
      PROMENADE_TRY(other_.draw(view, around, both));
      for (uint32_t y = 0; y < kProbePx; ++y)
        for (uint32_t x = 0; x < kProbePx; ++x) {
          nearest_m = std::min(nearest_m, other_.depth_m(x, y));
          const bool is_back = other_.depth_m(x, y) < buffer_.depth_m(x, y);
          backs += face < kFacesButDown && is_back ? 1U : 0U;
          backs_above += face == kUp && is_back ? 1U : 0U;
        }
    }
    solid = double(nearest_m) < kElbowRoomM || backs_above > kFacePixels / 2 || backs > kFacesButDown * kFacePixels / 2;
    return Done{};
  }

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

  Status explain(const RasterView& view, uint32_t x, uint32_t y, uint32_t item) {
    if (looks_.truly_seen[item] != 0) return Done{};
    const Result<std::optional<size_t>> met = full_.first_on(view, x, y);
    if (!met) return met.error();
    if (met->has_value() && hidden_[**met] == 0)
      ++looks_.crack_pixels;
    else
      looks_.truly_seen[item] = 1;
    return Done{};
  }

  enum class Free : uint8_t { unknown, yes, no };
  Box cell_;
  HeldNodes held_;
  std::span<const uint8_t> hidden_;
  FullDetail full_;
  LookOptions options_;
  Numbers numbers_;
  bool touched_ = false;  ///< some box of a node reaches into the cell
  Free free_ = Free::unknown;
  VisibilityBuffer buffer_, other_;
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
  verdict.missed_pixels = verdict.false_hidden_pixels - std::min(looks.crack_pixels, verdict.false_hidden_pixels);
  return verdict;
}

}  // namespace promenade
