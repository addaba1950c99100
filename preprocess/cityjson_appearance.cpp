#include "preprocess/cityjson_appearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "layout/file_io.h"
#include "preprocess/import_uri.h"

namespace promenade {

namespace {

constexpr uint64_t kMaxImageBytes = uint64_t(1) << 30;

struct TypeColor {
  std::string_view type;
  glm::u8vec4 color;
};

// Plain colours for models without appearance, as city viewers use them.
constexpr std::array<TypeColor, 23> kTypeColors{{
    {"RoofSurface", {178, 84, 66, 255}},
    {"WallSurface", {222, 214, 198, 255}},
    {"GroundSurface", {140, 134, 124, 255}},
    {"Window", {120, 150, 176, 255}},
    {"Door", {110, 78, 52, 255}},
    {"ClosureSurface", {214, 208, 196, 255}},
    {"OuterFloorSurface", {150, 146, 138, 255}},
    {"OuterCeilingSurface", {200, 196, 188, 255}},
    {"WaterSurface", {96, 140, 178, 255}},
    {"TrafficArea", {112, 112, 114, 255}},
    {"AuxiliaryTrafficArea", {134, 148, 112, 255}},
    {"Building", {214, 206, 192, 255}},
    {"BuildingPart", {214, 206, 192, 255}},
    {"Bridge", {166, 162, 156, 255}},
    {"Road", {112, 112, 114, 255}},
    {"Railway", {120, 110, 104, 255}},
    {"WaterBody", {96, 140, 178, 255}},
    {"PlantCover", {106, 140, 78, 255}},
    {"SolitaryVegetationObject", {92, 130, 66, 255}},
    {"LandUse", {158, 168, 120, 255}},
    {"TINRelief", {156, 158, 126, 255}},
    {"CityFurniture", {130, 130, 136, 255}},
    {"Tunnel", {150, 146, 142, 255}},
}};
constexpr glm::u8vec4 kOtherColor{200, 200, 200, 255};

glm::u8vec4 color_of_types(const CityLook& look) {
  for (const std::string* type : {&look.surface_type, &look.object_type})
    for (const TypeColor& entry : kTypeColors)
      if (entry.type == *type) return entry.color;
  return kOtherColor;
}

uint8_t unit_byte(double value) {
  return static_cast<uint8_t>(std::lround(std::clamp(std::isnan(value) ? 1.0 : value, 0.0, 1.0) * 255.0));
}

std::string dumped(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

void CityAppearance::use(const Json& appearance) { appearance_ = &appearance; }

std::string CityAppearance::theme_of(const Json& themes, const char* default_key) const {
  if (!themes.is_object() || themes.empty()) return {};
  const std::string wanted = text(member(*appearance_, default_key));
  return themes.contains(wanted) ? wanted : themes.begin().key();
}

uint32_t CityAppearance::material_of(const CityLook& look) {
  const Json& declared =
      look.material ? element(member(*appearance_, "materials"), *look.material) : element(Json(), 0);
  const Json& picture = look.texture ? element(member(*appearance_, "textures"), *look.texture) : element(Json(), 0);
  const bool plain = !declared.is_object() && !picture.is_object();
  const glm::u8vec4 type_color = color_of_types(look);
  std::pair<std::string, std::string> key{dumped(declared), dumped(picture)};
  if (plain) key = {"", std::string(reinterpret_cast<const char*>(&type_color), sizeof(type_color))};
  const auto [place, is_new] = materials_.emplace(std::move(key), static_cast<uint32_t>(scene_.materials.size()));
  if (!is_new) return place->second;

  Material material;
  if (plain) material.color = type_color;
  std::array<double, 3> diffuse{1, 1, 1};
  if (numbers(member(declared, "diffuseColor"), diffuse))
    material.color = {unit_byte(diffuse[0]), unit_byte(diffuse[1]), unit_byte(diffuse[2]), 255};
  material.color.a = unit_byte(1.0 - number(member(declared, "transparency"), 0));
  if (material.color.a < 255) material.alpha = AlphaMode::blend;
  if (picture.is_object()) material.texture = texture_of(picture, material);
  scene_.materials.push_back(material);
  return place->second;
}

uint32_t CityAppearance::texture_of(const Json& declared, Material& material) {
  const std::string wrap = text(member(declared, "wrapMode"));
  material.wrap_u = material.wrap_v = wrap == "mirror"                                        ? Wrap::mirror
                                      : wrap == "clamp" || wrap == "border" || wrap == "none" ? Wrap::clamp
                                                                                              : Wrap::repeat;
  const std::string image = text(member(declared, "image"));
  const auto [place, is_new] = textures_.emplace(image, static_cast<uint32_t>(scene_.textures.size()));
  if (!is_new) return place->second;
  SourceTexture texture{image.substr(0, 200), {}};
  if (const Result<std::filesystem::path> path = resolve_picture(folder_, image); path.ok())
    if (Result<std::vector<std::byte>> bytes = read_file(*path, kMaxImageBytes); bytes.ok())
      texture.encoded = *std::move(bytes);
  scene_.textures.push_back(std::move(texture));
  return place->second;
}

}  // namespace promenade
