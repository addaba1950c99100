#pragma once
// The border of what is known of a mesh that grows triangle by triangle: edges with a triangle on one side.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace promenade {

/// An edge as its triangle goes around it, from one vertex to the next.
struct OpenEdge {
  uint32_t from = 0, to = 0;  ///< vertices
  uint32_t across = 0;        ///< the triangle's third
};

/// Edges by the places that they begin and end at. One thread.
class OpenEdges {
 public:
  static constexpr uint32_t kNone = 0xffffffffU;

  /// place_of: each vertex' place; outlives this and grows with the mesh.
  explicit OpenEdges(const std::vector<uint32_t>& place_of) : place_of_(place_of) {}
  void add_place() { first_from_.push_back(kNone), first_to_.push_back(kNone); }
  /// Adds an edge whose other side is not known.
  void add(const OpenEdge& edge);
  /// Adds an edge, or closes the one that runs between the same places the other way: of the latest few from there.
  void add_or_close(const OpenEdge& edge);
  /// Takes the latest edge that is open. False: there is none.
  bool take(OpenEdge& edge);
  /// The latest edge from, to a place; kNone: none is open.
  uint32_t latest_from(uint32_t place) { return latest(first_from_[place], &Entry::next_from); }
  uint32_t latest_to(uint32_t place) { return latest(first_to_[place], &Entry::next_to); }
  const OpenEdge& operator[](uint32_t index) const { return entries_[index].edge; }
  void close(uint32_t index) { entries_[index].is_open = false; }
  void close_all();

 private:
  struct Entry {
    OpenEdge edge;
    uint32_t next_from, next_to;  ///< earlier edges from, to the same place
    bool is_open = true;
  };
  uint32_t latest(uint32_t& first, uint32_t Entry::*next);
  bool close_between(uint32_t from, uint32_t to);

  const std::vector<uint32_t>& place_of_;
  std::vector<Entry> entries_;
  std::vector<uint32_t> first_from_, first_to_;  ///< by place
  std::vector<uint32_t> stack_;                  ///< entries, closed ones among them
};

}  // namespace promenade
