#include "preprocess/visibility/line_beam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/random.h"

namespace promenade {
namespace {

struct Rectangle {
  double t0, t1, x0, x1;
  /// Whether the line x = slope t + offset touches it.
  bool met_by(double slope, double offset) const { return slope * t0 + offset <= x1 && slope * t1 + offset >= x0; }
};

// Cut again and again by lines through its own corners, up to rounding, a polygon is convex no longer: a line may cut
// it in twenty places (it once did so in a town of bricks). Run with AddressSanitizer this says that there is room for
// them; in any build, that no line that touches all rectangles is lost.
TEST(LinePolygon, keeps_every_line_however_often_the_same_rectangles_cut_it) {
  size_t lines = 0;
  for (uint64_t seed = 8740; seed < 8760; ++seed) {
    Random random(seed);
    const double base = 300 * random.unit();
    std::vector<Rectangle> rectangles(2 + random.below(5));
    for (Rectangle& r : rectangles) {
      const double size = std::pow(10, -random.range(0.0, 6.0));
      r.t0 = base + 10 * random.unit(), r.t1 = r.t0 + size * random.unit();
      r.x0 = base + (r.t0 - base) * 0.5 + size * random.range(-1.0, 1.0), r.x1 = r.x0 + size * random.unit();
    }
    LinePolygon polygon(rectangles[0].t0, rectangles[0].t1, rectangles[0].x0, rectangles[0].x1);
    std::vector<Rectangle> met = {rectangles[0]};
    for (int step = 0; step < 200; ++step) {
      Rectangle r = rectangles[random.below(static_cast<uint32_t>(rectangles.size()))];
      const double wider = random.chance(0.8) ? 0 : 1e-9 * random.unit();
      r.t1 += wider, r.x1 += wider;
      LinePolygon left = polygon;
      left.keep_touching(r.t0, r.t1, r.x0, r.x1);
      if (left.empty()) continue;
      polygon = left;
      met.push_back(r);
    }
    for (int i = 0; i < 2000; ++i) {  // through two points of two of them
      const Rectangle &a = met[random.below(static_cast<uint32_t>(met.size()))],
                      &b = met[random.below(static_cast<uint32_t>(met.size()))];
      const double at = random.range(a.t0, a.t1), x = random.range(a.x0, a.x1), run = random.range(b.t0, b.t1) - at;
      if (std::abs(run) < 1e-9) continue;
      const double slope = (random.range(b.x0, b.x1) - x) / run, offset = x - slope * at;
      if (slope < 0 || slope > 1) continue;
      const bool meets_all =
          std::all_of(met.begin(), met.end(), [&](const Rectangle& r) { return r.met_by(slope, offset); });
      if (meets_all) {
        ++lines;
        EXPECT_TRUE(polygon.touches(at, at, x, x)) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(lines, 100U);
}

}  // namespace
}  // namespace promenade
