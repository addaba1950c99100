#include "geometry/triangle_kernels.h"

#include <limits>

#include "geometry/lanes.h"

namespace promenade {

namespace {
using namespace lanes_sse;  // NOLINT(google-build-using-namespace): the kernels are written on its names
#include "geometry/triangle_kernels.inl"
}  // namespace

const TriangleKernels& portable_triangle_kernels() { return kKernels; }

const TriangleKernels& triangle_kernels() {
  static const TriangleKernels& chosen =
      __builtin_cpu_supports("avx2") != 0 ? avx2_triangle_kernels() : portable_triangle_kernels();
  return chosen;
}

}  // namespace promenade
