// Questions to a picture of occluders: VisibilityBuffer::may_be_seen.

#include <algorithm>

#include "raster/visibility.h"
#include "raster/visibility_state.h"

namespace promenade {

namespace {

using raster_kernel::BoxPicture;
using raster_kernel::Coverage;
using raster_kernel::Frame;
using raster_kernel::Item;
using raster_kernel::Region;

/// A unit cube about the origin, to be placed where a box is.
const PreparedMesh& unit_cube() {
  static const PreparedMesh cube = [] {
    Mesh mesh;
    for (uint32_t k = 0; k < 8; ++k) mesh.positions.emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    return *prepare(mesh, {}, {false});
  }();
  return cube;
}

/// Whether the item, drawn with every pixel that it touches, would win one.
bool probe(const VisibilityBuffer::State& s, const Item& item, const BoxPicture& box) {
  Frame frame = s.frame;
  frame.cull_hidden = true, frame.draw_solid = true, frame.draw_blended = true, frame.before_z = nullptr;
  return std::any_of(s.regions.begin(), s.regions.end(), [&](const Region& drawn) {
    Region r = drawn;
    r.read_only = true, r.found = false;
    s.kernels->draw(frame, item, box, r, Coverage::probe);
    return r.found;
  });
}

}  // namespace

bool VisibilityBuffer::may_be_seen(const Box& box) const {
  const State& s = *state_;
  if (box.empty()) return false;
  if (s.kernels == nullptr) return true;  // nothing drawn, nothing hidden
  float center[3], half[3];
  half_of(box, center, half);
  const Item room = item_of({&unit_cube(), 0, nullptr, std::nullopt}, s.view);  // only its frame, the model's
  const BoxPicture picture = s.kernels->project_box(s.frame, room, center, half);
  if (picture.culled) return false;
  glm::dmat4 placed(1.0);
  for (int i = 0; i < 3; ++i) {
    // Never flat, which would leave no triangle to draw; what it grows by is far below a rounding of the picture.
    placed[i][i] = std::max(double(half[i]), 1e-6 * std::max({half[0], half[1], half[2], 1e-6F}));
    placed[3][i] = center[i];
  }
  // The near plane may cut its faces off before what is inside: then the rectangle that it covers must do.
  const bool cut = s.view.orthographic ? picture.nearest_z >= -s.frame.near_m : picture.nearest_z * s.frame.near_m >= 1;
  if (cut) return true;
  return probe(s, item_of({&unit_cube(), 0, nullptr, placed}, s.view), picture);
}

bool VisibilityBuffer::may_be_seen(const RasterItem& drawn) const {
  const State& s = *state_;
  if (drawn.mesh->box.empty()) return false;
  if (s.kernels == nullptr) return true;
  float center[3], half[3];
  half_of(drawn.mesh->box, center, half);
  const Item item = item_of(drawn, s.view);
  const BoxPicture picture = s.kernels->project_box(s.frame, item, center, half);
  return !picture.culled && probe(s, item, picture);
}

}  // namespace promenade
