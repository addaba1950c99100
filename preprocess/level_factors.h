#pragma once
// About how many children nodes have, level by level, and how leaves are shared out to them.

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace promenade {

/// By level from just above the leaves up; the last holds for all levels above it, too. Small ones make small steps
/// between levels: smaller fronts, larger models.
class LevelFactors {
 public:
  /// Measured on a city of five million triangles (FIGURES.md): a first factor of 4 makes fronts 10 % larger and the
  /// model 9 % smaller, one of 2 leaves them as they are and the model 19 % larger; 2 at all levels hardly changes
  /// either.
  LevelFactors() : LevelFactors({3, 2, 2, 3}) {}
  /// Numbers with commas between; nullopt where they are not.
  static std::optional<LevelFactors> named(const std::string& text);
  /// At least one; each at least 2.
  LevelFactors(std::initializer_list<uint32_t> factors) : factors_(factors) {}
  explicit LevelFactors(std::vector<uint32_t> factors) : factors_(std::move(factors)) {}

  /// level: 0 just above the leaves.
  uint32_t at(uint32_t level) const;
  uint32_t largest() const;
  /// Of levels above nodes with about so many leaves.
  LevelFactors above(double leaves) const;
  const std::vector<uint32_t>& list() const { return factors_; }
  std::string name() const;

 private:
  std::vector<uint32_t> factors_;
};

/// How `leaves` leaves are shared out to the children of one node: in full subtrees, with as many children at each
/// level as its factor says, as large as there are a few of; no child gets more than one of these more than another.
/// So what a level is coarser than the one below hardly depends on how many triangles there are. All but the last of
/// the factors are kept so; at higher levels nodes have two thirds to one and a half of the last one, those nearest to
/// the root may have fewer: so the inner nodes, all of one size, are few.
struct LeafShares {
  uint32_t leaves = 1;
  uint32_t children = 1;
  uint32_t together = 1;  ///< leaves of a full subtree that is not divided here

  /// planned: leaves that the triangles were meant for when they were divided; kept while the leaves' limit holds, as
  /// cutting adds triangles to each. 0: none were.
  LeafShares(uint64_t triangles, uint32_t leaf_triangles, const LevelFactors& factors, uint32_t planned = 0);
  uint32_t leaves_of(uint32_t child) const {
    const uint32_t subtrees = leaves / together;
    return (subtrees / children + (child < subtrees % children ? 1U : 0U)) * together;
  }
  /// Leaves of the children [first, last).
  uint32_t leaves_of(uint32_t first, uint32_t last) const;
};

}  // namespace promenade
