#include "raster/kernel.h"

#include "raster/simd_portable.h"
namespace promenade::raster_kernel {
namespace {
using namespace simd_portable;  // NOLINT(google-build-using-namespace): the kernel is written on its names
#include "raster/kernel.inl"
}  // namespace
const Kernels& portable_kernels() { return kKernels; }
}  // namespace promenade::raster_kernel
