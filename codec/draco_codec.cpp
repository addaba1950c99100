#include "codec/draco_codec.h"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <fmt/format.h>

#include <exception>

#include "codec/byte_io.h"

namespace promenade {
namespace {

// Attributes bear these as unique ids; those that a mesh lacks are left out.
enum AttributeId : uint32_t { id_position, id_normal, id_texcoord, id_color, id_material };

/// One attribute of a vertex as Draco is told of it.
struct AttributeKind {
  draco::GeometryAttribute::Type type;
  draco::DataType data;
  uint8_t components;
};

AttributeKind kind_of(AttributeId id, bool on_grid) {
  switch (id) {
    case id_position:
      return {draco::GeometryAttribute::POSITION, on_grid ? draco::DT_INT32 : draco::DT_FLOAT32, 3};
    case id_normal:
      return {draco::GeometryAttribute::GENERIC, draco::DT_INT16, 2};
    case id_texcoord:
      return {draco::GeometryAttribute::TEX_COORD, draco::DT_INT32, 2};
    case id_color:
      return {draco::GeometryAttribute::COLOR, draco::DT_UINT8, 4};
    case id_material:
    default:
      return {draco::GeometryAttribute::GENERIC, draco::DT_UINT32, 1};
  }
}

/// A draco::Mesh in the making: one point a vertex.
class DracoBuilder {
 public:
  explicit DracoBuilder(size_t points) { mesh_.set_num_points(static_cast<uint32_t>(points)); }

  template <class T>
  void add(AttributeId id, bool on_grid, const std::vector<T>& values) {
    const AttributeKind kind = kind_of(id, on_grid);
    draco::GeometryAttribute attribute;
    attribute.Init(kind.type, nullptr, kind.components, kind.data, false, sizeof(T), 0);
    const int index = mesh_.AddAttribute(attribute, true, static_cast<uint32_t>(values.size()));
    draco::PointAttribute* target = mesh_.attribute(index);
    target->set_unique_id(id);
    for (uint32_t v = 0; v < values.size(); ++v) target->SetAttributeValue(draco::AttributeValueIndex(v), &values[v]);
  }

