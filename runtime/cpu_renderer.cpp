#include "runtime/cpu_renderer.h"

#include <algorithm>
#include <array>
#include <optional>

#include "raster/shade.h"

namespace promenade {
namespace {

constexpr uint32_t kMaxTextureSide = 16384;
constexpr size_t kMostLayers = 3;  // of what is seen through; each may take 8 bytes a pixel

/// Meshes and textures are drawn as they were staged: a handle shares what staging made.
struct CpuStagedMesh final : StagedMesh {
  std::shared_ptr<const PreparedMesh> mesh;  ///< null: could not be prepared
  std::string defect;
  std::vector<Material> materials;  ///< those that the mesh uses, as its attributes number them
  uint64_t byte_size() const override {
    return (mesh ? mesh->byte_size() : 0) + materials.size() * (sizeof(Material) + sizeof(raster_kernel::Surface));
  }
};

struct CpuStagedTexture final : StagedTexture {
  std::shared_ptr<const MipTexture> texture;
  uint64_t byte_size() const override { return texture->byte_size(); }
};

struct CpuMesh {
  std::shared_ptr<const PreparedMesh> mesh;  ///< null: the slot is free
  std::unique_ptr<SurfaceTable> surfaces;
  uint64_t bytes = 0;
  bool blended = false;  ///< some of it is seen through
};

/// The mesh with only the materials that it uses, in order of first use.
Mesh with_own_materials(const Mesh& mesh, std::span<const Material> materials, std::vector<Material>& own) {
  Mesh copy = mesh;
  std::vector<uint32_t> number(materials.size(), kNoTexture);
  if (copy.materials.empty() && !materials.empty()) own.push_back(materials[0]);
  for (uint32_t& m : copy.materials) {
    if (m >= materials.size()) continue;
    if (number[m] == kNoTexture) {
      number[m] = static_cast<uint32_t>(own.size());
      own.push_back(materials[m]);
    }
    m = number[m];
  }
  return copy;
}

/// A picture that fits, by leaving out rows and columns; an empty one becomes a white pixel.
Image fitting(const Image& image) {
  if (image.pixels.empty() || image.width == 0 || image.height == 0) return {1, 1, {glm::u8vec4(255)}};
  uint32_t step = 1;
  while (std::max(image.width, image.height) / step > kMaxTextureSide) step *= 2;
  Image out;
  out.width = std::max(1U, image.width / step), out.height = std::max(1U, image.height / step);
  out.pixels.reserve(size_t(out.width) * out.height);
  for (uint32_t y = 0; y < out.height; ++y)
    for (uint32_t x = 0; x < out.width; ++x) out.pixels.push_back(image.at(x * step, y * step));
  return out;
}

ShadeOptions shading_of(const FrameView& view, const CpuRendererOptions& options) {
  ShadeOptions o;
  o.threads = options.threads, o.simd = options.simd;
  o.textures = view.textures, o.anisotropy = options.anisotropy;
  o.to_sun = view.lighting.to_sun, o.sun = view.lighting.sun;
  o.sky_ambient = view.lighting.sky_ambient, o.ground_ambient = view.lighting.ground_ambient;
  o.sky = view.background.sky, o.plain = view.background.plain;
  o.zenith = view.background.zenith, o.horizon = view.background.horizon, o.below = view.background.below;
  return o;
}

template <class T>
uint32_t put_in_slot(std::vector<T>& slots, std::vector<uint32_t>& free, T value) {
  if (free.empty()) {
    slots.push_back(std::move(value));
    return static_cast<uint32_t>(slots.size() - 1);
  }
  const uint32_t slot = free.back();
  free.pop_back();
  slots[slot] = std::move(value);
  return slot;
}

class CpuRenderer final : public Renderer {
 public:
  explicit CpuRenderer(const CpuRendererOptions& options) : options_(options) {}

  std::unique_ptr<StagedMesh> stage_mesh(const Mesh& mesh, std::span<const Material> materials) const override {
    auto staged = std::make_unique<CpuStagedMesh>();
    const Mesh own = with_own_materials(mesh, materials, staged->materials);
    Result<PreparedMesh> prepared = prepare(own, staged->materials);
    if (prepared)
      staged->mesh = std::make_shared<const PreparedMesh>(std::move(*prepared));
    else
      staged->defect = prepared.error().message;
    return staged;
  }

