// What import mends in a mesh, on meshes of a few triangles.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "preprocess/repair.h"

namespace promenade {
namespace {

Mesh cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return mesh;
}

/// The same with a vertex for each corner, as files with flat normals have it.
Mesh split(const Mesh& mesh) {
  Mesh out;
  for (const uint32_t i : mesh.indices) {
    out.indices.push_back(static_cast<uint32_t>(out.positions.size()));
    out.positions.push_back(mesh.positions[i]);
  }
  return out;
}

void turn(Mesh& mesh, size_t triangle) { std::swap(mesh.indices[3 * triangle + 1], mesh.indices[3 * triangle + 2]); }

uint64_t count(const Counts& counts, const std::string& key) {
  const auto found = counts.find(key);
  return found == counts.end() ? 0 : found->second;
}

TEST(Repair, sound_mesh_stays_as_it_is) {
  Mesh mesh = cube();
  Counts counts;
  repair_mesh(mesh, counts);
  EXPECT_TRUE(counts.empty());
  EXPECT_EQ(mesh.indices, cube().indices);
}

TEST(Repair, degenerate_faces_go) {
  Mesh mesh = cube();
  mesh.positions.emplace_back(0.5F, 0, 0);
  mesh.indices.insert(mesh.indices.end(), {0, 0, 1, 0, 8, 1});  // a point twice, three on a line
  Counts counts;
  repair_mesh(mesh, counts);
  EXPECT_EQ(count(counts, "faces_degenerate"), 2U);
  EXPECT_EQ(mesh.triangle_count(), 12U);
  EXPECT_EQ(mesh.vertex_count(), 8U);
}

TEST(Repair, duplicate_goes_whatever_its_first_corner_and_its_vertices) {
  Mesh mesh = cube();
  Mesh again = cube();
  again.indices = {2, 1, 0};  // the first face, begun elsewhere, with vertices of its own
  append(mesh, again);
  Counts counts;
  repair_mesh(mesh, counts);
  EXPECT_EQ(count(counts, "faces_duplicate"), 1U);
  EXPECT_EQ(mesh.triangle_count(), 12U);
}

TEST(Repair, faces_back_to_back_both_stay) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 1};
  Counts counts;
  repair_mesh(mesh, counts);
  EXPECT_TRUE(counts.empty());
  EXPECT_EQ(mesh.triangle_count(), 2U);
}

TEST(Repair, same_place_in_another_material_is_no_duplicate) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2, 0, 1, 2};
  mesh.materials = {0, 1};
  Counts counts;
  repair_mesh(mesh, counts);
  EXPECT_EQ(mesh.triangle_count(), 2U);
}

TEST(Repair, minority_of_a_component_is_turned) {
  for (const bool with_split_vertices : {false, true}) {
    Mesh mesh = with_split_vertices ? split(cube()) : cube();
    for (const size_t t : {size_t(1), size_t(5), size_t(6)}) turn(mesh, t);
    Counts counts;
    repair_mesh(mesh, counts);
    EXPECT_EQ(count(counts, "faces_reoriented"), 3U);
    EXPECT_EQ(mesh.indices, (with_split_vertices ? split(cube()) : cube()).indices);
  }
}

TEST(Repair, turned_face_takes_its_normals_along) {
  Mesh mesh = split(cube());
  turn(mesh, 4);
  for (size_t t = 0; t < mesh.triangle_count(); ++t)
    for (int c = 0; c < 3; ++c) mesh.normals.push_back(glm::normalize(triangle_cross(mesh, t)));
  Counts counts;
  repair_mesh(mesh, counts);
  for (size_t t = 0; t < mesh.triangle_count(); ++t)
    EXPECT_GT(glm::dot(mesh.normals[mesh.indices[3 * t]], triangle_cross(mesh, t)), 0) << t;
}

TEST(Repair, each_component_follows_its_own_majority) {
  Mesh mesh = cube();
  Mesh inside_out = cube();
  for (size_t t = 0; t < 12; ++t) turn(inside_out, t);
  turn(inside_out, 3);
  for (glm::vec3& p : inside_out.positions) p.x += 5;
  append(mesh, inside_out);
  Counts counts;
  repair_mesh(mesh, counts);
  EXPECT_EQ(count(counts, "faces_reoriented"), 1U);
}

TEST(Repair, moebius_strip_is_left_alone) {
  Mesh mesh;
  constexpr uint32_t kSteps = 9;
  for (uint32_t i = 0; i < kSteps; ++i) {
    const float a = 6.2831853F * float(i) / float(kSteps);
    const glm::vec3 out(std::cos(a), std::sin(a), 0);
    const glm::vec3 across = std::cos(a / 2) * out + std::sin(a / 2) * glm::vec3(0, 0, 1);
    mesh.positions.push_back(3.0F * out - across);
    mesh.positions.push_back(3.0F * out + across);
  }
  for (uint32_t i = 0; i < kSteps; ++i) {
    const bool last = i + 1 == kSteps;
    const uint32_t next = last ? 0 : 2 * (i + 1);
    const uint32_t low = last ? next + 1 : next;
    const uint32_t high = last ? next : next + 1;
    mesh.indices.insert(mesh.indices.end(), {2 * i, low, 2 * i + 1, 2 * i + 1, low, high});
  }
  const std::vector<uint32_t> before = mesh.indices;
  Counts counts;
  repair_mesh(mesh, counts);
  EXPECT_EQ(mesh.indices, before);
}

TEST(Repair, edge_of_three_faces_joins_nothing) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  mesh.indices = {0, 1, 2, 0, 1, 3, 1, 0, 4};
  Counts counts;
  repair_mesh(mesh, counts);
  EXPECT_TRUE(counts.empty());
}

TEST(Repair, solid_means_closed_consistent_and_outwards) {
  const auto solid = [](const Mesh& mesh) -> bool { return solid_triangles(mesh)[0]; };
  EXPECT_TRUE(solid(cube()));
  EXPECT_TRUE(solid(split(cube())));
  Mesh open = cube();
  open.indices.resize(33);
  EXPECT_FALSE(solid(open));
  Mesh inconsistent = cube();
  turn(inconsistent, 7);
  EXPECT_FALSE(solid(inconsistent));
  Mesh inwards = cube();
  for (size_t t = 0; t < 12; ++t) turn(inwards, t);
  EXPECT_FALSE(solid(inwards));
}

}  // namespace
}  // namespace promenade
