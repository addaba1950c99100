#pragma once
// Which far pictures are drawn now: the eye's cell's, for some frames together with the last one's, so that a border is
// crossed by a fade and not by a jump of twice the bound.

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "layout/far.h"

namespace promenade {

/// A picture to draw, at the pixels whose threshold is in [from, to). Meaning as in DrawItem.
struct FarLayer {
  FarCellId cell{};
  float from = 0, to = 1;
};

/// Follows the eye through the far cells. One thread. Never a hole: what no picture shows is geometry.
class FarFollower {
 public:
  /// tables must outlive it.
  explicit FarFollower(const FarTables& tables) : tables_(tables) {}

  /// The cells whose pictures should be in memory, the most important first: the eye's, what is drawn, where the eye
  /// goes, what is beside; each with those of the outer shells around it. eye: metres, model space.
  std::vector<FarCellId> wanted(const glm::dvec3& eye, const glm::dvec3& velocity_m_per_s) const;

  /// Decides for a frame. ready(FarCellId): whether a cell's picture may be drawn, with those around it. frames: how
  /// long a fade takes; 0: none.
  template <class Ready>
  void follow(const glm::dvec3& eye, uint32_t frames, Ready&& ready);

  std::span<const FarLayer> layers() const { return layers_; }  ///< empty: geometry alone
  std::span<const Box> near() const { return near_; }           ///< one a layer: what is drawn as geometry
  std::optional<FarCellId> cell() const { return cell_; }       ///< the eye's; nullopt: outside
  std::optional<FarCellId> shown() const { return shown_; }     ///< whose picture is drawn; nullopt: geometry alone
  /// The eye's cell has a picture, and the last one's is drawn instead: off by at most twice the bound, about.
  bool is_late() const { return late_; }
  bool is_missing() const { return missing_; }  ///< the eye's cell has a picture, and geometry is drawn instead

 private:
  bool near_shown(const glm::dvec3& eye) const;
  void want(const std::optional<FarCellId>& cell, std::vector<FarCellId>& cells) const;
  void want_ahead(const glm::dvec3& eye, const glm::dvec3& way_m, std::vector<FarCellId>& cells) const;
  void set_layers();

  const FarTables& tables_;
  std::optional<FarCellId> cell_, shown_, fading_;
  float share_ = 1;  ///< of the pixels, that `shown_` has
  bool late_ = false, missing_ = false;
  std::vector<FarLayer> layers_;
  std::vector<Box> near_;
};

template <class Ready>
void FarFollower::follow(const glm::dvec3& eye, uint32_t frames, Ready&& ready) {
  cell_ = far_cell_at(tables_, eye);
  std::optional<FarCellId> next;
  late_ = missing_ = false;
  if (cell_ && ready(*cell_)) {
    next = cell_;
  } else if (shown_ && near_shown(eye) && ready(*shown_)) {
    next = shown_;
    late_ = cell_.has_value();
  } else {
    missing_ = cell_.has_value();
  }
  if (next != shown_) {
    fading_ = next && frames > 0 ? shown_ : std::nullopt;
    share_ = 0;
    shown_ = next;
  }
  if (fading_) {
    share_ += 1 / static_cast<float>(frames == 0 ? 1 : frames);
    if (share_ >= 1 || !ready(*fading_)) fading_.reset();
  }
  set_layers();
}

}  // namespace promenade
