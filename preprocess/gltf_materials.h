#pragma once
// Materials and pictures of glTF, as far as a diffusely lit surface needs them.

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <vector>

#include "preprocess/gltf_document.h"
#include "preprocess/scene.h"

namespace promenade {

/// Where a material's texture coordinates come from.
struct GltfTexcoords {
  uint32_t set = 0;           ///< TEXCOORD_set
  glm::dmat3 transform{1.0};  ///< KHR_texture_transform, baked into the coordinates at import
  bool has_transform = false;
  bool textured = false;
};

/// Fills the scene's materials (one a glTF material, in order; its base colour texture or, with
/// KHR_materials_pbrSpecularGlossiness only, the diffuse one) and textures, missing ones counted and named.
Status read_gltf_materials(GltfDocument& document, Scene& scene, std::vector<GltfTexcoords>& texcoords);

}  // namespace promenade
