#pragma once
#include <cstdint>

namespace promenade {

/// A node's place in the model's order: the permutation of nodes on disk.
enum class NodeId : uint32_t {};
constexpr NodeId kNoNode{0xffffffffU};
constexpr uint32_t index_of(NodeId id) { return static_cast<uint32_t>(id); }

}  // namespace promenade
