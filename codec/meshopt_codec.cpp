#include "codec/meshopt_codec.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <limits>

#include "codec/byte_io.h"

namespace promenade {
namespace {

/// How the attributes of one vertex lie in the bytes that the vertex codec sees: 16-bit words where they suffice.
struct VertexLayout {
  bool wide_positions = false;
  bool wide_texcoords = false;
  bool normals = false;
  bool texcoords = false;
  bool colors = false;

  size_t bytes() const {
    const size_t position = wide_positions ? 12 : 6;
    const size_t texcoord = !texcoords ? 0 : wide_texcoords ? 8 : 4;
    const size_t all = position + texcoord + (normals ? 4U : 0U) + (colors ? 4U : 0U);
    return (all + 3) / 4 * 4;  // the codec wants multiples of four
  }
};

template <class Vec>
bool needs_32_bits(const std::vector<Vec>& values) {
  return std::any_of(values.begin(), values.end(), [](const Vec& v) {
    for (int i = 0; i < Vec::length(); ++i)
      if (v[i] > std::numeric_limits<uint16_t>::max()) return true;
    return false;
  });
}

void put_words(std::span<std::byte>& at, uint32_t value, bool wide) {
  for (size_t i = 0; i < (wide ? 4U : 2U); ++i) at[i] = static_cast<std::byte>((value >> (8 * i)) & 0xffU);
  at = at.subspan(wide ? 4 : 2);
}

uint32_t get_words(std::span<const std::byte>& at, bool wide) {
  uint32_t value = 0;
  for (size_t i = 0; i < (wide ? 4U : 2U); ++i) value |= std::to_integer<uint32_t>(at[i]) << (8 * i);
  at = at.subspan(wide ? 4 : 2);
  return value;
}

std::vector<std::byte> interleaved(const QuantizedMesh& mesh, const VertexLayout& layout) {
  const size_t stride = layout.bytes();
  std::vector<std::byte> bytes(mesh.positions.size() * stride);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    std::span<std::byte> at = std::span(bytes).subspan(v * stride, stride);
    for (int i = 0; i < 3; ++i) put_words(at, mesh.positions[v][i], layout.wide_positions);
    for (int i = 0; i < 2 && layout.normals; ++i) put_words(at, static_cast<uint16_t>(mesh.normals[v][i]), false);
    for (int i = 0; i < 2 && layout.texcoords; ++i) put_words(at, mesh.texcoords[v][i], layout.wide_texcoords);
    for (int i = 0; i < 4 && layout.colors; ++i) at[static_cast<size_t>(i)] = std::byte(mesh.colors[v][i]);
  }
  return bytes;
}

void fill_attributes(std::span<const std::byte> bytes, const VertexLayout& layout, QuantizedMesh& mesh,
                     size_t vertices) {
  const size_t stride = layout.bytes();
  mesh.positions.resize(vertices);
  mesh.normals.resize(layout.normals ? vertices : 0);
  mesh.texcoords.resize(layout.texcoords ? vertices : 0);
  mesh.colors.resize(layout.colors ? vertices : 0);
  for (size_t v = 0; v < vertices; ++v) {
    std::span<const std::byte> at = bytes.subspan(v * stride, stride);
    for (int i = 0; i < 3; ++i) mesh.positions[v][i] = get_words(at, layout.wide_positions);
    for (int i = 0; i < 2 && layout.normals; ++i)
      mesh.normals[v][i] = static_cast<int16_t>(static_cast<uint16_t>(get_words(at, false)));
    for (int i = 0; i < 2 && layout.texcoords; ++i) mesh.texcoords[v][i] = get_words(at, layout.wide_texcoords);
    for (int i = 0; i < 4 && layout.colors; ++i)
      mesh.colors[v][i] = std::to_integer<uint8_t>(at[static_cast<size_t>(i)]);
  }
}

/// Triangles of a run in an order that the index codec likes, vertices in the order of their first use.
void reorder(QuantizedMesh& mesh) {
  size_t first = 0;
  for (const MaterialRun& run : mesh.runs) {
    uint32_t* indices = mesh.indices.data() + first;
    meshopt_optimizeVertexCacheStrip(indices, indices, size_t(run.triangles) * 3, mesh.positions.size());
    first += size_t(run.triangles) * 3;
  }
  std::vector<uint32_t> remap(mesh.positions.size());
  meshopt_optimizeVertexFetchRemap(remap.data(), mesh.indices.data(), mesh.indices.size(), mesh.positions.size());
  for (uint32_t& i : mesh.indices) i = remap[i];
  const auto move = [&remap](auto& values) {
    auto moved = values;
    for (size_t v = 0; v < values.size(); ++v) moved[remap[v]] = values[v];
    values = std::move(moved);
  };
  move(mesh.positions), move(mesh.normals), move(mesh.texcoords), move(mesh.colors);
}

}  // namespace

