#include "codec/far_warp.h"

#include <algorithm>
#include <cmath>

#include "geometry/cube_side.h"

namespace promenade {
namespace {

/// 8 bits of a place are below a pixel: enough for colours, and whole numbers are the same everywhere.
constexpr int kBelowBits = 8;
constexpr int32_t kOne = 1 << kBelowBits;

/// A pixel by its four neighbours; x and y in 1 / kOne pixels, within the picture.
glm::u8vec4 sample(const Image& image, int32_t x, int32_t y) {
  const auto x0 = static_cast<uint32_t>(x >> kBelowBits), y0 = static_cast<uint32_t>(y >> kBelowBits);
  const uint32_t x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
  const int32_t fx = x & (kOne - 1), fy = y & (kOne - 1);
  const glm::u8vec4 &a = image.at(x0, y0), &b = image.at(x1, y0), &c = image.at(x0, y1), &d = image.at(x1, y1);
  const auto mix = [&](uint8_t p, uint8_t q, uint8_t r, uint8_t s) {
    const int32_t top = p * (kOne - fx) + q * fx, bottom = r * (kOne - fx) + s * fx;
    return static_cast<uint8_t>((top * (kOne - fy) + bottom * fy + kOne * kOne / 2) >> (2 * kBelowBits));
  };
  const glm::u8vec4& nearest = fy < kOne / 2 ? (fx < kOne / 2 ? a : b) : (fx < kOne / 2 ? c : d);
  return {mix(a.r, b.r, c.r, d.r), mix(a.g, b.g, c.g, d.g), mix(a.b, b.b, c.b, d.b), nearest.a};
}

/// Where the reference sees points.
class Warp {
 public:
  Warp(const FarFace& face, uint32_t side, const FarReference& reference, Image& out)
      : grid_(face.grid), reference_(reference), out_(out), axes_(cube_side(side)), middle_(grid_.cells() / 2.0) {
    for (uint32_t s = 0; s < 6; ++s) sides_[s] = cube_side(s);
  }

  /// code: as FarFace::depth, above 0.
  void pixel(uint32_t x, uint32_t y, double code) const {
    const double u = (x - middle_) / middle_, v = (middle_ - y) / middle_, depth = FarFace::kNearest / code;
    const glm::dvec3 p = depth * (axes_.forward + u * axes_.right + v * axes_.up) + reference_.offset;
    const glm::dvec3 size = glm::abs(p);
    const uint32_t axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    const auto at = static_cast<int>(axis);
    if (!(size[at] > 0)) return;
    const uint32_t side = 2 * axis + (p[at] < 0 ? 1U : 0U);
    const FarFace* from = reference_.sides[side];
    if (from == nullptr) return;
    const double scale = middle_ * kOne / size[at];
    const double most = grid_.cells() * double(kOne);
    const double px = std::clamp(middle_ * kOne + scale * glm::dot(p, sides_[side].right), 0.0, most);
    const double py = std::clamp(middle_ * kOne - scale * glm::dot(p, sides_[side].up), 0.0, most);
    out_.at(x, y) =
        sample(from->colors, static_cast<int32_t>(std::floor(px + 0.5)), static_cast<int32_t>(std::floor(py + 0.5)));
  }

 private:
  HalvedGrid grid_;
  const FarReference& reference_;
  Image& out_;
  CubeSide axes_;
  double middle_;
  std::array<CubeSide, 6> sides_;
};

/// Depths between the corners of a triangle: a right one, its hypotenuse from a to b.
void warp_triangle(const Warp& warp, const FarFace& face, uint32_t a, uint32_t b, uint32_t c) {
  const auto side = static_cast<int64_t>(face.grid.side());
  const auto x = [side](uint32_t i) { return int64_t(i) % side; };
  const auto y = [side](uint32_t i) { return int64_t(i) / side; };
  const auto cross = [&](uint32_t p, uint32_t q, int64_t at_x, int64_t at_y) {
    return (x(q) - x(p)) * (at_y - y(p)) - (y(q) - y(p)) * (at_x - x(p));
  };
  const auto area = double(cross(a, b, x(c), y(c)));
  const double da = face.depth[a], db = face.depth[b], dc = face.depth[c];
  for (int64_t py = std::min({y(a), y(b), y(c)}); py <= std::max({y(a), y(b), y(c)}); ++py)
    for (int64_t px = std::min({x(a), x(b), x(c)}); px <= std::max({x(a), x(b), x(c)}); ++px) {
      const int64_t wa = cross(b, c, px, py), wb = cross(c, a, px, py), wc = cross(a, b, px, py);
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const double code = (double(wa) * da + double(wb) * db + double(wc) * dc) / area;
      warp.pixel(static_cast<uint32_t>(px), static_cast<uint32_t>(py), std::max(code, 1.0));
    }
}

}  // namespace

Image foretell(const FarFace& face, uint32_t side, const FarReference& reference, FarForetelling how) {
  const uint32_t pixels = face.grid.side();
  if (how == FarForetelling::still && reference.sides[side] != nullptr) return reference.sides[side]->colors;
  Image out{pixels, pixels, std::vector<glm::u8vec4>(face.grid.vertices(), {0, 0, 0, 0})};
  if (how == FarForetelling::still) return out;
  const Warp warp(face, side, reference, out);
  for_each_triangle(face.grid, face.kept,
                    [&](uint32_t a, uint32_t b, uint32_t c) { warp_triangle(warp, face, a, b, c); });
  return out;
}

}  // namespace promenade
