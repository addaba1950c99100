#pragma once
// A piece of the world as columns: on a fine grid seen from above, which heights are touched by a surface, which are
// free, and which free heights the open air cannot reach. What it cannot reach, below a surface that faces up, is
// solid: nobody sees through it.
//
// Only opaque surfaces count. Gaps narrower than a column (or lower than kSealedGapM) are taken for closed.

#include <deque>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

struct ColumnGrid {
  glm::dvec2 low{0};      ///< corner, metres, model space
  double column_m = 0.1;  ///< side of a column
  uint32_t nx = 0, ny = 0;
  size_t count() const { return size_t(nx) * ny; }
};

/// Per column, x fastest.
struct SolidColumns {
  std::vector<float> base_m;  ///< solid from here (-infinity: all the way down) ...
  std::vector<float> top_m;   ///< ... up to here; -infinity: nowhere solid
  /// Where air can slip in below the lowest sheet of the ground, and how high that gap reaches: only rays that come
  /// into this column that way, below that height, may go under the ground.
  struct Slip {
    uint32_t column;
    float top_m;
    uint8_t way;  ///< 0 to 3: towards +x, -x, +y, -y
  };
  std::vector<Slip> slips;
  /// All solid heights of each column, from below, between the surfaces that bound them.
  struct Span {
    uint32_t column;
    float base_m, top_m;
  };
  std::vector<Span> spans;
};

/// What becomes of gaps that lead under the ground.
enum class SlipRule : uint8_t {
  remember,  ///< closed, and listed as slips: for who knows that rays get there only from above
  open,      ///< air gets in, over the grid's border, too, and into all that is open from below
};

/// Gathers surfaces, then says what is solid. One thread.
class ColumnBuilder {
 public:
  static constexpr float kSealedGapM = 0.004F;

  explicit ColumnBuilder(const ColumnGrid& grid);
  /// Model space. Triangles whose material is not opaque are left out.
  void add(const Mesh& mesh, std::span<const Material> materials);
  /// Air may come in over the grid's border. Ends the builder's life.
  SolidColumns finish(SlipRule rule = SlipRule::remember);

 private:
  /// A surface within a column, packed: a tile of a dense city has tens of millions.
  struct Touch {
    uint32_t column_and_facing;  ///< four times the column within its band, and the facing and one
    float low, high;
    uint32_t column() const { return column_and_facing / 4; }
    /// 1 the column's middle lies under a surface that faces up, -1 down, 0 beside it
    int32_t facing() const { return static_cast<int32_t>(column_and_facing % 4) - 1; }
  };
  /// Rows of columns that are sorted at once; a deque, for it never moves what it holds, nor keeps twice the room.
  using Band = std::deque<Touch>;

  void add_triangle(const glm::vec3 (&corners)[3]);
  void touch(uint32_t x, uint32_t y, double low, double high, int32_t facing);
  std::vector<Touch> by_column(const Band& band, std::vector<size_t>& begin) const;

  ColumnGrid grid_;
  std::vector<Band> bands_;
};

}  // namespace promenade
