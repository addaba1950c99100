#include "runtime/calibration_scene.h"

#include <cmath>

namespace promenade {
namespace {

constexpr float kSquareM = 20;

float height_m(float x, float y) { return 6 * std::sin(x * 0.11F) * std::cos(y * 0.13F) + std::sin(x * y * 0.05F); }

}  // namespace

Mesh hilly_square(uint32_t column, uint32_t row, uint32_t cells_per_side, float repeats) {
  const uint32_t cells = cells_per_side;
  Mesh mesh;
  mesh.positions.reserve(size_t(cells + 1) * (cells + 1));
  mesh.texcoords.reserve(mesh.positions.capacity());
  mesh.indices.reserve(size_t(cells) * cells * 6);
  for (uint32_t y = 0; y <= cells; ++y)
    for (uint32_t x = 0; x <= cells; ++x) {
      const float u = float(x) / float(cells), v = float(y) / float(cells);
      const float px = (float(column) + u) * kSquareM, py = (float(row) + v) * kSquareM;
      mesh.positions.emplace_back(px, py, height_m(px, py));
      mesh.texcoords.emplace_back(u * repeats, v * repeats);
    }
  for (uint32_t y = 0; y < cells; ++y)
    for (uint32_t x = 0; x < cells; ++x) {
      const uint32_t a = y * (cells + 1) + x, b = a + cells + 1;
      for (const uint32_t i : {a, a + 1, b + 1, a, b + 1, b}) mesh.indices.push_back(i);
    }
  return mesh;
}

Image striped_picture(uint32_t side_px) {
  Image image;
  image.width = image.height = side_px;
  image.pixels.reserve(size_t(side_px) * side_px);
  for (uint32_t y = 0; y < side_px; ++y)
    for (uint32_t x = 0; x < side_px; ++x)
      image.pixels.emplace_back(uint8_t(90 + x % 64), uint8_t(120 + y % 64), uint8_t(80 + (x ^ y) % 64), uint8_t(255));
  return image;
}

}  // namespace promenade
