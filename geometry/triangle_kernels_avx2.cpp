#include "geometry/triangle_kernels.h"

#include <limits>

#include "geometry/lanes.h"

namespace promenade {

#ifdef __AVX2__
namespace {
using namespace lanes_avx2;  // NOLINT(google-build-using-namespace): the kernels are written on its names
#include "geometry/triangle_kernels.inl"
}  // namespace
const TriangleKernels& avx2_triangle_kernels() { return kKernels; }
#else
const TriangleKernels& avx2_triangle_kernels() { return portable_triangle_kernels(); }
#endif

}  // namespace promenade
