#include "preprocess/visibility/eyes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace promenade {
namespace {

constexpr double kElbowRoomM = 0.01;  // no eye is nearer to a surface: nearer than the corners of the near plane
constexpr double kHairM = 0.002;      // from the cell's faces
constexpr uint32_t kTriesAnEye = 12;
constexpr uint32_t kProbePx = 16;   // side of the small pictures that tell solid from free
constexpr float kProbeReachM = 60;  // how far they look

}  // namespace

EyeFinder::EyeFinder(const Box& cell, std::span<const RasterItem> items, bool oriented, Random random)
    : cell_(cell), items_(items), oriented_(oriented), random_(random) {
  for (const RasterItem& item : items) touched_ |= item.mesh->box.overlaps(cell);
}

glm::dvec3 EyeFinder::place() {
  const double x = random_.unit(), y = random_.unit(), z = random_.unit();
  const glm::dvec3 low(cell_.min), size(cell_.size());
  glm::dvec3 eye = low + glm::dvec3(x, y, z) * size;
  if (found_ % 2 != 0) return eye;
  // Onto a face, but for a hair: a surface in the face's plane would be seen by nobody, and seen past.
  const uint32_t face = random_.below(6);
  const auto axis = static_cast<int>(face / 2);
  const double hair_m = std::min(kHairM, size[axis] / 2);
  eye[axis] = low[axis] + (face % 2 == 0 ? hair_m : size[axis] - hair_m);
  return eye;
}

Result<std::optional<glm::dvec3>> EyeFinder::next() {
  std::optional<glm::dvec3> found;
  for (uint32_t i = 0; i < kTriesAnEye && !found; ++i) {
    const glm::dvec3 eye = place();
    bool solid = free_ == Free::no;
    if (free_ == Free::unknown || touched_) PROMENADE_TRY(is_solid(eye, solid));
    // Where no surface comes into the cell, all of it is as one point of it.
    if (!touched_) free_ = solid ? Free::no : Free::yes;
    if (!solid) found = eye;
    if (!touched_) break;
  }
  ++found_;
  return found;
}

/// Backs in most directions: with backs drawn more than half of the pixels are nearer than without. Not downwards: the
/// roof that a tower stands on goes on inside the tower, its front up. Likewise upwards alone: below the ground, or a
/// roof. Or with something above and next to nothing below the horizon, where two-sided surfaces make a ground: beneath
/// a floor that lies below it. Or so near to a surface that no eye is there.
Status EyeFinder::is_solid(const glm::dvec3& eye, bool& solid) {
  std::vector<RasterItem> around;
  for (const RasterItem& item : items_)
    if (item.mesh->box.distance(glm::vec3(eye)) < kProbeReachM) around.push_back(item);
  VisibilityOptions fronts;
  fronts.threads = 1;
  VisibilityOptions both = fronts;
  both.cull_back = false;
  fronts.one_sided = oriented_;
  constexpr int kUp = 4, kDown = 5, kFacesButDown = 5;
  constexpr uint32_t kFacePixels = kProbePx * kProbePx;
  constexpr double kTouchM = 1e-5;  // what is nearer would not be seen at all
  uint32_t backs = 0, backs_above = 0, something_above = 0, something_below = 0;
  float nearest_m = std::numeric_limits<float>::infinity();
  for (int face = 0; face < 6; ++face) {
    const RasterView view = cube_face_view(eye, face, kProbePx, kTouchM);
    PROMENADE_TRY(fronts_.draw(view, around, fronts));
    PROMENADE_TRY(both_.draw(view, around, both));
    for (uint32_t y = 0; y < kProbePx; ++y)
      for (uint32_t x = 0; x < kProbePx; ++x) {
        nearest_m = std::min(nearest_m, both_.depth_m(x, y));
        const bool is_back = both_.depth_m(x, y) < fronts_.depth_m(x, y);
        backs += face < kFacesButDown && is_back ? 1U : 0U;
        backs_above += face == kUp && is_back ? 1U : 0U;
        const bool is_something = std::isfinite(both_.depth_m(x, y));
        something_above += face == kUp && is_something ? 1U : 0U;
        something_below += (face == kDown || (face < kUp && y >= kProbePx / 2)) && is_something ? 1U : 0U;
      }
  }
  const bool beneath = oriented_ && something_above > kFacePixels / 2 && something_below < kFacePixels / 8;
  solid = double(nearest_m) < kElbowRoomM || backs_above > kFacePixels / 2 || backs > kFacesButDown * kFacePixels / 2 ||
          beneath;
  return Done{};
}

Random numbers_of(uint64_t seed, const Box& cell) {
  Random random(seed);
  for (const float v : {cell.min.x, cell.min.y, cell.min.z, cell.max.x, cell.max.y, cell.max.z})
    random = random.fork(static_cast<uint64_t>(static_cast<int64_t>(double(v) * 1024)));
  return random;
}

RasterView random_view(const glm::dvec3& eye, uint32_t side_px, Random& random) {
  Camera camera;
  camera.pose.eye = eye;
  camera.pose.yaw_deg = random.unit() * 360;
  camera.pose.pitch_deg = std::asin(random.unit() * 2 - 1) * 180 / std::numbers::pi * 0.7;
  camera.width_px = camera.height_px = side_px;
  camera.vertical_fov_deg = 60;
  camera.near_m = EyeFinder::kNearM;
  return perspective_view(camera, glm::dvec3(0));
}

}  // namespace promenade
