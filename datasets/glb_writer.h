#pragma once
// Writes binary glTF 2.0 out of core: mesh data goes to disk as it comes, only the JSON part stays in memory.

#include <filesystem>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"

namespace promenade {

/// Where a node is over time, upright: linear between the keys, over and over.
struct NodeMotion {
  std::vector<float> times_s;     ///< ascending from 0; at least two
  std::vector<glm::vec3> places;  ///< by key, metres, z up
  std::vector<float> yaws_rad;    ///< by key, counter-clockwise; less than half a turn from one to the next
};

/// One .glb file, published atomically by finish(). Coordinates are given z up in metres; the file is y up as glTF
/// demands (x, z, -y), positions and transforms turned here. Index 0 is the first material, mesh, ... added. One
/// thread.
class GlbWriter {
 public:
  static Result<GlbWriter> create(const std::filesystem::path& path, std::string_view generator);
  GlbWriter(GlbWriter&&) noexcept;
  GlbWriter& operator=(GlbWriter&&) noexcept;
  ~GlbWriter();

  /// An embedded picture. mime: "image/png" or "image/jpeg".
  Result<uint32_t> add_texture(std::string_view name, std::string_view mime, std::span<const std::byte> encoded);
  uint32_t add_material(std::string_view name, const Material& material);
  /// A sound mesh; one primitive per material that it uses. Indices are 16 bits wide where that suffices.
  Result<uint32_t> add_mesh(std::string_view name, const Mesh& mesh);
  /// A node that shows a mesh. class_name goes to extras.class.
  void add_node(std::string_view name, std::string_view class_name, uint32_t mesh, const glm::dmat4& world_from_mesh);

  /// A node that moves: an animation of its own.
  Status add_moving_node(std::string_view name, std::string_view class_name, uint32_t mesh, const NodeMotion& motion);

  /// Errors: disk full, more than 4 GiB (glTF's limit: use tiles).
  Status finish();

 private:
  struct State;
  explicit GlbWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace promenade
