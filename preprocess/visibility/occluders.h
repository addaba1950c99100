#pragma once
// Occluders of a model that stands on the ground: solid regions of its plan with the height up to which they are solid,
// found in the triangles of its leaves (what the source draws), not told by anybody.
//
// A region is given as nested loops, each the border of the region eroded by a known distance: from a point that moves
// by less than that distance (or when what is drawn differs by less), everything behind the loop stays hidden.

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "geometry/job_monitor.h"
#include "geometry/paged_array.h"
#include "layout/model_io.h"
#include "preprocess/visibility/slip_map.h"

namespace promenade {

struct OccluderOptions {
  double column_m = 0.18;     ///< finest gap that is seen; coarser: faster, occluders thinner by about as much
  double tile_m = 128;        ///< the world is worked through in squares of this size ...
  double margin_m = 24;       ///< ... with this much around them: buildings longer than twice that may fall apart
  double least_rise_m = 1.5;  ///< lower things hide too little to be kept
  /// What tiles in work may take together; less: fewer at once, and those that would take more than half of it are
  /// worked through in quarters. What is found is not in it.
  uint64_t memory_bytes = uint64_t(768) << 20;
};

/// A polygon such that every point of its sides is solid from base to top, and so is what lies within, but for the
/// holes of the same occluder, erosion and top.
struct OccluderLoop {
  float top_m = 0;
  float base_m = 0;  ///< -infinity: all the way down
  uint32_t first_point = 0, point_count = 0;
  bool is_hole = false;       ///< what is solid lies around it: it bounds a yard, or a chimney's well in a roof
  glm::vec2 low{0}, high{0};  ///< bounds
};

/// What hangs together: a building, or a block of them.
struct Occluder {
  Box box;           ///< of all its loops; z from the lowest base (finite) or top to the highest top
  float base_m = 0;  ///< of all its loops, the highest
  uint32_t first_loop = 0;
  std::array<uint32_t, 9>
      loops_end{};  ///< by erosion, from first_loop on: loops of erosion k lie in [end[k-1], end[k])
};

struct OccluderSet {
  /// How far the loops lie within what is solid, metres: halves of a cell's side, and a tenth more for the error of
  /// what is drawn.
  static constexpr std::array<float, 9> kErosionsM = {0.005F, 0.05F, 0.14F, 0.28F, 0.55F, 1.1F, 2.2F, 4.4F, 8.8F};

  std::vector<Occluder> occluders;
  PagedArray<OccluderLoop> loops;
  PagedArray<glm::vec2> points;

  std::span<const OccluderLoop> loops_of(const Occluder& occluder, size_t erosion) const {
    const uint32_t begin = erosion == 0 ? occluder.first_loop : occluder.loops_end[erosion - 1];
    return {loops.data() + begin, occluder.loops_end[erosion] - begin};
  }
  std::span<const glm::vec2> points_of(const OccluderLoop& loop) const {
    return {points.data() + loop.first_point, loop.point_count};
  }

  /// What is known of the ground, on a coarse grid of squares from a low corner on.
  struct Ground {
    static constexpr double kSquareM = 2;
    glm::dvec2 corner{0};
    uint32_t nx = 0, ny = 0;
    std::vector<float> solid_m;  ///< all of the square is solid up to here; -infinity: it is not
    SlipMap slips;               ///< where a ray may slip under it
    float slips_top_m = -std::numeric_limits<float>::infinity();  ///< only rays below this can

    /// The height below which all of the rectangle is solid.
    float solid_below(const Box& rectangle) const;
    /// Whether rays from one box to another may meet a slip: it lies between them (in the hull of their plans), and
    /// leads their way.
    bool has_slips(const Box& from, const Box& to) const;
  };
  Ground ground;
};

/// Most that a tile in work may take before it is worked through in quarters.
uint64_t most_tile_bytes(const OccluderOptions& options);

/// Reads every leaf, some times over, tile by tile on the threads of the arena; memory as the options say, and in
/// proportion to what is found. The same result at any number of threads. Errors: reading the model; "interrupted".
Result<OccluderSet> extract_occluders(const ModelReader& model, const OccluderOptions& options, JobMonitor& monitor);

}  // namespace promenade
