#pragma once
// What a city is written to: blocks come in, one file goes out.

#include <cstddef>
#include <vector>

#include "datasets/city.h"
#include "datasets/city_block.h"
#include "datasets/city_traffic.h"

namespace promenade {

/// A facade's picture, encoded.
struct EncodedFacade {
  std::vector<std::byte> jpeg;
  uint64_t pixels = 0;
};

/// One file, published by finish(). One thread.
class CityFile {
 public:
  CityFile() = default;
  CityFile(const CityFile&) = delete;
  CityFile& operator=(const CityFile&) = delete;
  virtual ~CityFile() = default;

  /// Blocks in their order. facades: by object; empty where an object has none. Counts what it writes in `figures`.
  virtual Status add(const CityBlock& block, uint32_t x, uint32_t y, const std::vector<EncodedFacade>& facades,
                     PropLibrary& props, CityFigures& figures) = 0;
  virtual Status add_traffic(const std::vector<MovingCar>& cars, PropLibrary& props, CityFigures& figures) = 0;
  virtual Status finish() = 0;
};

}  // namespace promenade
