#include "runtime/draw_costs.h"

#include <algorithm>
#include <cmath>

namespace promenade {
namespace {

constexpr double kMegapixel = 1e6;
/// Part of a frame's surprise that the terms take up. The pace takes the rest within some frames.
constexpr double kLearningRate = 0.02;
/// One frame changes the terms by no more than if it had taken this part longer or shorter than foretold.
constexpr double kLargestSurprise = 0.25;
/// A load that differs from the last one by this part is another view: what was learnt of the pace may not hold.
constexpr double kOtherLoad = 0.1;
/// Learning stays within this factor of what was measured.
constexpr double kLargestFactor = 4;

}  // namespace

DrawLoad load_of_picture(uint32_t width_px, uint32_t height_px) {
  DrawLoad load;
  load.amount[DrawLoad::picture] = double(width_px) * double(height_px) / kMegapixel;
  return load;
}

DrawLoad load_of_node(const NodeRecord& node, double pixels) {
  DrawLoad load;
  load.amount[DrawLoad::nodes] = 1;
  load.amount[DrawLoad::triangles] = node.triangles;
  load.amount[DrawLoad::cover] = pixels / kMegapixel;
  load.amount[DrawLoad::textures] = node.texture_count;
  return load;
}

double covered_pixels(const Box& box, double distance_m, double pixels_per_radian, double picture_pixels) {
  const double radius_m = double(box.diagonal()) / 2;
  if (distance_m <= 0) return picture_pixels;
  const double radius_px = radius_m / (distance_m + radius_m) * pixels_per_radian;
  return std::min(picture_pixels, 3.141592653589793 * radius_px * radius_px);
}

double ms_of(const DrawLoad& load, const DrawCosts& costs) {
  double ms = 0;
  for (size_t i = 0; i < DrawLoad::kTerms; ++i) ms += load.amount[i] * costs.ms[i];
  return ms;
}

DrawCosts fitted_costs(const std::vector<std::pair<DrawLoad, double>>& rows) {
  constexpr int kRounds = 2000;  // of cheap steps; five terms settle in some hundred
  DrawCosts costs;
  for (int round = 0; round < kRounds; ++round)
    for (size_t term = 0; term < DrawLoad::kTerms; ++term) {
      double along = 0, square = 0;
      for (const auto& [load, ms] : rows) {
        const double weight = 1 / std::max(ms * ms, 1e-9);
        along += weight * load.amount[term] * (ms - ms_of(load, costs));
        square += weight * load.amount[term] * load.amount[term];
      }
      if (square > 0) costs.ms[term] = std::max(0.0, costs.ms[term] + along / square);
    }
  return costs;
}

double CostModel::refined_ms(const DrawLoad& load) const {
  double ms = 0;
  for (size_t i = 0; i < DrawLoad::kTerms; ++i) ms += load.amount[i] * measured_.ms[i] * factor_[i];
  return ms;
}

DrawCosts CostModel::costs() const {
  DrawCosts now;
  for (size_t i = 0; i < DrawLoad::kTerms; ++i) now.ms[i] = pace_ * factor_[i] * measured_.ms[i];
  return now;
}

void CostModel::learn(const DrawLoad& load, double took_ms) {
  const double refined = refined_ms(load);
  if (!(refined > 0) || !(took_ms > 0) || !std::isfinite(took_ms)) return;
  const double measured_ms = ms_of(load, measured_), pace_before = pace_;
  const bool is_other = std::abs(measured_ms - last_measured_ms_) > kOtherLoad * last_measured_ms_;
  last_measured_ms_ = measured_ms;
  if (is_other) frames_ = 0;
  ratios_[frames_ % kPaceFrames] = took_ms / refined;
  ++frames_;
  const size_t known = std::min<size_t>(frames_, kPaceFrames);
  std::array<double, kPaceFrames> sorted = ratios_;
  std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(known));
  pace_ = known % 2 == 1 ? sorted[known / 2] : (sorted[known / 2 - 1] + sorted[known / 2]) / 2;
  // Of what the pace does not explain each term takes its part, by how much of the frame it was. A pace that was just
  // found anew explains everything: what it had been tells how the terms differ.
  const double explained = (is_other ? pace_before : pace_) * refined;
  const double surprise = std::clamp(took_ms / explained - 1, -kLargestSurprise, kLargestSurprise);
  for (size_t i = 0; i < DrawLoad::kTerms; ++i) {
    const double part = load.amount[i] * measured_.ms[i] * factor_[i] / refined;
    factor_[i] = std::clamp(factor_[i] * (1 + kLearningRate * surprise * part), 1 / kLargestFactor, kLargestFactor);
  }
}

}  // namespace promenade
