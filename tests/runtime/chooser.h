#pragma once
// A selection policy on a forest whose nodes are all resident, seen along x.

#include <vector>

#include "runtime/policy.h"
#include "tests/runtime/forest.h"
#include "tests/runtime/scenes.h"

namespace promenade::scenes {

/// In front of the camera, 10 m away, 16 m wide: seen whole (the view is 90 degrees).
const Box ahead_pose{{10, -8, -1}, {10.5F, 8, 1}};

struct Chooser {
  explicit Chooser(const forest::Forest& f) : source(f), resident(f.model().tables.nodes.size(), 1) {
    view.camera = looking_along_x();
  }
  const Selection& operator()() {
    select(source.model(), view, resident, options, state, selection);
    return selection;
  }
  void lack(NodeId id) { resident[index_of(id)] = 0; }

  const forest::Forest& source;
  std::vector<uint8_t> resident;
  SelectView view;
  SelectOptions options;
  SelectState state;
  Selection selection;
};

}  // namespace promenade::scenes
