#pragma once
// What a build is told about view cells.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/box.h"
#include "geometry/result.h"
#include "layout/cell_front.h"

namespace promenade {

/// How viewing space is divided.
enum class CellStyle : uint8_t {
  none,       ///< not at all: the tree alone serves
  automatic,  ///< kd where most of the space under roofs is open: rooms; else octree
  octree,     ///< halves along every axis: for cities and landscapes
  kd,         ///< along walls, floors and ceilings: for the inside of buildings
};

struct CellOptions {
  CellStyle cells = CellStyle::none;
  /// By name, in the order in which a cell asks them; empty: nothing is hidden; "auto": what suits the style.
  std::vector<std::string> hiders;
  double pixel_error = 1;                     ///< bound of the fronts, pixels. Smaller: finer fronts, larger vLODs
  uint32_t width_px = 1280, height_px = 720;  ///< the picture that it is meant for
  double vertical_fov_deg = 60;
  ErrorAt error_at = ErrorAt::center;
  /// Most triangles of a vLOD that is not divided further. Smaller: more cells, less drawn.
  uint64_t cell_triangles = 100000;
  /// A cell is divided when it sees more than this many times what the smallest of its parts sees. [chhugani2003]
  /// section 2.1 has 2; under levels of detail most of what is seen is near, and less is to be gained.
  double cell_gain = 1.25;
  double smallest_cell_m = 4;  ///< no cell is divided whose parts would be shorter than this along every axis
  /// Space between walls nearer to each other than this, or than a 32nd of the model's length, gets no cell (in cells
  /// along walls): nobody passes there. 0: it does.
  double least_room_m = 0.4;
  uint32_t max_cells = 0;               ///< 0: one a node, 256 to 4096. Those that gain most are divided first
  std::optional<double> walk_height_m;  ///< only space this high above what one may stand on; nullopt: up to the sky
  bool openings = false;                ///< store what is open in walls, for eyes at run time
  std::vector<DBox> inside;             ///< only space in these boxes, metres, world; empty: everywhere
};

/// The camera and the bound that the options name.
FrontBound bound_of(const CellOptions& options);

/// Refuses what no build can do; the message names the option.
Status check_options(const CellOptions& options);
/// Of every option that the result depends on.
uint64_t hash_of(const CellOptions& options);
/// By option name, for the manifest.
std::map<std::string, std::string> settings_of(const CellOptions& options);

/// "none", "auto", "octree", "kd".
std::string_view name_of(CellStyle style);
std::optional<CellStyle> cell_style_named(std::string_view name);

}  // namespace promenade
