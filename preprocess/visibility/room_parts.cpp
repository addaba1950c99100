#include "preprocess/visibility/room_parts.h"

#include <array>
#include <cmath>
#include <map>

#include "preprocess/visibility/leaf_meshes.h"

namespace promenade {
namespace {

constexpr float kPartM = 3;  // what lies in one room is told apart by squares of space of this size

/// A room and a cube of space; and which way it is faced.
struct PartKey {
  uint32_t room;
  int32_t x, y, z;
  Facing facing;
  auto operator<=>(const PartKey&) const = default;
};
using NodeParts = std::map<PartKey, Box>;

/// Whether nobody in a room is before a triangle: a wall's surface bounds the room before it and the inside of the
/// wall, which it shows its back. Surfaces in the room's plane count, too: what is before them there is the next
/// room's, which the triangle is near enough to be in.
bool shows_its_back(const glm::vec3& normal, const std::array<glm::vec3, 3>& triangle, const Box& room) {
  constexpr float kBeforeM = Rooms::kSlackM - 1e-5F;
  if (normal == glm::vec3(0)) return false;
  glm::vec3 before;  // the room's corner that is farthest before it
  for (int axis = 0; axis < 3; ++axis) before[axis] = normal[axis] > 0 ? room.max[axis] : room.min[axis];
  return glm::dot(glm::dvec3(normal), glm::dvec3(before) - glm::dvec3(triangle[0])) <= double(kBeforeM);
}

/// Bounds of the part of a triangle within a box; empty where there is none.
Box clipped(const std::array<glm::vec3, 3>& triangle, const Box& box) {
  std::array<glm::vec3, 10> polygon, kept;  // each of six planes adds one corner at most
  size_t count = 3;
  std::copy(triangle.begin(), triangle.end(), polygon.begin());
  for (int plane = 0; plane < 6; ++plane) {
    const int axis = plane / 2;
    const float sign = plane % 2 == 0 ? 1.0F : -1.0F, at = plane % 2 == 0 ? box.max[axis] : box.min[axis];
    size_t left = 0;
    for (size_t i = 0; i < count; ++i) {
      const glm::vec3 &a = polygon[i], &b = polygon[i + 1 == count ? 0 : i + 1];
      const float out_a = sign * (a[axis] - at), out_b = sign * (b[axis] - at);
      if (out_a <= 0) kept[left++] = a;
      if ((out_a <= 0) != (out_b <= 0)) {
        kept[left] = a + (b - a) * (out_a / (out_a - out_b));
        kept[left++][axis] = at;
      }
    }
    count = left;
    std::copy_n(kept.begin(), count, polygon.begin());
  }
  Box bounds;
  for (size_t i = 0; i < count; ++i) bounds.add(polygon[i]);
  return bounds;
}

class NodePlacer {
 public:
  NodePlacer(const Model& model, const Rooms& rooms, NodeId id)
      : rooms_(rooms), materials_(model.tables.materials), model_(model) {
    const NodeRecord& node = model_.tables.nodes[index_of(id)];
    reach_m_ = Rooms::kSlackM + (node.child_count == 0 ? 0 : node.error_m);
  }

  /// What moves is in every room that it sweeps.
  NodeParts run_swept(const Box& swept) {
    for_each_room(rooms_, swept.grown(reach_m_), [&](uint32_t room) {
      const Box near = rooms_.space.cells[room].box.grown(reach_m_);
      const Box inside{glm::max(near.min, swept.min), glm::min(near.max, swept.max)};
      if (!inside.empty()) parts_[{room, 0, 0, 0, Facing()}].add(inside);
    });
    return std::move(parts_);
  }

  NodeParts run(const Mesh& mesh) {
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
      std::array<glm::vec3, 3> p;
      for (size_t k = 0; k < 3; ++k) p[k] = mesh.positions[mesh.indices[3 * t + k]];
      const glm::vec3 cross = triangle_cross(mesh, t);
      const float length = glm::length(cross);
      const bool one_sided = !materials_[mesh.material_of(t)].two_sided;
      place(p, one_sided && length > 0 ? cross / length : glm::vec3(0));
    }
    return std::move(parts_);
  }

