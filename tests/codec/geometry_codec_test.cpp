#include "codec/geometry_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <tuple>

#include "codec/byte_io.h"
#include "codec/frame.h"
#include "codec/quantized_mesh.h"
#include "tests/codec/mesh_fixtures.h"
#include "tests/golden.h"

namespace promenade {
namespace {

using testing::HasSubstr;

constexpr std::array kCodecs = {GeometryCodec::raw, GeometryCodec::meshopt, GeometryCodec::draco, GeometryCodec::grown};
constexpr std::array kQuantizing = {GeometryCodec::meshopt, GeometryCodec::draco, GeometryCodec::grown};
constexpr std::array kWithFineGrid = {GeometryCodec::meshopt, GeometryCodec::grown};

/// One triangle with all that is known of it, its smallest corner first.
using Corner = std::array<float, 12>;
using Triangle = std::pair<uint32_t, std::array<Corner, 3>>;

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    Triangle triangle{mesh.material_of(t), {}};
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t v = mesh.indices[3 * t + c];
      Corner& corner = triangle.second[c];
      const auto set = [&corner](size_t at, const auto& value) {
        for (int i = 0; i < value.length(); ++i) corner[at + static_cast<size_t>(i)] = float(value[i]);
      };
      set(0, mesh.positions[v]);
      if (!mesh.normals.empty()) set(3, mesh.normals[v]);
      if (!mesh.texcoords.empty()) set(6, mesh.texcoords[v]);
      if (!mesh.colors.empty()) set(8, mesh.colors[v]);
    }
    std::rotate(triangle.second.begin(), std::min_element(triangle.second.begin(), triangle.second.end()),
                triangle.second.end());
    triangles.push_back(triangle);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

/// What the quantised codecs promise to return.
Mesh rounded(Mesh mesh, std::optional<float> step_m) {
  if (step_m)
    for (glm::vec3& p : mesh.positions) p = snapped(p, *step_m);
  for (glm::vec3& n : mesh.normals) n = normal_of_octahedral(octahedral_of_normal(n));
  for (glm::vec2& t : mesh.texcoords) t = glm::round(t * 32768.0F) / 32768.0F;
  return mesh;
}

EncodedMesh encoded(const Mesh& mesh, GeometryCodec codec, std::optional<float> step_m = std::nullopt) {
  Result<EncodedMesh> out = encode_mesh(mesh, {codec, step_m, 9});
  EXPECT_TRUE(out) << (out ? "" : out.error().message);
  return out ? *out : EncodedMesh{};
}

TEST(GeometryCodec, has_a_name_for_each) {
  for (const GeometryCodec codec : kCodecs) EXPECT_EQ(geometry_codec_named(name_of(codec)), codec);
  EXPECT_FALSE(geometry_codec_named("zip"));
}

TEST(GeometryCodec, returns_every_triangle_with_its_attributes_and_material) {
  for (const auto& [name, mesh] : mesh_fixtures())
    for (const GeometryCodec codec : kCodecs)
      for (const std::optional<float> step_m : {std::optional<float>(), std::optional(0.0625F)}) {
        const EncodedMesh out = encoded(mesh, codec, step_m);
        const Result<Mesh> back = decode_mesh(out.bytes);
        ASSERT_TRUE(back) << name << " " << name_of(codec) << ": " << back.error().message;
        EXPECT_EQ(back->vertex_count(), out.vertices);
        EXPECT_EQ(back->triangle_count(), out.triangles);
        Mesh expected = mesh;
        if (codec != GeometryCodec::raw)
          expected = rounded(mesh, step_m);
        else if (step_m)
          for (glm::vec3& p : expected.positions) p = snapped(p, *step_m);
        EXPECT_EQ(triangles_of(*back), triangles_of(expected)) << name << " " << name_of(codec);
        EXPECT_EQ(back->materials.empty(), mesh.materials.empty());
        EXPECT_EQ(back->colors.empty(), mesh.colors.empty());
      }
}

TEST(GeometryCodec, keeps_every_colour_of_few_and_of_many) {
  for (const uint32_t side : {4U, 24U}) {  // one byte a colour, and two
    Mesh mesh = hills(side);
    std::mt19937 random(7);
    mesh.colors.resize(mesh.vertex_count());
    for (glm::u8vec4& c : mesh.colors) {
      const auto bits = static_cast<uint32_t>(random());
      c = {bits & 0xffU, (bits >> 8U) & 0xffU, (bits >> 16U) & 0xffU, bits >> 24U};
    }
    for (const GeometryCodec codec : kQuantizing) {
      const Result<Mesh> back = decode_mesh(encoded(mesh, codec, 1.0F / 512).bytes);
      ASSERT_TRUE(back) << back.error().message;
      EXPECT_EQ(triangles_of(*back), triangles_of(rounded(mesh, 1.0F / 512))) << name_of(codec);
    }
  }
}

/// Every third vertex on a grid 16 times as fine as the others'.
Mesh on_two_grids(Mesh mesh, float step_m) {
  for (size_t v = 0; v < mesh.vertex_count(); ++v)
    mesh.positions[v] = snapped(mesh.positions[v], v % 3 == 0 ? step_m / 16 : step_m);
  return mesh;
}

TEST(GeometryCodec, keeps_what_lies_on_a_finer_grid) {
  constexpr float kStepM = 0.0625F;
  for (const GeometryCodec codec : kWithFineGrid)
    for (const auto& [name, mesh] : mesh_fixtures()) {
      const Mesh apart = on_two_grids(mesh, kStepM);
      const Result<EncodedMesh> out = encode_mesh(apart, {codec, kStepM, 9, kStepM / 16});
      ASSERT_TRUE(out) << name << ": " << out.error().message;
      EXPECT_EQ(out->position_error_m, 0);
      EXPECT_EQ(position_step_m(out->bytes), kStepM);
      EXPECT_EQ(fine_step_m(out->bytes), kStepM / 16);
      const Result<Mesh> back = decode_mesh(out->bytes);
      ASSERT_TRUE(back) << name << ": " << back.error().message;
      EXPECT_EQ(triangles_of(*back), triangles_of(rounded(apart, kStepM / 16))) << name << " " << name_of(codec);
      for (size_t n = 0; n < out->bytes.size(); n += out->bytes.size() / 50 + 1)
        EXPECT_FALSE(decode_mesh(std::span(out->bytes).first(n))) << name << " " << n;
    }
  for (const GeometryCodec codec : kWithFineGrid) EXPECT_EQ(fine_step_m(encoded(hills(4), codec, kStepM).bytes), 0);
}

TEST(GeometryCodec, a_finer_grid_is_at_most_256_times_as_fine_and_not_of_raw_or_draco) {
  const Mesh mesh = hills(24);
  for (const GeometryCodec codec : kWithFineGrid) {
    const Result<EncodedMesh> finest = encode_mesh(mesh, {codec, 1.0F, 9, 1.0F / 4096});
    ASSERT_TRUE(finest);
    EXPECT_EQ(fine_step_m(finest->bytes), 1.0F / 256);
    EXPECT_LT(finest->position_error_m, 1.0F / 256);
    EXPECT_EQ(triangles_of(*decode_mesh(finest->bytes)), triangles_of(rounded(mesh, 1.0F / 256)));
  }
  for (const GeometryCodec codec : {GeometryCodec::raw, GeometryCodec::draco})
    EXPECT_EQ(encode_mesh(mesh, {codec, 1.0F, 9, 1.0F / 16})->bytes, encoded(mesh, codec, 1.0F).bytes);
}

TEST(GeometryCodec, keeps_raw_arrays_exactly_as_they_are) {
  const Mesh mesh = textured_cube();
  const Result<Mesh> back = decode_mesh(encoded(mesh, GeometryCodec::raw).bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->positions, mesh.positions);
  EXPECT_EQ(back->normals, mesh.normals);
  EXPECT_EQ(back->texcoords, mesh.texcoords);
  EXPECT_EQ(back->colors, mesh.colors);
  EXPECT_EQ(back->indices, mesh.indices);
  EXPECT_EQ(back->materials, mesh.materials);
}

TEST(GeometryCodec, gives_the_same_bytes_each_time) {
  for (const GeometryCodec codec : kCodecs)
    EXPECT_EQ(encoded(hills_of_many_materials(), codec, 0.001953125F).bytes,
              encoded(hills_of_many_materials(), codec, 0.001953125F).bytes);
}

TEST(GeometryCodec, reports_the_farthest_that_a_position_moved) {
  const Mesh mesh = hills(24);
  for (const GeometryCodec codec : kCodecs) {
    EXPECT_EQ(encoded(mesh, codec).position_error_m, 0);
    const float error_m = encoded(mesh, codec, 0.25F).position_error_m;
    double worst = 0;
    for (const glm::vec3& p : mesh.positions)
      worst = std::max(worst, glm::length(glm::dvec3(snapped(p, 0.25F)) - glm::dvec3(p)));
    EXPECT_GE(double(error_m), worst);
    EXPECT_NEAR(double(error_m), worst, 1e-6);
    EXPECT_LE(double(error_m), 0.125 * std::sqrt(3.0) + 1e-6);
  }
}

TEST(GeometryCodec, keeps_points_of_two_meshes_together_on_one_grid) {
  Mesh a = hills(8), b = hills(8);
  for (glm::vec3& p : b.positions) p.x += 50;  // b's left border is a's right border
  for (size_t i = 0; i < a.positions.size(); i += 9) b.positions[i] = a.positions[i + 8];
  for (const GeometryCodec codec : kCodecs) {
    const Result<Mesh> da = decode_mesh(encoded(a, codec, 0.0625F).bytes);
    const Result<Mesh> db = decode_mesh(encoded(b, codec, 0.0625F).bytes);
    ASSERT_TRUE(da && db);
    for (size_t i = 0; i < a.positions.size(); i += 9) {
      const glm::vec3 expected = snapped(b.positions[i], 0.0625F);
      EXPECT_EQ(std::count(da->positions.begin(), da->positions.end(), expected), 1);
      EXPECT_EQ(std::count(db->positions.begin(), db->positions.end(), expected), 1);
    }
  }
}

TEST(GeometryCodec, drops_triangles_that_rounding_collapses_and_unused_vertices) {
  Mesh mesh = one_triangle();
  mesh.positions.emplace_back(1.01F, 0, 0);  // rounds to vertex 1
  mesh.positions.emplace_back(9, 9, 9);      // used by nobody
  mesh.indices.insert(mesh.indices.end(), {1, 3, 2});
  for (const GeometryCodec codec : kQuantizing) {
    const Result<Mesh> back = decode_mesh(encoded(mesh, codec, 0.5F).bytes);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->triangle_count(), 1U);
    EXPECT_EQ(back->vertex_count(), 3U);
  }
}

