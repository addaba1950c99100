#pragma once
// What far pictures a build is to make.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geometry/result.h"
#include "geometry/shells.h"
#include "layout/far.h"
#include "layout/model.h"

namespace promenade {

struct FarOptions {
  bool pictures = false;  ///< false: none
  double bound_deg = 1;   ///< parallax of what is far from anywhere in a view cell. Larger: fewer cells or triangles
  double box_m = 0;       ///< within it geometry is drawn; 0: a sixth of the model's longest side
  double cell_m = 0;  ///< length of a view cell; 0: flat, the largest that keeps the bound; with depth four times that
  uint32_t shells =
      1;  ///< of boxes, one around the other: fewer cells whose pictures reach far ([xiong1996] chapter 4)
  ShellSpacing spacing = ShellSpacing::linear;
  double spacing_factor = 0;  ///< of ShellSpacing; 0: such that as many boxes again would reach the model's end
  bool depth = true;          ///< false: flat on the box's sides, as [xiong1996] has them
  uint32_t side_px = 0;       ///< of a picture, 2^n + 1; 0: a texel is at most a quarter of the bound, 513 or 1025
  int jpeg_quality = 85;      ///< 0: PNG, exact
  /// Sides are told against a neighbour's where that is shorter (never exact ones): a few per cent less on disk
  /// (`study far`), and after a jump two pictures to read instead of one.
  bool deltas = false;
  std::optional<double> height_m;  ///< view cells only this high above what one may stand on; nullopt: up to the sky
  std::vector<glm::dvec3> along;   ///< view cells only where one of these lies, world; empty: everywhere
  uint32_t max_cells = 4096;       ///< refuses to begin with more
};

/// Refuses what no build can do; the message names the option.
Status check_options(const FarOptions& options);
/// Of every option that the result depends on.
uint64_t hash_of(const FarOptions& options);
/// By option name, for the manifest.
std::map<std::string, std::string> settings_of(const FarOptions& options);

/// Pictures of a shell reach so far beyond the box of the shell around it, in its lengths: no gap opens between the
/// two.
constexpr double kFarOverlap = 1.0 / 16;

/// The grid of view cells over a model, without cells. Errors: a flat cell that cannot keep the bound, a box that holds
/// the model.
Result<FarTables> far_grid(const Model& model, const FarOptions& options);

}  // namespace promenade
