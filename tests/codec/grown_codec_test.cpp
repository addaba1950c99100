#include "codec/grown_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <tuple>

#include "tests/codec/grown_slow_decoder.h"
#include "tests/codec/mesh_fixtures.h"

namespace promenade {
namespace {

/// A triangle with all that a quantised mesh knows of its corners, its smallest corner first.
using Corner = std::array<uint32_t, 8>;
using Triangle = std::pair<uint32_t, std::array<Corner, 3>>;

std::vector<Triangle> triangles_of(const QuantizedMesh& mesh) {
  std::vector<Triangle> triangles;
  size_t next = 0;
  for (const MaterialRun& run : mesh.runs)
    for (uint32_t t = 0; t < run.triangles; ++t) {
      Triangle triangle{run.material, {}};
      for (Corner& corner : triangle.second) {
        const uint32_t v = mesh.indices[next++];
        corner = {mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z};
        if (!mesh.normals.empty())
          corner[3] = static_cast<uint16_t>(mesh.normals[v].x), corner[4] = static_cast<uint16_t>(mesh.normals[v].y);
        if (!mesh.texcoords.empty()) corner[5] = mesh.texcoords[v].x, corner[6] = mesh.texcoords[v].y;
        if (!mesh.colors.empty())
          corner[7] = uint32_t(mesh.colors[v].r) << 24U | uint32_t(mesh.colors[v].g) << 16U |
                      uint32_t(mesh.colors[v].b) << 8U | mesh.colors[v].a;
      }
      std::rotate(triangle.second.begin(), std::min_element(triangle.second.begin(), triangle.second.end()),
                  triangle.second.end());
      triangles.push_back(triangle);
    }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

QuantizedMesh without_arrays(QuantizedMesh mesh) {
  mesh.positions.clear(), mesh.normals.clear(), mesh.texcoords.clear(), mesh.colors.clear(), mesh.indices.clear();
  return mesh;
}

Status decode(std::span<const std::byte> bytes, const QuantizedMesh& like, QuantizedMesh& out) {
  out = without_arrays(like);
  return decode_grown(bytes, like.positions.size(), like.indices.size() / 3, !like.normals.empty(),
                      !like.texcoords.empty(), !like.colors.empty(), out);
}

/// Tidies the mesh, codes it and expects it back, also from the decoder that was written from the format.
void expect_back(QuantizedMesh mesh, const std::string& name, const std::vector<uint32_t>& materials = {}) {
  std::vector<uint32_t> given = materials;
  given.resize(mesh.indices.size() / 3);
  tidy(mesh, given);
  const GrownMesh grown = encode_grown(mesh);
  EXPECT_EQ(grown.vertices, mesh.positions.size()) << name;
  QuantizedMesh back;
  const Status status = decode(grown.bytes, mesh, back);
  ASSERT_TRUE(status.ok()) << name << ": " << status.error().message;
  EXPECT_EQ(triangles_of(back), triangles_of(mesh)) << name;
  const SlowGrownDecoder slow(grown.bytes, without_arrays(mesh), !mesh.normals.empty(), !mesh.texcoords.empty(),
                              !mesh.colors.empty());
  EXPECT_TRUE(slow.is_at_end()) << name;
  EXPECT_EQ(triangles_of(slow.mesh()), triangles_of(mesh)) << name;
}

/// Triangles between few places, so that every edge has many and every place lies in many parts.
QuantizedMesh soup(uint32_t seed, uint32_t places, uint32_t triangles, uint32_t looks) {
  std::mt19937 random(seed);
  QuantizedMesh mesh;
  mesh.on_grid = true;
  std::vector<glm::u32vec3> at(places);
  for (glm::u32vec3& p : at) p = {random() % 90, random() % 9 * 1000, random() % 2097152};
  for (uint32_t i = 0; i < 3 * triangles; ++i) {
    mesh.positions.push_back(at[random() % places]);
    const auto look = static_cast<uint32_t>(random() % looks);
    mesh.normals.push_back(look == 0 ? kNoNormal : glm::i16vec2(look % 17, -int(look % 5)));
    mesh.texcoords.emplace_back(look * 77777, look % 3);
    mesh.colors.emplace_back(look % 250, look % 7, 9, 255);
    mesh.indices.push_back(i);
  }
  return mesh;
}

/// A closed ring of squares in two triangles each: growing meets itself.
QuantizedMesh torus(uint32_t around, uint32_t along) {
  QuantizedMesh mesh;
  mesh.on_grid = true;
  for (uint32_t i = 0; i < around; ++i)
    for (uint32_t j = 0; j < along; ++j) {
      const double a = 6.283185307 * i / around, b = 6.283185307 * j / along;
      mesh.positions.emplace_back(5000 + std::cos(a) * (3000 + 1000 * std::cos(b)),
                                  5000 + std::sin(a) * (3000 + 1000 * std::cos(b)), 2000 + 1000 * std::sin(b));
      const uint32_t i1 = (i + 1) % around, j1 = (j + 1) % along;
      const uint32_t p = i * along + j, q = i1 * along + j, r = i1 * along + j1, s = i * along + j1;
      for (const uint32_t v : {p, q, r, p, r, s}) mesh.indices.push_back(v);
    }
  return mesh;
}

TEST(GrownCodec, returns_triangles_between_few_places_whatever_their_edges) {
  for (uint32_t seed = 0; seed < 60; ++seed) {
    const uint32_t places = 3 + seed % 13, triangles = 1 + seed * 7 % 150;
    const QuantizedMesh mesh = soup(seed, places, triangles, 1 + seed % 40);
    expect_back(mesh, "soup " + std::to_string(seed));
    std::vector<uint32_t> materials;
    for (uint32_t t = 0; t < triangles; ++t) materials.push_back(t * seed % 5 * 1000000007);
    expect_back(mesh, "soup of materials " + std::to_string(seed), materials);
  }
}

TEST(GrownCodec, returns_closed_surfaces_and_those_with_either_winding) {
  for (const auto& [around, along] : {std::pair(3U, 3U), std::pair(8U, 3U), std::pair(40U, 17U)}) {
    QuantizedMesh mesh = torus(around, along);
    expect_back(mesh, "torus");
    for (size_t t = 0; t < mesh.indices.size(); t += 9) std::swap(mesh.indices[t], mesh.indices[t + 1]);
    expect_back(mesh, "torus with turned triangles");
  }
}

TEST(GrownCodec, returns_a_triangle_that_is_there_a_thousand_times_and_its_other_side) {
  QuantizedMesh mesh;
  mesh.on_grid = true;
  mesh.positions = {{0, 0, 0}, {7, 0, 0}, {0, 9, 1}};
  for (uint32_t i = 0; i < 1000; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2, 2, 1, 0});
  expect_back(mesh, "many alike");
}

TEST(GrownCodec, returns_a_place_of_a_thousand_vertices) {
  QuantizedMesh mesh;
  mesh.on_grid = true;
  for (uint32_t i = 0; i < 1000; ++i) {
    mesh.positions.emplace_back(0, 0, 0);
    mesh.positions.emplace_back(100 + i, 3 * i, 5);
    mesh.texcoords.emplace_back(i, i * i);
    mesh.texcoords.emplace_back(1, i);
    mesh.indices.insert(mesh.indices.end(), {2 * i, 2 * i + 1, (2 * i + 3) % 2000});
  }
  expect_back(mesh, "apex");
  std::mt19937 random(5);
  for (uint32_t i = 0; i < 1000; ++i)
    mesh.indices.insert(mesh.indices.end(),
                        {uint32_t(random() % 1000 * 2), uint32_t(random() % 1000 * 2 + 1), 1 + 2 * (i % 7)});
  expect_back(mesh, "apex met again");
}

TEST(GrownCodec, returns_bits_of_any_floats_and_numbers_of_32_bits) {
  std::mt19937 random(9);
  QuantizedMesh mesh;
  for (uint32_t i = 0; i < 300; ++i) {
    mesh.positions.emplace_back(random(), i % 2 == 0 ? 0U : 0xffffffffU, random() % 3 * 0x80000000U);
    mesh.normals.emplace_back(random() % 600, -int(random() % 600));
    mesh.texcoords.emplace_back(random(), 0x80000000U);
    mesh.indices.insert(mesh.indices.end(), {i, uint32_t(random() % 300), uint32_t(random() % 300)});
  }
  expect_back(mesh, "floats");
  mesh.on_grid = true;
  mesh.fine_bits = 8;
  expect_back(mesh, "grid");
}

TEST(GrownCodec, returns_meshes_as_they_are_quantised) {
  for (const auto& [name, mesh] : mesh_fixtures())
    for (const int fine_bits : {0, 4})
      expect_back(*quantize(mesh, 1.0F / 256, fine_bits, int64_t(1) << 28), name, mesh.materials);
}

TEST(GrownCodec, returns_no_triangles) {
  expect_back({}, "empty");
  QuantizedMesh unused;
  unused.positions = {{1, 2, 3}};
  expect_back(unused, "a vertex that none has");
}

TEST(GrownCodec, refuses_every_truncation_and_what_follows) {
  QuantizedMesh mesh = soup(3, 9, 60, 20);
  tidy(mesh, std::vector<uint32_t>(60));
  std::vector<std::byte> bytes = encode_grown(mesh).bytes;
  QuantizedMesh back;
  for (size_t n = 0; n < bytes.size(); ++n)
    EXPECT_FALSE(decode(std::span(bytes).first(n), mesh, back).ok()) << n << " of " << bytes.size();
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(decode(bytes, mesh, back).ok());
}

TEST(GrownCodec, refuses_fewer_and_more_vertices_than_there_are) {
  QuantizedMesh mesh = soup(4, 9, 60, 20);
  tidy(mesh, std::vector<uint32_t>(60));
  const std::vector<std::byte> bytes = encode_grown(mesh).bytes;
  for (const int more : {-100, -1, 1, 100}) {
    QuantizedMesh like = mesh, back;
    like.positions.resize(size_t(std::max(int(mesh.positions.size()) + more, 0)));
    EXPECT_FALSE(decode(bytes, like, back).ok()) << more;
  }
}

TEST(GrownCodec, refuses_more_triangles_than_its_bytes_can_tell_before_allocating) {
  QuantizedMesh like, back;
  like.runs = {{0, 1U << 30U}};
  const std::vector<std::byte> bytes(5000);
  EXPECT_FALSE(decode_grown(bytes, 1U << 31U, 1U << 30U, true, true, true, like).ok());
  EXPECT_TRUE(like.indices.empty());
  // The surest that there are: as many as no byte tells, of one kind.
  QuantizedMesh mesh;
  mesh.on_grid = true;
  mesh.positions = {{0, 0, 0}, {7, 0, 0}, {0, 9, 1}};
  for (uint32_t i = 0; i < 400000; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
  tidy(mesh, std::vector<uint32_t>(400000));
  EXPECT_TRUE(decode(encode_grown(mesh).bytes, mesh, back).ok());
}

/// What a decoder may return of any bytes: indices of vertices that there are.
bool is_whole(const QuantizedMesh& mesh, const QuantizedMesh& like) {
  return mesh.positions.size() == like.positions.size() && mesh.indices.size() == like.indices.size() &&
         (like.normals.empty() || mesh.normals.size() == like.positions.size()) &&
         (like.colors.empty() || mesh.colors.size() == like.positions.size()) &&
         std::all_of(mesh.indices.begin(), mesh.indices.end(), [&](uint32_t i) { return i < mesh.positions.size(); });
}

TEST(GrownCodec, survives_any_change_of_its_bytes) {
  std::mt19937 random(21);
  for (uint32_t seed = 0; seed < 12; ++seed) {
    QuantizedMesh mesh = seed % 3 == 0 ? torus(9, 5) : soup(seed, 4 + seed, 40, 12);
    mesh.fine_bits = static_cast<uint8_t>(seed % 4);
    tidy(mesh, std::vector<uint32_t>(mesh.indices.size() / 3));
    const std::vector<std::byte> sound = encode_grown(mesh).bytes;
    for (int round = 0; round < 400; ++round) {
      std::vector<std::byte> changed = sound;
      if (round % 7 == 0) changed.resize(random() % changed.size());
      for (int change = 0; change <= round % 4 && !changed.empty(); ++change)
        changed[random() % changed.size()] = static_cast<std::byte>(random());
      QuantizedMesh back;
      if (decode(changed, mesh, back).ok()) {
        EXPECT_TRUE(is_whole(back, mesh));
      }
    }
  }
}

TEST(GrownCodec, survives_bytes_that_are_no_mesh) {
  std::mt19937 random(22);
  QuantizedMesh like = soup(1, 9, 200, 9);
  tidy(like, std::vector<uint32_t>(200));
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::byte> bytes(random() % 400);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    if (!bytes.empty()) bytes[0] = static_cast<std::byte>(random() % bytes.size());
    QuantizedMesh back;
    if (decode(bytes, like, back).ok()) {
      EXPECT_TRUE(is_whole(back, like));
    }
  }
}

}  // namespace
}  // namespace promenade
