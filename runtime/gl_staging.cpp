#include "runtime/gl_staging.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace promenade {
namespace {

/// Conversions by table: pow() for every texel of every level would cost more than decoding the picture.
struct ColorTables {
  std::array<float, 256> linear{};
  std::vector<uint8_t> srgb;
  // Entries a step of the steepest part of the curve (12.92 x 255 levels a unit): 20, so that rounding is to the
  // nearest.
  static constexpr uint32_t kSrgbEntries = 65536;

  ColorTables() : srgb(kSrgbEntries) {
    for (size_t i = 0; i < linear.size(); ++i) linear[i] = srgb_to_linear(static_cast<uint8_t>(i));
    for (uint32_t i = 0; i < kSrgbEntries; ++i) srgb[i] = linear_to_srgb(float(i) / float(kSrgbEntries - 1));
  }
  uint8_t encode(float value) const {
    // Never negative, and lround is a call a texel. NOLINTNEXTLINE(bugprone-incorrect-roundings)
    return srgb[static_cast<uint32_t>(std::clamp(value, 0.0F, 1.0F) * float(kSrgbEntries - 1) + 0.5F)];
  }
};

const ColorTables& color_tables() {
  static const ColorTables tables;
  return tables;
}

struct Range {
  uint32_t begin, end;
};

/// Source texels that texel `i` of a half as long row covers.
Range covered(uint32_t i, uint32_t length, uint32_t half_length) {
  return {static_cast<uint32_t>(uint64_t(i) * length / half_length),
          static_cast<uint32_t>((uint64_t(i + 1) * length + half_length - 1) / half_length)};
}

glm::u8vec4 averaged(const Image& image, Range xs, Range ys, const ColorTables& tables) {
  glm::vec3 weighted(0), plain(0);
  float opacity = 0;
  for (uint32_t y = ys.begin; y < ys.end; ++y)
    for (uint32_t x = xs.begin; x < xs.end; ++x) {
      const glm::u8vec4& texel = image.at(x, y);
      const glm::vec3 color(tables.linear[texel.r], tables.linear[texel.g], tables.linear[texel.b]);
      weighted += color * float(texel.a);
      plain += color;
      opacity += float(texel.a);
    }
  const float count = float((xs.end - xs.begin) * (ys.end - ys.begin));
  // Where nothing is opaque the colour still bleeds into its neighbours when magnified: keep the plain mean.
  const glm::vec3 color = opacity > 0 ? weighted / opacity : plain / count;
  return {tables.encode(color.r), tables.encode(color.g), tables.encode(color.b),
          static_cast<uint8_t>(std::lround(opacity / count))};
}

uint32_t group_rank(const Material& material) { return static_cast<uint32_t>(material.alpha); }

/// Triangle numbers by (opaque, masked, blended), then material, then as they came.
std::vector<uint32_t> triangles_by_material(const Mesh& mesh, std::span<const Material> materials) {
  std::vector<uint32_t> order(mesh.triangle_count());
  std::iota(order.begin(), order.end(), 0U);
  if (mesh.materials.empty()) return order;
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const uint32_t ma = mesh.materials[a], mb = mesh.materials[b];
    if (ma == mb) return false;
    const uint32_t ra = group_rank(materials[ma]), rb = group_rank(materials[mb]);
    return ra != rb ? ra < rb : ma < mb;
  });
  return order;
}

template <class Index>
void fill_indices(const Mesh& mesh, const std::vector<uint32_t>& order, std::vector<Index>& indices) {
  indices.reserve(order.size() * 3);
  for (const uint32_t triangle : order)
    for (size_t corner = 0; corner < 3; ++corner)
      indices.push_back(static_cast<Index>(mesh.indices[size_t{3} * triangle + corner]));
}

}  // namespace

uint64_t GlStagedTexture::byte_size() const {
  uint64_t bytes = 0;
  for (const Image& level : levels) bytes += level.pixels.size() * sizeof(glm::u8vec4);
  return bytes;
}

uint32_t pack_normal(const glm::vec3& normal) {
  const auto part = [](float value) {
    const int rounded = static_cast<int>(std::lround(std::clamp(value, -1.0F, 1.0F) * 511.0F));
    return static_cast<uint32_t>(rounded) & 1023U;
  };
  return part(normal.x) | part(normal.y) << 10 | part(normal.z) << 20;
}

GlStagedMesh stage_gl_mesh(const Mesh& mesh, std::span<const Material> materials) {
  GlStagedMesh staged;
  staged.box = bounds(mesh);
  staged.has_normals = !mesh.normals.empty();
  staged.has_colors = !mesh.colors.empty();
  staged.vertices.resize(mesh.vertex_count());
  for (size_t i = 0; i < mesh.vertex_count(); ++i) {
    staged.vertices[i] = {mesh.positions[i], staged.has_normals ? pack_normal(mesh.normals[i]) : 0U,
                          staged.has_colors ? mesh.colors[i] : glm::u8vec4(255),
                          mesh.texcoords.empty() ? glm::vec2(0) : mesh.texcoords[i]};
  }
  const std::vector<uint32_t> order = triangles_by_material(mesh, materials);
  if (mesh.vertex_count() <= 65536)
    fill_indices(mesh, order, staged.indices16);
  else
    fill_indices(mesh, order, staged.indices32);
  uint32_t last = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    const uint32_t material = mesh.material_of(order[i]);
    if (i == 0 || material != last) {
      Material look = material < materials.size() ? materials[material] : Material{};
      if (mesh.texcoords.empty()) look.texture = kNoTexture;
      staged.groups.push_back({look, static_cast<uint32_t>(3 * i), 0});
    }
    staged.groups.back().index_count += 3;
    last = material;
  }
  staged.groups.shrink_to_fit();
  return staged;
}

uint64_t gl_mesh_bytes_bound(uint64_t vertices, uint64_t triangles) {
  return vertices * sizeof(GlVertex) + triangles * 3 * (vertices <= 65536 ? sizeof(uint16_t) : sizeof(uint32_t)) +
         triangles * kGroupBytesMax;
}

Image halved(const Image& image) {
  const ColorTables& tables = color_tables();
  Image half;
  half.width = std::max(1U, image.width / 2);
  half.height = std::max(1U, image.height / 2);
  half.pixels.resize(size_t(half.width) * half.height);
  for (uint32_t y = 0; y < half.height; ++y)
    for (uint32_t x = 0; x < half.width; ++x)
      half.at(x, y) =
          averaged(image, covered(x, image.width, half.width), covered(y, image.height, half.height), tables);
  return half;
}

GlStagedTexture stage_gl_texture(const Image& image, uint32_t max_side) {
  GlStagedTexture staged;
  if (image.width == 0 || image.height == 0) {
    staged.levels.push_back({1, 1, {glm::u8vec4(255)}});
    return staged;
  }
  Image level = image;
  while (std::max(level.width, level.height) > max_side) level = halved(level);
  while (true) {
    const bool last = level.width == 1 && level.height == 1;
    Image next = last ? Image{} : halved(level);
    staged.levels.push_back(std::move(level));
    if (last) return staged;
    level = std::move(next);
  }
}

uint64_t gl_texture_bytes(uint32_t width, uint32_t height) {
  uint64_t bytes = 0;
  for (uint64_t w = std::max(1U, width), h = std::max(1U, height);;
       w = std::max<uint64_t>(1, w / 2), h = std::max<uint64_t>(1, h / 2)) {
    bytes += w * h * sizeof(glm::u8vec4);
    if (w == 1 && h == 1) return bytes;
  }
}

}  // namespace promenade
