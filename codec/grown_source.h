#pragma once
// The mesh that an encoder lets grow again: which of its triangles lie where.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/quantized_mesh.h"

namespace promenade {

/// Vertices and places are the source's here, unless they are said to be grown. A place is where vertices lie: those
/// with one position have one. One thread.
class GrownSource {
 public:
  using Corners = std::array<uint32_t, 3>;  ///< vertices
  static constexpr uint32_t kNone = 0xffffffffU;

  /// mesh: outlives this.
  explicit GrownSource(const QuantizedMesh& mesh);
  /// From now on only the triangles of this run.
  void begin_run(size_t first, size_t count) { first_ = first, end_ = first + count, next_ = first; }
  /// The next triangle of the run that has not grown, a corner first that is known where one is.
  Corners next_triangle();
  /// A triangle of the run beyond the edge of a grown one, from its begin to its end: its corners at the edge's end,
  /// its begin, and the third. False: there is none.
  bool beyond(uint32_t grown_from, uint32_t grown_to, Corners& corners);

  /// kNone: not grown yet.
  uint32_t grown_place(uint32_t vertex) const { return grown_place_[place_of_[vertex]]; }
  uint32_t grown_vertex(uint32_t vertex) const { return grown_vertex_[vertex]; }
  void grow_place(uint32_t vertex);
  void grow_vertex(uint32_t vertex);
  /// Of grown vertices, of grown places: a vertex of the source.
  const std::vector<uint32_t>& vertex_sources() const { return vertex_sources_; }
  const std::vector<uint32_t>& place_sources() const { return place_sources_; }

 private:
  static uint32_t after(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
  uint32_t place_at(uint32_t corner) const { return place_of_[mesh_.indices[corner]]; }
  size_t slot_of(uint32_t from, uint32_t to) const;
  void find_places();
  void link_edges();

  const QuantizedMesh& mesh_;
  uint32_t places_ = 0;
  std::vector<uint32_t> place_of_;
  std::vector<uint32_t> edges_, next_same_;  ///< corners that edges begin at: the first by hash, and the next
  std::vector<uint32_t> grown_place_, grown_vertex_, vertex_sources_, place_sources_;
  std::vector<uint8_t> is_grown_;
  size_t first_ = 0, end_ = 0, next_ = 0;
};

}  // namespace promenade