std::vector<std::byte> encode_meshopt(QuantizedMesh mesh) {
  reorder(mesh);
  const VertexLayout layout{needs_32_bits(mesh.positions), needs_32_bits(mesh.texcoords), !mesh.normals.empty(),
                            !mesh.texcoords.empty(), !mesh.colors.empty()};
  std::vector<unsigned char> index_code(meshopt_encodeIndexBufferBound(mesh.indices.size(), mesh.positions.size()));
  index_code.resize(
      meshopt_encodeIndexBuffer(index_code.data(), index_code.size(), mesh.indices.data(), mesh.indices.size()));
  const std::vector<std::byte> vertices = interleaved(mesh, layout);
  std::vector<unsigned char> vertex_code(meshopt_encodeVertexBufferBound(mesh.positions.size(), layout.bytes()));
  vertex_code.resize(meshopt_encodeVertexBuffer(vertex_code.data(), vertex_code.size(), vertices.data(),
                                                mesh.positions.size(), layout.bytes()));
  ByteWriter writer;
  writer.put(uint8_t(layout.wide_positions));
  writer.put(uint8_t(layout.wide_texcoords));
  writer.put(static_cast<uint32_t>(index_code.size()));
  writer.put_bytes(std::as_bytes(std::span(index_code)));
  writer.put_bytes(std::as_bytes(std::span(vertex_code)));
  return writer.take();
}

Status decode_meshopt(std::span<const std::byte> bytes, size_t vertices, size_t triangles, bool normals, bool texcoords,
                      bool colors, QuantizedMesh& mesh) {
  ByteReader reader(bytes);
  VertexLayout layout;
  layout.wide_positions = reader.get<uint8_t>() != 0;
  layout.wide_texcoords = reader.get<uint8_t>() != 0;
  layout.normals = normals, layout.texcoords = texcoords, layout.colors = colors;
  const std::span<const std::byte> index_code = reader.get_bytes(reader.get<uint32_t>());
  const std::span<const std::byte> vertex_code = reader.get_bytes(reader.remaining());
  if (!reader.ok()) return Error{"mesh: connectivity reaches beyond the end"};
  const auto* index_bytes = reinterpret_cast<const unsigned char*>(index_code.data());
  const auto* vertex_bytes = reinterpret_cast<const unsigned char*>(vertex_code.data());
  mesh.indices.resize(triangles * 3);
  if (meshopt_decodeIndexBuffer(mesh.indices.data(), mesh.indices.size(), index_bytes, index_code.size()) != 0)
    return Error{fmt::format("mesh: {} bytes of connectivity do not decode", index_code.size())};
  std::vector<std::byte> interleaved_bytes(vertices * layout.bytes());
  if (meshopt_decodeVertexBuffer(interleaved_bytes.data(), vertices, layout.bytes(), vertex_bytes,
                                 vertex_code.size()) != 0)
    return Error{fmt::format("mesh: {} bytes of vertices do not decode", vertex_code.size())};
  fill_attributes(interleaved_bytes, layout, mesh, vertices);
  return Done{};
}

}  // namespace promenade
