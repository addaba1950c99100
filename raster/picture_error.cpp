#include "raster/picture_error.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>

namespace promenade {
namespace {

/// Where a point of model space lies in the picture; nothing before the near plane.
bool project(const RasterView& view, const glm::dvec3& point, glm::dvec2& at_px) {
  const glm::dvec3 d = point - view.eye;
  const double depth_m = glm::dot(d, view.forward);
  if (!view.orthographic && !(depth_m > view.near_m)) return false;
  const double scale = view.orthographic ? view.scale_px : view.scale_px / depth_m;
  at_px = {view.width_px / 2.0 + glm::dot(d, view.right) * scale, view.height_px / 2.0 - glm::dot(d, view.up) * scale};
  return true;
}

bool alike(const glm::u8vec4& a, const glm::u8vec4& b) {
  for (int c = 0; c < 3; ++c)
    if (std::abs(int(a[c]) - int(b[c])) > PictureErrors::kColorDifference) return false;
  return true;
}

}  // namespace

/// What one row of pixels adds.
struct PictureErrors::Row {
  std::vector<float> errors_px;
  uint64_t background_pixels = 0, other_color = 0;

  Row(const RasterView& view, const DepthPicture& reference, const DepthPicture& drawn, const ClosestPointTree& surface,
      uint32_t y)
      : view_(view), reference_(reference), y_(y) {
    const size_t first = size_t(y) * view.width_px;
    uint32_t hint = kNoTriangle;
    for (uint32_t x = 0; x < view.width_px; ++x) {
      const float depth_m = reference.depth_m[first + x];
      if (std::isfinite(depth_m)) {
        measure(surface, x, depth_m, hint);
        if (!std::isfinite(drawn.depth_m[first + x]) && closed_around(x)) ++background_pixels;
      }
      if (!drawn.color.empty() && !has_color_around(x, drawn.color[first + x])) ++other_color;
    }
  }

 private:
  void measure(const ClosestPointTree& surface, uint32_t x, float depth_m, uint32_t& hint) {
    const glm::dvec2 center(x + 0.5, y_ + 0.5);
    const glm::dvec3 point =
        ray_origin(view_, center.x, center.y) + ray_direction(view_, center.x, center.y) * double(depth_m);
    ClosestPointTree::Limits limits;
    limits.hint = hint;
    const ClosestPoint closest = surface.closest(glm::vec3(point), limits);
    if (closest.triangle == kNoTriangle) return errors_px.push_back(float(kBins));
    hint = closest.triangle;
    glm::dvec2 at_px;
    // Beside the eye there is no picture of the closest point: as far as it would be seen at the point's depth.
    const double error_px = project(view_, glm::dvec3(closest.point), at_px)
                                ? glm::length(at_px - center)
                                : std::sqrt(double(closest.distance2_m2)) * view_.scale_px / double(depth_m);
    errors_px.push_back(float(error_px));
  }

  /// Calls visit for the pixels around, until it returns false.
  template <class Visit>
  bool each_around(uint32_t x, const Visit& visit) const {
    for (uint32_t v = y_ > 0 ? y_ - 1 : 0; v <= std::min(y_ + 1, view_.height_px - 1); ++v)
      for (uint32_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, view_.width_px - 1); ++u)
        if (!visit(size_t(v) * view_.width_px + u)) return false;
    return true;
  }
  bool closed_around(uint32_t x) const {
    return each_around(x, [&](size_t i) { return std::isfinite(reference_.depth_m[i]); });
  }
  bool has_color_around(uint32_t x, const glm::u8vec4& color) const {
    return !each_around(x, [&](size_t i) { return !alike(reference_.color[i], color); });
  }

  const RasterView& view_;
  const DepthPicture& reference_;
  uint32_t y_;
};

void PictureErrors::add(const RasterView& view, const DepthPicture& reference, const DepthPicture& drawn,
                        const ClosestPointTree& surface) {
  std::vector<std::vector<float>> errors(view.height_px);
  std::vector<glm::uvec2> counts(view.height_px);
  tbb::parallel_for(uint32_t(0), view.height_px, [&](uint32_t y) {
    Row row(view, reference, drawn, surface, y);
    errors[y] = std::move(row.errors_px);
    counts[y] = {row.background_pixels, row.other_color};
  });
  pixels_ += uint64_t(view.width_px) * view.height_px;
  for (const glm::uvec2& count : counts) background_pixels_ += count.x, other_color_ += count.y;
  for (const std::vector<float>& row : errors)
    for (const float error_px : row) {
      ++points_;
      largest_px_ = std::max(largest_px_, double(error_px));
      ++histogram_[std::min(kBins - 1, size_t(double(error_px) * kBinsAPixel))];
    }
}

double PictureErrors::quantile_px(double share) const {
  if (points_ == 0) return 0;
  const auto wanted = static_cast<uint64_t>(std::ceil(share * double(points_)));
  uint64_t sum = 0;
  for (size_t bin = 0; bin + 1 < kBins; ++bin) {
    sum += histogram_[bin];
    if (sum >= wanted) return std::min(largest_px_, double(bin + 1) / kBinsAPixel);
  }
  return largest_px_;
}

}  // namespace promenade
