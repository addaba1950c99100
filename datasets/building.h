#pragma once
// A furnished university building in the manner of [funkhouser1993]'s Soda Hall.

#include <filesystem>

#include "geometry/box.h"
#include "geometry/job_monitor.h"
#include "geometry/result.h"

namespace promenade {

struct BuildingOptions {
  uint64_t seed = 1;
  uint64_t triangles =
      1'400'000;  ///< aimed at within 10 %: sets the tessellation of the furniture (or more floors, when it runs out)
  uint32_t floors = 7;
  uint32_t jobs = 0;  ///< threads; 0: as many as cores. Never affects a byte
};

struct BuildingFigures {
  uint64_t triangles = 0;  ///< instances counted each
  uint64_t unique_triangles = 0;
  uint64_t structure_triangles = 0;  ///< walls, floors, ceilings
  uint64_t objects = 0, unique_objects = 0, classes = 0, rooms = 0, files = 0, bytes = 0;
  DBox box;
};

/// Writes `output` (.glb) and beside it NAME_walk.json: a walk through doors, corridors and stairs that visits every
/// floor, its eye never nearer than 0.25 m to anything. Nothing stays half-written.
Result<BuildingFigures> generate_building(const BuildingOptions& options, const std::filesystem::path& output,
                                          JobMonitor& monitor);

}  // namespace promenade
