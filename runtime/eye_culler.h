#pragma once
// What one eye cannot see of what its cell sees: eye-to-cell and eye-to-object, [funkhouser1993] section 4.1.3 and
// 4.1.4.
//
// From a point, all that is seen through axial openings is told by rectangles on the sides of a cube around the eye.
// For each side regions are gone through front to back, as the cells' tree has them, so that all rectangles by which a
// region is reached are known when its turn comes, and open plans take no longer than closed ones. A node is left out
// when on no side, and in no region that its box reaches into, the box's rectangle there meets one by which the region
// is reached.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "layout/model.h"
#include "layout/openings.h"

namespace promenade {

/// One thread at a time.
class EyeCuller {
 public:
  /// Both must outlive it.
  EyeCuller(const Model& model, const Openings& openings);

  /// Those of the nodes of which something may be seen from the eye (metres, model space), whatever it looks at, in
  /// their order. nodes: no finer, and no coarser, than the front of the eye's cell: openings are as much larger as
  /// what is drawn of their walls may be off. An eye outside all regions sees them all. Valid until the next call.
  std::span<const NodeId> seen(const glm::dvec3& eye, std::span<const NodeId> nodes);

  uint32_t regions_reached() const { return reached_; }  ///< by the last call
  uint64_t byte_size() const;

 private:
  /// On a side of the cube: along the two axes after the side's own, as parts of the distance along it.
  struct Rectangle {
    double low_u = -1, high_u = 1, low_v = -1, high_v = 1;
    bool meets(const Rectangle& r) const {
      return low_u <= r.high_u && r.low_u <= high_u && low_v <= r.high_v && r.low_v <= high_v;
    }
  };
  /// More become one: what lies between them counts as seen, too.
  struct Arrived {
    static constexpr uint32_t kMost = 3;
    std::array<Rectangle, kMost> parts;
    uint32_t count = 0;
  };

  void list_regions_of_nodes();
  void find_start();
  void look(int axis, double sign);
  void pass();
  void leave(uint32_t region);
  void forget_side();
  void arrive(uint32_t region, const Rectangle& rectangle);
  bool reaches(NodeId node) const;
  bool project(const DBox& box, Rectangle& into) const;
  double growth_m(const Box& face) const;

  const Model& model_;
  const Openings& openings_;
  std::vector<uint32_t> parent_;         ///< by node of the regions' tree
  std::vector<uint32_t> leaf_;           ///< by region: its node in the tree
  std::vector<uint32_t> waiting_;        ///< by node of the tree: reached regions in it
  std::vector<Arrived> arrived_;         ///< by region, on the side in work
  std::vector<uint32_t> touched_;        ///< regions that were reached on it
  std::vector<uint32_t> counted_;        ///< by region: the last call that reached it
  std::vector<uint32_t> start_;          ///< regions that the eye is in
  std::vector<uint32_t> node_regions_;   ///< regions that nodes' boxes reach into
  std::vector<uint32_t> first_of_node_;  ///< by node, and the end: into node_regions_; none: it is never left out
  std::vector<uint8_t> is_seen_;         ///< by place in the question
  std::vector<NodeId> seen_;
  std::vector<uint32_t> open_;  ///< tree nodes on the way; scratch
  glm::dvec3 eye_{0};
  int axis_ = 0;
  double sign_ = 1;
  uint32_t reached_ = 0, call_ = 0;
};

}  // namespace promenade
