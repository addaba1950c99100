#pragma once
// The border of what is known of a mesh that grows triangle by triangle: edges with a triangle on one side, in loops.

#include <cstdint>
#include <vector>

namespace promenade {

/// An edge as its triangle goes around it, from one vertex to the next.
struct OpenEdge {
  uint32_t from = 0, to = 0;  ///< vertices
  uint32_t across = 0;        ///< the triangle's third
  uint32_t before = 0;        ///< the edge that ends where this begins; GrownBorder::kNone: none is known
  uint32_t next = 0;          ///< the edge that begins where this ends
  bool is_open = true;
};

/// A stack of open edges; linked ones meet in a place. Edges that were closed below the top stay until they are there.
/// One thread.
class GrownBorder {
 public:
  static constexpr uint32_t kNone = 0xffffffffU;

  uint32_t size() const { return static_cast<uint32_t>(edges_.size()); }
  OpenEdge& operator[](uint32_t index) { return edges_[index]; }
  const OpenEdge& operator[](uint32_t index) const { return edges_[index]; }
  void clear() { edges_.clear(); }
  /// Linked to nothing. Where it lies.
  uint32_t add(uint32_t from, uint32_t to, uint32_t across) {
    edges_.push_back({from, to, across, kNone, kNone, true});
    return size() - 1;
  }
  /// Takes the latest open edge; what is linked to it has to be linked anew. False: none is open.
  bool take(OpenEdge& edge) {
    while (!edges_.empty()) {
      edge = edges_.back();
      edges_.pop_back();
      if (edge.is_open) return true;
    }
    return false;
  }
  /// One ends where the other begins; either may be kNone.
  void link(uint32_t before, uint32_t next) {
    if (before != kNone) edges_[before].next = next;
    if (next != kNone) edges_[next].before = before;
  }
  void close(uint32_t index) { edges_[index].is_open = false; }

 private:
  std::vector<OpenEdge> edges_;
};

}  // namespace promenade
