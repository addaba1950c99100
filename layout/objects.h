#pragma once
// What a model knows of its source's objects: those that move by themselves, the classes of all, and what the solid
// ones fill.
//
// An object that moves has a tree of nodes of its own, whose root is one of the model's roots. Meshes of its nodes are
// in the object's own space; the boxes in the tables hold what they sweep, so that hiding and reading need not know of
// time.

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <string>
#include <vector>

#include "geometry/animation.h"
#include "geometry/box.h"
#include "geometry/node_id.h"
#include "layout/footprints.h"

namespace promenade {

/// An object that moves: what hangs on one joint.
struct MovingObject {
  uint32_t joint = 0;
  NodeId root = kNoNode;
  /// Lengthens nothing together with the joint's pose at any time: metres in an object's space are at least metres in
  /// the world, so that errors and sizes of its nodes are bounds.
  glm::dmat4 joint_from_object{1.0};
  bool operator==(const MovingObject&) const = default;
};

/// A node of such an object.
struct MovingNode {
  uint32_t object = 0;
  Box box;  ///< in the object's space; of its mesh and all its descendants'
  bool operator==(const MovingNode&) const = default;
};

/// How much of a leaf is of a class.
struct ClassShare {
  NodeId leaf = kNoNode;
  uint32_t class_index = 0;  ///< into ModelObjects::classes
  float area_m2 = 0;         ///< of the source's triangles
  bool operator==(const ClassShare&) const = default;
};

struct ModelObjects {
  Animation animation;
  std::vector<MovingObject> moving;
  std::vector<MovingNode> moving_nodes;  ///< the last nodes of the model, in their order
  std::vector<std::string> classes;      ///< as the source names them; without a name: ""
  std::vector<ClassShare> class_shares;  ///< ascending by leaf, then class
  Footprints footprints;
  bool empty() const { return moving.empty() && class_shares.empty() && footprints.empty(); }
  uint64_t byte_size() const;
};

}  // namespace promenade