 private:
  void place(const std::array<glm::vec3, 3>& p, const glm::vec3& normal) {
    Box around;
    for (const glm::vec3& corner : p) around.add(corner);
    const Facing facing = Facing::of(normal);
    for_each_room(rooms_, around.grown(reach_m_), [&](uint32_t room) {
      const Box& box = rooms_.space.cells[room].box;
      if (shows_its_back(normal, p, box)) return;
      const Box near = box.grown(reach_m_);
      const Box inside = near.contains(around) ? around : clipped(p, near);
      if (inside.empty()) return;
      const glm::ivec3 cube(glm::floor(inside.center() / kPartM));
      parts_[{room, cube.x, cube.y, cube.z, facing}].add(inside);
    });
  }

  const Rooms& rooms_;
  const std::vector<Material>& materials_;
  const Model& model_;
  float reach_m_ = 0;
  NodeParts parts_;
};

}  // namespace

Facing Facing::of(const glm::vec3& normal) {
  if (normal == glm::vec3(0)) return {};
  Facing facing{0, kNoAxis};
  for (uint32_t octant = 0; octant < 8; ++octant)
    for (uint32_t i = 0; i < 3; ++i) {
      const bool down = (octant >> i & 1U) != 0;
      if (down ? normal[static_cast<int>(i)] > 0 : normal[static_cast<int>(i)] < 0)
        facing.octants = static_cast<uint8_t>(facing.octants | 1U << octant);
    }
  for (uint8_t i = 0; i < 3; ++i)
    if (normal[(i + 1) % 3] == 0 && normal[(i + 2) % 3] == 0)
      facing.axis = static_cast<uint8_t>(2 * i + (normal[i] < 0 ? 1 : 0));
  return facing;
}

bool Facing::shows_front_to(const Box& cell, const Box& box) const {
  if (axis == kNoAxis) return true;
  const int i = axis / 2;
  return axis % 2 == 0 ? cell.max[i] > box.min[i] : cell.min[i] < box.max[i];
}

Result<RoomParts> find_room_parts(const ModelReader& reader, const Rooms& rooms, JobMonitor& monitor) {
  const Model& model = reader.model();
  std::vector<NodeId> nodes;
  nodes.reserve(model.tables.nodes.size());
  RoomParts placed;
  placed.anywhere.assign(model.tables.nodes.size(), 0);
  for (uint32_t i = 0; i < model.tables.nodes.size(); ++i) {
    const NodeRecord& node = model.tables.nodes[i];
    placed.anywhere[i] = node.child_count != 0 && node.error_m > kMostErrorM ? 1 : 0;
    if (placed.anywhere[i] == 0) nodes.push_back(NodeId{i});
  }
  std::vector<NodeParts> made(nodes.size());
  PROMENADE_TRY(for_each_mesh(reader, nodes, monitor, [&](size_t i, const Mesh& mesh) {
    NodePlacer placer(model, rooms, nodes[i]);
    made[i] =
        model.is_moving(nodes[i]) ? placer.run_swept(model.tables.nodes[index_of(nodes[i])].box) : placer.run(mesh);
  }));
  placed.first.assign(rooms.space.cells.size() + 1, 0);
  for (const NodeParts& of_node : made)
    for (const auto& [key, box] : of_node) ++placed.first[key.room + 1];
  for (size_t i = 1; i < placed.first.size(); ++i) placed.first[i] += placed.first[i - 1];
  placed.parts.resize(placed.first.back());
  std::vector<size_t> next(placed.first.begin(), placed.first.end() - 1);
  for (size_t i = 0; i < made.size(); ++i)
    for (const auto& [key, box] : made[i]) placed.parts[next[key.room]++] = {box, nodes[i], key.facing};
  return placed;
}

}  // namespace promenade
