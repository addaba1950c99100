#pragma once
// KHR_draco_mesh_compression: a primitive's triangles and attributes from Draco's bytes.

#include <map>
#include <memory>
#include <string>

#include "preprocess/gltf_document.h"

namespace promenade {

/// Decodes the primitive's Draco data. `what` names the primitive for messages.
class GltfDracoPrimitive {
 public:
  static Result<GltfDracoPrimitive> decode(GltfDocument& document, const Json& extension, const std::string& what);
  GltfDracoPrimitive(GltfDracoPrimitive&&) noexcept;
  ~GltfDracoPrimitive();

  uint64_t vertex_count() const;
  uint64_t index_count() const;
  void indices(std::span<uint32_t> out) const;
  /// Components of an attribute ("POSITION"); 0: not in it.
  uint32_t components(const std::string& attribute) const;
  /// Fills `out` with the values of vertices from `first` on; false: not in it, or not convertible.
  bool floats(const std::string& attribute, uint64_t first, std::span<float> out) const;

 private:
  struct State;
  explicit GltfDracoPrimitive(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace promenade
