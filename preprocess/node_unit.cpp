#include "preprocess/node_unit.h"

#include <fmt/format.h>

#include <span>

#include "codec/image_codec.h"
#include "preprocess/unit_io.h"

namespace promenade {

namespace {

constexpr uint64_t kLargestTables = uint64_t(1) << 32;  // bounds recursion into a damaged file

void write(UnitWriter& writer, const Box& box) { writer.value(box.min), writer.value(box.max); }
Box read_box(UnitReader& reader) {
  const auto min = reader.value<glm::vec3>();
  return {min, reader.value<glm::vec3>()};
}

void write(UnitWriter& writer, const NormalCone& cone) { writer.value(cone.axis), writer.value(cone.cos_angle); }
NormalCone read_cone(UnitReader& reader) {
  const auto axis = reader.value<glm::vec3>();
  return {axis, reader.value<float>()};
}

void write(UnitWriter& writer, const NodeRecord& r) {
  write(writer, r.box), write(writer, r.cone);
  writer.value(r.error_m), writer.value(r.error_p99_m), writer.value(r.average_normal), writer.value(r.surface_m2);
  writer.value(r.triangles), writer.value(r.textured_triangles), writer.value(r.vertices);
}
NodeRecord read_record(UnitReader& reader) {
  NodeRecord r;
  r.box = read_box(reader), r.cone = read_cone(reader);
  r.error_m = reader.value<float>(), r.error_p99_m = reader.value<float>();
  r.average_normal = reader.value<glm::vec3>(), r.surface_m2 = reader.value<float>();
  r.triangles = reader.value<uint32_t>(), r.textured_triangles = reader.value<uint32_t>();
  r.vertices = reader.value<uint32_t>();
  return r;
}

void write(UnitWriter& writer, const std::vector<Material>& materials) {
  writer.value(static_cast<uint64_t>(materials.size()));
  for (const Material& m : materials) {
    writer.value(m.color), writer.value(m.texture), writer.value(m.wrap_u), writer.value(m.wrap_v);
    writer.value(m.alpha), writer.value(m.alpha_cutoff), writer.value(uint8_t(m.two_sided));
  }
}
std::vector<Material> read_materials(UnitReader& reader) {
  std::vector<Material> materials;
  for (auto left = reader.value<uint64_t>(); left > 0 && reader.ok(); --left) {
    Material& m = materials.emplace_back();
    m.color = reader.value<glm::u8vec4>(), m.texture = reader.value<uint32_t>();
    m.wrap_u = reader.value<Wrap>(), m.wrap_v = reader.value<Wrap>(), m.alpha = reader.value<AlphaMode>();
    m.alpha_cutoff = reader.value<uint8_t>(), m.two_sided = reader.value<uint8_t>() != 0;
  }
  return materials;
}

void write(UnitWriter& writer, const UnitNode& node) {
  write(writer, node.record);
  writer.array(node.children), writer.value(node.mesh), writer.value(node.step_m), writer.array(node.textures),
      writer.array(node.texels_m), writer.value(node.atlas);
  writer.value(node.atlas_record.width), writer.value(node.atlas_record.height), writer.value(node.atlas_record.flags);
  write(writer, node.atlas_materials);
  writer.array(node.classes);
}
UnitNode read_node(UnitReader& reader) {
  UnitNode node;
  node.record = read_record(reader);
  node.children = reader.array<uint32_t>(), node.mesh = reader.value<UnitBlob>();
  node.step_m = reader.value<float>();
  node.textures = reader.array<uint32_t>(), node.texels_m = reader.array<float>(),
  node.atlas = reader.value<UnitBlob>();
  node.atlas_record.width = reader.value<uint32_t>(), node.atlas_record.height = reader.value<uint32_t>();
  node.atlas_record.flags = reader.value<uint32_t>();
  node.atlas_materials = read_materials(reader);
  node.classes = reader.array<ClassArea>();
  return node;
}

std::vector<std::byte> surface_bytes(const NodeSurface& s) {
  UnitWriter writer;
  writer.mesh(s.mesh);
  write(writer, s.atlas_materials);
  writer.array(s.border.edges), writer.array(s.border.passed);
  writer.mesh(s.reference.mesh), writer.value(s.reference.error_m), writer.value(s.reference.p99_m);
  writer.value(s.error_m), writer.value(s.p99_m), writer.value(s.texture_error_m), writer.value(s.texel_m);
  write(writer, s.box), write(writer, s.cone);
  writer.value(s.stored_error_m), writer.value(s.stored_p99_m);
  return std::move(writer.bytes());
}
NodeSurface read_surface(UnitReader& reader) {
  NodeSurface s;
  s.mesh = reader.mesh();
  s.atlas_materials = read_materials(reader);
  s.border.edges = reader.array<BorderEdge>(), s.border.passed = reader.array<glm::vec3>();
  s.reference.mesh = reader.mesh();
  s.reference.error_m = reader.value<double>(), s.reference.p99_m = reader.value<double>();
  s.error_m = reader.value<double>(), s.p99_m = reader.value<double>(), s.texture_error_m = reader.value<double>();
  s.texel_m = reader.value<float>();
  s.box = read_box(reader), s.cone = read_cone(reader);
  s.stored_error_m = reader.value<float>(), s.stored_p99_m = reader.value<float>();
  return s;
}

/// Payload: offset of the tables; blobs; tables.
struct Assembly {
  UnitWriter writer;
  UnitBlob add(std::span<const std::byte> bytes) {
    const UnitBlob blob{writer.bytes().size(), bytes.size()};
    writer.bytes().insert(writer.bytes().end(), bytes.begin(), bytes.end());
    return blob;
  }
};

std::optional<NodeUnit> parse(const std::string& name, std::span<const std::byte> payload) {
  UnitReader start(payload);
  const auto tables = start.value<uint64_t>();
  if (!start.ok() || tables > payload.size()) return std::nullopt;
  UnitReader reader(payload.subspan(static_cast<size_t>(tables)));
  NodeUnit unit;
  unit.name = name;
  unit.payload_bytes = payload.size();
  const auto count = reader.value<uint64_t>();
  if (count > kLargestTables) return std::nullopt;
  for (uint64_t i = 0; i < count && reader.ok(); ++i) unit.nodes.push_back(read_node(reader));
  unit.surface = reader.value<UnitBlob>();
  if (!reader.ok()) return std::nullopt;
  return unit;
}

}  // namespace

Result<NodeUnit> store_node_unit(const WorkFolder& folder, const std::string& name, uint64_t hash,
                                 const std::vector<StoredNode>& nodes,
                                 const std::vector<std::vector<uint32_t>>& children, const NodeSurface& root) {
  Assembly assembly;
  assembly.writer.value(uint64_t(0));
  NodeUnit unit;
  unit.name = name;
  for (size_t i = 0; i < nodes.size(); ++i) {
    const StoredNode& stored = nodes[i];
    const UnitBlob mesh = assembly.add(stored.mesh);
    const UnitBlob atlas = assembly.add(stored.atlas);
    unit.nodes.push_back({stored.record, children[i], mesh, stored.step_m, stored.textures, stored.texels_m, atlas,
                          stored.atlas_record, stored.atlas_materials, stored.classes});
  }
  unit.surface = assembly.add(surface_bytes(root));
  const auto tables = static_cast<uint64_t>(assembly.writer.bytes().size());
  assembly.writer.value(static_cast<uint64_t>(unit.nodes.size()));
  for (const UnitNode& node : unit.nodes) write(assembly.writer, node);
  assembly.writer.value(unit.surface);
  std::vector<std::byte>& payload = assembly.writer.bytes();
  std::memcpy(payload.data(), &tables, sizeof tables);
  unit.payload_bytes = payload.size();
  PROMENADE_TRY(folder.store(name, hash, payload));
  return unit;
}

std::optional<NodeUnit> load_node_unit(const WorkFolder& folder, const std::string& name, uint64_t hash) {
  const std::optional<std::vector<std::byte>> payload = folder.load(name, hash);
  return payload ? parse(name, *payload) : std::nullopt;
}

Result<NodeSurface> read_root_surface(const WorkFolder& folder, const NodeUnit& unit) {
  const Error damaged{
      fmt::format("{}: damaged; remove the .work folder and build again", folder.path_of(unit.name).string())};
  const Result<RandomAccessFile> file = folder.open_unit(unit.name);
  if (!file.ok()) return file.error();
  const Result<std::vector<std::byte>> bytes = folder.read(*file, unit.surface.offset, unit.surface.bytes);
  if (!bytes.ok()) return bytes.error();
  UnitReader reader(*bytes);
  NodeSurface surface = read_surface(reader);
  if (!reader.ok()) return damaged;
  if (const UnitBlob& atlas = unit.nodes.front().atlas; atlas.bytes > 0) {
    const Result<std::vector<std::byte>> encoded = folder.read(*file, atlas.offset, atlas.bytes);
    if (!encoded.ok()) return encoded.error();
    Result<Image> image = decode_image(*encoded, unit.name);
    if (!image.ok()) return image.error();
    surface.atlas = std::make_shared<const Image>(std::move(*image));
  }
  return surface;
}

}  // namespace promenade