TEST(GeometryCodec, returns_nothing_where_rounding_collapses_every_triangle) {
  for (const GeometryCodec codec : kQuantizing) {
    const EncodedMesh out = encoded(one_triangle(), codec, 1024.0F);
    EXPECT_EQ(out.triangles, 0U);
    const Result<Mesh> back = decode_mesh(out.bytes);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->vertex_count(), 0U);
  }
}

TEST(GeometryCodec, refuses_a_mesh_too_large_for_the_step) {
  Mesh mesh = one_triangle();
  mesh.positions[1].x = 1025;
  for (const GeometryCodec codec : kQuantizing) {
    EXPECT_TRUE(encode_mesh(mesh, {codec, std::ldexp(1.0F, -10), 9}));
    const auto refused = encode_mesh(mesh, {codec, std::ldexp(1.0F, -11), 9});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("choose a larger step"));
  }
  EXPECT_TRUE(encode_mesh(mesh, {GeometryCodec::raw, std::ldexp(1.0F, -11), 9}));
  mesh.positions[1].x = 3e38F;
  for (const GeometryCodec codec : kQuantizing) EXPECT_FALSE(encode_mesh(mesh, {codec, 1.0F, 9}));
}

TEST(GeometryCodec, refuses_steps_that_are_no_powers_of_two_and_meshes_with_defects) {
  for (const float step_m : {0.0F, -1.0F, 0.3F, std::nanf(""), 1e-30F, 1e30F})
    EXPECT_FALSE(encode_mesh(one_triangle(), {GeometryCodec::meshopt, step_m, 9})) << step_m;
  Mesh mesh = one_triangle();
  mesh.indices[1] = 3;
  EXPECT_THAT(encode_mesh(mesh, {}).error().message, HasSubstr("index 1 is 3"));
}

