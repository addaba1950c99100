#pragma once
// What a visibility buffer holds; shared with shading, nobody else.

#include <functional>
#include <vector>

#include "raster/kernel.h"
#include "raster/visibility.h"

namespace promenade {

/// Ids are given out in runs of so many: a table of one entry a run says whose an id is.
constexpr uint32_t kIdRunBits = 8;

struct VisibilityBuffer::State {
  RasterView view;
  VisibilityStats stats;
  raster_kernel::Frame frame = {};
  std::vector<float> z;
  std::vector<uint32_t> id;
  std::vector<float> hz;  ///< of all regions, one after the other
  std::vector<uint8_t> dirty;
  std::vector<raster_kernel::GapTile> gap_tiles;
  std::vector<raster_kernel::Region> regions;
  std::vector<uint8_t> blank;  ///< of each region, layers only: all of its ids say that nothing is there
  const raster_kernel::Kernels* kernels = nullptr;  ///< that drew it; null: there is no picture
  std::vector<raster_kernel::Item> items;           ///< as the caller listed them
  std::vector<uint32_t> nodes;
  std::vector<uint32_t> item_of_run;

  /// Offset of a pixel in the planes.
  size_t at(uint32_t x, uint32_t y) const {
    return ((size_t(y >> 3) * static_cast<uint32_t>(frame.tiles_x) + (x >> 3)) << 6 | (y & 4U) << 3 | (x & 4U) << 2 |
            (y & 3U) << 2 | (x & 3U));
  }
  bool covered(size_t at) const { return z[at] != frame.clear_z && id[at] != raster_kernel::kNoSurface; }
  uint32_t item_at(size_t at) const { return item_of_run[id[at] >> kIdRunBits]; }
  float depth_m(size_t at) const;
};

/// A mesh as the kernels want it, for one view.
raster_kernel::Item item_of(const RasterItem& drawn, const RasterView& view);
/// Centre and half size, grown by what rounding may take away.
void half_of(const Box& box, float* center, float* half);

/// Runs body(i) for i in [0, count), on `threads` threads (0: one a processor).
void run_parallel(unsigned threads, size_t count, const std::function<void(size_t)>& body);
unsigned thread_count(unsigned wanted);

const raster_kernel::Kernels& kernels_of(Simd simd);

}  // namespace promenade
