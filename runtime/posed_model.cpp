#include "runtime/posed_model.h"

#include <glm/common.hpp>

namespace promenade {

PosedModel::PosedModel(const Model& source) : source_(source) {
  if (!moves()) return;
  posed_ = source;
  set_time(0);
}

void PosedModel::set_time(double time_s) {
  if (!moves()) return;
  const std::vector<glm::dmat4> matrices = model_from_objects(source_, time_s);
  matrices_.assign(matrices.begin(), matrices.end());
  const uint32_t first = source_.first_moving_node();
  for (uint32_t i = 0; i < source_.objects.moving_nodes.size(); ++i) {
    const MovingNode& node = source_.objects.moving_nodes[i];
    const DBox box = transformed_box(node.box, matrices[node.object]);
    // Within what it sweeps, but for rounding: the parts of a parent stay in its box.
    const Box& swept = source_.tables.nodes[first + i].box;
    posed_.tables.nodes[first + i].box = {glm::clamp(glm::vec3(box.min), swept.min, swept.max),
                                          glm::clamp(glm::vec3(box.max), swept.min, swept.max)};
  }
}

glm::mat4 PosedModel::matrix_of(NodeId id) const {
  if (!source_.is_moving(id)) return glm::mat4(1);
  return matrices_[source_.objects.moving_nodes[index_of(id) - source_.first_moving_node()].object];
}

uint64_t PosedModel::byte_size(const Model& source) {
  if (source.objects.moving.empty()) return 0;
  const ModelTables& t = source.tables;
  const auto bytes = [](const auto& v) { return uint64_t(v.size()) * sizeof(v[0]); };
  return bytes(t.nodes) + bytes(t.children) + bytes(t.roots) + bytes(t.materials) + bytes(t.textures) +
         bytes(t.node_textures) + bytes(t.segments) + source.objects.byte_size() +
         source.objects.moving.size() * sizeof(glm::mat4);
}

}  // namespace promenade
