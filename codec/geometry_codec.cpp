// The bytes are described in FORMAT.md.
#include "codec/geometry_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "codec/byte_io.h"
#include "codec/draco_codec.h"
#include "codec/frame.h"
#include "codec/grown_codec.h"
#include "codec/meshopt_codec.h"
#include "codec/quantized_mesh.h"
#include "codec/varint.h"

namespace promenade {
namespace {

constexpr uint32_t kMagic = 0x48534d50;  // "PMSH"
constexpr uint8_t kVersion = 3;
constexpr size_t kHeaderBytes = 24;
constexpr uint8_t kHasNormals = 1, kHasTexcoords = 2, kHasColors = 4, kHasMaterials = 8, kOnGrid = 16, kFine = 32,
                  kByKinds = 64;
constexpr uint8_t kAllFlags = 127;
constexpr int kMaxExponent = 60;
constexpr int64_t kFarthestBase = int64_t(1) << 53;  // no sum with an offset overflows; encoders stay far below
constexpr int64_t kTexcoordSteps = int64_t(1) << 28;
constexpr int64_t kDracoTexcoordSteps = int64_t(1) << 21;  // its predictor for texture coordinates fails above

constexpr std::array<std::string_view, 4> kNames = {"raw", "meshopt", "draco", "grown"};

/// The fixed part before the compressed payload.
struct Header {
  GeometryCodec codec = GeometryCodec::raw;
  uint8_t flags = 0;
  int8_t position_exponent = 0;
  int8_t texcoord_exponent = 0;
  uint8_t fine_bits = 0;  ///< 0 without kFine
  uint32_t vertices = 0;
  uint32_t triangles = 0;
  uint32_t runs = 0;

