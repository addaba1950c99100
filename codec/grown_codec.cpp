// The bytes are described in FORMAT.md.
#include "codec/grown_codec.h"

#include <fmt/format.h>

#include "codec/grown_looks.h"
#include "codec/grown_places.h"
#include "codec/grown_triangles.h"

namespace promenade {
namespace {

/// No choice is surer than 16376 to 8 of 16384, and each triangle takes three such ones or one of 16354 to 30: so many
/// cannot be told in a byte. What is allocated is bounded by the bytes that there are.
constexpr size_t kMostTrianglesAByte = 8192;

template <class T>
std::vector<T> in_order(const std::vector<T>& values, const std::vector<uint32_t>& sources) {
  std::vector<T> out;
  if (values.empty()) return out;
  out.reserve(sources.size());
  for (const uint32_t source : sources) out.push_back(values[source]);
  return out;
}

/// Where the grown places are.
std::vector<Place> places_of(const QuantizedMesh& mesh, const GrownSource& source) {
  std::vector<Place> places;
  places.reserve(source.place_sources().size());
  for (const uint32_t v : source.place_sources())
    places.push_back({{mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z, 0}});
  return places;
}

/// The vertices' positions, by those of their places.
void spread(const std::vector<Place>& places, const std::vector<uint32_t>& place_of, QuantizedMesh& mesh) {
  mesh.positions.resize(place_of.size());
  for (size_t v = 0; v < place_of.size(); ++v) {
    const std::array<uint32_t, 4>& at = places[place_of[v] + kFirstPlace].at;
    mesh.positions[v] = {at[0], at[1], at[2]};
  }
}

}  // namespace

GrownMesh encode_grown(const QuantizedMesh& mesh) {
  PutSide side;
  GrownSource source(mesh);
  TriangleGrower<PutSide> grower(side, mesh.positions.size(), mesh.indices.size() / 3, &source);
  size_t first = 0;
  for (const MaterialRun& run : mesh.runs) {
    source.begin_run(first, run.triangles);
    grower.grow_run(run.triangles);
    first += run.triangles;
  }
  PlaceTeller<PutSide> places(side, mesh.on_grid, mesh.fine_bits, grower.places());
  places.tell_all(std::span(grower.place_kin()).first(grower.places()), places_of(mesh, source));
  QuantizedMesh grown;
  grown.on_grid = mesh.on_grid;
  spread(places.places(), grower.place_of(), grown);
  grown.indices = grower.take_indices();
  grown.normals = in_order(mesh.normals, source.vertex_sources());
  grown.texcoords = in_order(mesh.texcoords, source.vertex_sources());
  grown.colors = in_order(mesh.colors, source.vertex_sources());
  if (!grown.normals.empty()) tell_normals(side, grower.vertex_kin(), grown);
  if (!grown.texcoords.empty()) tell_texcoords(side, grower.vertex_kin(), grown);
  if (!grown.colors.empty()) tell_colors(side, grower.vertex_kin(), grown);
  return {side.finish(), static_cast<uint32_t>(grown.positions.size())};
}

Status decode_grown(std::span<const std::byte> bytes, size_t vertices, size_t triangles, bool normals, bool texcoords,
                    bool colors, QuantizedMesh& mesh) {
  if (triangles / kMostTrianglesAByte > bytes.size())
    return Error{fmt::format("mesh: {} triangles in {} bytes", triangles, bytes.size())};
  GetSide side(bytes);
  TriangleGrower<GetSide> grower(side, vertices, triangles, nullptr);
  for (const MaterialRun& run : mesh.runs)
    if (!grower.grow_run(run.triangles)) return Error{fmt::format("mesh: its {} triangles do not decode", triangles)};
  if (grower.vertices() != vertices)
    return Error{fmt::format("mesh: decodes to {} vertices, its header has {}", grower.vertices(), vertices)};
  PlaceTeller<GetSide> places(side, mesh.on_grid, mesh.fine_bits, grower.places());
  places.tell_all(std::span(grower.place_kin()).first(grower.places()), {});
  mesh.indices = grower.take_indices();
  spread(places.places(), grower.place_of(), mesh);
  const std::vector<VertexKin>& kin = grower.vertex_kin();
  if (normals && !tell_normals(side, kin, mesh)) return Error{"mesh: its normals do not decode"};
  if (texcoords && !tell_texcoords(side, kin, mesh)) return Error{"mesh: its texture coordinates do not decode"};
  if (colors && !tell_colors(side, kin, mesh)) return Error{"mesh: its colours do not decode"};
  if (!side.at_end()) return Error{fmt::format("mesh: its {} bytes do not end with it", bytes.size())};
  return Done{};
}

}  // namespace promenade
