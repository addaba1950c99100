// Source: Khronos, glTF 2.0 specification, sections 3 (concepts) and 4 (the binary container).

#include "datasets/glb_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "datasets/glb_spool.h"
#include "layout/file_io.h"

namespace promenade {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

constexpr uint32_t kMagic = 0x46546c67;      // "glTF"
constexpr uint32_t kJsonChunk = 0x4e4f534a;  // "JSON"
constexpr uint32_t kBinChunk = 0x004e4942;   // "BIN"
constexpr uint64_t kMaxFileBytes = 0xffffffff;
// 65535 would restart the primitive, so that a mesh with 16-bit indices has at most so many vertices.
constexpr size_t kMaxVerticesOf16Bits = 65535;

enum Component : uint32_t { unsigned_short = 5123, unsigned_int = 5125, float_32 = 5126 };
enum Target : uint32_t { none = 0, vertices = 34962, indices = 34963 };

std::string json_text(std::string_view text) {
  return nlohmann::json(std::string(text)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

glm::vec3 y_up(const glm::vec3& v) { return {v.x, v.z, -v.y}; }

glm::dmat4 y_up(const glm::dmat4& m) {
  // Columns are vectors in the z-up frame; the change of frame is a rotation, its inverse its transpose.
  const glm::dmat4 turn(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);
  return turn * m * glm::transpose(turn);
}

const std::array<uint16_t, 256>& linear_of_srgb() {
  // 16 bits, so that every sRGB byte comes back exactly.
  static const std::array<uint16_t, 256> table = [] {
    std::array<uint16_t, 256> values{};
    for (size_t i = 0; i < 256; ++i)
      values[i] = static_cast<uint16_t>(std::lround(srgb_to_linear(static_cast<uint8_t>(i)) * 65535.0F));
    return values;
  }();
  return table;
}

std::array<uint16_t, 4> linear_color(const glm::u8vec4& c) {
  const std::array<uint16_t, 256>& table = linear_of_srgb();
  return {table[c.r], table[c.g], table[c.b], static_cast<uint16_t>(c.a * 257)};
}

uint32_t wrap_code(Wrap wrap) { return wrap == Wrap::repeat ? 10497 : wrap == Wrap::mirror ? 33648 : 33071; }

/// A JSON array that grows by one text after another.
struct JsonArray {
  std::string text;
  uint32_t count = 0;
  uint32_t add(std::string_view item) {
    if (count > 0) text += ",\n";
    text += item;
    return count++;
  }
};

}  // namespace

struct GlbWriter::State {
  std::filesystem::path path;
  std::string generator;
  GlbSpool spool;
  JsonArray views, accessors, meshes, nodes, materials, images, textures, samplers, animations;
  std::vector<bool> textured;                                    ///< by material
  std::map<std::pair<Wrap, Wrap>, uint32_t> sampler_of;          ///< by wrap
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> texture_of;  ///< by image, sampler

  Result<uint32_t> add_view(std::span<const std::byte> bytes, Target target);
  Result<uint32_t> add_accessor(std::span<const std::byte> bytes, Target target, Component component, size_t count,
                                std::string_view type, std::string_view more = {});
  Result<uint32_t> add_indices(const Mesh& mesh);
  Result<std::string> add_attributes(const Mesh& mesh, bool with_texcoords);
  Result<std::string> add_primitive(const Mesh& mesh, uint32_t material);
  std::string json() const;
};

Result<uint32_t> GlbWriter::State::add_view(std::span<const std::byte> bytes, Target target) {
  constexpr std::array<std::byte, 3> kZeros{};
  const uint64_t offset = spool.size();
  PROMENADE_TRY(spool.write(bytes));
  PROMENADE_TRY(spool.write(std::span(kZeros).first((4 - bytes.size() % 4) % 4)));
  if (spool.size() > kMaxFileBytes)
    return Error{fmt::format("{}: more than 4 GiB, the most that a .glb file holds: write tiles", path.string())};
  std::string item = fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{})", offset, bytes.size());
  if (target != Target::none) item += fmt::format(R"(,"target":{})", static_cast<uint32_t>(target));
  return views.add(item + "}");
}

Result<uint32_t> GlbWriter::State::add_accessor(std::span<const std::byte> bytes, Target target, Component component,
                                                size_t count, std::string_view type, std::string_view more) {
  const Result<uint32_t> view = add_view(bytes, target);
  if (!view) return view.error();
  return accessors.add(fmt::format(R"({{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}})", *view,
                                   static_cast<uint32_t>(component), count, type, more));
}

Result<uint32_t> GlbWriter::State::add_indices(const Mesh& mesh) {
  const size_t count = mesh.indices.size();
  if (mesh.vertex_count() > kMaxVerticesOf16Bits)
    return add_accessor(std::as_bytes(std::span(mesh.indices)), Target::indices, Component::unsigned_int, count,
                        "SCALAR");
  std::vector<uint16_t> narrow(count);
  std::transform(mesh.indices.begin(), mesh.indices.end(), narrow.begin(),
                 [](uint32_t i) { return static_cast<uint16_t>(i); });
  return add_accessor(std::as_bytes(std::span(narrow)), Target::indices, Component::unsigned_short, count, "SCALAR");
}

Result<std::string> GlbWriter::State::add_attributes(const Mesh& mesh, bool with_texcoords) {
  const size_t count = mesh.vertex_count();
  std::vector<glm::vec3> turned(count);
  const auto turn = [&](const std::vector<glm::vec3>& from) {
    std::transform(from.begin(), from.end(), turned.begin(), [](const glm::vec3& v) { return y_up(v); });
    return std::as_bytes(std::span(turned));
  };
  const auto bytes = turn(mesh.positions);
  Box box;
  for (const glm::vec3& p : turned) box.add(p);
  const Result<uint32_t> positions = add_accessor(bytes, Target::vertices, Component::float_32, count, "VEC3",
                                                  fmt::format(R"(,"min":[{},{},{}],"max":[{},{},{}])", box.min.x,
                                                              box.min.y, box.min.z, box.max.x, box.max.y, box.max.z));
  if (!positions) return positions.error();
  std::string text = fmt::format(R"("POSITION":{})", *positions);
  if (!mesh.normals.empty()) {
    const Result<uint32_t> a = add_accessor(turn(mesh.normals), Target::vertices, Component::float_32, count, "VEC3");
    if (!a) return a.error();
    text += fmt::format(R"(,"NORMAL":{})", *a);
  }
  if (!mesh.texcoords.empty() && with_texcoords) {
    const Result<uint32_t> a =
        add_accessor(std::as_bytes(std::span(mesh.texcoords)), Target::vertices, Component::float_32, count, "VEC2");
    if (!a) return a.error();
    text += fmt::format(R"(,"TEXCOORD_0":{})", *a);
  }
  if (!mesh.colors.empty()) {
    std::vector<std::array<uint16_t, 4>> linear(count);
    std::transform(mesh.colors.begin(), mesh.colors.end(), linear.begin(), linear_color);
    const Result<uint32_t> a = add_accessor(std::as_bytes(std::span(linear)), Target::vertices,
                                            Component::unsigned_short, count, "VEC4", R"(,"normalized":true)");
    if (!a) return a.error();
    text += fmt::format(R"(,"COLOR_0":{})", *a);
  }
  return text;
}

Result<std::string> GlbWriter::State::add_primitive(const Mesh& mesh, uint32_t material) {
  const bool known = material < materials.count;
  Result<std::string> attributes = add_attributes(mesh, known && textured[material]);
  if (!attributes) return attributes;
  const Result<uint32_t> index = add_indices(mesh);
  if (!index) return index.error();
  std::string text = fmt::format(R"({{"attributes":{{{}}},"indices":{})", *attributes, *index);
  if (known) text += fmt::format(R"(,"material":{})", material);
  return text + "}";
}

std::string GlbWriter::State::json() const {
  std::string text =
      fmt::format(R"({{"asset":{{"version":"2.0","generator":{}}},"scene":0,"scenes":[{{)", json_text(generator));
  if (nodes.count > 0) {
    text += R"("nodes":[)";
    for (uint32_t i = 0; i < nodes.count; ++i) text += fmt::format("{}{}", i > 0 ? "," : "", i);
    text += "]";
  }
  text += "}]";
  const auto add = [&](const char* name, const JsonArray& array) {
    if (array.count > 0) text += fmt::format(",\n\"{}\":[{}]", name, array.text);
  };
  add("nodes", nodes), add("meshes", meshes), add("materials", materials), add("textures", textures);
  add("samplers", samplers), add("images", images), add("animations", animations), add("accessors", accessors),
      add("bufferViews", views);
  if (spool.size() > 0) text += fmt::format(",\n\"buffers\":[{{\"byteLength\":{}}}]", spool.size());
  text += "}";
  text.resize((text.size() + 3) / 4 * 4, ' ');
  return text;
}

GlbWriter::GlbWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
GlbWriter::GlbWriter(GlbWriter&&) noexcept = default;
GlbWriter& GlbWriter::operator=(GlbWriter&&) noexcept = default;
GlbWriter::~GlbWriter() = default;

Result<GlbWriter> GlbWriter::create(const std::filesystem::path& path, std::string_view generator) {
  Result<GlbSpool> spool = GlbSpool::create(path);
  if (!spool) return spool.error();
  auto state = std::unique_ptr<State>(
      new State{path, std::string(generator), std::move(*spool), {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}});
  return GlbWriter(std::move(state));
}

Result<uint32_t> GlbWriter::add_texture(std::string_view name, std::string_view mime,
                                        std::span<const std::byte> encoded) {
  if (mime != "image/png" && mime != "image/jpeg")
    return Error{
        fmt::format("{}: texture {}: glTF knows image/png and image/jpeg, not {}", state_->path.string(), name, mime)};
  if (encoded.empty()) return Error{fmt::format("{}: texture {} is empty", state_->path.string(), name)};
  const Result<uint32_t> view = state_->add_view(encoded, Target::none);
  if (!view) return view.error();
  return state_->images.add(
      fmt::format(R"({{"name":{},"mimeType":"{}","bufferView":{}}})", json_text(name), mime, *view));
}

uint32_t GlbWriter::add_material(std::string_view name, const Material& material) {
  State& s = *state_;
  std::string base = fmt::format(R"("metallicFactor":0,"roughnessFactor":1,"baseColorFactor":[{},{},{},{}])",
                                 srgb_to_linear(material.color.r), srgb_to_linear(material.color.g),
                                 srgb_to_linear(material.color.b), static_cast<float>(material.color.a) / 255.0F);
  const bool textured = material.texture < s.images.count;
  if (textured) {
    const auto [sampler, new_sampler] = s.sampler_of.try_emplace({material.wrap_u, material.wrap_v}, s.samplers.count);
    if (new_sampler)
      s.samplers.add(fmt::format(R"({{"magFilter":9729,"minFilter":9987,"wrapS":{},"wrapT":{}}})",
                                 wrap_code(material.wrap_u), wrap_code(material.wrap_v)));
    const auto [texture, new_texture] = s.texture_of.try_emplace({material.texture, sampler->second}, s.textures.count);
    if (new_texture) s.textures.add(fmt::format(R"({{"sampler":{},"source":{}}})", sampler->second, material.texture));
    base += fmt::format(R"(,"baseColorTexture":{{"index":{}}})", texture->second);
  }
  std::string item = fmt::format(R"({{"name":{},"pbrMetallicRoughness":{{{}}})", json_text(name), base);
  if (material.alpha == AlphaMode::blend) item += R"(,"alphaMode":"BLEND")";
  if (material.alpha == AlphaMode::mask)
    item += fmt::format(R"(,"alphaMode":"MASK","alphaCutoff":{})", static_cast<float>(material.alpha_cutoff) / 255.0F);
  if (material.two_sided) item += R"(,"doubleSided":true)";
  s.textured.push_back(textured);
  return s.materials.add(item + "}");
}

Result<uint32_t> GlbWriter::add_mesh(std::string_view name, const Mesh& mesh) {
  State& s = *state_;
  if (const std::string defect = find_defect(mesh); !defect.empty())
    return Error{fmt::format("{}: mesh {}: {}", s.path.string(), name, defect)};
  if (mesh.indices.empty()) return Error{fmt::format("{}: mesh {} has no triangles", s.path.string(), name)};
  std::map<uint32_t, std::vector<uint32_t>> triangles_of;
  for (size_t t = 0; t < mesh.materials.size(); ++t)
    triangles_of[mesh.materials[t]].push_back(static_cast<uint32_t>(t));
  if (triangles_of.empty()) triangles_of[0];
  const uint32_t last = triangles_of.rbegin()->first;
  if (last > 0 && last >= s.materials.count)
    return Error{fmt::format("{}: mesh {}: material {} of {}", s.path.string(), name, last, s.materials.count)};
  std::string primitives;
  for (const auto& [material, triangles] : triangles_of) {
    const Result<std::string> primitive = triangles_of.size() == 1
                                              ? s.add_primitive(mesh, material)
                                              : s.add_primitive(submesh(mesh, triangles), material);
    if (!primitive) return primitive.error();
    if (!primitives.empty()) primitives += ",";
    primitives += *primitive;
  }
  return s.meshes.add(fmt::format(R"({{"name":{},"primitives":[{}]}})", json_text(name), primitives));
}

void GlbWriter::add_node(std::string_view name, std::string_view class_name, uint32_t mesh,
                         const glm::dmat4& world_from_mesh) {
  std::string item =
      fmt::format(R"({{"name":{},"extras":{{"class":{}}},"mesh":{})", json_text(name), json_text(class_name), mesh);
  const glm::dmat4 m = y_up(world_from_mesh);
  if (glm::dmat3(m) != glm::dmat3(1)) {
    item += R"(,"matrix":[)";
    // Adding zero turns -0 into 0: shorter, and the same for every way of computing it.
    for (int i = 0; i < 16; ++i) item += fmt::format("{}{}", i > 0 ? "," : "", m[i / 4][i % 4] + 0.0);
    item += "]";
  } else if (glm::dvec3(m[3]) != glm::dvec3(0)) {
    item += fmt::format(R"(,"translation":[{},{},{}])", m[3].x + 0.0, m[3].y + 0.0, m[3].z + 0.0);
  }
  state_->nodes.add(item + "}");
}

Status GlbWriter::add_moving_node(std::string_view name, std::string_view class_name, uint32_t mesh,
                                  const NodeMotion& motion) {
  State& s = *state_;
  const size_t keys = motion.times_s.size();
  if (keys < 2 || motion.places.size() != keys || motion.yaws_rad.size() != keys)
    return Error{fmt::format("{}: node {}: a motion of {} times, {} places and {} turns", s.path.string(), name, keys,
                             motion.places.size(), motion.yaws_rad.size())};
  std::vector<glm::vec3> places;
  std::vector<std::array<float, 4>> turns;
  places.reserve(keys), turns.reserve(keys);
  for (const glm::vec3& place : motion.places) places.push_back(y_up(place));
  for (const float yaw : motion.yaws_rad) turns.push_back({0, std::sin(yaw / 2), 0, std::cos(yaw / 2)});
  const auto add = [&](const auto& values, std::string_view type, std::string_view more = {}) {
    return s.add_accessor(std::as_bytes(std::span(values)), Target::none, Component::float_32, keys, type, more);
  };
  const Result<uint32_t> times =
      add(motion.times_s, "SCALAR",
          fmt::format(R"(,"min":[{}],"max":[{}])", motion.times_s.front(), motion.times_s.back()));
  if (!times) return times.error();
  const Result<uint32_t> translations = add(places, "VEC3"), rotations = add(turns, "VEC4");
  if (!translations) return translations.error();
  if (!rotations) return rotations.error();
  const uint32_t node = s.nodes.add(fmt::format(
      R"({{"name":{},"extras":{{"class":{}}},"mesh":{},"translation":[{},{},{}],"rotation":[{},{},{},{}]}})",
      json_text(name), json_text(class_name), mesh, places[0].x, places[0].y, places[0].z, turns[0][0], turns[0][1],
      turns[0][2], turns[0][3]));
  s.animations.add(
      fmt::format(R"({{"name":{0},"samplers":[{{"input":{1},"output":{2}}},{{"input":{1},"output":{3}}}],"channels":[)"
                  R"({{"sampler":0,"target":{{"node":{4},"path":"translation"}}}},{{"sampler":1,"target":{{"node":{4},)"
                  R"("path":"rotation"}}}}]}})",
                  json_text(name), *times, *translations, *rotations, node));
  return Done{};
}

Status GlbWriter::finish() {
  State& s = *state_;
  const std::string json = s.json();
  const uint64_t bin_bytes = s.spool.size();
  const uint64_t total = 12 + 8 + json.size() + (bin_bytes > 0 ? 8 + bin_bytes : 0);
  if (total > kMaxFileBytes)
    return Error{
        fmt::format("{}: {} bytes, more than the 4 GiB that a .glb file holds: write tiles", s.path.string(), total)};
  Result<AtomicFile> file = AtomicFile::create(s.path);
  if (!file) return file.error();
  const auto words = [&](std::initializer_list<uint32_t> values) {
    return file->write(std::as_bytes(std::span(values.begin(), values.size())));
  };
  PROMENADE_TRY(words({kMagic, 2, static_cast<uint32_t>(total), static_cast<uint32_t>(json.size()), kJsonChunk}));
  PROMENADE_TRY(file->write(std::as_bytes(std::span(json))));
  if (bin_bytes > 0) {
    PROMENADE_TRY(words({static_cast<uint32_t>(bin_bytes), kBinChunk}));
    PROMENADE_TRY(s.spool.read_back([&](std::span<const std::byte> piece) { return file->write(piece); }));
  }
  return file->commit();
}

}  // namespace promenade
