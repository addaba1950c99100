#pragma once
// The border of what is known of a mesh that grows triangle by triangle: edges with a triangle on one side, in loops.

#include <cstdint>
#include <vector>

namespace promenade {

/// An edge as its triangle goes around it, from one vertex to the next.
struct OpenEdge {
  uint32_t from = 0, to = 0;  ///< vertices
  uint32_t across = 0;        ///< the triangle's third
  uint32_t from_place = 0, to_place = 0;
  uint32_t before = 0;   ///< the edge that ends where this begins; GrownBorder::kNoEdge: none is known
  uint32_t next = 0;     ///< the edge that begins where this ends
  uint32_t is_open = 0;  ///< or 0
};

/// A stack of open edges; linked ones meet in a place. Edges that were closed below the top stay until they are there.
/// One thread.
class GrownBorder {
 public:
  /// An edge that is never open and ends nowhere, so that links need no question.
  static constexpr uint32_t kNoEdge = 0;
  /// Places where it does.
  static constexpr uint32_t kNoBegin = 0xfffffffdU, kNoEnd = 0xfffffffeU;

  GrownBorder() { clear(); }
  uint32_t size() const { return static_cast<uint32_t>(edges_.size()); }
  OpenEdge& operator[](uint32_t index) { return edges_[index]; }
  const OpenEdge& operator[](uint32_t index) const { return edges_[index]; }
  void clear() {
    OpenEdge none;
    none.from_place = kNoBegin, none.to_place = kNoEnd;
    edges_.assign(1, none);
  }
  /// before, next: may be of an edge that is added next. Where it lies.
  uint32_t add(const OpenEdge& edge) {
    edges_.push_back(edge);
    return size() - 1;
  }
  /// Takes the latest open edge; what is linked to it has to be linked anew. False: none is open.
  bool take(OpenEdge& edge) {
    while (edges_.size() > 1) {
      edge = edges_.back();
      edges_.pop_back();
      if (edge.is_open != 0) return true;
    }
    return false;
  }
  /// One ends where the other begins.
  void link(uint32_t before, uint32_t next) { edges_[before].next = next, edges_[next].before = before; }
  void close(uint32_t index) { edges_[index].is_open = 0; }

 private:
  std::vector<OpenEdge> edges_;
};

}  // namespace promenade
