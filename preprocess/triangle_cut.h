#pragma once
// Cutting large triangles along a plane of the partition, so that the boxes of both sides stay tight.

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

/// The plane position[axis] == value. An edge that crosses it is cut when it is longer than min_edge_m.
struct CutPlane {
  int axis = 0;
  float value = 0;
  float min_edge_m = 0;
};

/// Cuts triangles of one mesh along one plane. Whether an edge is cut, and where, depends on its two ends only: two
/// triangles that share it stay together, also in different meshes. Attributes are interpolated, winding is kept. One
/// thread. Source: [lakhia2004] section 3.2.
class TriangleCutter {
 public:
  /// Both must outlive the cutter. The mesh grows.
  TriangleCutter(Mesh& mesh, const CutPlane& plane) : mesh_(&mesh), plane_(plane) {}

  /// Whether an edge of the triangle would be cut.
  bool crosses(uint32_t triangle) const;
  /// Cuts a triangle that crosses. Its first piece keeps its index, others are added at the mesh's end; each goes to
  /// the side on which its centroid lies.
  void cut(uint32_t triangle, std::vector<uint32_t>& below, std::vector<uint32_t>& above);

 private:
  bool cuts_edge(uint32_t a, uint32_t b) const;
  uint32_t point_on(uint32_t a, uint32_t b);
  void place(uint32_t triangle, std::vector<uint32_t>& below, std::vector<uint32_t>& above) const;

  Mesh* mesh_;
  CutPlane plane_;
  std::unordered_map<uint64_t, uint32_t> points_;  ///< vertex made for an edge
};

/// Coordinate of a triangle's centroid.
glm::vec3 centroid(const Mesh& mesh, uint32_t triangle);

/// Like submesh, in time that depends on the piece only. Vertices come in ascending order.
Mesh piece_of(const Mesh& mesh, std::span<const uint32_t> triangles);

}  // namespace promenade
