#include "datasets/city_texture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/random.h"

namespace promenade {
namespace {

constexpr float kBrickM = 0.24F, kCourseM = 0.075F, kJointM = 0.01F;

uint32_t hashed(uint32_t x, uint32_t y, uint32_t seed) {
  uint32_t h = x * 0x8da6b343U ^ y * 0xd8163841U ^ seed * 0xcb1ab31fU;
  h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
  h = (h ^ (h >> 12)) * 0x297a2d39U;
  return h ^ (h >> 15);
}
float unit_of(uint32_t hash) { return static_cast<float>(hash >> 8) * 0x1p-24F; }

/// Smooth noise in [0, 1] on a lattice of one unit.
float noise(float x, float y, uint32_t seed) {
  const float fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<uint32_t>(static_cast<int32_t>(fx)), iy = static_cast<uint32_t>(static_cast<int32_t>(fy));
  const float u = x - fx, v = y - fy, su = u * u * (3 - 2 * u), sv = v * v * (3 - 2 * v);
  const float a = unit_of(hashed(ix, iy, seed)), b = unit_of(hashed(ix + 1, iy, seed));
  const float c = unit_of(hashed(ix, iy + 1, seed)), d = unit_of(hashed(ix + 1, iy + 1, seed));
  return (a + (b - a) * su) * (1 - sv) + (c + (d - c) * su) * sv;
}

class FacadePainter {
 public:
  FacadePainter(const FacadeSketch& sketch, uint32_t width, uint32_t height, uint64_t seed)
      : sketch_(sketch), seed_(static_cast<uint32_t>(seed ^ (seed >> 32))) {
    image_.width = width, image_.height = height;
    image_.pixels.resize(size_t(width) * height);
  }
  Image paint() {
    for (uint32_t y = 0; y < image_.height; ++y) paint_row(y);
    for (size_t i = 0; i < sketch_.panes.size(); ++i) paint_pane(sketch_.panes[i], static_cast<uint32_t>(i));
    return std::move(image_);
  }

 private:
  void paint_row(uint32_t row);
  void paint_pane(const PaneSketch& pane, uint32_t index);
  float brick(float x, float z, float& joint) const;

  const FacadeSketch& sketch_;
  uint32_t seed_;
  Image image_;
};

/// How bright the brick at a place is; joint: how much of the place is mortar.
float FacadePainter::brick(float x, float z, float& joint) const {
  const float course = std::floor(z / kCourseM);
  const float shift = std::fmod(course, 2.0F) * 0.5F;
  const float along = x / kBrickM + shift, column = std::floor(along);
  const float in_x = (along - column) * kBrickM, in_z = z - course * kCourseM;
  joint = in_x < kJointM || in_z < kJointM ? 1.0F : 0.0F;
  return 0.8F + 0.4F * unit_of(hashed(static_cast<uint32_t>(column), static_cast<uint32_t>(course), seed_));
}

void FacadePainter::paint_row(uint32_t row) {
  const float z = sketch_.height_m * (1 - (static_cast<float>(row) + 0.5F) / static_cast<float>(image_.height));
  const float upper = std::max(0.0F, z - sketch_.ground_floor_m);
  const bool other = z > sketch_.ground_floor_m && static_cast<int>(upper / sketch_.floor_m) % 2 == 0;
  const Color wall = other ? sketch_.wall_other : sketch_.wall;
  // Rain keeps the foot of a wall dark, and soot its top.
  const float foot = 0.25F * std::exp(-z / 0.5F), soot = 0.12F * std::exp(-(sketch_.height_m - z) / 1.2F);
  for (uint32_t column = 0; column < image_.width; ++column) {
    const float x = sketch_.around_m * (static_cast<float>(column) + 0.5F) / static_cast<float>(image_.width);
    const float broad = noise(x * 0.35F, z * 0.35F, seed_), fine = noise(x * 9, z * 9, seed_ + 1);
    const float streaks = noise(x * 2.6F, z * 0.22F, seed_ + 2);
    float light = 0.86F + 0.2F * broad + 0.1F * (fine - 0.5F) - foot - soot;
    if (streaks > 0.62F) light -= 0.5F * (streaks - 0.62F);
    Color color = wall;
    if (sketch_.bricks) {
      float joint = 0;
      light *= brick(x, z, joint);
      if (joint > 0) color = blend(wall, rgb(196, 188, 176), 0.6F), light = 0.8F + 0.15F * fine;
    }
    image_.at(column, row) = shade(color, light);
  }
}

/// A pane mirrors the sky, and the roofs across the street in its lower part; some have curtains.
void FacadePainter::paint_pane(const PaneSketch& pane, uint32_t index) {
  const auto pixel = [](float t, uint32_t count) {
    return static_cast<uint32_t>(std::clamp(t * static_cast<float>(count), 0.0F, static_cast<float>(count)));
  };
  const uint32_t x0 = pixel(pane.low.x, image_.width), x1 = pixel(pane.high.x, image_.width);
  const uint32_t y0 = pixel(pane.low.y, image_.height), y1 = pixel(pane.high.y, image_.height);
  const float curtain = unit_of(hashed(index, 7, seed_)), tone = 0.8F + 0.4F * unit_of(hashed(index, 8, seed_));
  for (uint32_t y = y0; y < y1; ++y)
    for (uint32_t x = x0; x < x1; ++x) {
      const float t = (static_cast<float>(y - y0) + 0.5F) / static_cast<float>(y1 - y0);
      const float s = (static_cast<float>(x - x0) + 0.5F) / static_cast<float>(std::max(1U, x1 - x0));
      const float skyline = 0.45F + 0.35F * noise(s * 4 + static_cast<float>(index) * 3.7F, 0, seed_ + 3);
      Color color = t < skyline ? blend(rgb(168, 196, 220), shade(sketch_.glass, tone), 0.35F + 0.5F * t)
                                : shade(sketch_.glass, 0.75F * tone);
      if (curtain < 0.35F && (s < 0.22F || s > 0.78F))
        color = shade(rgb(226, 218, 204), 0.85F + 0.15F * std::sin(s * 60));
      if (curtain > 0.85F && t < 0.5F) color = shade(rgb(214, 206, 190), 0.95F + 0.05F * std::sin(t * 90));
      image_.at(x, y) = color;
    }
}

}  // namespace

Image paint_facade(const FacadeSketch& sketch, uint32_t width, uint32_t height, uint64_t seed) {
  return FacadePainter(sketch, width, height, seed).paint();
}

}  // namespace promenade