TEST(GeometryCodec, keeps_far_texture_coordinates_to_a_grid_as_fine_as_floats) {
  Mesh mesh = one_triangle();
  mesh.texcoords = {{0, 0}, {3000.37F, -2}, {1e7F, 5}};
  for (const GeometryCodec codec : kQuantizing) {
    const Result<Mesh> back = decode_mesh(encoded(mesh, codec).bytes);
    ASSERT_TRUE(back) << back.error().message;
    double worst = 0;
    const auto triangles = triangles_of(*back), expected = triangles_of(mesh);
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 6; i < 8; ++i)
        worst = std::max(worst, std::abs(double(triangles[0].second[c][i]) - double(expected[0].second[c][i])));
    EXPECT_LE(worst, codec == GeometryCodec::draco ? 1e7 / double(1 << 20) : 1e7 / double(1 << 28));
  }
}

TEST(OctahedralNormals, are_off_by_at_most_0_48_degrees) {
  std::mt19937 random(3);
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    glm::dvec3 n;
    for (int axis = 0; axis < 3; ++axis) n[axis] = double(random()) / 2147483648.0 - 1;
    if (glm::length(n) < 0.01) continue;
    const glm::dvec3 back(normal_of_octahedral(octahedral_of_normal(glm::normalize(n))));
    worst = std::max(worst, std::asin(std::min(1.0, glm::length(glm::cross(glm::normalize(n), back)))));
  }
  EXPECT_LT(worst * 180 / 3.14159265, 0.48);
}

