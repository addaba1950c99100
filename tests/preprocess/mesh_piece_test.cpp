#include "preprocess/mesh_piece.h"

#include <gtest/gtest.h>

#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

TEST(PieceOf, keeps_triangles_with_all_attributes) {
  const Mesh mesh = test::box_city_block();
  const std::vector<uint32_t> triangles{100, 3, 4, 77};
  const Mesh piece = piece_of(mesh, triangles);
  const Mesh expected = submesh(mesh, triangles);
  ASSERT_EQ(piece.triangle_count(), 4);
  EXPECT_EQ(piece.vertex_count(), expected.vertex_count());
  for (size_t i = 0; i < piece.indices.size(); ++i) {
    EXPECT_EQ(piece.positions[piece.indices[i]], expected.positions[expected.indices[i]]);
    EXPECT_EQ(piece.normals[piece.indices[i]], expected.normals[expected.indices[i]]);
    EXPECT_EQ(piece.colors[piece.indices[i]], expected.colors[expected.indices[i]]);
  }
}

}  // namespace
}  // namespace promenade
