#pragma once
// Models in memory: small trees with known boxes, errors and sizes, whose segments can be read, decoded and made to
// fail.

#include <algorithm>
#include <atomic>
#include <cstring>
#include <set>
#include <vector>

#include "runtime/model_source.h"

namespace promenade::forest {

/// Builds trees of squares. A node's picture is a square at x = 10 that fills its box's y and z.
class Forest : public ModelSource {
 public:
  explicit Forest(uint32_t segment_bytes = 1000) : segment_bytes_(segment_bytes) {
    model_.tables.materials.emplace_back();
  }

  NodeId root(const Box& box, float error_m, uint32_t triangles = 1000) {
    const NodeId id = add(box, error_m, triangles, kNoNode);
    model_.tables.roots.push_back(id);
    return id;
  }
  /// Splits a node along y into `count` equal children; children are leaves until split themselves.
  std::vector<NodeId> split(NodeId parent, uint32_t count, float error_m, uint32_t triangles = 1000) {
    const Box box = node(parent).box;
    std::vector<NodeId> children;
    for (uint32_t i = 0; i < count; ++i) {
      Box part = box;
      const float width = box.size().y / float(count);
      part.min.y = box.min.y + width * float(i);
      part.max.y = part.min.y + width;
      children.push_back(add(part, error_m, triangles, parent));
    }
    node(parent).first_child = static_cast<uint32_t>(model_.tables.children.size());
    node(parent).child_count = count;
    model_.tables.children.insert(model_.tables.children.end(), children.begin(), children.end());
    return children;
  }
  /// Splits every leaf `depth` times; errors halve, leaves have none.
  void grow(NodeId id, uint32_t arity, uint32_t depth, uint32_t triangles = 1000) {
    if (depth == 0) {
      node(id).error_m = 0;
      return;
    }
    const float error_m = node(id).error_m / 2;
    for (const NodeId child : split(id, arity, error_m, triangles)) grow(child, arity, depth - 1, triangles);
  }
  /// A texture of side x side pixels that these nodes share.
  uint32_t texture(uint32_t side, const std::vector<NodeId>& nodes) {
    const uint32_t index = static_cast<uint32_t>(model_.tables.textures.size());
    model_.tables.textures.push_back({side, side, segment(SegmentRecord::Type::texture), 0});
    for (const NodeId id : nodes) {
      node(id).first_texture = static_cast<uint32_t>(model_.tables.node_textures.size());
      node(id).texture_count = 1;
      model_.tables.node_textures.push_back(index);
    }
    return index;
  }

  NodeRecord& node(NodeId id) { return model_.tables.nodes[index_of(id)]; }
  Model& edit() { return model_; }
  const Model& model() const override { return model_; }

  Status read_piece(uint32_t segment, uint64_t offset, std::span<std::byte> into) const override {
    ++reads;
    if (unreadable.contains(segment)) return Error{"forest: unreadable"};
    if (offset + into.size() > model_.tables.segments[segment].stored_bytes) return Error{"forest: beyond the end"};
    std::fill(into.begin(), into.end(), static_cast<std::byte>(segment & 255U));
    return Done{};
  }
  Result<Mesh> decode_mesh(NodeId id, std::span<const std::byte> stored) const override {
    const NodeRecord& record = model_.tables.nodes[index_of(id)];
    if (!whole(record.segment, stored) || undecodable.contains(record.segment)) return Error{"forest: wrong bytes"};
    Mesh mesh;
    const Box& b = record.box;
    mesh.positions = {{10, b.max.y, b.max.z}, {10, b.max.y, b.min.z}, {10, b.min.y, b.min.z}, {10, b.min.y, b.max.z}};
    for (uint32_t i = 0; i < record.triangles; ++i) {
      const std::vector<uint32_t> corners =
          i % 2 == 0 ? std::vector<uint32_t>{0, 1, 2} : std::vector<uint32_t>{0, 2, 3};
      mesh.indices.insert(mesh.indices.end(), corners.begin(), corners.end());
    }
    return mesh;
  }
  Result<Image> decode_texture(uint32_t texture, std::span<const std::byte> stored) const override {
    const TextureRecord& record = model_.tables.textures[texture];
    if (!whole(record.segment, stored)) return Error{"forest: wrong bytes"};
    return Image{record.width, record.height,
                 std::vector<glm::u8vec4>(size_t(record.width) * record.height, glm::u8vec4(255))};
  }

  std::set<uint32_t> unreadable, undecodable;  ///< segments
  mutable std::atomic<uint64_t> reads{0};

 private:
  NodeId add(const Box& box, float error_m, uint32_t triangles, NodeId parent) {
    const NodeId id{static_cast<uint32_t>(model_.tables.nodes.size())};
    NodeRecord record;
    record.box = box;
    record.error_m = error_m;
    record.surface_m2 = box.size().y * box.size().z;
    record.parent = parent;
    record.level = parent == kNoNode ? 0 : node(parent).level + 1;
    record.triangles = triangles;
    record.vertices = 4;
    record.segment = segment(SegmentRecord::Type::mesh);
    model_.tables.nodes.push_back(record);
    return id;
  }
  uint32_t segment(SegmentRecord::Type type) {
    std::vector<SegmentRecord>& segments = model_.tables.segments;
    segments.push_back({type, 0, uint64_t(segments.size()) * segment_bytes_, segment_bytes_, 0});
    return static_cast<uint32_t>(segments.size() - 1);
  }
  bool whole(uint32_t segment, std::span<const std::byte> stored) const {
    return stored.size() == model_.tables.segments[segment].stored_bytes &&
           std::all_of(stored.begin(), stored.end(),
                       [segment](std::byte b) { return b == static_cast<std::byte>(segment & 255U); });
  }

  uint32_t segment_bytes_;
  Model model_;
};

}  // namespace promenade::forest