  std::unique_ptr<StagedTexture> stage_texture(const Image& image, uint32_t largest_side) const override {
    auto staged = std::make_unique<CpuStagedTexture>();
    staged->texture = std::make_shared<const MipTexture>(*MipTexture::make(fitting(image), largest_side));
    return staged;
  }

  Result<MeshHandle> create_mesh(const StagedMesh& base, std::span<const TextureHandle> textures) override {
    const auto& staged = static_cast<const CpuStagedMesh&>(base);
    if (!staged.mesh) return Error{staged.defect};
    std::vector<const MipTexture*> pointers;
    for (const TextureHandle t : textures)
      pointers.push_back(t == kNoTextureHandle ? nullptr : textures_[static_cast<uint32_t>(t)].get());
    CpuMesh mesh;
    mesh.mesh = staged.mesh;
    mesh.surfaces = std::make_unique<SurfaceTable>(staged.materials, pointers);
    mesh.bytes = staged.byte_size();
    mesh.blended = has_blended(*mesh.mesh);
    bytes_ += mesh.bytes;
    return MeshHandle{put_in_slot(meshes_, free_meshes_, std::move(mesh))};
  }

  Result<TextureHandle> create_texture(const StagedTexture& base) override {
    const auto& staged = static_cast<const CpuStagedTexture&>(base);
    bytes_ += staged.texture->byte_size();
    return TextureHandle{put_in_slot(textures_, free_textures_, staged.texture)};
  }

  void destroy(MeshHandle handle) override {
    const auto slot = static_cast<uint32_t>(handle);
    bytes_ -= meshes_[slot].bytes;
    meshes_[slot] = {};
    free_meshes_.push_back(slot);
    drawn_ = false;  // its picture may look at the mesh
  }

  void destroy(TextureHandle handle) override {
    const auto slot = static_cast<uint32_t>(handle);
    bytes_ -= textures_[slot]->byte_size();
    textures_[slot].reset();
    free_textures_.push_back(slot);
    drawn_ = false;
  }

  uint64_t bytes_of(MeshHandle mesh) const override { return meshes_[static_cast<uint32_t>(mesh)].bytes; }
  uint64_t bytes_of(TextureHandle texture) const override {
    return textures_[static_cast<uint32_t>(texture)]->byte_size();
  }
  bool copies_staged() const override { return false; }
  uint64_t bytes() const override { return bytes_; }

  uint64_t mesh_bytes_bound(uint64_t vertices, uint64_t triangles) const override {
    return prepared_bytes_bound(vertices, triangles) +
           (triangles + 1) * (sizeof(Material) + sizeof(raster_kernel::Surface));  // each triangle its own material
  }

  uint64_t texture_bytes_bound(uint32_t width, uint32_t height) const override {
    uint64_t texels = 0;
    uint64_t w = std::clamp(width, 1U, kMaxTextureSide), h = std::clamp(height, 1U, kMaxTextureSide);
    for (; w > 1 || h > 1; w = std::max(uint64_t(1), w / 2), h = std::max(uint64_t(1), h / 2)) texels += (w + 1) * h;
    return (texels + 2) * (sizeof(int32_t) + 1);
  }

  uint64_t frame_bytes(uint32_t width_px, uint32_t height_px, bool see_through) const override {
    const uint64_t padded = (uint64_t(width_px) + 7) / 8 * 8 * ((uint64_t(height_px) + 7) / 8 * 8);
    // Depth, id and the farthest depths of the tiles with their borders, of the solid picture and each layer; the
    // picture, how much its pixels differ, and those of its edges before all are known; what each tile shows.
    const uint64_t differences = (uint64_t(width_px) + raster_kernel::kSmoothPadding) * height_px +
                                 (uint64_t(height_px) + 7) / 8 * raster_kernel::kStrengths * sizeof(uint32_t);
    const uint64_t pixels = uint64_t(width_px) * height_px;
    const uint64_t smoothed = std::min(pixels, std::max<uint64_t>(ShadeOptions{}.least_smoothed_px, pixels / 20));
    return (1 + (see_through ? kMostLayers : 0)) * (padded * 8 + padded / 4) + pixels * 4 +
           smoothed * sizeof(raster_kernel::Smoothed) + differences + padded / 8;
  }