TEST(OctahedralNormals, keep_axes_and_zero_exactly) {
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0F, -1.0F}) {
      glm::vec3 n(0);
      n[axis] = sign;
      EXPECT_EQ(normal_of_octahedral(octahedral_of_normal(n)), n);
    }
  EXPECT_EQ(normal_of_octahedral(octahedral_of_normal(glm::vec3(0))), glm::vec3(0));
}

// ---- bytes

TEST(DecodeMesh, reads_the_golden_bytes_of_version_3) {
  for (const auto& [codec, name, is_old] :
       {std::tuple(GeometryCodec::raw, "mesh_v3_raw.bin", false),
        std::tuple(GeometryCodec::draco, "mesh_v3_draco.bin", false),
        std::tuple(GeometryCodec::meshopt, "mesh_v3_meshopt_kinds.bin", false),
        std::tuple(GeometryCodec::grown, "mesh_v3_grown.bin", false),
        std::tuple(GeometryCodec::meshopt, "mesh_v3_meshopt.bin", true)}) {  // without flag 64: read, written no more
    if (!is_old) expect_golden(name, encoded(textured_cube(), codec, 0.0009765625F).bytes);
    const Result<Mesh> back = decode_mesh(golden_bytes(name));
    ASSERT_TRUE(back) << name << ": " << back.error().message;
    Mesh expected = textured_cube();
    for (glm::vec3& p : expected.positions) p = snapped(p, 0.0009765625F);
    if (codec != GeometryCodec::raw) expected = rounded(expected, std::nullopt);
    EXPECT_EQ(triangles_of(*back), triangles_of(expected));
  }
}

TEST(DecodeMesh, reads_the_golden_bytes_of_two_grids) {
  const Mesh mesh = on_two_grids(hills(4), 0.0625F);
  expect_golden("mesh_v3_meshopt_fine_kinds.bin",
                encode_mesh(mesh, {GeometryCodec::meshopt, 0.0625F, 9, 0.0625F / 16})->bytes);
  expect_golden("mesh_v3_grown_fine.bin", encode_mesh(mesh, {GeometryCodec::grown, 0.0625F, 9, 0.0625F / 16})->bytes);
  for (const char* name : {"mesh_v3_meshopt_fine_kinds.bin", "mesh_v3_meshopt_fine.bin", "mesh_v3_grown_fine.bin"}) {
    const Result<Mesh> back = decode_mesh(golden_bytes(name));
    ASSERT_TRUE(back) << name << ": " << back.error().message;
    EXPECT_EQ(triangles_of(*back), triangles_of(rounded(mesh, 0.0625F / 16))) << name;
  }
}

