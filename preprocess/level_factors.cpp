#include "preprocess/level_factors.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace promenade {

namespace {

// Leaves are planned a little below their limit, because planes on the lattice share out a little unevenly.
constexpr double kFill = 0.95;
// Children of a node, to the wanted number.
constexpr double kMostFactor = 1.5;
// Leaves may become as many times more for the sake of full subtrees.
constexpr double kMostRounding = 1.1;

}  // namespace

std::optional<LevelFactors> LevelFactors::named(const std::string& text) {
  std::vector<uint32_t> factors;
  for (const char *at = text.data(), *end = at + text.size();; ++at) {
    const auto [after, error] = std::from_chars(at, end, factors.emplace_back());
    if (error != std::errc()) return std::nullopt;
    if (after == end) return LevelFactors(std::move(factors));
    if (*after != ',') return std::nullopt;
    at = after;
  }
}

std::string LevelFactors::name() const { return fmt::format("{}", fmt::join(factors_, ",")); }

uint32_t LevelFactors::at(uint32_t level) const { return factors_[std::min<size_t>(level, factors_.size() - 1)]; }

uint32_t LevelFactors::largest() const { return *std::max_element(factors_.begin(), factors_.end()); }

LevelFactors LevelFactors::above(double leaves) const {
  uint32_t level = 0;
  for (double full = factors_.front(); full <= leaves && level + 1 < factors_.size(); full *= factors_[level]) ++level;
  return LevelFactors(std::vector<uint32_t>(factors_.begin() + level, factors_.end()));
}

LeafShares::LeafShares(uint64_t triangles, uint32_t leaf_triangles, const LevelFactors& factors, uint32_t planned) {
  if (triangles <= leaf_triangles) return;
  const bool plan_holds = planned > 1 && triangles <= uint64_t(planned) * leaf_triangles;
  const auto wanted =
      plan_holds ? double(planned) : std::max(2.0, std::ceil(double(triangles) / (kFill * leaf_triangles)));
  uint32_t level = 0;
  double full = 1;  // leaves of a full subtree
  double subtrees = wanted;
  for (uint32_t l = 1; l < factors.list().size(); ++l) {
    full *= factors.at(l - 1);
    const double rounded = std::ceil(wanted / full);
    if (rounded < 2) break;
    if (rounded * full <= (plan_holds ? 1 : kMostRounding) * wanted)
      level = l, together = static_cast<uint32_t>(full), subtrees = rounded;
  }
  leaves = static_cast<uint32_t>(subtrees) * together;
  children = static_cast<uint32_t>(subtrees);
  if (subtrees <= kMostFactor * factors.at(level)) return;
  double below = 1;  // subtrees of a child that is full itself
  while (below * factors.at(level) <= subtrees) below *= factors.at(level++);
  const double times = subtrees / below;  // 1 to the level's factor
  // Each child is left with 0.75 to 1.5 full ones.
  children = times < kMostFactor ? factors.at(level - 1) : static_cast<uint32_t>(std::max(2.0, std::floor(times)));
}

uint32_t LeafShares::leaves_of(uint32_t first, uint32_t last) const {
  uint32_t sum = 0;
  for (uint32_t child = first; child < last; ++child) sum += leaves_of(child);
  return sum;
}

}  // namespace promenade
