// Sides of far pictures told against a neighbour's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "codec/far_warp.h"
#include "geometry/cube_side.h"
#include "geometry/random.h"
#include "tests/golden.h"

namespace promenade {
namespace {

using testing::HasSubstr;

/// What a ray meets in a hall around the box: walls, a floor and a roof at 1.5 to 4 half boxes, painted in blocks.
struct Hall {
  bool roof = true;
  struct Seen {
    double depth = 0;
    glm::u8vec4 color{0};
  };
  Seen at(uint32_t side, double u, double v, const glm::dvec3& eye) const {
    const CubeSide axes = cube_side(side);
    const glm::dvec3 ray = axes.forward + u * axes.right + v * axes.up;
    double nearest = 1e9;
    int wall = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (ray[axis] == 0) continue;
      const double place = ray[axis] > 0 ? 2.5 + axis / 2.0 : -1.5 - axis / 2.0;
      if (const double t = (place - eye[axis]) / ray[axis]; t > 0 && t < nearest)
        nearest = t, wall = 2 * axis + (ray[axis] > 0 ? 1 : 0);
    }
    if (!roof && wall == 5) return {};
    const glm::dvec3 p = eye + nearest * ray;
    const auto block = [&](int axis) { return static_cast<int>(std::floor(p[axis] * 6)); };
    const auto shade = static_cast<uint8_t>(60 + 37 * ((block(0) * 3 + block(1) * 5 + block(2) * 7 + 300) % 5));
    return {nearest, {shade, static_cast<uint8_t>(40 * wall), static_cast<uint8_t>(255 - shade), 255}};
  }
};

FarFace drawn(const Hall& hall, uint32_t side, const glm::dvec3& eye, uint32_t levels) {
  FarFace face;
  face.grid.levels = levels;
  const uint32_t pixels = face.grid.side();
  const double middle = face.grid.cells() / 2.0;
  face.colors = {pixels, pixels, std::vector<glm::u8vec4>(face.grid.vertices())};
  face.kept.assign(face.grid.vertices(), 1);
  face.depth.assign(face.grid.vertices(), FarFace::kNearest);
  for (uint32_t y = 0; y < pixels; ++y)
    for (uint32_t x = 0; x < pixels; ++x) {
      const Hall::Seen seen = hall.at(side, (x - middle) / middle, (middle - y) / middle, eye);
      face.colors.at(x, y) = seen.color;
      if (seen.color.a != 0)
        face.depth[face.grid.index(x, y)] =
            static_cast<uint16_t>(std::clamp(std::round(FarFace::kNearest / seen.depth), 1.0, 65535.0));
    }
  return face;
}

/// A hall from two places; the neighbour as it was decoded.
struct TwoCells {
  explicit TwoCells(bool roof = true, uint32_t levels = 7, int quality = 90) : hall{roof} {
    for (uint32_t s = 0; s < 6; ++s) {
      const FarFace face = drawn(hall, s, glm::dvec3(0), levels);
      neighbour[s] = *decode_far_face(*encode_far_face(face, {quality}));
      reference.sides[s] = &neighbour[s];
    }
    reference.offset = {0.2, -0.1, 0.05};
    reference.places = {-1, 2, -128};
    for (uint32_t s = 0; s < 6; ++s) sides[s] = drawn(hall, s, reference.offset, levels);
  }
  Hall hall;
  std::array<FarFace, 6> sides, neighbour;
  FarReference reference;
};

double mean_error(const Image& a, const Image& b) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    if (a.pixels[i].a == 0) continue;
    for (int c = 0; c < 3; ++c) sum += std::abs(double(a.pixels[i][c]) - double(b.pixels[i][c])), ++count;
  }
  return sum / count;
}

TEST(FarDelta, foretells_what_a_neighbour_sees_of_the_same_points) {
  const TwoCells cells;
  for (uint32_t s = 0; s < 6; ++s) {
    const Image warped = foretell(cells.sides[s], s, cells.reference, FarForetelling::warped);
    const Image still = foretell(cells.sides[s], s, cells.reference, FarForetelling::still);
    EXPECT_LT(mean_error(cells.sides[s].colors, warped), 16) << s;
    EXPECT_GT(mean_error(cells.sides[s].colors, still), 3 * mean_error(cells.sides[s].colors, warped)) << s;
  }
}

TEST(FarDelta, of_the_same_place_is_the_neighbours_picture) {
  TwoCells cells;
  cells.reference.offset = glm::dvec3(0);
  for (uint32_t s = 0; s < 6; ++s) {
    const FarFace same = drawn(cells.hall, s, glm::dvec3(0), 7);
    const Image warped = foretell(same, s, cells.reference, FarForetelling::warped);
    // What lies on an edge of the cube may come from the side beyond.
    for (uint32_t y = 1; y + 1 < warped.height; ++y)
      for (uint32_t x = 1; x + 1 < warped.width; ++x)
        ASSERT_EQ(warped.at(x, y), cells.neighbour[s].colors.at(x, y)) << s << ": " << x << ", " << y;
  }
}

