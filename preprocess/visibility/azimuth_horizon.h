#pragma once
// The horizon around an eye in a world of upright solids: in each direction of the plan, how steeply one must look up
// to see over what stands nearer than some distance.

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "geometry/box.h"

namespace promenade {

/// What a box is to an eye: the bins of azimuth that it lies in, its distance, the steepest slope to any of its points.
struct BoxInView {
  uint32_t first_bin = 0, bins = 0;  ///< bins from first_bin on, around the circle
  float nearest_m = 0;               ///< of its plan, from the eye; 0: all around, may be anywhere
  float slope = 0;                   ///< rise over horizontal distance, greatest
};

/// All roundings go the safe way: what hides, hides. One thread.
class AzimuthHorizon {
 public:
  static constexpr uint32_t kBins = 4096;  // 1.5 mrad: 15 cm at 100 m. measured: see bench_hiders

  /// Starts anew: an eye (metres, model space) that nothing hides anything from.
  void reset(const glm::dvec3& eye);

  /// Adds upright walls from the ground to top_m along a closed polygon. What of them comes within `clear` (a
  /// rectangle of the plan) is left out.
  void add(std::span<const glm::vec2> polygon, float top_m, const Box& clear);

  BoxInView view_of(const Box& box) const;
  /// Whether nothing of it is seen over what was added.
  bool hides(const BoxInView& view) const;

  /// Only bins that may matter need to be filled: add() leaves the others as they are. After reset() all matter.
  void want_none();
  void want(const BoxInView& view);
  void wants_complete();

  /// Whether walls of this height in this box could hide something in a wanted bin that is not hidden yet.
  bool worth_adding(const Box& box) const;

 private:
  /// Undominated walls of a bin: farther ones are seen over nearer ones.
  struct Bin {
    static constexpr uint32_t kMost = 7;
    uint32_t count = 0;
    std::array<float, kMost> distance_m, slope;
  };
  void commit(uint32_t bin, double nearest_m, double farthest_m);
  bool wanted(uint32_t first_bin, uint32_t bins) const;

  struct Walk;
  glm::dvec3 eye_{0};
  double rise_m_ = 0;  ///< of the polygon in work: its top over the eye
  std::vector<Bin> bins_ = std::vector<Bin>(kBins);
  std::vector<uint32_t> wanted_ = std::vector<uint32_t>(kBins + 1);  ///< sums of flags
  bool all_wanted_ = true;
};

}  // namespace promenade