  bool has(uint8_t flag) const { return (flags & flag) != 0; }
  /// Bytes of the arrays of the decoded mesh. Cannot overflow: 40 bytes a vertex, 16 a triangle.
  uint64_t mesh_bytes() const {
    const uint64_t vertex =
        12U + (has(kHasNormals) ? 12U : 0U) + (has(kHasTexcoords) ? 8U : 0U) + (has(kHasColors) ? 4U : 0U);
    return vertices * vertex + uint64_t(triangles) * (has(kHasMaterials) ? 16U : 12U);
  }
};

void put_header(ByteWriter& writer, const Header& header) {
  writer.put(kMagic);
  writer.put(kVersion);
  writer.put(static_cast<uint8_t>(header.codec));
  writer.put(header.flags);
  writer.put(header.position_exponent);
  writer.put(header.vertices);
  writer.put(header.triangles);
  writer.put(header.runs);
  writer.put(header.texcoord_exponent);
  writer.put(header.fine_bits);
  for (int i = 0; i < 2; ++i) writer.put(uint8_t(0));
}

Result<Header> get_header(ByteReader& reader, uint64_t max_bytes) {
  if (reader.remaining() < kHeaderBytes)
    return Error{fmt::format("mesh: {} bytes are no mesh, its header has {}", reader.remaining(), kHeaderBytes)};
  if (const auto magic = reader.get<uint32_t>(); magic != kMagic)
    return Error{fmt::format("mesh: begins with {:08x}, not {:08x}", magic, kMagic)};
  if (const auto version = reader.get<uint8_t>(); version != kVersion)
    return Error{
        fmt::format("mesh: version {}, this program reads {}; use the program that wrote it", version, kVersion)};
  Header header;
  const auto codec = reader.get<uint8_t>();
  if (codec >= kNames.size()) return Error{fmt::format("mesh: unknown codec {}", codec)};
  header.codec = static_cast<GeometryCodec>(codec);
  header.flags = reader.get<uint8_t>();
  header.position_exponent = reader.get<int8_t>();
  header.vertices = reader.get<uint32_t>();
  header.triangles = reader.get<uint32_t>();
  header.runs = reader.get<uint32_t>();
  header.texcoord_exponent = reader.get<int8_t>();
  header.fine_bits = reader.get<uint8_t>();
  const auto reserved = reader.get<uint16_t>();
  const bool is_fine =
      header.fine_bits > 0 && header.fine_bits <= kMaxFineBits && header.has(kOnGrid) && has_fine_grid(header.codec);
  if (header.flags > kAllFlags || (header.has(kByKinds) && header.codec != GeometryCodec::meshopt) || reserved != 0 ||
      (header.has(kFine) ? !is_fine : header.fine_bits != 0))
    return Error{fmt::format("mesh: unknown flags {:#x} or reserved bytes {:#x}", header.flags,
                             uint32_t(reserved) << 8U | header.fine_bits)};
  if (header.mesh_bytes() > max_bytes)
    return Error{fmt::format("mesh: {} vertices and {} triangles take {} bytes, at most {} are allowed",
                             header.vertices, header.triangles, header.mesh_bytes(), max_bytes)};
  if (header.runs > header.triangles)
    return Error{fmt::format("mesh: {} materials for {} triangles", header.runs, header.triangles)};
  return header;
}

Header header_for(const Mesh& mesh, const GeometryEncodeOptions& options) {
  Header header;
  header.codec = options.codec;
  header.flags = static_cast<uint8_t>(
      (mesh.normals.empty() ? 0 : kHasNormals) | (mesh.texcoords.empty() ? 0 : kHasTexcoords) |
      (mesh.colors.empty() ? 0 : kHasColors) | (mesh.materials.empty() ? 0 : kHasMaterials) |
      (options.position_step_m ? kOnGrid : 0) | (options.codec == GeometryCodec::meshopt ? kByKinds : 0));
  header.vertices = static_cast<uint32_t>(mesh.vertex_count());
  header.triangles = static_cast<uint32_t>(mesh.triangle_count());
  return header;
}

/// Rounded up to the next float, so that it remains a bound.
float bound_m(double distance) {
  const auto rounded = static_cast<float>(distance);
  return double(rounded) < distance ? std::nextafter(rounded, std::numeric_limits<float>::infinity()) : rounded;
}

/// How many bits finer than its grid a mesh is coded.
int fine_bits_of(const GeometryEncodeOptions& options) {
  if (!has_fine_grid(options.codec) || !options.position_step_m || !(options.fine_step_m > 0)) return 0;
  return std::clamp(std::ilogb(*options.position_step_m) - std::ilogb(options.fine_step_m), 0, kMaxFineBits);
}

double rounding_error_m(const Mesh& mesh, float step_m) {
  double worst = 0;
  for (const glm::vec3& p : mesh.positions)
    worst = std::max(worst, glm::length(glm::dvec3(snapped(p, step_m)) - glm::dvec3(p)));
  return worst;
}

// ---- raw

template <class Vec>
void put_vectors(ByteWriter& writer, const std::vector<Vec>& values) {
  for (const Vec& v : values)
    for (int i = 0; i < Vec::length(); ++i) writer.put(v[i]);
}

template <class Vec>
void get_vectors(ByteReader& reader, size_t count, std::vector<Vec>& values) {
  values.resize(count);
  for (Vec& v : values)
    for (int i = 0; i < Vec::length(); ++i) v[i] = reader.get<typename Vec::value_type>();
}

void get_numbers(ByteReader& reader, size_t count, std::vector<uint32_t>& values) {
  values.resize(count);
  for (uint32_t& v : values) v = reader.get<uint32_t>();
}

std::vector<std::byte> raw_payload(const Mesh& mesh, std::optional<float> step_m) {
  ByteWriter writer;
  for (const glm::vec3& p : mesh.positions) put_vectors(writer, std::vector{step_m ? snapped(p, *step_m) : p});
  put_vectors(writer, mesh.normals);
  put_vectors(writer, mesh.texcoords);
  put_vectors(writer, mesh.colors);
  for (const uint32_t i : mesh.indices) writer.put(i);
  for (const uint32_t m : mesh.materials) writer.put(m);
  return writer.take();
}

Result<Mesh> mesh_of_raw(const Header& header, std::span<const std::byte> payload) {
  if (payload.size() != header.mesh_bytes())
    return Error{fmt::format("mesh: raw payload of {} bytes, {} are due", payload.size(), header.mesh_bytes())};
  ByteReader reader(payload);
  Mesh mesh;
  get_vectors(reader, header.vertices, mesh.positions);
  if (header.has(kHasNormals)) get_vectors(reader, header.vertices, mesh.normals);
  if (header.has(kHasTexcoords)) get_vectors(reader, header.vertices, mesh.texcoords);
  if (header.has(kHasColors)) get_vectors(reader, header.vertices, mesh.colors);
  get_numbers(reader, size_t(header.triangles) * 3, mesh.indices);
  if (header.has(kHasMaterials)) get_numbers(reader, header.triangles, mesh.materials);
  return mesh;
}

// ---- quantised

Result<std::vector<std::byte>> quantized_payload(const QuantizedMesh& mesh, GeometryCodec codec) {
  ByteWriter writer;
  for (const int64_t base : mesh.position_base) writer.put(base);
  for (const int64_t base : mesh.texcoord_base) writer.put(base);
  for (const MaterialRun& run : mesh.runs) {
    writer.put(run.material);
    writer.put(run.triangles);
  }
  if (codec == GeometryCodec::meshopt) {
    writer.put_bytes(encode_meshopt(mesh));
    return writer.take();
  }
  const Result<std::vector<std::byte>> bytes = encode_draco(mesh);
  if (!bytes) return bytes.error();
  writer.put_bytes(*bytes);
  return writer.take();
}

Status get_runs(ByteReader& reader, const Header& header, QuantizedMesh& mesh) {
  constexpr size_t kRunBytes = 8;
  if (header.runs > reader.remaining() / kRunBytes)
    return Error{fmt::format("mesh: {} materials in {} bytes", header.runs, reader.remaining())};
  uint64_t triangles = 0;
  for (uint32_t r = 0; r < header.runs; ++r) {
    const auto material = reader.get<uint32_t>();
    mesh.runs.push_back({material, reader.get<uint32_t>()});
    triangles += mesh.runs.back().triangles;
  }
  if (triangles != header.triangles)
    return Error{fmt::format("mesh: materials of {} triangles, there are {}", triangles, header.triangles)};
  return Done{};
}

/// A quantised mesh but for its arrays, bases and runs.
QuantizedMesh empty_mesh(const Header& header) {
  QuantizedMesh mesh;
  mesh.on_grid = header.has(kOnGrid);
  mesh.has_materials = header.has(kHasMaterials);
  mesh.position_exponent = header.position_exponent;
  mesh.fine_bits = header.fine_bits;
  mesh.texcoord_exponent = header.texcoord_exponent;
  mesh.by_kinds = header.has(kByKinds);
  return mesh;
}

Result<Mesh> mesh_of_quantized(const Header& header, std::span<const std::byte> payload) {
  ByteReader reader(payload);
  QuantizedMesh mesh = empty_mesh(header);
  for (int64_t& base : mesh.position_base) base = reader.get<int64_t>();
  for (int64_t& base : mesh.texcoord_base) base = reader.get<int64_t>();
  for (const int64_t base : {mesh.position_base[0], mesh.position_base[1], mesh.position_base[2], mesh.texcoord_base[0],
                             mesh.texcoord_base[1]})
    if (base > kFarthestBase || base < -kFarthestBase) return Error{fmt::format("mesh: base {} is too far out", base)};
  PROMENADE_TRY(get_runs(reader, header, mesh));
  if (!reader.ok()) return Error{fmt::format("mesh: payload of {} bytes ends too soon", payload.size())};
  const std::span<const std::byte> rest = reader.get_bytes(reader.remaining());
  const bool normals = header.has(kHasNormals), texcoords = header.has(kHasTexcoords), colors = header.has(kHasColors);
  if (header.codec == GeometryCodec::meshopt)
    PROMENADE_TRY(decode_meshopt(rest, header.vertices, header.triangles, normals, texcoords, colors, mesh));
  else
    PROMENADE_TRY(decode_draco(rest, header.triangles, normals, texcoords, colors, mesh));
  if (mesh.positions.size() != header.vertices || mesh.indices.size() != size_t(header.triangles) * 3)
    return Error{fmt::format("mesh: decodes to {} vertices and {} indices, its header has {} and {} triangles",
                             mesh.positions.size(), mesh.indices.size(), header.vertices, header.triangles)};
  return dequantize(mesh);
}

Result<Mesh> checked(Result<Mesh> mesh) {
  if (!mesh) return mesh;
  if (const std::string defect = find_defect(*mesh); !defect.empty()) return Error{"mesh: " + defect};
  return mesh;
}

Status check_options(const Mesh& mesh, const GeometryEncodeOptions& options) {
  if (const std::string defect = find_defect(mesh); !defect.empty()) return Error{"mesh: " + defect};
  if (mesh.vertex_count() > std::numeric_limits<int32_t>::max() ||
      mesh.indices.size() > std::numeric_limits<int32_t>::max())
    return Error{fmt::format("mesh: {} vertices and {} triangles are too many to code as one", mesh.vertex_count(),
                             mesh.triangle_count())};
  if (!options.position_step_m) return Done{};
  int exponent = 0;
  const float step_m = *options.position_step_m;
  if (!(step_m > 0) || std::frexp(step_m, &exponent) != 0.5F || std::abs(exponent - 1) > kMaxExponent)
    return Error{
        fmt::format("mesh: step of {} m is no power of two from 2^-{} to 2^{}", step_m, kMaxExponent, kMaxExponent)};
  return Done{};
}

EncodedMesh assembled(const Header& header, std::span<const std::byte> payload, int zstd_level) {
  ByteWriter writer;
  put_header(writer, header);
  writer.put_bytes(compress_frame(payload, zstd_level));
  EncodedMesh out;
  out.bytes = writer.take();
  out.vertices = header.vertices;
  out.triangles = header.triangles;
  return out;
}

// ---- grown

void put_signed(std::vector<std::byte>& bytes, int64_t value) {
  const uint64_t code = (static_cast<uint64_t>(value) << 1U) ^ (value < 0 ? ~uint64_t(0) : 0);
  put_varint(bytes, static_cast<uint32_t>(code));
  put_varint(bytes, static_cast<uint32_t>(code >> 32U));
}

bool get_signed(VarintReader& reader, int64_t& value) {
  uint32_t low = 0, high = 0;
  if (!reader.get(low) || !reader.get(high)) return false;
  const uint64_t code = uint64_t(high) << 32U | low;
  value = static_cast<int64_t>((code >> 1U) ^ (0 - (code & 1U)));
  return value <= kFarthestBase && value >= -kFarthestBase;
}

EncodedMesh assembled_grown(Header header, const QuantizedMesh& mesh) {
  const GrownMesh grown = encode_grown(mesh);
  header.vertices = grown.vertices;
  ByteWriter writer;
  put_header(writer, header);
  std::vector<std::byte> bytes = writer.take();
  if (mesh.on_grid)
    for (const int64_t base : mesh.position_base) put_signed(bytes, base);
  if (header.has(kHasTexcoords))
    for (const int64_t base : mesh.texcoord_base) put_signed(bytes, base);
  for (const MaterialRun& run : mesh.runs) put_varint(bytes, run.material), put_varint(bytes, run.triangles);
  bytes.insert(bytes.end(), grown.bytes.begin(), grown.bytes.end());
  return {std::move(bytes), 0, header.vertices, header.triangles};
}

Result<Mesh> mesh_of_grown(const Header& header, std::span<const std::byte> payload) {
  if (header.vertices > uint64_t(header.triangles) * 3)
    return Error{fmt::format("mesh: {} vertices for {} triangles", header.vertices, header.triangles)};
  VarintReader reader(payload);
  QuantizedMesh mesh = empty_mesh(header);
  if (mesh.on_grid)
    for (int64_t& base : mesh.position_base)
      if (!get_signed(reader, base)) return Error{"mesh: the base of its positions is none"};
  if (header.has(kHasTexcoords))
    for (int64_t& base : mesh.texcoord_base)
      if (!get_signed(reader, base)) return Error{"mesh: the base of its texture coordinates is none"};
  uint64_t triangles = 0;
  for (uint32_t r = 0; r < header.runs; ++r) {
    MaterialRun run;
    if (!reader.get(run.material) || !reader.get(run.triangles))
      return Error{fmt::format("mesh: material {} of {} is none", r, header.runs)};
    mesh.runs.push_back(run), triangles += run.triangles;
  }
  if (triangles != header.triangles)
    return Error{fmt::format("mesh: materials of {} triangles, there are {}", triangles, header.triangles)};
  PROMENADE_TRY(decode_grown(payload.subspan(reader.offset()), header.vertices, header.triangles,
                             header.has(kHasNormals), header.has(kHasTexcoords), header.has(kHasColors), mesh));
  return dequantize(mesh);
}

}  // namespace

std::string_view name_of(GeometryCodec codec) { return kNames[static_cast<size_t>(codec)]; }

std::optional<GeometryCodec> geometry_codec_named(std::string_view name) {
  for (size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<GeometryCodec>(i);
  return std::nullopt;
}

Result<EncodedMesh> encode_mesh(const Mesh& mesh, const GeometryEncodeOptions& options) {
  PROMENADE_TRY(check_options(mesh, options));
  Header header = header_for(mesh, options);
  EncodedMesh out;
  if (options.codec == GeometryCodec::raw) {
    out = assembled(header, raw_payload(mesh, options.position_step_m), options.zstd_level);
  } else {
    const bool draco = options.codec == GeometryCodec::draco;
    const int fine_bits = fine_bits_of(options);
    const Result<QuantizedMesh> quantized =
        quantize(mesh, options.position_step_m, fine_bits, draco ? kDracoTexcoordSteps : kTexcoordSteps);
    if (!quantized) return quantized.error();
    header.position_exponent = quantized->position_exponent;
    header.texcoord_exponent = quantized->texcoord_exponent;
    header.fine_bits = quantized->fine_bits;
    if (fine_bits > 0) header.flags |= kFine;
    header.vertices = static_cast<uint32_t>(quantized->positions.size());
    header.triangles = static_cast<uint32_t>(quantized->indices.size() / 3);
    header.runs = static_cast<uint32_t>(quantized->runs.size());
    if (options.codec == GeometryCodec::grown) {
      out = assembled_grown(header, *quantized);
    } else {
      const Result<std::vector<std::byte>> payload = quantized_payload(*quantized, options.codec);
      if (!payload) return payload.error();
      out = assembled(header, *payload, options.zstd_level);
    }
  }
  if (options.position_step_m)
    out.position_error_m =
        bound_m(rounding_error_m(mesh, std::ldexp(*options.position_step_m, -fine_bits_of(options))));
  return out;
}

float position_step_m(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  const Result<Header> header = get_header(reader, std::numeric_limits<uint64_t>::max());
  if (!header || !header->has(kOnGrid) || header->codec == GeometryCodec::raw) return 0;
  return std::ldexp(1.0F, header->position_exponent);
}

float fine_step_m(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  const Result<Header> header = get_header(reader, std::numeric_limits<uint64_t>::max());
  if (!header || header->fine_bits == 0 || header->codec == GeometryCodec::raw) return 0;
  return std::ldexp(1.0F, header->position_exponent - header->fine_bits);
}

Result<Mesh> decode_mesh(std::span<const std::byte> bytes, uint64_t max_bytes) {
  ByteReader reader(bytes);
  const Result<Header> header = get_header(reader, max_bytes);
  if (!header) return header.error();
  if (header->codec == GeometryCodec::grown) return checked(mesh_of_grown(*header, bytes.subspan(kHeaderBytes)));
  // What is decompressed lies beside the mesh that is decoded from it.
  const Result<std::vector<std::byte>> payload =
      decompress_frame(bytes.subspan(kHeaderBytes), max_bytes - header->mesh_bytes());
  if (!payload) return Error{"mesh: " + payload.error().message};
  return checked(header->codec == GeometryCodec::raw ? mesh_of_raw(*header, *payload)
                                                     : mesh_of_quantized(*header, *payload));
}

}  // namespace promenade