TEST(EncodeMesh, takes_the_bytes_that_were_committed) {
  std::string text = "# fixture codec bytes, on a grid of 1/512 m\n";
  for (const auto& [name, mesh] : mesh_fixtures())
    for (const GeometryCodec codec : kCodecs)
      text += name + " " + std::string(name_of(codec)) + " " +
              std::to_string(encoded(mesh, codec, 1.0F / 512).bytes.size()) + "\n";
  expect_golden("mesh_sizes.txt", std::string_view(text));
}

/// A second decoder of raw meshes, written from FORMAT.md, with no checks.
Mesh slow_raw_decoder(const std::vector<std::byte>& bytes) {
  const auto at = [](const std::vector<std::byte>& from, size_t offset, size_t size) {
    uint64_t value = 0;
    for (size_t i = size; i-- > 0;) value = value * 256 + std::to_integer<uint64_t>(from[offset + i]);
    return value;
  };
  const uint64_t flags = at(bytes, 6, 1), vertices = at(bytes, 8, 4), triangles = at(bytes, 12, 4);
  const std::vector<std::byte> payload = *decompress_frame(std::span(bytes).subspan(24), 1U << 24U);
  size_t offset = 0;
  const auto next_float = [&] {
    const auto bits = static_cast<uint32_t>(at(payload, offset, 4));
    offset += 4;
    float value = 0;
    std::memcpy(&value, &bits, 4);
    return value;
  };
  const auto next_vec3 = [&] {
    const float x = next_float(), y = next_float();
    return glm::vec3(x, y, next_float());
  };
  Mesh mesh;
  for (uint64_t v = 0; v < vertices; ++v) mesh.positions.push_back(next_vec3());
  for (uint64_t v = 0; v < vertices && (flags & 1U) != 0; ++v) mesh.normals.push_back(next_vec3());
  for (uint64_t v = 0; v < vertices && (flags & 2U) != 0; ++v) {
    const float u = next_float();
    mesh.texcoords.emplace_back(u, next_float());
  }
  for (uint64_t v = 0; v < vertices && (flags & 4U) != 0; ++v, offset += 4)
    mesh.colors.emplace_back(at(payload, offset, 1), at(payload, offset + 1, 1), at(payload, offset + 2, 1),
                             at(payload, offset + 3, 1));
  for (uint64_t i = 0; i < 3 * triangles; ++i, offset += 4)
    mesh.indices.push_back(static_cast<uint32_t>(at(payload, offset, 4)));
  for (uint64_t t = 0; t < triangles && (flags & 8U) != 0; ++t, offset += 4)
    mesh.materials.push_back(static_cast<uint32_t>(at(payload, offset, 4)));
  EXPECT_EQ(offset, payload.size());
  return mesh;
}

TEST(DecodeMesh, agrees_with_a_slow_decoder_written_from_the_format) {
  for (const auto& [name, mesh] : mesh_fixtures()) {
    const EncodedMesh out = encoded(mesh, GeometryCodec::raw);
    const Mesh slow = slow_raw_decoder(out.bytes);
    EXPECT_EQ(slow.positions, mesh.positions) << name;
    EXPECT_EQ(triangles_of(slow), triangles_of(*decode_mesh(out.bytes))) << name;
  }
}

TEST(EncodeMesh, writes_the_header_that_the_format_shows) {
  std::ifstream in(std::filesystem::path(PROMENADE_SOURCE_DIR) / "codec" / "FORMAT.md");
  std::string shown, actual;
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line == "```hex") inside = true;
    if (inside && line == "```") break;  // the file's first example
    const size_t colon = line.find(": ");
    if (inside && colon != std::string::npos) shown += line.substr(colon + 2, line.find("  #") - colon - 2) + " ";
  }
  const EncodedMesh out = encoded(one_triangle(), GeometryCodec::raw);
  for (size_t i = 0; i < 24; ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    actual += kDigits[std::to_integer<size_t>(out.bytes[i]) / 16];
    actual += kDigits[std::to_integer<size_t>(out.bytes[i]) % 16];
    actual += ' ';
  }
  EXPECT_EQ(shown, actual);
  EXPECT_EQ(decompress_frame(std::span(out.bytes).subspan(24), 1000)->size(), 48U);
}

