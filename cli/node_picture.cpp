#include "cli/node_picture.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "codec/image_codec.h"
#include "layout/file_io.h"

namespace promenade {
namespace {

/// The outline of a box's plan, seen from straight above.
void outline(const RasterView& view, const Box& box, Image& image) {
  const auto pixel = [&](const glm::vec3& p) {
    const glm::dvec3 d = glm::dvec3(p) - view.eye;
    return glm::ivec2(std::lround(glm::dot(d, view.right) * view.scale_px + view.width_px / 2.0),
                      std::lround(-glm::dot(d, view.up) * view.scale_px + view.height_px / 2.0));
  };
  const glm::ivec2 a = pixel(box.min), b = pixel(box.max);
  const glm::ivec2 low = glm::min(a, b) - 2, high = glm::max(a, b) + 2;
  for (int y = std::max(low.y, 0); y <= std::min(high.y, int(image.height) - 1); ++y)
    for (int x = std::max(low.x, 0); x <= std::min(high.x, int(image.width) - 1); ++x)
      if (x < low.x + 2 || x > high.x - 2 || y < low.y + 2 || y > high.y - 2)
        image.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)) = {220, 0, 0, 255};
}

}  // namespace

Status write_node_picture(const NodeMeshes& meshes, std::span<const NodeId> nodes, const RasterView& view,
                          const std::function<glm::u8vec3(size_t)>& color_of, const Box& marked,
                          const std::filesystem::path& path) {
  const Result<HeldNodes> held = hold_nodes(meshes, nodes);
  if (!held) return held.error();
  VisibilityBuffer buffer;
  PROMENADE_TRY(buffer.draw(view, held->items));
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
  for (uint32_t y = 0; y < view.height_px; ++y)
    for (uint32_t x = 0; x < view.width_px; ++x)
      if (const float d = buffer.depth_m(x, y); std::isfinite(d))
        nearest = std::min(nearest, d), farthest = std::max(farthest, d);
  Image image{view.width_px, view.height_px, {}};
  image.pixels.assign(size_t(image.width) * image.height, {255, 255, 255, 255});
  for (uint32_t y = 0; y < view.height_px; ++y)
    for (uint32_t x = 0; x < view.width_px; ++x) {
      const uint32_t item = buffer.item(x, y);
      if (item == kNoTriangle) continue;
      const float far = (buffer.depth_m(x, y) - nearest) / std::max(farthest - nearest, 1e-6F);
      image.at(x, y) = glm::u8vec4(glm::vec3(color_of(item)) * (1 - 0.5F * std::sqrt(far)), 255);
    }
  if (!marked.empty()) outline(view, marked, image);
  const Result<std::vector<std::byte>> bytes = encode_image(image, ImageFormat::png);
  if (!bytes) return bytes.error();
  return write_file(path, *bytes);
}

RasterView plan_view(const Box& box, uint32_t side_px) {
  RasterView view;
  const glm::dvec3 size(box.size());
  view.eye = glm::dvec3(glm::dvec2(box.center()), double(box.max.z) + 1);
  view.right = {1, 0, 0}, view.up = {0, 1, 0}, view.forward = {0, 0, -1};
  view.scale_px = side_px / std::max({size.x, size.y, 1e-3});
  view.width_px = std::max(1U, static_cast<uint32_t>(size.x * view.scale_px));
  view.height_px = std::max(1U, static_cast<uint32_t>(size.y * view.scale_px));
  view.near_m = 0, view.orthographic = true;
  return view;
}

}  // namespace promenade
