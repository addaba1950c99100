#pragma once
// Fades between levels of detail: where a front goes on from a node to what is below it, or back, both are drawn for
// some frames, each at its part of the pixels of one pattern, so that a switch does not pop. Source: what
// [funkhouser1993] section 4.2.5 planned; the pattern instead of blending keeps depth exact and costs no sorting.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "layout/model.h"
#include "runtime/vlod_marks.h"

namespace promenade {

/// What to draw of a node: the pixels whose threshold is in [from, to). Meaning as in DrawItem.
struct FadedNode {
  NodeId node = kNoNode;
  float from = 0, to = 1;
  bool extra = false;  ///< not of the front: it goes
};

/// Follows fronts from frame to frame. One thread. At every pixel of a fade exactly one side is drawn; a side that is
/// not resident any more, or does not cover all that is in view, ends its fade at once: never a hole.
class Fades {
 public:
  /// model must outlive it.
  explicit Fades(const Model& model);

  /// What to draw for this front, in its order, then what goes. frames: how long a fade takes; 0: no fades. vlod: null:
  /// all may be seen. All of the front is resident.
  void follow(std::span<const NodeId> front, std::span<const uint8_t> resident, const Frustum& frustum,
              const VlodMarks* vlod, uint32_t frames, std::vector<FadedNode>& items);

  size_t running() const { return fades_.size(); }
  uint64_t byte_size() const { return place_.capacity() * sizeof(Place) + last_front_.capacity() * sizeof(NodeId); }

 private:
  struct Place {
    uint32_t now = 0, before = 0;  ///< frame in which it was in the front last, and the one before that
  };
  /// Between a node and the front's nodes, or last ones, below it.
  struct Fade {
    float top_share = 1;        ///< of the pixels
    bool to_top = false;        ///< the node comes, else what is below it
    std::vector<NodeId> below;  ///< to_top: what goes
    bool in_view = false;       ///< met in this frame
  };
  bool in_front(NodeId id) const { return place_[index_of(id)].now == frame_; }
  bool was_in_front(NodeId id) const;
  NodeId parent_of(NodeId id) const { return model_.tables.nodes[index_of(id)].parent; }
  NodeId fading_top_of(NodeId id) const;
  void begin_new(std::span<const NodeId> front);
  void step(std::span<const uint8_t> resident, const Frustum& frustum, const VlodMarks* vlod, uint32_t frames);
  bool covers(NodeId top, const std::vector<NodeId>& below, const Frustum& frustum, const VlodMarks* vlod) const;

  const Model& model_;
  std::vector<Place> place_;
  std::vector<NodeId> last_front_;
  std::map<NodeId, Fade> fades_;  ///< by the upper node; none is above another
  uint32_t frame_ = 0;
};

}  // namespace promenade
