#include "runtime/front.h"

#include <vector>

namespace promenade {
namespace {

void add(FrontSize& size, const NodeRecord& node) {
  ++size.nodes;
  size.triangles += node.triangles;
}

}  // namespace

FrontCount count_front(const Model& model, const Camera& camera, double pixel_error, ErrorKind kind) {
  const glm::vec3 eye(camera.pose.eye - model.manifest.origin);
  const Frustum frustum = frustum_of(camera, model.manifest.origin);
  const double per_radian = pixels_per_radian(camera);
  struct Visit {
    NodeId node;
    bool below_front;
  };
  std::vector<Visit> stack;
  for (const NodeId root : model.tables.roots) stack.push_back({root, false});
  FrontCount count;
  while (!stack.empty()) {
    const Visit at = stack.back();
    stack.pop_back();
    const NodeRecord& node = model.tables.nodes[index_of(at.node)];
    const bool in_view = classify(frustum, node.box) != Overlap::outside;
    const bool leaf = node.child_count == 0;
    const bool fine =
        leaf || screen_error_px(double(error_m(node, kind)), double(node.box.distance(eye)), per_radian) <= pixel_error;
    if (fine && !at.below_front) {
      add(count.front, node);
      if (in_view) add(count.front_in_view, node);
    }
    if (leaf) {
      add(count.leaves, node);
      if (in_view) add(count.leaves_in_view, node);
    }
    for (const NodeId child : model.children_of(at.node)) stack.push_back({child, at.below_front || fine});
  }
  return count;
}

}  // namespace promenade
