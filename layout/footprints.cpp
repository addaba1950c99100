#include "layout/footprints.h"

#include <fmt/format.h>

#include <cmath>

namespace promenade {

void Footprints::append(const Footprints& others) {
  const auto loops = static_cast<uint32_t>(loop_ends.size()), first = static_cast<uint32_t>(points.size());
  for (Footprint footprint : others.all) {
    footprint.loops_end += loops;
    all.push_back(footprint);
  }
  for (const uint32_t end : others.loop_ends) loop_ends.push_back(first + end);
  points.insert(points.end(), others.points.begin(), others.points.end());
}

std::string Footprints::defect() const {
  uint32_t loops = 0, end = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    const Footprint& f = all[i];
    if (f.loops_end <= loops || f.loops_end > loop_ends.size() || !(f.base_m < f.top_m) ||
        !std::isfinite(f.top_m - f.base_m))
      return fmt::format("footprint {}: loops {} to {} of {}, from {} to {} m", i, loops, f.loops_end, loop_ends.size(),
                         f.base_m, f.top_m);
    loops = f.loops_end;
  }
  if (loops != loop_ends.size()) return fmt::format("footprints: {} loops, {} are due", loop_ends.size(), loops);
  for (size_t i = 0; i < loop_ends.size(); ++i) {
    if (loop_ends[i] < end + 3 || loop_ends[i] > points.size())
      return fmt::format("loop {} of the footprints: points {} to {} of {}", i, end, loop_ends[i], points.size());
    end = loop_ends[i];
  }
  if (end != points.size()) return fmt::format("footprints: {} points, {} are due", points.size(), end);
  for (const glm::vec2& p : points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return "footprints: a point that is no place";
  return {};
}

}  // namespace promenade
