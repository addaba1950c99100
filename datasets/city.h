#pragma once
// The random city generator of [xiong1996] appendix A, with real detail.

#include <filesystem>

#include "geometry/box.h"
#include "geometry/job_monitor.h"
#include "geometry/path.h"
#include "geometry/result.h"

namespace promenade {

enum class StreetStyle : uint8_t { grid, organic };

/// Everything [xiong1996]'s generator takes, in metres, and what Promenade adds.
struct CityOptions {
  uint64_t seed = 1;
  uint64_t triangles =
      1'000'000;  ///< aimed at within 10 %; sets blocks_x and blocks_y when those are 0, else the detail
  StreetStyle style = StreetStyle::grid;
  uint32_t blocks_x = 0, blocks_y = 0;
  double block_length_m = 120, block_width_m = 80;
  uint32_t max_rows = 4, max_columns = 6;  ///< of buildings on a block
  double max_height_m = 60;
  double street_width_m = 14, street_height_m = 0;
  double curb_width_m = 2.5, curb_height_m = 0.15;
  double tree_distance_m = 12;          ///< 0: no trees
  uint32_t moving = 0;                  ///< cars that drive: animated objects, beyond `triangles`
  bool plain = false;                   ///< [xiong1996]'s: bands of colour, dividers; on the streets trees alone
  bool solids = false;                  ///< closed blocks, flat on top; generate_city sets it by the output's name
  bool interiors = false;               ///< furnished rooms behind the windows
  double texture_megapixels = 0;        ///< unique facade textures, all together; 0: colours only
  uint64_t tile_triangles = 1'000'000;  ///< a city larger than this is written as a folder of tiles of about this size
  uint32_t jobs = 0;                    ///< threads; 0: as many as cores. Never affects a byte
};

struct CityFigures {
  uint64_t triangles = 0;  ///< instances counted each
  uint64_t unique_triangles = 0;
  uint64_t objects = 0, buildings = 0, files = 0, bytes = 0;
  double texture_megapixels = 0;
  DBox box;
};

/// Writes `output` (a .glb, or `solids` as CityJSON text sequences to a .jsonl, or a folder of tiles when it has no
/// such ending) and, beside it, NAME_walk.json, NAME_drive.json and NAME_fly.json: a street walk at 1.4 m/s, a drive at
/// 100 km/h, a fly-over. Memory stays bounded whatever `triangles` is. Nothing stays half-written.
Result<CityFigures> generate_city(const CityOptions& options, const std::filesystem::path& output, JobMonitor& monitor);

}  // namespace promenade