TEST(DecodeMesh, rejects_every_truncation_and_a_trailing_byte) {
  for (const GeometryCodec codec : kCodecs) {
    std::vector<std::byte> bytes = encoded(textured_cube(), codec, 0.0009765625F).bytes;
    for (size_t n = 0; n < bytes.size(); ++n) EXPECT_FALSE(decode_mesh(std::span(bytes).first(n))) << n;
    bytes.push_back(std::byte{0});
    EXPECT_FALSE(decode_mesh(bytes));
  }
}

TEST(DecodeMesh, rejects_another_magic_version_codec_or_flag) {
  const std::vector<std::byte> sound = encoded(one_triangle(), GeometryCodec::meshopt).bytes;
  const auto message_with = [&sound](size_t at, int value) {
    std::vector<std::byte> bytes = sound;
    bytes[at] = static_cast<std::byte>(value);
    const Result<Mesh> mesh = decode_mesh(bytes);
    return mesh ? std::string("decoded") : mesh.error().message;
  };
  EXPECT_THAT(message_with(0, 'X'), HasSubstr("not 48534d50"));
  EXPECT_THAT(message_with(4, 2), HasSubstr("version 2, this program reads 3"));
  EXPECT_THAT(message_with(5, 4), HasSubstr("unknown codec 4"));
  EXPECT_THAT(message_with(6, 32), HasSubstr("unknown flags"));
  EXPECT_THAT(message_with(6, 128), HasSubstr("unknown flags"));
  std::vector<std::byte> raw = encoded(one_triangle(), GeometryCodec::raw).bytes;
  raw[6] = std::byte{64};  // kinds are meshopt's
  EXPECT_THAT(decode_mesh(raw).error().message, HasSubstr("unknown flags"));
  EXPECT_THAT(message_with(23, 1), HasSubstr("reserved bytes"));
}

TEST(DecodeMesh, rejects_counts_beyond_the_limit_before_allocating) {
  std::vector<std::byte> bytes = encoded(one_triangle(), GeometryCodec::raw).bytes;
  EXPECT_TRUE(decode_mesh(bytes, 1000));
  EXPECT_FALSE(decode_mesh(bytes, 90));
  for (size_t i = 8; i < 16; ++i) bytes[i] = std::byte{0xff};
  EXPECT_THAT(decode_mesh(bytes).error().message, HasSubstr("at most 1073741824 are allowed"));
  std::vector<std::byte> grown = encoded(one_triangle(), GeometryCodec::grown).bytes;
  grown[10] = std::byte{2};  // 131,075 vertices of a triangle
  EXPECT_THAT(decode_mesh(grown).error().message, HasSubstr("131075 vertices for 1 triangles"));
}

/// Packs a changed payload anew, so that changes reach the decoders behind the frame.
std::vector<std::byte> with_payload(const std::vector<std::byte>& mesh, std::span<const std::byte> payload,
                                    GeometryCodec codec = GeometryCodec::meshopt) {
  std::vector<std::byte> bytes(mesh.begin(), mesh.begin() + 24);
  std::vector<std::byte> packed(payload.begin(), payload.end());
  if (codec != GeometryCodec::grown) packed = compress_frame(payload, 1);
  bytes.insert(bytes.end(), packed.begin(), packed.end());
  return bytes;
}

/// What follows the header, unpacked where it is packed.
std::vector<std::byte> payload_of(const std::vector<std::byte>& mesh, GeometryCodec codec) {
  const auto rest = std::span(mesh).subspan(24);
  return codec == GeometryCodec::grown ? std::vector(rest.begin(), rest.end()) : *decompress_frame(rest, 1U << 24U);
}

/// Where the vertices' part of a meshopt payload begins: behind the bases, a run a material and the connectivity.
size_t vertices_offset(const std::vector<std::byte>& payload, size_t runs) {
  ByteReader reader(std::span<const std::byte>(payload).subspan(40 + 8 * runs));
  return 40 + 8 * runs + sizeof(uint32_t) + reader.get<uint32_t>();
}