TEST(FarDelta, comes_back_with_exact_triangles_and_opacities_and_colours_as_near_as_alone) {
  for (const bool roof : {false, true}) {
    const TwoCells cells(roof);
    for (uint32_t s = 0; s < 6; ++s)
      for (const FarForetelling how : {FarForetelling::still, FarForetelling::warped}) {
        const Result<std::vector<std::byte>> bytes = encode_far_delta(cells.sides[s], {90}, s, cells.reference, how);
        ASSERT_TRUE(bytes) << bytes.error().message;
        EXPECT_EQ(reference_of_far_face(*bytes), cells.reference.places);
        EXPECT_EQ(*encode_far_delta(cells.sides[s], {90}, s, cells.reference, how), *bytes) << "the same bytes again";
        const Result<FarFace> back = decode_far_face(*bytes, s, &cells.reference);
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(back->kept, cells.sides[s].kept);
        EXPECT_EQ(back->depth, cells.sides[s].depth);
        for (size_t i = 0; i < back->colors.pixels.size(); ++i)
          ASSERT_EQ(back->colors.pixels[i].a, cells.sides[s].colors.pixels[i].a) << i;
        const std::vector<std::byte> alone_bytes = *encode_far_face(cells.sides[s], {90});
        EXPECT_EQ(reference_of_far_face(alone_bytes), std::nullopt);
        const FarFace alone = *decode_far_face(alone_bytes);
        if (!roof && s == 4) continue;  // nothing at all
        EXPECT_LT(mean_error(cells.sides[s].colors, back->colors),
                  1.5 * mean_error(cells.sides[s].colors, alone.colors) + 0.1)
            << s;
      }
  }
}

TEST(FarDelta, takes_less_than_a_side_alone_where_the_neighbour_sees_the_same) {
  const TwoCells cells(true, 8);
  uint64_t alone = 0, warped = 0, still = 0;
  for (uint32_t s = 0; s < 6; ++s) {
    // A quarter of the vertices would do for the hall; colours are what is compared.
    alone += encode_far_face(cells.sides[s], {90})->size();
    warped += encode_far_delta(cells.sides[s], {90}, s, cells.reference, FarForetelling::warped)->size();
    still += encode_far_delta(cells.sides[s], {90}, s, cells.reference, FarForetelling::still)->size();
  }
  EXPECT_LT(warped, alone);
  EXPECT_LT(still, alone);
}

TEST(FarDelta, without_its_reference_or_with_another_grid_is_refused) {
  TwoCells cells(true, 4);
  const std::vector<std::byte> bytes =
      *encode_far_delta(cells.sides[0], {90}, 0, cells.reference, FarForetelling::warped);
  EXPECT_THAT(decode_far_face(bytes).error().message, HasSubstr("told against another"));
  const TwoCells finer(true, 5);
  EXPECT_THAT(decode_far_face(bytes, 0, &finer.reference).error().message, HasSubstr("other sizes"));
  EXPECT_FALSE(encode_far_delta(cells.sides[0], {90}, 0, finer.reference, FarForetelling::warped));
  EXPECT_FALSE(encode_far_delta(cells.sides[0], {90}, 6, cells.reference, FarForetelling::warped));
  cells.reference.offset.x = std::nan("");
  EXPECT_THAT(decode_far_face(bytes, 0, &cells.reference).error().message, HasSubstr("half boxes away"));
}

TEST(FarDelta, reads_references_that_see_nothing) {
  TwoCells cells(true, 5);
  cells.reference.sides = {};
  const Result<std::vector<std::byte>> bytes =
      encode_far_delta(cells.sides[2], {90}, 2, cells.reference, FarForetelling::warped);
  ASSERT_TRUE(bytes);
  EXPECT_LT(mean_error(cells.sides[2].colors, decode_far_face(*bytes, 2, &cells.reference)->colors), 8);
}

TEST(FarDelta, survives_every_truncation_and_any_changed_byte) {
  const TwoCells cells(false, 5);
  const std::vector<std::byte> bytes =
      *encode_far_delta(cells.sides[1], {80}, 1, cells.reference, FarForetelling::warped);
  for (size_t size = 0; size < bytes.size(); ++size) {
    const Result<FarFace> cut = decode_far_face(std::span(bytes).first(size), 1, &cells.reference);
    if (cut) {
      EXPECT_EQ(cut->depth.size(), cut->grid.vertices());
    }
  }
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    std::vector<std::byte> changed = bytes;
    changed[random.below(static_cast<uint32_t>(bytes.size()))] = std::byte(random.below(256));
    const Result<FarFace> back = decode_far_face(changed, 1, &cells.reference);
    if (!back) continue;
    EXPECT_EQ(back->colors.pixels.size(), back->grid.vertices());
    std::vector<uint8_t> kept = back->kept;
    EXPECT_FALSE(close_halvings(back->grid, kept)) << "whatever the bytes say, triangles fit together";
  }
}

TEST(FarDelta, has_the_golden_bytes_of_version_2) {
  const TwoCells cells(false, 4, 0);
  const FarFaceCoding exact{0};
  expect_golden("far_face_v2.bin",
                *encode_far_delta(cells.sides[3], exact, 3, cells.reference, FarForetelling::warped));
  const Result<FarFace> back = decode_far_face(golden_bytes("far_face_v2.bin"), 3, &cells.reference);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->depth, cells.sides[3].depth);
}

}  // namespace
}  // namespace promenade
