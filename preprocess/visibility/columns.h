#pragma once
// A piece of the world as columns: on a fine grid seen from above, which heights are touched by a surface, which are
// free, and which free heights the open air cannot reach. What it cannot reach, below a surface that faces up, is
// solid: nobody sees through it.
//
// Only opaque surfaces count. Gaps narrower than a column (or lower than kSealedGapM) are taken for closed.

#include <array>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/paged_array.h"

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
  /// All solid heights of each column, from below, between the surfaces that bound them; if asked for.
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

struct ColumnOptions {
  SlipRule rule = SlipRule::remember;
  bool spans = false;  ///< SolidColumns::spans, which take more than all the rest of it
  /// Most that surfaces and columns may take, bytes, about; nullopt: whatever they do
  std::optional<uint64_t> most_bytes;
  size_t most_triangles = size_t(1) << 18;  ///< held at once: more than a tile of a city has
};

/// Gathers surfaces, then says what is solid. Takes memory for the triangles that it was given last, and otherwise in
/// proportion to the columns and what is free in each. One thread.
class ColumnBuilder {
 public:
  static constexpr float kSealedGapM = 0.004F;

  explicit ColumnBuilder(const ColumnGrid& grid, const ColumnOptions& options = {});
  /// Model space. Triangles whose material is not opaque are left out.
  void add(const Mesh& mesh, std::span<const Material> materials);
  /// Air may come in over the grid's border. Nullopt: it takes too much. Ends the builder's life.
  std::optional<SolidColumns> finish();

 private:
  using Triangle = std::array<glm::vec3, 3>;
  /// A surface within a column, or several that touch each other.
  struct Touch {
    uint32_t column;  ///< within its band
    int32_t facing;   ///< sum of 1 the column's middle lies under a surface that faces up, -1 down, 0 beside it
    float low, high;
  };
  using Touches = PagedArray<Touch>;
  /// Rows of columns that are worked through at once: only theirs stand side by side, surface by surface.
  struct Band {
    std::vector<uint32_t> triangles;  ///< that reach into it, of those held
    Touches touches;                  ///< of triangles that are held no more
    size_t touches_joined = 0;        ///< how many were left when they were last joined
  };

  void add_triangle(const Triangle& triangle);
  void touch(size_t band, const Triangle& triangle, Touches& touches) const;
  void touch_all(size_t number);
  void sort_by_column(const Touches& touches);
  /// Calls visit(low, high, facing) for the surfaces of a column that hang together, from below.
  template <class Visit>
  void for_each_joined(std::span<const Touch> column, const Visit& visit) const;
  void join(Band& band);
  void settle();
  bool is_too_much(size_t touches, size_t runs) const;

  ColumnGrid grid_;
  ColumnOptions options_;
  std::vector<Triangle> triangles_;
  std::vector<Band> bands_;
  bool too_much_ = false;
  // Of the band in work:
  Touches sorted_;             ///< by column, then by height
  std::vector<size_t> begin_;  ///< of each column in it, and the end
};

}  // namespace promenade
