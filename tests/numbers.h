#pragma once
// Random numbers of tests: the same everywhere, from the seed on.

#include <glm/vec3.hpp>

#include "geometry/random.h"

namespace promenade::test {

class Numbers {
 public:
  explicit Numbers(uint64_t seed) : random_(seed) {}
  uint64_t next() { return random_.next(); }
  float unit() { return random_.range(0.0F, 1.0F); }
  float between(float low, float high) { return random_.range(low, high); }
  glm::vec3 in_cube(float half) {
    const float x = between(-half, half), y = between(-half, half), z = between(-half, half);
    return {x, y, z};
  }

 private:
  Random random_;
};

}  // namespace promenade::test
