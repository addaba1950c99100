#include "preprocess/coarser_leaves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "preprocess/bake.h"

namespace promenade {
namespace {

constexpr uint32_t kMostPower = 16;
constexpr double kRounding = 1 + 1e-6;
// Of the parent's error: nearer to it, the node would hardly ever be what is drawn.
constexpr double kShareOfParent = 0.5;
// Textures of less than this are about what the node's triangles take besides.
constexpr uint64_t kSmallBytes = uint64_t(1) << 18;

double texel_growth(uint32_t versions) { return std::pow(double(kTextureStep), double(versions)); }

uint64_t decoded_bytes(const UnitNode& leaf, const std::vector<uint32_t>& versions, const TextureStore& textures) {
  uint64_t bytes = 0;
  for (size_t i = 0; i < versions.size(); ++i) {
    const StoredTexture& texture = textures[leaf.textures[i]];
    const StoredTexture::Size size =
        versions[i] == 0 ? StoredTexture::Size{texture.width, texture.height} : texture.smaller[versions[i] - 1];
    bytes += uint64_t(size.width) * size.height * sizeof(glm::u8vec4);
  }
  return bytes;
}

float rounded_up(double value) {
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

}  // namespace

std::vector<uint32_t> texture_versions(const UnitNode& leaf, uint32_t power, const TextureStore& textures) {
  double finest_m = std::numeric_limits<double>::infinity();
  for (const float texel_m : leaf.texels_m)
    if (texel_m > 0) finest_m = std::min(finest_m, double(texel_m));
  std::vector<uint32_t> versions(leaf.textures.size(), 0);
  for (size_t i = 0; i < versions.size(); ++i) {
    if (!(leaf.texels_m[i] > 0)) continue;
    const size_t most = textures[leaf.textures[i]].smaller.size();
    while (versions[i] < most &&
           double(leaf.texels_m[i]) * texel_growth(versions[i] + 1) <= finest_m * texel_growth(power) * kRounding)
      ++versions[i];
  }
  return versions;
}

NodeRecord coarser_record(const UnitNode& leaf, uint32_t power, const TextureStore& textures) {
  NodeRecord record = leaf.record;
  const std::vector<uint32_t> versions = texture_versions(leaf, power, textures);
  double error_m = 0;
  for (size_t i = 0; i < versions.size(); ++i)
    if (versions[i] > 0)
      error_m = std::max(error_m, kTexelReach * double(leaf.texels_m[i]) * texel_growth(versions[i]));
  if (error_m == 0) return record;
  record.error_m = rounded_up(double(record.error_m) + error_m);
  record.error_p99_m = std::min(record.error_m, rounded_up(double(record.error_p99_m) + error_m));
  return record;
}

uint32_t worthwhile_powers(const UnitNode& leaf, const NodeRecord* parent, const TextureStore& textures) {
  uint32_t powers = 1;
  uint64_t finer_bytes = decoded_bytes(leaf, texture_versions(leaf, 0, textures), textures);
  for (uint32_t power = 1; power <= kMostPower && finer_bytes >= kSmallBytes; ++power) {
    const uint64_t bytes = decoded_bytes(leaf, texture_versions(leaf, power, textures), textures);
    if (2 * bytes > finer_bytes) continue;
    const NodeRecord record = coarser_record(leaf, power, textures);
    if (parent != nullptr &&
        (double(record.error_m) > kShareOfParent * double(parent->error_m) || record.error_p99_m > parent->error_p99_m))
      break;
    powers |= 1U << power;
    finer_bytes = bytes;
  }
  return powers;
}

}  // namespace promenade
