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

  GrownBorder() : edges_(kMostAdded + 1) { edges_[kNoEdge].from_place = kNoBegin, edges_[kNoEdge].to_place = kNoEnd; }
  uint32_t size() const { return size_; }
  OpenEdge& operator[](uint32_t index) { return edges_[index]; }
  const OpenEdge& operator[](uint32_t index) const { return edges_[index]; }
  void clear() { size_ = 1; }
  /// To be called before a triangle adds its edges.
  void make_room() {
    if (edges_.size() - size_ < kMostAdded) edges_.resize(edges_.size() * 2);
  }
  /// Linked to nothing. Where it lies.
  [[gnu::always_inline]] uint32_t add(uint32_t from, uint32_t to, uint32_t across, uint32_t from_place,
                                      uint32_t to_place) {
    OpenEdge& edge = edges_[size_];
    edge.from = from, edge.to = to, edge.across = across;
    edge.from_place = from_place, edge.to_place = to_place;
    edge.before = edge.next = kNoEdge;
    edge.is_open = 1;
    return size_++;
  }
  /// Takes the latest open edge; what is linked to it has to be linked anew. False: none is open.
  [[gnu::always_inline]] bool take(OpenEdge& taken) {
    while (size_ > 1) {
      const OpenEdge& edge = edges_[--size_];
      if (edge.is_open == 0) continue;
      // One by one, as they were just written.
      taken.from = edge.from, taken.to = edge.to, taken.across = edge.across;
      taken.from_place = edge.from_place, taken.to_place = edge.to_place;
      taken.before = edge.before, taken.next = edge.next;
      return true;
    }
    return false;
  }
  /// One ends where the other begins.
  [[gnu::always_inline]] void link(uint32_t before, uint32_t next) {
    edges_[before].next = next, edges_[next].before = before;
  }
  void close(uint32_t index) { edges_[index].is_open = 0; }

 private:
  static constexpr size_t kMostAdded = 3;  // by a triangle
  std::vector<OpenEdge> edges_;            ///< with room for more
  uint32_t size_ = 1;
};

}  // namespace promenade
