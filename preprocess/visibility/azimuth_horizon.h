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

/// What a box is to an eye: the bins of azimuth that it lies in, how near it is, the steepest slope to any of its
/// points.
struct BoxInView {
  uint32_t first_bin = 0, bins = 0;  ///< bins from first_bin on, around the circle
  float nearness = 0;                ///< inverse of the distance to its plan; infinity: all around, may be anywhere
  float slope = 0;                   ///< rise over horizontal distance, greatest
};

/// All roundings go the safe way: what hides, hides. One thread.
class AzimuthHorizon {
 public:
  static constexpr uint32_t kBins =
      1024;  // 6 mrad; 2048 take half as long again for 0.01 to 0.05 less overestimate (study hiders)

  /// Starts anew: an eye (metres, model space) that nothing hides anything from.
  void reset(const glm::dvec3& eye);

  /// Adds upright walls from the ground to top_m along a closed polygon. What of them comes within `clear` (a
  /// rectangle of the plan) is left out.
  void add(std::span<const glm::vec2> polygon, float top_m, const Box& clear);

  BoxInView view_of(const Box& box) const;
  /// Whether nothing of it is seen over what was added.
  bool hides(const BoxInView& view) const;

  /// Only bins that may matter need to be filled, and only until what is wanted in them is hidden: add() leaves the
  /// others as they are. After reset() everything matters.
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
    std::array<float, kMost> nearness, slope;  ///< nearness: inverse of the distance
    bool hides(float nearness_of, float slope_of) const {
      uint32_t k = count;
      while (k > 0 && nearness[k - 1] < nearness_of) --k;
      return k > 0 && slope[k - 1] >= slope_of;
    }
  };
  /// A wall through all of a bin, by the inverses of its least and greatest distance.
  void commit(uint32_t bin, double nearest, double farthest);
  void find_sector();
  void place(size_t corner);
  void place_corners(std::span<const glm::vec2> polygon);
  uint32_t bin_of(size_t corner) const { return static_cast<uint32_t>(turn_[corner]) & (kBins - 1); }
  /// Whether something that is wanted there is not hidden yet.
  bool is_open(uint32_t first_bin, uint32_t bins) const;
  bool is_open(uint32_t bin) const { return (open_[bin / kWord] >> (bin % kWord) & 1U) != 0; }

  struct Walk;
  glm::dvec3 eye_{0};
  double rise_m_ = 0;  ///< of the polygon in work: its top over the eye
  /// Of the polygon's corners, as seen from the eye: where, the place around it in bins, the inverse of the distance.
  std::vector<double> x_, y_, turn_, inverse_;
  std::vector<uint8_t> beside_;  ///< bits: it lies clockwise, counter-clockwise of the sector
  /// The ends of a sector, less than half a turn, that all wanted bins lie in; 0: there is none. Sides that do not
  /// reach into it need not be walked.
  std::array<glm::dvec2, 2> sector_{};
  std::vector<Bin> bins_ = std::vector<Bin>(kBins);
  /// By bin: what is wanted is nowhere nearer, nowhere steeper.
  std::array<float, kBins> wanted_nearness_, wanted_slope_;
  static constexpr uint32_t kWord = 64;
  std::array<uint64_t, kBins / kWord> open_;  ///< a bit a bin
};

}  // namespace promenade
