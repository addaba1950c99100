#pragma once
// What stands beside the picture: figures, plots, settings; and over it: cells, boxes, the view pyramid.

#include <array>
#include <chrono>
#include <optional>
#include <string>

#include "runtime/overlay.h"
#include "runtime/session.h"

namespace promenade {

/// The last frames' figures.
class FramePlots {
 public:
  /// Of a picture that has just been drawn.
  void add(const FrameRow& row);
  /// It is in the window now. Returns how long that took from when keys and mouse were asked for, milliseconds; 0:
  /// there was no picture.
  double shown();
  /// As wide as the panel; the frame times with a line at the target.
  void draw_plots(double target_ms, uint64_t memory_bytes) const;
  /// A table of the last frame.
  void draw_figures(const Session& session) const;

 private:
  static constexpr size_t kFrames = 120;
  using Plot = std::array<float, kFrames>;
  static void push(Plot& plot, double value);
  Plot frame_ms_{}, resident_mib_{}, read_kib_{};
  FrameRow last_;
  std::optional<std::chrono::steady_clock::time_point> drawn_;  ///< not shown yet
  double response_ms_ = 0;
};

/// A table of names and what they are now. Between Panels::begin() and end(), as all below.
class FigureTable {
 public:
  explicit FigureTable(const char* id);
  ~FigureTable();
  FigureTable(const FigureTable&) = delete;
  FigureTable& operator=(const FigureTable&) = delete;
  void row(const char* name, const std::string& value) const;

 private:
  bool open_;
};

/// Sliders and boxes for all that the policies can be told.
void draw_settings(Session& session);

/// What keys and mouse do.
void draw_keys();

/// To the next of [xiong1996]'s styles: near geometry with far pictures, near alone, far alone, brute force. Other
/// policies give way to `stratified`. brute_from: the policy that brute force stands in for; the caller keeps it.
/// Returns what is shown now, or why there is no such thing.
std::string show_next_style(Session& session, const ModelSource& source, std::optional<Policy>& brute_from);

/// What boxes are drawn over the picture, and what their colours say.
enum class BoxColors : uint8_t { none, level, triangles, error, resident };
void draw_box_colors_setting(BoxColors& colors);

/// Draws, behind the panels, into the picture that `view` took: boxes of the nodes drawn (or resident) in false
/// colours, and, of a bird's eye, the walker's view pyramid, its cell and that cell's neighbours; and, where far
/// pictures are drawn, their cell and the box around it within which is geometry. row: of the frame shown.
void draw_overlay(const RasterView& view, const ModelSource& source, const Session& session, BoxColors colors,
                  const Camera* walker, const FrameRow& row);

}  // namespace promenade
