#pragma once
// Materials and pictures of CityJSON.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "preprocess/import_json.h"
#include "preprocess/scene.h"

namespace promenade {

/// How a surface looks, as its geometry names it: indices into the document's lists, or none.
struct CityLook {
  std::optional<uint64_t> material, texture;
  std::string surface_type;  ///< semantic: "RoofSurface"
  std::string object_type;   ///< "Building"
};

/// Materials of the scene for what surfaces name: made when first asked for, each once. Without appearance a surface is
/// coloured by its semantics (roof, wall, ground, window, door) or its object's type (vegetation, water, road ...).
class CityAppearance {
 public:
  CityAppearance(std::filesystem::path folder, Scene& scene) : folder_(std::move(folder)), scene_(scene) {}

  /// The "appearance" of the document, or of a feature, that the looks to come refer to; stays alive with the caller.
  void use(const Json& appearance);
  uint32_t material_of(const CityLook& look);
  /// Name of the theme to show among those of a geometry's "material" or "texture".
  std::string theme_of(const Json& themes, const char* default_key) const;
  const Json& texture_vertices() const { return member(*appearance_, "vertices-texture"); }

 private:
  uint32_t texture_of(const Json& declared, Material& material);

  std::filesystem::path folder_;
  Scene& scene_;
  const Json* appearance_ = nullptr;
  std::map<std::string, uint32_t> textures_;
  std::map<std::pair<std::string, std::string>, uint32_t> materials_;  ///< by what they say, so features share them
};

}  // namespace promenade
