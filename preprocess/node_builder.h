#pragma once
// One node of the HLOD tree made from a leaf's triangles or from its children, with its measured error.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "layout/model.h"
#include "preprocess/border.h"
#include "preprocess/class_runs.h"
#include "preprocess/fins.h"
#include "preprocess/node_profile.h"
#include "preprocess/texture_store.h"

namespace promenade {

/// Materials by index in meshes under construction: the source's, then the plain ones, then those of the node's atlas.
struct MaterialBase {
  std::vector<Material> materials;       ///< the source's (Material::texture: by TextureStore), then kPlain plain ones
  static constexpr uint32_t kPlain = 4;  ///< white: one-sided, two-sided, the same see-through
  explicit MaterialBase(std::vector<Material> source);
  uint32_t plain(bool two_sided, bool see_through) const;
  uint32_t size() const { return static_cast<uint32_t>(materials.size()); }
};

/// A node as the model will hold it, but for what depends on other nodes' places (ids, indices into tables).
struct StoredNode {
  NodeRecord record;
  std::vector<std::byte> mesh;     ///< encoded; materials from MaterialBase::size() on are atlas_materials
  float step_m = 0;                ///< of the grid that the mesh was coded on; 0: none
  std::vector<uint32_t> textures;  ///< shared ones, by TextureStore
  std::vector<float>
      texels_m;  ///< of each of these: its largest_texel_m on the node's surface; 0: not to be made smaller
  std::vector<std::byte> atlas;           ///< encoded picture; empty: none
  TextureRecord atlas_record;             ///< but for its segment
  std::vector<Material> atlas_materials;  ///< but for their texture, which is the atlas
  std::vector<ClassArea> classes;         ///< of a leaf's triangles; none where the source names none
};

/// A surface without its looks that others are measured against, and how far it may be from the source.
struct Reference {
  Mesh mesh;  ///< positions and triangles only
  double error_m = 0, p99_m = 0;
};

/// Most triangles of a reference, to a node's: errors add up only every few levels.
constexpr size_t kReferenceNodes = 24;

/// What a node's parent is made from.
struct NodeSurface {
  Mesh mesh;                              ///< before coding; untextured triangles have plain materials
  std::vector<Material> atlas_materials;  ///< as in StoredNode
  std::shared_ptr<const Image> atlas;
  Border border;                               ///< of `mesh`: where other nodes' surfaces begin
  double error_m = 0, p99_m = 0;               ///< of what is stored, without coding
  Reference reference;                         ///< more detailed than `mesh`: what that was measured against; or empty
  double texture_error_m = 0;                  ///< how far a colour may be from its place
  float texel_m = 0;                           ///< of the finest picture on it; 0: none
  Box box;                                     ///< as in NodeRecord
  NormalCone cone;                             ///< as in NodeRecord
  float stored_error_m = 0, stored_p99_m = 0;  ///< as in NodeRecord
};

struct NodeBuilderOptions {
  uint32_t node_triangles = 2250;
  GeometryCodec codec = GeometryCodec::grown;
  float leaf_step_m = 1.0F / 1024;  ///< a power of two: the grid that all leaves share
  int jpeg_quality = 85;
  uint32_t max_atlas_px = 512;  ///< a node is drawn when its error is about a pixel: rarely larger on the screen
};

/// How a node's mesh is coded. step_m 0: as floats, whatever the codec. fine_step_m: as in GeometryEncodeOptions.
GeometryEncodeOptions encode_options(GeometryCodec codec, float step_m, float fine_step_m);

struct BuiltNode {
  StoredNode stored;
  NodeSurface surface;
};

/// Any thread.
class NodeBuilder {
 public:
  /// Both must outlive the builder.
  NodeBuilder(const MaterialBase& base, const TextureStore& textures, const NodeBuilderOptions& options)
      : base_(base), textures_(textures), options_(options) {}

  /// A leaf shows the source's triangles as they are, rounded to the leaves' grid. border: where other leaves begin.
  Result<BuiltNode> leaf(Mesh mesh, Border border = {}) const;
  /// A node above others: their surfaces together, simplified, measured against the most detailed surface below that is
  /// small enough; its error and the distance add up. What is stored has fins (fins.h) where other nodes begin.
  Result<BuiltNode> inner(std::span<const NodeSurface> children) const;

  /// What all nodes so far have cost.
  const NodeProfile& profile() const { return profile_; }

 private:
  struct Merged;
  Merged merge(std::span<const NodeSurface> children) const;
  Reference reference_of(std::span<const NodeSurface> children) const;
  /// What comes of a node's surface besides the surface.
  struct Shape {
    bool has_fins = false;   ///< to be stored
    double most_step_m = 0;  ///< of the grid
  };
  Shape reduce(Mesh bare, Border border, NodeSurface& surface) const;
  double step_of(double error_m) const;
  FinOptions fin_options(std::function<uint32_t(uint32_t material)> fin_material) const;
  Mesh with_fins(const Mesh& mesh, const Border& border) const;
  uint32_t fin_material(uint32_t material, std::vector<Material>& atlas_materials) const;
  Status bake(const Merged& merged, BuiltNode& node) const;
  /// What is stored of a surface.
  struct Shown {
    Mesh mesh;
    std::vector<uint8_t> is_exact;  ///< of each vertex, as add_fins returns it; empty: none
    bool has_fins = false;
  };
  float fine_step_of(double step_m) const;
  Status store(const Shown& shown, double step_m, std::span<const NodeSurface> children, BuiltNode& node) const;
  Status encode(const Shown& shown, double step_m, StoredNode& stored, double& error_m) const;
  void add_leaf_textures(const Mesh& mesh, BuiltNode& node) const;
  bool is_textured(uint32_t material) const;
  bool is_two_sided(uint32_t material, std::span<const Material> atlas_materials) const;

  const MaterialBase& base_;
  const TextureStore& textures_;
  NodeBuilderOptions options_;
  mutable NodeProfile profile_;
};

}  // namespace promenade
