#include "raster/kernel.h"

#if defined(__AVX2F__) || defined(__AVX2__)
#include "raster/simd_avx2.h"
namespace promenade::raster_kernel {
namespace {
using namespace simd_avx2;  // NOLINT(google-build-using-namespace): the kernel is written on its names
#include "raster/kernel.inl"
}  // namespace
const Kernels& avx2_kernels() { return kKernels; }
}  // namespace promenade::raster_kernel
#else
namespace promenade::raster_kernel {
const Kernels& avx2_kernels() { return portable_kernels(); }
}  // namespace promenade::raster_kernel
#endif
