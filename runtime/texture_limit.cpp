#include "runtime/texture_limit.h"

#include <algorithm>
#include <bit>
#include <glm/vec2.hpp>
#include <vector>

namespace promenade {
namespace {

constexpr uint32_t kSmallestSide = 64;
constexpr size_t kMostCells = 64;  // looked at: a blink, however many there are

glm::uvec2 limited_size(const TextureRecord& texture, const TextureLimit& limit) {
  uint32_t halvings = 0;
  while (std::max(texture.width, texture.height) >> halvings > limit.of(texture)) ++halvings;
  return {std::max(1U, texture.width >> halvings), std::max(1U, texture.height >> halvings)};
}

/// Shared pictures of what a cell sees, each once.
std::vector<uint32_t> shared_textures(const ModelSource& source, CellId cell) {
  const Model& model = source.model();
  std::vector<uint32_t> textures;
  const Result<Vlod> vlod = source.read_vlod(cell);
  if (!vlod) return textures;  // the loader will meet it, too, and says so
  for (const NodeId node : vlod->nodes)
    for (const uint32_t texture : model.textures_of(node))
      if ((model.tables.textures[texture].flags & TextureRecord::kAtlas) == 0) textures.push_back(texture);
  std::sort(textures.begin(), textures.end());
  textures.erase(std::unique(textures.begin(), textures.end()), textures.end());
  return textures;
}

}  // namespace

uint64_t limited_bytes_bound(const TextureRecord& texture, const Renderer& renderer, const TextureLimit& limit) {
  const glm::uvec2 size = limited_size(texture, limit);
  return renderer.texture_bytes_bound(size.x, size.y);
}

uint64_t limited_bytes(const TextureRecord& texture, const TextureLimit& limit) {
  const glm::uvec2 size = limited_size(texture, limit);
  const uint64_t texel_bytes = (texture.flags & TextureRecord::kHasOpacity) != 0 ? 5 : 4;
  return uint64_t(size.x) * size.y * texel_bytes * 4 / 3;
}

TextureLimit texture_limit_for(const ModelSource& source, uint64_t bytes) {
  const Model& model = source.model();
  TextureLimit limit;
  if (source.cells() == nullptr || model.tables.textures.empty()) return limit;
  const size_t cells = source.cells()->cells.size(), step = std::max<size_t>(1, cells / kMostCells);
  std::vector<std::vector<uint32_t>> seen;
  seen.reserve(cells / step + 1);
  uint32_t largest = 1;
  for (size_t i = step / 2; i < cells; i += step) {
    seen.push_back(shared_textures(source, CellId{static_cast<uint32_t>(i)}));
    for (const uint32_t texture : seen.back())
      largest = std::max({largest, model.tables.textures[texture].width, model.tables.textures[texture].height});
  }
  const auto fits = [&](const std::vector<uint32_t>& textures) {
    uint64_t sum = 0;
    for (const uint32_t texture : textures) sum += limited_bytes(model.tables.textures[texture], limit);
    return sum <= bytes;
  };
  for (uint32_t side = std::bit_floor(largest); side >= kSmallestSide && !std::all_of(seen.begin(), seen.end(), fits);
       side /= 2)
    limit.side_px = side;
  return limit;
}

}  // namespace promenade