  Status draw(const FrameView& view, std::span<const DrawItem> items) override;
  DrawCounts counts() const override { return counts_; }

  Result<Image> read_color() override;
  Result<std::vector<float>> read_depth() override;
  Result<std::vector<uint32_t>> read_nodes() override;

 private:
  VisibilityOptions visibility_options() const;
  Status draw_layers(const ShadeOptions& shading);

  CpuRendererOptions options_;
  std::vector<CpuMesh> meshes_;
  std::vector<std::shared_ptr<const MipTexture>> textures_;
  std::vector<uint32_t> free_meshes_, free_textures_;
  uint64_t bytes_ = 0;

  // The frame drawn last.
  bool drawn_ = false;
  std::vector<RasterItem> items_;
  VisibilityBuffer solid_;                            ///< what is not seen through
  std::array<VisibilityBuffer, kMostLayers> layers_;  ///< what is, the nearest first
  Image image_;
  DrawCounts counts_;
};

VisibilityOptions CpuRenderer::visibility_options() const {
  VisibilityOptions options;
  options.threads = options_.threads, options.simd = options_.simd, options.draw_blended = false;
  options.close_gaps = options_.close_gaps;
  return options;
}

Status CpuRenderer::draw(const FrameView& view, std::span<const DrawItem> items) {
  drawn_ = false;
  bool blended = false;
  items_.clear();
  for (const DrawItem& item : items) {
    const CpuMesh& mesh = meshes_[static_cast<uint32_t>(item.mesh)];
    RasterItem placed{mesh.mesh.get(), index_of(item.node), mesh.surfaces.get(), std::nullopt};
    if (item.model_from_mesh != glm::mat4(1.0F)) placed.model_from_mesh = glm::dmat4(item.model_from_mesh);
    placed.fade_from = item.fade_from, placed.fade_to = item.fade_to;
    placed.error_m = item.error_m;
    blended = blended || mesh.blended;
    items_.push_back(placed);
  }
  PROMENADE_TRY(solid_.draw(perspective_view(view.camera, view.model_origin), items_, visibility_options()));
  counts_ = {solid_.stats().triangles_drawn, solid_.stats().items_drawn};
  const ShadeOptions shading = shading_of(view, options_);
  shade(solid_, shading, image_);
  if (options_.smooth_edges) smooth_edges(solid_, shading, image_);
  if (blended) PROMENADE_TRY(draw_layers(shading));
  drawn_ = true;
  return Done{};
}

/// What is seen through, over the finished picture.
Status CpuRenderer::draw_layers(const ShadeOptions& shading) {
  std::vector<const VisibilityBuffer*> drawn;
  for (VisibilityBuffer& layer : layers_) {
    PROMENADE_TRY(layer.draw_layer(solid_, drawn.empty() ? nullptr : drawn.back(), items_, visibility_options()));
    if (layer.stats().triangles_drawn == 0) break;
    counts_.triangles += layer.stats().triangles_drawn, counts_.draw_calls += layer.stats().items_drawn;
    drawn.push_back(&layer);
  }
  blend_layers(drawn, shading, image_);
  return Done{};
}

Result<Image> CpuRenderer::read_color() {
  if (image_.pixels.empty()) return Error{"the CPU renderer has no frame: draw one before reading it"};
  return image_;
}

Result<std::vector<float>> CpuRenderer::read_depth() {
  if (!drawn_) return Error{"the CPU renderer has no frame: draw one before reading it"};
  std::vector<float> depth(size_t(solid_.width_px()) * solid_.height_px());
  solid_.read_depth_m(depth);
  return depth;
}

Result<std::vector<uint32_t>> CpuRenderer::read_nodes() {
  if (!drawn_) return Error{"the CPU renderer has no frame: draw one before reading it"};
  std::vector<uint32_t> nodes(size_t(solid_.width_px()) * solid_.height_px());
  solid_.read_nodes(nodes);
  return nodes;
}

}  // namespace

std::unique_ptr<Renderer> create_cpu_renderer(const CpuRendererOptions& options) {
  return std::make_unique<CpuRenderer>(options);
}

}  // namespace promenade
