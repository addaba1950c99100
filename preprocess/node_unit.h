#pragma once
// What a work unit of the tree leaves in the work folder: the nodes of one chunk, or those above the chunks.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "preprocess/node_builder.h"
#include "preprocess/work_folder.h"

namespace promenade {

/// A run of bytes in a unit's payload.
struct UnitBlob {
  uint64_t offset = 0;
  uint64_t bytes = 0;
};

/// A node without its bytes.
struct UnitNode {
  NodeRecord record;
  std::vector<uint32_t> children;  ///< in this unit; with kOtherUnit: the root of that chunk's unit
  UnitBlob mesh;
  float step_m = 0;
  std::vector<uint32_t> textures;
  std::vector<float> texels_m;  ///< as StoredNode's
  UnitBlob atlas;
  TextureRecord atlas_record;
  std::vector<Material> atlas_materials;
  std::vector<ClassArea> classes;
};

/// A unit's nodes; the first is its root. Empty: a chunk without triangles.
struct NodeUnit {
  static constexpr uint32_t kOtherUnit = 0x80000000U;
  std::string name;
  std::vector<UnitNode> nodes;
  UnitBlob surface;  ///< of the root, for those above it
  uint64_t payload_bytes = 0;
};

/// Publishes nodes (children as in UnitNode) and the root's surface; returns what load_node_unit would.
Result<NodeUnit> store_node_unit(const WorkFolder& folder, const std::string& name, uint64_t hash,
                                 const std::vector<StoredNode>& nodes,
                                 const std::vector<std::vector<uint32_t>>& children, const NodeSurface& root);
std::optional<NodeUnit> load_node_unit(const WorkFolder& folder, const std::string& name, uint64_t hash);

/// The surface of a unit's root, its atlas decoded again.
Result<NodeSurface> read_root_surface(const WorkFolder& folder, const NodeUnit& unit);

}  // namespace promenade
