// Whether the errors that a build records bound the distances to the source, at random points of both surfaces.
// PROMENADE_BOUND_POINTS sets how many points a source gets (default 100,000; 1,000,000 takes some seconds).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "geometry/closest_point.h"
#include "tests/preprocess/build_fixtures.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

uint64_t points_wanted() {
  const char* text = std::getenv("PROMENADE_BOUND_POINTS");
  const uint64_t wanted = text != nullptr ? std::strtoull(text, nullptr, 10) : 0;
  return wanted > 0 ? wanted : 100'000;
}

/// Points spread over a mesh by area.
class PointsOn {
 public:
  PointsOn(const Mesh& mesh, uint64_t seed) : mesh_(mesh), numbers_(seed), area_until_(mesh.triangle_count()) {
    double area = 0;
    for (size_t t = 0; t < area_until_.size(); ++t)
      area_until_[t] = area += double(glm::length(triangle_cross(mesh, t)));
  }
  glm::vec3 next() {
    const double at = area_until_.back() * double(numbers_.unit());
    const auto found = std::lower_bound(area_until_.begin(), area_until_.end(), at) - area_until_.begin();
    const size_t t = std::min(static_cast<size_t>(found), area_until_.size() - 1);
    const auto corner = [&](size_t c) { return mesh_.positions[mesh_.indices[3 * t + c]]; };
    const float r = std::sqrt(numbers_.unit()), w = numbers_.unit();
    return corner(0) + r * (1 - w) * (corner(1) - corner(0)) + r * w * (corner(2) - corner(0));
  }

 private:
  const Mesh& mesh_;
  test::Numbers numbers_;
  std::vector<double> area_until_;
};

float distance_m(const ClosestPointTree& tree, const glm::vec3& p) { return std::sqrt(tree.nearest(p).distance2_m2); }

struct Distances {
  float to_source_m = 0, from_source_m = 0;
};

/// Checks points on a node and on the source below it: what is seen of the leaves is within their error of the source.
Distances check_node(const ModelReader& reader, uint32_t node, const ClosestPointTree& source, uint64_t points) {
  Distances largest;
  const Model& model = reader.model();
  const float bound_m = model.tables.nodes[node].error_m;
  const Mesh surface = mesh_of(reader, node);
  const ClosestPointTree tree(surface);
  PointsOn on_node(surface, node);
  for (uint64_t i = 0; i < points; ++i)
    largest.to_source_m = std::max(largest.to_source_m, distance_m(source, on_node.next()));
  const std::vector<uint32_t> leaves = leaves_below(model, node);
  for (const uint32_t leaf : leaves) {
    const Mesh detail = mesh_of(reader, leaf);
    const float leaf_error_m = leaf == node ? 0 : model.tables.nodes[leaf].error_m;
    PointsOn on_leaf(detail, leaf + uint64_t(node) * 7919);
    for (uint64_t i = 0; i < points / leaves.size() + 1; ++i)
      largest.from_source_m = std::max(largest.from_source_m, distance_m(tree, on_leaf.next()) - leaf_error_m);
  }
  EXPECT_LE(largest.to_source_m, bound_m * 1.00001F) << "node " << node;
  EXPECT_LE(largest.from_source_m, bound_m * 1.00001F) << "node " << node;
  return largest;
}

class Bound : public testing::TestWithParam<std::pair<const char*, Mesh (*)()>> {};

Mesh hills() { return test::hills(100); }
Mesh ball() { return test::ball(60); }
Mesh block() { return test::box_city_block(); }
Mesh soup() { return test::disjoint_triangles(8000, 1.5F); }

TEST_P(Bound, is_passed_by_no_random_point_of_either_surface_on_any_level) {
  const TemporaryFolder folder;
  const Mesh mesh = GetParam().second();
  JobMonitor monitor;
  const BuildOptions options = small_build(folder.write("source.obj", obj_text(mesh)), folder.path() / "model.prom");
  const Result<BuildFigures> figures = build_model(options, monitor);
  ASSERT_TRUE(figures.ok()) << figures.error().message;
  const Result<ModelReader> reader = ModelReader::open(options.model);
  ASSERT_TRUE(reader.ok());
  const Model& model = reader->model();
  Mesh source = mesh;
  for (glm::vec3& p : source.positions) p = glm::vec3(glm::dvec3(p) - model.manifest.origin);
  const ClosestPointTree tree(source);
  std::vector<float> looseness;
  const uint64_t points = points_wanted() / model.tables.nodes.size() / 2 + 1;
  for (uint32_t i = 0; i < model.tables.nodes.size(); ++i) {
    const Distances d = check_node(*reader, i, tree, points);
    const float largest = std::max(d.to_source_m, d.from_source_m);
    if (model.tables.nodes[i].child_count > 0 && largest > 0)
      looseness.push_back(model.tables.nodes[i].error_m / largest);
  }
  ASSERT_FALSE(looseness.empty());
  std::nth_element(looseness.begin(), looseness.begin() + std::ptrdiff_t(looseness.size() / 2), looseness.end());
  const float median = looseness[looseness.size() / 2];
  std::printf("%s: bound over the largest distance found, median of inner nodes: %.2f\n", GetParam().first,
              double(median));
  EXPECT_LT(median, 1.5F) << "errors that add up over levels, or coarse grids, would make bounds loose";
}

INSTANTIATE_TEST_SUITE_P(Sources, Bound,
                         testing::Values(std::pair("hills", &hills), std::pair("ball", &ball),
                                         std::pair("block", &block), std::pair("soup", &soup)),
                         [](const auto& param) { return std::string(param.param.first); });

}  // namespace
}  // namespace promenade
