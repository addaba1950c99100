#include "layout/model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/layout/model_fixtures.h"

namespace promenade {
namespace {

using testing::HasSubstr;

TEST(FindDefect, finds_none_in_a_sound_model) { EXPECT_EQ(find_defect(model_of_squares()), ""); }

struct Damage {
  std::function<void(Model&)> apply;
  const char* message;
};

TEST(FindDefect, names_what_is_wrong_and_where) {
  const Damage damages[] = {
      {[](Model& m) { m.tables.nodes.clear(); }, "no nodes"},
      {[](Model& m) { m.manifest.files.pop_back(); }, "tables.bin"},
      {[](Model& m) { m.manifest.files[0].name = "../geometry.bin"; }, "no name of a data file"},
      {[](Model& m) { m.manifest.files[1].name = "geometry.bin"; }, "named twice"},
      {[](Model& m) { m.tables.segments[1].type = static_cast<SegmentRecord::Type>(9); }, "segment 1: unknown type 9"},
      {[](Model& m) { m.tables.segments[1].file = 2; }, "segment 1: file 2"},
      {[](Model& m) { m.tables.segments[2].stored_bytes = 101; }, "segment 2: 101 bytes @0xc8 reach beyond"},
      {[](Model& m) { m.tables.segments[2].offset = ~uint64_t(0); }, "reach beyond"},
      {[](Model& m) { m.tables.textures[0].width = 0; }, "texture 0: 0 x 1"},
      {[](Model& m) { m.tables.textures[0].segment = 0; }, "texture 0: segment 0 is no texture"},
      {[](Model& m) { m.tables.textures[0].flags = 4; }, "unknown flags"},
      {[](Model& m) { m.tables.node_textures[1] = 1; }, "node texture 1"},
      {[](Model& m) { m.tables.materials.clear(); }, "no materials"},
      {[](Model& m) { m.tables.materials[1].texture = 1; }, "material 1: texture 1 of 1"},
      {[](Model& m) { m.tables.materials[1].alpha = static_cast<AlphaMode>(3); }, "material 1: unknown"},
      {[](Model& m) { m.tables.nodes[1].box = Box{}; }, "node 1: box is empty"},
      {[](Model& m) { m.tables.nodes[1].box.max.x = std::nanf(""); }, "node 1: box"},
      {[](Model& m) { m.tables.nodes[1].error_m = -1; }, "node 1: error of -1"},
      {[](Model& m) { m.tables.nodes[1].error_p99_m = 0.1F; }, "99th percentile"},
      {[](Model& m) {
         m.tables.nodes[1].cone.axis = {0, 0, 2};
       },
       "normal cone"},
      {[](Model& m) { m.tables.nodes[1].cone.cos_angle = std::nanf(""); }, "normal cone"},
      {[](Model& m) {
         m.tables.nodes[1].average_normal = {0, 0.5F, 0};
       },
       "average normal"},
      {[](Model& m) { m.tables.nodes[1].surface_m2 = INFINITY; }, "surface"},
      {[](Model& m) { m.tables.nodes[0].first_child = 1; }, "children 1 + 2 of 2"},
      {[](Model& m) { m.tables.nodes[0].first_child = 0xffffffffU; }, "children"},
      {[](Model& m) { m.tables.nodes[2].texture_count = 2; }, "textures 1 + 2 of 2"},
      {[](Model& m) { m.tables.nodes[2].segment = 3; }, "segment 3 is no mesh"},
      {[](Model& m) { m.tables.nodes[2].textured_triangles = 3; }, "3 of 2 triangles textured"},
      {[](Model& m) { m.tables.roots = {NodeId{9}}; }, "root 9 of 3"},
      {[](Model& m) { m.tables.roots = {NodeId{1}}; }, "root 1 has parent 0"},
      {[](Model& m) {
         m.tables.roots = {NodeId{0}, NodeId{0}};
       },
       "root 0 is named twice"},
      {[](Model& m) { m.tables.roots.clear(); }, "0 of 3 nodes hang below the roots"},
      {[](Model& m) { m.tables.children[1] = NodeId{7}; }, "child 7 of 3"},
      {[](Model& m) { m.tables.children[1] = NodeId{1}; }, "child 1 is met twice"},
      {[](Model& m) { m.tables.children[1] = NodeId{0}; }, "child 0 has parent"},
      {[](Model& m) { m.tables.nodes[2].level = 2; }, "has level 2, not 1"},
      {[](Model& m) { m.tables.nodes[2].box.max.x = 4; }, "box does not contain that of child 2"},
      {[](Model& m) { m.tables.nodes[2].error_m = 0.6F; }, "below the 0.6"},
      {[](Model& m) { m.tables.nodes[0].child_count = 1; }, "2 of 3 nodes hang"}};
  for (const Damage& damage : damages) {
    Model model = model_of_squares();
    damage.apply(model);
    EXPECT_THAT(find_defect(model), HasSubstr(damage.message));
  }
}

}  // namespace
}  // namespace promenade
