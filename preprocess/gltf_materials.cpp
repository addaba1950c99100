#include "preprocess/gltf_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "preprocess/import_uri.h"

namespace promenade {

namespace {

constexpr uint64_t kMaxImageBytes = uint64_t(1) << 30;

uint8_t unit_byte(double value) {
  return static_cast<uint8_t>(std::lround(std::clamp(std::isnan(value) ? 1.0 : value, 0.0, 1.0) * 255.0));
}

Wrap wrap_of(const Json& value) {
  const uint64_t code = whole(value).value_or(10497);
  return code == 33071 ? Wrap::clamp : code == 33648 ? Wrap::mirror : Wrap::repeat;
}

/// The picture's bytes, or why there are none.
Result<std::vector<std::byte>> read_image(GltfDocument& document, const Json& image) {
  if (const std::optional<uint64_t> view = whole(member(image, "bufferView"))) return document.view_bytes(*view);
  const Json& uri = member(image, "uri");
  if (!uri.is_string()) return Error{"has no data"};
  const auto& reference = uri.get_ref<const std::string&>();
  if (is_data_uri(reference)) {
    std::optional<std::vector<std::byte>> bytes = decode_data_uri(reference);
    if (!bytes) return Error{"has a data URI that is not base64"};
    return *std::move(bytes);
  }
  const Result<std::filesystem::path> path = resolve_reference(document.folder(), reference, true);
  if (!path.ok()) return path.error();
  return read_file(*path, kMaxImageBytes);
}

std::string image_name(const Json& image, uint64_t index) {
  const std::string uri = text(member(image, "uri"));
  if (!uri.empty() && !is_data_uri(uri)) return uri.substr(0, 200);
  const std::string name = text(member(image, "name"));
  return name.empty() ? fmt::format("image {}", index) : name.substr(0, 200);
}

void read_images(GltfDocument& document, Scene& scene) {
  const Json& images = member(document.json(), "images");
  if (!images.is_array()) return;
  for (size_t i = 0; i < images.size(); ++i) {
    SourceTexture texture{image_name(images[i], i), {}};
    Result<std::vector<std::byte>> bytes = read_image(document, images[i]);
    if (bytes.ok()) texture.encoded = *std::move(bytes);
    scene.textures.push_back(std::move(texture));
  }
}

/// Index of the picture behind a textureInfo, the forms that extensions add included.
std::optional<uint64_t> picture_of(const Json& root, const Json& info) {
  const std::optional<uint64_t> index = whole(member(info, "index"));
  if (!index) return std::nullopt;
  const Json& texture = element(member(root, "textures"), *index);
  for (const char* extension : {"EXT_texture_webp", "MSFT_texture_dds", "KHR_texture_basisu"})
    if (!whole(member(texture, "source")))
      if (const auto source = whole(member(member(member(texture, "extensions"), extension), "source"))) return source;
  return whole(member(texture, "source"));
}

GltfTexcoords texcoords_of(const Json& info) {
  GltfTexcoords out;
  out.textured = true;
  uint64_t set = whole(member(info, "texCoord")).value_or(0);
  const Json& transform = member(member(info, "extensions"), "KHR_texture_transform");
  if (transform.is_object()) {
    std::array<double, 2> offset{0, 0};
    std::array<double, 2> scale{1, 1};
    numbers(member(transform, "offset"), offset);
    numbers(member(transform, "scale"), scale);
    const double rotation = number(member(transform, "rotation"), 0);
    const double c = std::cos(rotation);
    const double s = std::sin(rotation);
    // translation * rotation * scale, as the extension defines them (columns).
    out.transform = glm::dmat3(c * scale[0], -s * scale[0], 0, s * scale[1], c * scale[1], 0, offset[0], offset[1], 1);
    out.has_transform = true;
    set = whole(member(transform, "texCoord")).value_or(set);
  }
  out.set = static_cast<uint32_t>(std::min<uint64_t>(set, 1000));
  return out;
}

glm::u8vec4 color_of(const Json& factor) {
  std::array<double, 4> linear{1, 1, 1, 1};
  numbers(factor, linear);
  const auto channel = [](double v) { return linear_to_srgb(std::isnan(v) ? 1.0F : static_cast<float>(v)); };
  return {channel(linear[0]), channel(linear[1]), channel(linear[2]), unit_byte(linear[3])};
}

Material read_material(const GltfDocument& document, const Json& declared, const Scene& scene,
                       GltfTexcoords& texcoords) {
  Material material;
  const Json& metallic = member(declared, "pbrMetallicRoughness");
  const Json& glossy = member(member(declared, "extensions"), "KHR_materials_pbrSpecularGlossiness");
  const bool from_glossy = !metallic.is_object() && glossy.is_object();
  material.color = color_of(from_glossy ? member(glossy, "diffuseFactor") : member(metallic, "baseColorFactor"));
  const Json& info = from_glossy ? member(glossy, "diffuseTexture") : member(metallic, "baseColorTexture");
  const std::optional<uint64_t> picture = picture_of(document.json(), info);
  if (picture && *picture < scene.textures.size()) {
    material.texture = static_cast<uint32_t>(*picture);
    texcoords = texcoords_of(info);
    const Json& texture = element(member(document.json(), "textures"), *whole(member(info, "index")));
    const Json& samplers = member(document.json(), "samplers");
    if (const std::optional<uint64_t> index = whole(member(texture, "sampler"))) {
      material.wrap_u = wrap_of(member(element(samplers, *index), "wrapS"));
      material.wrap_v = wrap_of(member(element(samplers, *index), "wrapT"));
    }
  }
  const std::string alpha = text(member(declared, "alphaMode"));
  material.alpha = alpha == "BLEND" ? AlphaMode::blend : alpha == "MASK" ? AlphaMode::mask : AlphaMode::opaque;
  material.alpha_cutoff = unit_byte(number(member(declared, "alphaCutoff"), 0.5));
  material.two_sided = truth(member(declared, "doubleSided"));
  return material;
}

}  // namespace

Status read_gltf_materials(GltfDocument& document, Scene& scene, std::vector<GltfTexcoords>& texcoords) {
  read_images(document, scene);
  const Json& declared = member(document.json(), "materials");
  if (!declared.is_array()) return Done{};
  for (const Json& material : declared)
    scene.materials.push_back(read_material(document, material, scene, texcoords.emplace_back()));
  return Done{};
}

}  // namespace promenade
