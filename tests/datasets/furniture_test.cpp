#include "datasets/furniture.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <set>

#include "datasets/shapes.h"

namespace promenade {
namespace {

/// Vertices by position: the parts repeat corners bit by bit, but for the sign of a zero.
std::vector<uint32_t> welded(const Mesh& mesh) {
  std::map<std::array<float, 3>, uint32_t> ids;
  std::vector<uint32_t> weld;
  for (const glm::vec3& p : mesh.positions)
    weld.push_back(
        ids.try_emplace({p.x + 0.0F, p.y + 0.0F, p.z + 0.0F}, static_cast<uint32_t>(ids.size())).first->second);
  return weld;
}

/// How many edges are not walked as often one way as the other: 0 for closed, consistently wound surfaces.
size_t open_edges(const Mesh& mesh) {
  const std::vector<uint32_t> weld = welded(mesh);
  std::map<std::pair<uint32_t, uint32_t>, int> balance;
  for (size_t i = 0; i < mesh.indices.size(); ++i) {
    const uint32_t a = weld[mesh.indices[i]], b = weld[mesh.indices[i % 3 == 2 ? i - 2 : i + 1]];
    balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
  }
  return static_cast<size_t>(
      std::count_if(balance.begin(), balance.end(), [](const auto& e) { return e.second != 0; }));
}

/// The signed volume of each connected part.
std::vector<double> part_volumes(const Mesh& mesh) {
  const std::vector<uint32_t> weld = welded(mesh);
  std::vector<uint32_t> root(mesh.positions.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (size_t i = 0; i < mesh.indices.size(); ++i)
    root[find(weld[mesh.indices[i]])] = find(weld[mesh.indices[i - i % 3]]);
  std::map<uint32_t, double> volume;
  const glm::dvec3 center(bounds(mesh).center());
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto p = [&](size_t k) { return glm::dvec3(mesh.positions[mesh.indices[i + k]]) - center; };
    volume[find(weld[mesh.indices[i]])] += glm::dot(p(0), glm::cross(p(1), p(2))) / 6;
  }
  std::vector<double> volumes;
  volumes.reserve(volume.size());
  for (const auto& [part, v] : volume) volumes.push_back(v);
  return volumes;
}

/// Share of corners whose normal looks the way their triangle does.
double agreeing_normals(const Mesh& mesh) {
  size_t agree = 0;
  for (size_t i = 0; i < mesh.indices.size(); ++i)
    agree += glm::dot(mesh.normals[mesh.indices[i]], triangle_cross(mesh, i / 3)) > 0 ? 1U : 0U;
  return double(agree) / double(mesh.indices.size());
}

TEST(Shapes, polygons_with_holes_keep_their_area) {
  const std::vector<glm::dvec2> outer{{0, 0}, {10, 0}, {10, 3}, {0, 3}};
  const std::vector<std::vector<glm::dvec2>> holes{
      {{1, 1}, {1, 2}, {2, 2}, {2, 1}}, {{4, 1}, {4, 2}, {5, 2}, {5, 1}}, {{7, 1}, {7, 2}, {8, 2}, {8, 1}}};
  const std::vector<uint32_t> triangles = triangulate(outer, holes);
  EXPECT_EQ(triangles.size() / 3, 4 + 12 + 2 * 3 - 2U);
  std::vector<glm::dvec2> all = outer;
  for (const auto& hole : holes) all.insert(all.end(), hole.begin(), hole.end());
  double area = 0;
  for (size_t i = 0; i < triangles.size(); i += 3) {
    const glm::dvec2 a = all[triangles[i]], b = all[triangles[i + 1]] - a, c = all[triangles[i + 2]] - a;
    EXPECT_GT(b.x * c.y - b.y * c.x, 0);
    area += (b.x * c.y - b.y * c.x) / 2;
  }
  EXPECT_NEAR(area, 27, 1e-9);
}

TEST(Shapes, a_rounded_box_fills_its_box) {
  Sculptor sculptor(1);
  sculptor.rounded_box({-1, -2, 0}, {1, 2, 3}, 0.2, 3);
  const Mesh mesh = sculptor.take();
  EXPECT_EQ(open_edges(mesh), 0U);
  EXPECT_EQ(bounds(mesh), (Box{{-1, -2, 0}, {1, 2, 3}}));
  EXPECT_EQ(agreeing_normals(mesh), 1);
}

TEST(Shapes, a_mirrored_part_still_faces_outwards) {
  glm::dmat4 mirror(1);
  mirror[0][0] = -1;
  Sculptor sculptor(1);
  sculptor.stand(mirror).cylinder({1, 0, 0}, {1, 0, 2}, 0.5, 8);
  const Mesh mesh = sculptor.take();
  ASSERT_EQ(part_volumes(mesh).size(), 1U);
  EXPECT_GT(part_volumes(mesh)[0], 0);
  EXPECT_EQ(agreeing_normals(mesh), 1);
}

TEST(Furniture, names_are_unique_and_there_are_more_than_a_hundred_kinds) {
  const FurnitureCatalogue catalogue;
  std::set<std::string> names;
  for (const FurnitureItem& item : catalogue.items()) names.insert(item.name);
  EXPECT_EQ(names.size(), catalogue.items().size());
  EXPECT_GT(names.size(), 100U);
}

TEST(Furniture, every_item_is_sound_closed_and_faces_outwards_at_any_quality) {
  const FurnitureCatalogue catalogue;
  for (const double quality : {0.2, 1.0}) {
    for (const FurnitureItem& item : catalogue.items()) {
      const Mesh mesh = item.build(quality);
      EXPECT_EQ(find_defect(mesh), "") << item.name;
      EXPECT_EQ(open_edges(mesh), 0U) << item.name << " at quality " << quality;
      for (const double volume : part_volumes(mesh)) EXPECT_GT(volume, 0) << item.name << " at quality " << quality;
      EXPECT_GT(agreeing_normals(mesh), 0.93) << item.name;  // tight bends of thin tubes shade a little off
    }
  }
}

TEST(Furniture, more_quality_never_means_fewer_triangles) {
  const FurnitureCatalogue catalogue;
  for (const FurnitureItem& item : catalogue.items()) {
    size_t before = 0;
    for (const double quality : {0.1, 0.5, 1.0}) {
      const size_t now = item.build(quality).triangle_count();
      EXPECT_GE(now, before) << item.name << " at quality " << quality;
      before = now;
    }
  }
}

TEST(Furniture, a_book_is_as_large_as_its_shelf_is_told) {
  const FurnitureCatalogue catalogue;
  for (uint32_t i = 0; i < catalogue.variants("book"); ++i) {
    const Box box = bounds(catalogue.items()[catalogue.find("book", i)].build(1));
    const BookSize size = book_size(i);
    EXPECT_NEAR(box.size().x, size.width_m, 1e-6);
    EXPECT_NEAR(box.size().z, size.height_m, 1e-6);
    EXPECT_LT(size.height_m, kShelfPitchM - 0.022);
  }
}

}  // namespace
}  // namespace promenade
