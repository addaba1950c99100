#include "codec/meshopt_codec.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "codec/byte_io.h"
#include "codec/vertex_streams.h"

namespace promenade {
namespace {

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
  std::vector<unsigned char> index_code(meshopt_encodeIndexBufferBound(mesh.indices.size(), mesh.positions.size()));
  index_code.resize(
      meshopt_encodeIndexBuffer(index_code.data(), index_code.size(), mesh.indices.data(), mesh.indices.size()));
  ByteWriter writer;
  writer.put(static_cast<uint32_t>(index_code.size()));
  writer.put_bytes(std::as_bytes(std::span(index_code)));
  put_vertices(mesh, writer);
  return writer.take();
}

Status decode_meshopt(std::span<const std::byte> bytes, size_t vertices, size_t triangles, bool normals, bool texcoords,
                      bool colors, QuantizedMesh& mesh) {
  ByteReader reader(bytes);
  const std::span<const std::byte> index_code = reader.get_bytes(reader.get<uint32_t>());
  if (!reader.ok()) return Error{"mesh: connectivity reaches beyond the end"};
  const auto* index_bytes = reinterpret_cast<const unsigned char*>(index_code.data());
  mesh.indices.resize(triangles * 3);
  if (meshopt_decodeIndexBuffer(mesh.indices.data(), mesh.indices.size(), index_bytes, index_code.size()) != 0)
    return Error{fmt::format("mesh: {} bytes of connectivity do not decode", index_code.size())};
  return get_vertices(reader, vertices, normals, texcoords, colors, mesh);
}

}  // namespace promenade
