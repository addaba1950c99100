#include "layout/model.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <initializer_list>

namespace promenade {
namespace {

constexpr float kUnitTolerance = 1e-3F;

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool is_unit(const glm::vec3& v) { return finite(v) && std::abs(glm::length(v) - 1) <= kUnitTolerance; }

/// Whether [first, first + count) lies in a table of `size` entries, without overflow.
bool in_range(uint64_t first, uint64_t count, size_t size) { return first <= size && count <= size - first; }

std::string find_file_defect(const ModelManifest& manifest) {
  if (manifest.files.empty() || manifest.files.back().name != "tables.bin")
    return "the last of the files is not tables.bin";
  for (size_t i = 0; i < manifest.files.size(); ++i) {
    const std::string& name = manifest.files[i].name;
    if (name.empty() || name[0] == '.' || name.find('/') != std::string::npos)
      return fmt::format("file {}: \"{}\" is no name of a data file", i, name);
    for (size_t j = 0; j < i; ++j)
      if (manifest.files[j].name == name) return fmt::format("file {}: \"{}\" is named twice", i, name);
  }
  return {};
}

std::string find_segment_defect(const Model& model) {
  const std::vector<SegmentRecord>& segments = model.tables.segments;
  for (size_t i = 0; i < segments.size(); ++i) {
    const SegmentRecord& s = segments[i];
    if (s.type != SegmentRecord::Type::mesh && s.type != SegmentRecord::Type::texture)
      return fmt::format("segment {}: unknown type {}", i, static_cast<int>(s.type));
    if (size_t(s.file) + 1 >= model.manifest.files.size())
      return fmt::format("segment {}: file {} is none of the data files", i, s.file);
    const ModelManifest::File& file = model.manifest.files[s.file];
    if (s.offset > file.bytes || s.stored_bytes > file.bytes - s.offset)
      return fmt::format("segment {}: {} bytes @{:#x} reach beyond the {} bytes of {}", i, s.stored_bytes, s.offset,
                         file.bytes, file.name);
  }
  return {};
}

/// Whether a segment exists and is of the type.
bool is_segment(const ModelTables& tables, uint32_t segment, SegmentRecord::Type type) {
  return segment < tables.segments.size() && tables.segments[segment].type == type;
}

std::string find_texture_defect(const ModelTables& tables) {
  for (size_t i = 0; i < tables.textures.size(); ++i) {
    const TextureRecord& t = tables.textures[i];
    if (t.width == 0 || t.height == 0) return fmt::format("texture {}: {} x {} pixels", i, t.width, t.height);
    if (!is_segment(tables, t.segment, SegmentRecord::Type::texture))
      return fmt::format("texture {}: segment {} is no texture", i, t.segment);
    if ((t.flags & ~(TextureRecord::kHasOpacity | TextureRecord::kAtlas)) != 0)
      return fmt::format("texture {}: unknown flags {:#x}", i, t.flags);
  }
  for (size_t i = 0; i < tables.node_textures.size(); ++i)
    if (tables.node_textures[i] >= tables.textures.size())
      return fmt::format("node texture {}: {} of {} textures", i, tables.node_textures[i], tables.textures.size());
  return {};
}

std::string find_material_defect(const ModelTables& tables) {
  if (tables.materials.empty()) return "no materials";
  for (size_t i = 0; i < tables.materials.size(); ++i) {
    const Material& m = tables.materials[i];
    if (m.texture != kNoTexture && m.texture >= tables.textures.size())
      return fmt::format("material {}: texture {} of {}", i, m.texture, tables.textures.size());
    if (m.wrap_u > Wrap::clamp || m.wrap_v > Wrap::clamp || m.alpha > AlphaMode::blend)
      return fmt::format("material {}: unknown wrap or alpha mode", i);
  }
  return {};
}

std::string find_number_defect(const NodeRecord& n) {
  if (!finite(n.box.min) || !finite(n.box.max) || n.box.empty()) return "box is empty or not finite";
  if (!std::isfinite(n.error_m) || n.error_m < 0) return fmt::format("error of {} m", n.error_m);
  if (!(n.error_p99_m >= 0 && n.error_p99_m <= n.error_m))
    return fmt::format("99th percentile of error {} m, error {} m", n.error_p99_m, n.error_m);
  if (!is_unit(n.cone.axis) || !(n.cone.cos_angle >= -1 && n.cone.cos_angle <= 1))
    return fmt::format("normal cone with cos {} or an axis that is no unit vector", n.cone.cos_angle);
  if (!is_unit(n.average_normal) && n.average_normal != glm::vec3(0)) return "average normal is neither unit nor 0";
  if (!std::isfinite(n.surface_m2) || n.surface_m2 < 0) return fmt::format("surface of {} m2", n.surface_m2);
  return {};
}

std::string find_range_defect(const ModelTables& tables, const NodeRecord& n) {
  if (!in_range(n.first_child, n.child_count, tables.children.size()))
    return fmt::format("children {} + {} of {}", n.first_child, n.child_count, tables.children.size());
  if (!in_range(n.first_texture, n.texture_count, tables.node_textures.size()))
    return fmt::format("textures {} + {} of {}", n.first_texture, n.texture_count, tables.node_textures.size());
  if (!is_segment(tables, n.segment, SegmentRecord::Type::mesh)) return fmt::format("segment {} is no mesh", n.segment);
  if (n.textured_triangles > n.triangles)
    return fmt::format("{} of {} triangles textured", n.textured_triangles, n.triangles);
  return {};
}

/// Empty when the child at `place` of the table may hang below the node.
std::string find_child_defect(const ModelTables& tables, uint32_t parent_index, NodeId child_id) {
  const NodeRecord& parent = tables.nodes[parent_index];
  if (index_of(child_id) >= tables.nodes.size())
    return fmt::format("child {} of {} nodes", index_of(child_id), tables.nodes.size());
  const NodeRecord& child = tables.nodes[index_of(child_id)];
  if (index_of(child.parent) != parent_index)
    return fmt::format("child {} has parent {}", index_of(child_id), index_of(child.parent));
  if (child.level != parent.level + 1)
    return fmt::format("child {} has level {}, not {}", index_of(child_id), child.level, parent.level + 1);
  if (!parent.box.contains(child.box)) return fmt::format("box does not contain that of child {}", index_of(child_id));
  if (child.error_m > parent.error_m)
    return fmt::format("error {} m is below the {} m of child {}", parent.error_m, child.error_m, index_of(child_id));
  return {};
}

/// Walks from the roots: every node must be met exactly once. With levels that grow by one, that excludes cycles.
std::string find_tree_defect(const ModelTables& tables) {
  std::vector<bool> met(tables.nodes.size());
  std::vector<uint32_t> open;
  const auto meet = [&](NodeId id) {
    if (met[index_of(id)]) return false;
    met[index_of(id)] = true;
    open.push_back(index_of(id));
    return true;
  };
  for (const NodeId root : tables.roots) {
    if (index_of(root) >= tables.nodes.size())
      return fmt::format("root {} of {} nodes", index_of(root), tables.nodes.size());
    const NodeRecord& node = tables.nodes[index_of(root)];
    if (node.parent != kNoNode || node.level != 0)
      return fmt::format("root {} has parent {} and level {}", index_of(root), index_of(node.parent), node.level);
    if (!meet(root)) return fmt::format("root {} is named twice", index_of(root));
  }
  size_t count = tables.roots.size();
  while (!open.empty()) {
    const uint32_t index = open.back();
    open.pop_back();
    const NodeRecord& node = tables.nodes[index];
    for (uint32_t i = 0; i < node.child_count; ++i, ++count) {
      const NodeId child = tables.children[node.first_child + i];
      if (std::string defect = find_child_defect(tables, index, child); !defect.empty())
        return fmt::format("node {}: {}", index, defect);
      if (!meet(child)) return fmt::format("node {}: child {} is met twice", index, index_of(child));
    }
  }
  if (count != tables.nodes.size())
    return fmt::format("{} of {} nodes hang below the roots", count, tables.nodes.size());
  return {};
}

/// Objects that move have the last nodes, each its own tree.
std::string find_moving_defect(const Model& model) {
  const ModelObjects& objects = model.objects;
  const size_t nodes = model.tables.nodes.size();
  if (objects.moving_nodes.size() > nodes)
    return fmt::format("{} of {} nodes move", objects.moving_nodes.size(), nodes);
  const size_t first = nodes - objects.moving_nodes.size();
  for (size_t i = 0; i < objects.moving.size(); ++i) {
    const MovingObject& object = objects.moving[i];
    if (object.joint >= objects.animation.joints.size())
      return fmt::format("moving object {}: joint {} of {}", i, object.joint, objects.animation.joints.size());
    for (int k = 0; k < 4; ++k)
      if (!finite(glm::vec3(object.joint_from_object[k]))) return fmt::format("moving object {}: not finite", i);
    if (index_of(object.root) < first || index_of(object.root) >= nodes ||
        objects.moving_nodes[index_of(object.root) - first].object != i ||
        model.tables.nodes[index_of(object.root)].parent != kNoNode)
      return fmt::format("moving object {}: {} is no root of it", i, index_of(object.root));
  }
  for (size_t i = 0; i < objects.moving_nodes.size(); ++i) {
    const MovingNode& node = objects.moving_nodes[i];
    if (node.object >= objects.moving.size() || !finite(node.box.min) || !finite(node.box.max) || node.box.empty())
      return fmt::format("node {}: of moving object {} of {}, or without a box", first + i, node.object,
                         objects.moving.size());
  }
  for (size_t i = 0; i < nodes; ++i) {
    const NodeId parent = model.tables.nodes[i].parent;
    if (parent == kNoNode) continue;
    const bool moves = i >= first, parent_moves = index_of(parent) >= first;
    if (moves != parent_moves ||
        (moves && objects.moving_nodes[i - first].object != objects.moving_nodes[index_of(parent) - first].object))
      return fmt::format("node {}: its parent moves otherwise", i);
  }
  return {};
}

std::string find_class_defect(const Model& model) {
  for (const ClassShare& share : model.objects.class_shares)
    if (index_of(share.leaf) >= model.tables.nodes.size() || share.class_index >= model.objects.classes.size() ||
        !std::isfinite(share.area_m2) || share.area_m2 < 0)
      return fmt::format("class {} of {} in node {}: {} m2", share.class_index, model.objects.classes.size(),
                         index_of(share.leaf), share.area_m2);
  return {};
}

}  // namespace

std::vector<glm::dmat4> model_from_objects(const Model& model, double time_s) {
  const std::vector<glm::dmat4> poses = poses_at(model.objects.animation, time_s);
  const glm::dmat4 model_from_world = glm::translate(glm::dmat4(1), -model.manifest.origin);
  std::vector<glm::dmat4> matrices;
  matrices.reserve(model.objects.moving.size());
  for (const MovingObject& object : model.objects.moving)
    matrices.push_back(model_from_world * poses[object.joint] * object.joint_from_object);
  return matrices;
}

std::string find_defect(const Model& model) {
  const ModelTables& tables = model.tables;
  if (tables.nodes.empty()) return "no nodes";
  if (tables.nodes.size() >= index_of(kNoNode)) return fmt::format("{} nodes are too many", tables.nodes.size());
  for (std::string defect : {find_file_defect(model.manifest), find_segment_defect(model), find_texture_defect(tables),
                             find_material_defect(tables)})
    if (!defect.empty()) return defect;
  for (size_t i = 0; i < tables.nodes.size(); ++i) {
    std::string defect = find_number_defect(tables.nodes[i]);
    if (defect.empty()) defect = find_range_defect(tables, tables.nodes[i]);
    if (!defect.empty()) return fmt::format("node {}: {}", i, defect);
  }
  for (std::string defect : {find_tree_defect(tables), find_defect(model.objects.animation), find_moving_defect(model),
                             find_class_defect(model), model.objects.footprints.defect()})
    if (!defect.empty()) return defect;
  return {};
}

}  // namespace promenade