TEST(DecodeMesh, rejects_kinds_that_are_none_and_vertices_like_those_that_are_not_there) {
  const auto message_with = [](const Mesh& mesh, size_t place, int kind) {
    const std::vector<std::byte> sound = encoded(mesh, GeometryCodec::meshopt, 0.5F).bytes;
    std::vector<std::byte> payload = *decompress_frame(std::span(sound).subspan(24), 1U << 24U);
    payload[vertices_offset(payload, 1) + 2 + mesh.vertex_count() + place] = static_cast<std::byte>(kind);
    const Result<Mesh> back = decode_mesh(with_payload(sound, payload));
    return back ? std::string("decoded") : back.error().message;
  };
  EXPECT_THAT(message_with(one_triangle(), 0, 125), HasSubstr("a position of kind 125"));
  EXPECT_THAT(message_with(one_triangle(), 0, 5), HasSubstr("vertex 0 is of kind 1, like none that is there"));
  EXPECT_THAT(message_with(one_triangle(), 2, 3), HasSubstr("vertex 2 is of kind 3, like none that is there"));
  Mesh flat = one_triangle();
  flat.positions = {{0, 0, 0}, {0, 0, 0.5F}, {0, 0.5F, 0}};  // two numbers are told, of two bytes each
  flat.normals.assign(3, glm::vec3(0));
  const size_t normals = 3 + 2 * 2;
  EXPECT_THAT(message_with(flat, normals, 7), HasSubstr("a normal of kind 7"));
  EXPECT_THAT(message_with(flat, normals, 3), HasSubstr("vertex 0 is of kind 3, like none that is there"));
  EXPECT_THAT(message_with(flat, normals, 2), HasSubstr("vertex 0 is of kind 2, like none that is there"));
  EXPECT_THAT(message_with(flat, normals, 6), HasSubstr("normals reach beyond the end"));
}

TEST(DecodeMesh, survives_random_changes_of_what_was_written_before_kinds) {
  std::mt19937 random(11);
  for (const char* name : {"mesh_v3_meshopt.bin", "mesh_v3_meshopt_fine.bin"}) {
    const std::vector<std::byte> sound = golden_bytes(name);
    const std::vector<std::byte> payload = *decompress_frame(std::span(sound).subspan(24), 1U << 24U);
    for (int round = 0; round < 300; ++round) {
      std::vector<std::byte> changed = payload;
      if (round % 5 == 0) changed.resize(random() % changed.size());
      for (int change = 0; change < 1 + round % 4 && !changed.empty(); ++change)
        changed[random() % changed.size()] = static_cast<std::byte>(random());
      const Result<Mesh> back = decode_mesh(with_payload(sound, changed), 1U << 22U);
      if (back) {
        EXPECT_EQ(find_defect(*back), "");
      }
    }
  }
}

TEST(DecodeMesh, survives_random_changes_of_header_and_payload) {
  std::mt19937 random(7);
  for (const GeometryCodec codec : kCodecs) {
    for (const auto& [mesh, fine_step_m] :
         {std::pair(textured_cube(), 0.0F), std::pair(hills(6), 0.0F), std::pair(hills(6), 0.0009765625F / 16),
          std::pair(hills_of_many_materials(), 0.0F)}) {
      const std::vector<std::byte> sound = encode_mesh(mesh, {codec, 0.0009765625F, 9, fine_step_m})->bytes;
      const std::vector<std::byte> payload = payload_of(sound, codec);
      for (int round = 0; round < 150; ++round) {
        std::vector<std::byte> changed = payload;
        if (round % 5 == 0) changed.resize(random() % changed.size());
        for (int change = 0; change < 1 + round % 4 && !changed.empty(); ++change)
          changed[random() % changed.size()] = static_cast<std::byte>(random());
        std::vector<std::byte> bytes = with_payload(sound, changed, codec);
        if (round % 3 == 0) bytes[random() % 24] = static_cast<std::byte>(random());
        const Result<Mesh> back = decode_mesh(bytes, 1U << 22U);
        if (back) {
          EXPECT_EQ(find_defect(*back), "");
        }
      }
    }
  }
}

}  // namespace
}  // namespace promenade
