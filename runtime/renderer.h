#pragma once
// What draws: meshes and textures in, pictures out. Behind this interface stand OpenGL (gl_renderer.h) and the CPU
// visibility buffer (cpu_renderer.h).

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"
#include "geometry/node_id.h"
#include "geometry/result.h"

namespace promenade {

/// Who draws: OpenGL, the CPU visibility buffer, or whichever of them is faster here: both are timed once for each way
/// to OpenGL (a window, a context in memory, a GPU without a display), and the figures kept (calibration.h).
enum class RendererKind : uint8_t { automatic, gl, cpu };

/// Names of what a renderer holds. A handle is used by the renderer that gave it and, once destroyed, never again.
enum class TextureHandle : uint32_t {};
enum class MeshHandle : uint32_t {};
constexpr TextureHandle kNoTextureHandle{0xffffffffU};
constexpr MeshHandle kNoMeshHandle{0xffffffffU};
/// Of pictures: no bound.
constexpr uint32_t kAnySide = 0xffffffffU;

/// A mesh brought into the form that the renderer uploads (interleaved, grouped by material). Made on any thread.
class StagedMesh {
 public:
  virtual ~StagedMesh() = default;
  /// Heap bytes that this object holds.
  virtual uint64_t byte_size() const = 0;
};

/// A picture in the form that the renderer uploads (with its mip maps). Made on any thread.
class StagedTexture {
 public:
  virtual ~StagedTexture() = default;
  virtual uint64_t byte_size() const = 0;
};

/// The light of day: a sun, and a sky that lights from above and (reflected) from below. Linear colours.
struct Lighting {
  glm::vec3 to_sun{0.40F, -0.55F, 0.73F};  ///< model space; need not be unit
  glm::vec3 sun{0.72F, 0.69F, 0.62F};
  glm::vec3 sky_ambient{0.30F, 0.34F, 0.40F};
  glm::vec3 ground_ambient{0.16F, 0.15F, 0.13F};
};

/// What is seen where no surface is.
struct Background {
  bool sky = true;                  ///< false: the plain colour
  glm::u8vec4 plain{0, 0, 0, 255};  ///< sRGB
  glm::u8vec4 zenith{84, 132, 196, 255};
  glm::u8vec4 horizon{200, 216, 232, 255};
  glm::u8vec4 below{120, 116, 108, 255};
};

/// Where a frame is seen from. Model space is the world less model_origin.
struct FrameView {
  Camera camera;
  glm::dvec3 model_origin{0};
  Lighting lighting;
  Background background;
  bool textures = true;  ///< false: surfaces in their material's and vertices' colours only
};

/// One mesh, placed. For a model's node the matrix is the identity; for an instance of a source its transform.
/// Any affine matrix; a mirroring one (negative determinant) keeps fronts fronts.
struct DrawItem {
  MeshHandle mesh = kNoMeshHandle;
  NodeId node = kNoNode;  ///< what read_nodes() reports
  glm::mat4 model_from_mesh{1.0F};
  /// A fade between levels: drawn at the pixels whose threshold in an ordered 8 x 8 pattern lies in [fade_from,
  /// fade_to). A node with [0, a) and its children with [a, 1) share the picture exactly: at every pixel one of them
  /// is drawn.
  float fade_from = 0, fade_to = 1;
  /// Bound on the distance between the mesh's surface and what it stands for, in metres: how wide gaps beside its
  /// neighbours may be that are closed; 0: none.
  float error_m = 0;
};

/// What the last frame cost, counted by the renderer.
struct DrawCounts {
  uint64_t triangles = 0;
  uint64_t draw_calls = 0;
};

/// Thread: stage_* from any thread at once; everything else on the thread that made the renderer (the render thread).
class Renderer {
 public:
  virtual ~Renderer() = default;

  /// Brings a sound mesh (find_defect empty, materials in range) into uploadable form. `materials`: what
  /// Mesh::materials indexes. Groups triangles by material.
  virtual std::unique_ptr<StagedMesh> stage_mesh(const Mesh& mesh, std::span<const Material> materials) const = 0;
  /// Makes the mip maps (box filter in linear light, weighted by opacity). A picture larger than the renderer takes, or
  /// with a side over largest_side (> 0), is halved until it fits; an empty one becomes one white pixel.
  virtual std::unique_ptr<StagedTexture> stage_texture(const Image& image, uint32_t largest_side) const = 0;
  std::unique_ptr<StagedTexture> stage_texture(const Image& image) const { return stage_texture(image, kAnySide); }

  /// textures: what Material::texture indexes; kNoTextureHandle (or beyond the end): drawn in the plain colour. The
  /// textures must outlive the mesh. Errors: out of memory.
  virtual Result<MeshHandle> create_mesh(const StagedMesh& staged, std::span<const TextureHandle> textures) = 0;
  virtual Result<TextureHandle> create_texture(const StagedTexture& staged) = 0;
  virtual void destroy(MeshHandle mesh) = 0;
  virtual void destroy(TextureHandle texture) = 0;

  /// Exact bytes of vertices and indices, or of texels in all mip levels, that a handle holds.
  virtual uint64_t bytes_of(MeshHandle mesh) const = 0;
  virtual uint64_t bytes_of(TextureHandle texture) const = 0;
  /// Upper bounds, before there is a handle, of staged and of uploaded size alike: for admission under a memory bound.
  virtual uint64_t mesh_bytes_bound(uint64_t vertices, uint64_t triangles) const = 0;
  virtual uint64_t texture_bytes_bound(uint32_t width, uint32_t height) const = 0;
  /// Whether a handle holds a copy of what was staged, and both are there for a moment.
  virtual bool copies_staged() const { return true; }
  /// Bytes of all living meshes and textures.
  virtual uint64_t bytes() const = 0;
  /// Bytes of the picture, its depth and whatever else a frame needs at this size. see_through: the scene has surfaces
  /// with AlphaMode::blend.
  virtual uint64_t frame_bytes(uint32_t width_px, uint32_t height_px, bool see_through) const = 0;

  /// Draws a frame in linear light to sRGB bytes: opaque and masked surfaces in the given order (give them front to
  /// back), the sky, then blended ones back to front by item. Returns when the picture is whole.
  virtual Status draw(const FrameView& view, std::span<const DrawItem> items) = 0;
  virtual DrawCounts counts() const = 0;

  /// Of the frame drawn last. Row 0 at the top.
  virtual Result<Image> read_color() = 0;
  /// Metres along the view axis to the nearest opaque or masked surface; +infinity where there is none.
  virtual Result<std::vector<float>> read_depth() = 0;
  /// Node of the nearest opaque or masked surface, 0xffffffff where there is none. May draw the scene once more.
  virtual Result<std::vector<uint32_t>> read_nodes() = 0;
};

}  // namespace promenade