  void add_face(uint32_t a, uint32_t b, uint32_t c) {
    mesh_.AddFace({draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
  }

  draco::Mesh& mesh() { return mesh_; }

 private:
  draco::Mesh mesh_;
};

template <class T>
std::vector<T> by_corner(const std::vector<T>& values, const std::vector<uint32_t>& indices) {
  std::vector<T> out;
  out.reserve(indices.size());
  for (const uint32_t i : indices) out.push_back(values[i]);
  return out;
}

/// A point for each corner, so that a material can be written at it; Draco unites those that agree.
void fill(const QuantizedMesh& mesh, DracoBuilder& builder) {
  builder.add(id_position, mesh.on_grid, by_corner(mesh.positions, mesh.indices));
  if (!mesh.normals.empty()) builder.add(id_normal, mesh.on_grid, by_corner(mesh.normals, mesh.indices));
  if (!mesh.texcoords.empty()) builder.add(id_texcoord, mesh.on_grid, by_corner(mesh.texcoords, mesh.indices));
  if (!mesh.colors.empty()) builder.add(id_color, mesh.on_grid, by_corner(mesh.colors, mesh.indices));
  if (mesh.runs.size() > 1) {  // by its place among the runs, which is small; one run needs none
    std::vector<uint32_t> places;
    for (uint32_t r = 0; r < mesh.runs.size(); ++r) places.insert(places.end(), size_t(mesh.runs[r].triangles) * 3, r);
    builder.add(id_material, mesh.on_grid, places);
  }
  for (uint32_t c = 0; c < mesh.indices.size(); c += 3) builder.add_face(c, c + 1, c + 2);
}

uint64_t get_varint(ByteReader& reader) {
  uint64_t value = 0;
  for (unsigned shift = 0; shift < 63; shift += 7) {
    const auto byte = reader.get<uint8_t>();
    value |= uint64_t(byte & 0x7fU) << shift;
    if ((byte & 0x80U) == 0) break;
  }
  return value;
}

/// Reads the counts that Draco would allocate for and compares them with what the caller knows.
Status check_header(std::span<const std::byte> bytes, size_t triangles) {
  ByteReader reader(bytes);
  const std::span<const std::byte> magic = reader.get_bytes(5);
  const auto major = reader.get<uint8_t>(), minor = reader.get<uint8_t>();
  const auto type = reader.get<uint8_t>(), method = reader.get<uint8_t>();
  const auto flags = reader.get<uint16_t>();
  reader.get<uint8_t>();  // how edgebreaker coded its symbols
  const uint64_t vertices = get_varint(reader), faces = get_varint(reader);
  if (!reader.ok() || std::string_view(reinterpret_cast<const char*>(magic.data()), 5) != "DRACO")
    return Error{"mesh: no Draco header"};
  if (major != 2 || minor != 2 || type != draco::TRIANGULAR_MESH || method != draco::MESH_EDGEBREAKER_ENCODING ||
      flags != 0)
    return Error{fmt::format("mesh: Draco {}.{}, type {}, method {}, flags {} is not what is written here", major,
                             minor, type, method, flags)};
  if (faces != triangles || vertices > 3 * triangles)
    return Error{
        fmt::format("mesh: Draco's header has {} faces and {} vertices for {} triangles", faces, vertices, triangles)};
  return Done{};
}

template <class T>
Status read_values(const draco::Mesh& decoded, AttributeId id, bool on_grid, std::vector<T>& values) {
  const AttributeKind kind = kind_of(id, on_grid);
  const draco::PointAttribute* attribute = decoded.GetAttributeByUniqueId(id);
  if (attribute == nullptr || attribute->data_type() != kind.data || attribute->num_components() != kind.components ||
      attribute->byte_stride() != int64_t(sizeof(T)))
    return Error{fmt::format("mesh: Draco attribute {} is missing or of another kind", int(id))};
  values.resize(decoded.num_points());
  for (uint32_t p = 0; p < decoded.num_points(); ++p) {
    const draco::AttributeValueIndex index = attribute->mapped_index(draco::PointIndex(p));
    if (index.value() >= attribute->size() || !attribute->IsAddressValid(attribute->GetAddress(index)))
      return Error{fmt::format("mesh: Draco attribute {} has no value for point {}", int(id), p)};
    attribute->GetValue(index, &values[p]);
  }
  return Done{};
}

Status read_mesh(const draco::Mesh& decoded, bool normals, bool texcoords, bool colors, QuantizedMesh& mesh) {
  PROMENADE_TRY(read_values(decoded, id_position, mesh.on_grid, mesh.positions));
  if (normals) PROMENADE_TRY(read_values(decoded, id_normal, mesh.on_grid, mesh.normals));
  if (texcoords) PROMENADE_TRY(read_values(decoded, id_texcoord, mesh.on_grid, mesh.texcoords));
  if (colors) PROMENADE_TRY(read_values(decoded, id_color, mesh.on_grid, mesh.colors));
  std::vector<uint32_t> places;
  if (mesh.runs.size() > 1) PROMENADE_TRY(read_values(decoded, id_material, mesh.on_grid, places));
  const std::vector<MaterialRun> runs = mesh.runs;
  std::vector<uint32_t> materials;
  for (uint32_t f = 0; f < decoded.num_faces(); ++f) {
    const draco::Mesh::Face& face = decoded.face(draco::FaceIndex(f));
    for (const draco::PointIndex& p : face) {
      if (p.value() >= decoded.num_points()) return Error{fmt::format("mesh: Draco face {} has no point", f)};
      mesh.indices.push_back(p.value());
    }
    const uint32_t place = places.empty() ? 0 : places[face[0].value()];
    if (place >= runs.size()) return Error{fmt::format("mesh: Draco face {} has no material", f)};
    materials.push_back(runs[place].material);
  }
  tidy(mesh, materials);
  return Done{};
}

}  // namespace

Result<std::vector<std::byte>> encode_draco(const QuantizedMesh& mesh) {
  if (mesh.indices.empty()) return std::vector<std::byte>{};
  try {
    DracoBuilder builder(mesh.indices.size());
    fill(mesh, builder);
    if (!builder.mesh().DeduplicateAttributeValues()) return Error{"mesh: Draco cannot unite its values"};
    builder.mesh().DeduplicatePointIds();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    encoder.SetSpeedOptions(3, 3);
    draco::EncoderBuffer buffer;
    const draco::Status status = encoder.EncodeMeshToBuffer(builder.mesh(), &buffer);
    if (!status.ok()) return Error{fmt::format("mesh: Draco cannot encode it: {}", status.error_msg_string())};
    const std::span<const std::byte> bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  } catch (const std::exception& e) {
    return Error{fmt::format("mesh: Draco cannot encode it: {}", e.what())};
  }
}

Status decode_draco(std::span<const std::byte> bytes, size_t triangles, bool normals, bool texcoords, bool colors,
                    QuantizedMesh& mesh) {
  if (triangles == 0) return bytes.empty() ? Status(Done{}) : Error{"mesh: bytes for no triangles"};
  PROMENADE_TRY(check_header(bytes, triangles));
  try {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
      return Error{fmt::format("mesh: Draco cannot decode it: {}", decoded.status().error_msg_string())};
    if (decoded.value()->num_faces() != triangles || decoded.value()->num_points() > 3 * triangles)
      return Error{fmt::format("mesh: Draco decodes {} faces and {} points for {} triangles",
                               decoded.value()->num_faces(), decoded.value()->num_points(), triangles)};
    return read_mesh(*decoded.value(), normals, texcoords, colors, mesh);
  } catch (const std::exception& e) {
    return Error{fmt::format("mesh: Draco cannot decode it: {}", e.what())};
  }
}

}  // namespace promenade
