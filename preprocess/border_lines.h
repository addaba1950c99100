#pragma once
// The borders of a work mesh while its places collapse.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "preprocess/border.h"
#include "preprocess/work_mesh.h"

namespace promenade {

/// Chains of border edges. A place in a chain may go along it, and what it leaves behind is kept, with what it had
/// passed by before. Ends of chains and places where several meet have no way along.
class BorderLines {
 public:
  BorderLines() = default;
  /// work: made from the mesh whose border that is, nothing collapsed yet.
  BorderLines(const WorkMesh& work, const Border& border);

  bool has(uint32_t place) const { return place < role_.size() && role_[place] != Role::none; }
  bool is_edge(uint32_t a, uint32_t b) const;
  /// The places that this one may go to; none at ends and where several meet.
  std::optional<std::array<uint32_t, 2>> ways(uint32_t place) const;
  /// How far what the border would pass by without a place, on it and beside it, would be from the border: at least
  /// this, where it is over the limit.
  float deviation_m(uint32_t place, float limit_m) const;

  /// A place has gone to one of its ways.
  void shorten(uint32_t place);
  /// A place has gone elsewhere: its edges are borders no more.
  void leave(uint32_t place);

  /// The border of finish(work).
  Border border(const WorkMesh& work) const;
  size_t edge_count() const { return edges_.size(); }

 private:
  static constexpr uint32_t kNone = 0xffffffffU;
  enum class Role : uint8_t { none, passed, held };
  struct Edge {
    uint32_t from, to;
    uint32_t first = kNone, last = kNone;  ///< of points_
    bool alive = true;
  };
  void append(Edge& edge, uint32_t first, uint32_t last);
  void hold(uint32_t place) { role_[place] = Role::held; }

  const WorkMesh* work_ = nullptr;
  std::vector<Edge> edges_;
  std::vector<glm::vec3> points_;     ///< passed by, in the model
  std::vector<uint32_t> next_point_;  ///< along the edge
  std::vector<Role> role_;            ///< of each place
  std::vector<uint32_t> in_, out_;    ///< edges of each place
};

}  // namespace promenade
