#include "raster/kernel.h"

#if defined(__AVX512F__) || defined(__AVX512__)
#include "raster/simd_avx512.h"
namespace promenade::raster_kernel {
namespace {
using namespace simd_avx512;  // NOLINT(google-build-using-namespace): the kernel is written on its names
#include "raster/kernel.inl"
}  // namespace
const Kernels& avx512_kernels() { return kKernels; }
}  // namespace promenade::raster_kernel
#else
namespace promenade::raster_kernel {
const Kernels& avx512_kernels() { return portable_kernels(); }
}  // namespace promenade::raster_kernel
#endif
