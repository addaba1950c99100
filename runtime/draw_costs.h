#pragma once
// What drawing costs on this machine: a linear model of a frame's time, measured once, stored, refined while running.

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "layout/model.h"
#include "runtime/renderer.h"

namespace promenade {

/// What a frame asks of a renderer. Loads add up.
struct DrawLoad {
  enum Term : uint8_t { picture, nodes, triangles, cover, textures };
  static constexpr size_t kTerms = textures + 1;
  /// Megapixels of the picture; nodes (draws); triangles; megapixels of the nodes' boxes, one above the other;
  /// textures.
  std::array<double, kTerms> amount{};
  DrawLoad& operator+=(const DrawLoad& other) {
    for (size_t i = 0; i < kTerms; ++i) amount[i] += other.amount[i];
    return *this;
  }
};

/// Of a picture without anything in it.
DrawLoad load_of_picture(uint32_t width_px, uint32_t height_px);
/// Of one node. pixels: what its box covers of the picture at most.
DrawLoad load_of_node(const NodeRecord& node, double pixels);
/// The most pixels that a box may cover: its bounding sphere's disc, no more than the picture. distance_m: to the box.
double covered_pixels(const Box& box, double distance_m, double pixels_per_radian, double picture_pixels);

/// Milliseconds for one of each term of DrawLoad; none is negative.
struct DrawCosts {
  std::array<double, DrawLoad::kTerms> ms{};
  bool stored = false;  ///< read from a file, not measured now
};
double ms_of(const DrawLoad& load, const DrawCosts& costs);

/// Draws some scenes that differ in one term each (about half a second) and solves for the costs. What it uploads is
/// gone afterwards. The renderer's thread. Errors: the renderer's. Source: [funkhouser1993] section 4.2.3, whose
/// coefficients were read off such plots.
Result<DrawCosts> measure_draw_costs(Renderer& renderer);
/// What `file` has for this key, else what `measure` returns, which is then added to it. A broken file counts as none,
/// one that cannot be written is no error. file empty: nothing is stored. Errors: measure's.
Result<DrawCosts> stored_draw_costs(const std::filesystem::path& file, const std::string& key,
                                    const std::function<Result<DrawCosts>()>& measure);
/// Both, in draw_costs.json in the user's cache folder. renderer_name: what tells it from others ("cpu", "gl:
/// llvmpipe").
Result<DrawCosts> draw_costs_here(Renderer& renderer, const std::string& renderer_name);

/// Least squares with coefficients >= 0, by coordinate descent. rows: loads with their milliseconds; errors count
/// relative to these. Pure.
DrawCosts fitted_costs(const std::vector<std::pair<DrawLoad, double>>& rows);

/// Foretells frame times and learns from each frame: slowly what every term costs here and now, quickly the pace of the
/// machine as a whole (other programs, clock speeds), by a median, so that one frame that the system interrupted
/// changes nothing. How much of what is drawn lies hidden behind the rest changes with what is asked for: where a frame
/// asks for much more or less than the one before, as in another cell, the pace is found anew. One thread.
class CostModel {
 public:
  explicit CostModel(const DrawCosts& measured) : measured_(measured) { factor_.fill(1); }

  double estimate_ms(const DrawLoad& load) const { return pace_ * refined_ms(load); }
  /// As measured once, without what has been learnt since.
  double unrefined_ms(const DrawLoad& load) const { return ms_of(load, measured_); }
  void learn(const DrawLoad& load, double took_ms);
  double pace() const { return pace_; }
  /// What the terms cost now, pace included.
  DrawCosts costs() const;

 private:
  double refined_ms(const DrawLoad& load) const;

  DrawCosts measured_;
  std::array<double, DrawLoad::kTerms> factor_;  ///< on the measured costs
  double pace_ = 1;
  static constexpr size_t kPaceFrames = 9;
  std::array<double, kPaceFrames> ratios_{};  ///< took over refined, of the last frames
  uint32_t frames_ = 0;                       ///< since the pace was last found anew
  double last_measured_ms_ = 0;               ///< what the last load takes as measured
};

}  // namespace promenade
