#include "preprocess/gltf_draco.h"

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>

#include <exception>

namespace promenade {

struct GltfDracoPrimitive::State {
  std::unique_ptr<draco::Mesh> mesh;
  std::map<std::string, const draco::PointAttribute*> attributes;
};

GltfDracoPrimitive::GltfDracoPrimitive(std::unique_ptr<State> state) : state_(std::move(state)) {}
GltfDracoPrimitive::GltfDracoPrimitive(GltfDracoPrimitive&&) noexcept = default;
GltfDracoPrimitive::~GltfDracoPrimitive() = default;

Result<GltfDracoPrimitive> GltfDracoPrimitive::decode(GltfDocument& document, const Json& extension,
                                                      const std::string& what) {
  const std::optional<uint64_t> view = whole(member(extension, "bufferView"));
  const Error broken{
      fmt::format("{}: {}: Draco data do not decode; the file is cut off or broken", document.name(), what)};
  if (!view) return broken;
  const Result<std::vector<std::byte>> bytes = document.view_bytes(*view);
  if (!bytes.ok()) return bytes.error();
  auto state = std::make_unique<State>();
  try {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    draco::Decoder decoder;
    draco::StatusOr<std::unique_ptr<draco::Mesh>> decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) return broken;
    state->mesh = std::move(decoded).value();
  } catch (const std::exception&) {
    return broken;
  }
  if (!state->mesh) return broken;
  const Json& attributes = member(extension, "attributes");
  if (attributes.is_object())
    for (const auto& [name, id] : attributes.items())
      if (const std::optional<uint64_t> unique_id = whole(id); unique_id && *unique_id <= 0xffffffffU)
        if (const auto* attribute = state->mesh->GetAttributeByUniqueId(static_cast<uint32_t>(*unique_id)))
          state->attributes.emplace(name, attribute);
  return GltfDracoPrimitive(std::move(state));
}

uint64_t GltfDracoPrimitive::vertex_count() const { return state_->mesh->num_points(); }
uint64_t GltfDracoPrimitive::index_count() const { return uint64_t(state_->mesh->num_faces()) * 3; }

void GltfDracoPrimitive::indices(std::span<uint32_t> out) const {
  for (uint32_t f = 0; f < state_->mesh->num_faces(); ++f) {
    const draco::Mesh::Face& face = state_->mesh->face(draco::FaceIndex(f));
    for (size_t corner = 0; corner < 3; ++corner) out[size_t(f) * 3 + corner] = face[corner].value();
  }
}

uint32_t GltfDracoPrimitive::components(const std::string& attribute) const {
  const auto found = state_->attributes.find(attribute);
  return found == state_->attributes.end() ? 0 : static_cast<uint32_t>(found->second->num_components());
}

bool GltfDracoPrimitive::floats(const std::string& attribute, uint64_t first, std::span<float> out) const {
  const auto found = state_->attributes.find(attribute);
  if (found == state_->attributes.end()) return false;
  const draco::PointAttribute& values = *found->second;
  const auto components = static_cast<size_t>(values.num_components());
  for (size_t v = 0; v < out.size() / components; ++v) {
    const draco::AttributeValueIndex place = values.mapped_index(draco::PointIndex(static_cast<uint32_t>(first + v)));
    if (place.value() >= values.size()) return false;
    if (!values.ConvertValue<float>(place, static_cast<int8_t>(components), out.data() + v * components)) return false;
  }
  return true;
}

}  // namespace promenade
