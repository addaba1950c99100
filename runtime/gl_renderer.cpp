#include "runtime/gl_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <optional>
#include <string_view>

#include "runtime/gl_frame_target.h"
#include "runtime/gl_functions.h"
#include "runtime/gl_shaders.h"
#include "runtime/gl_staging.h"

namespace promenade {
namespace {

// GL_EXT_texture_filter_anisotropic; core since 4.6.
constexpr GLenum kMaxAnisotropy = 0x84FF, kTextureAnisotropy = 0x84FE;

/// A material's triangles as they are drawn.
struct DrawGroup {
  glm::vec4 base_color{1};  ///< linear
  float alpha_cutoff = 0;
  GLuint texture = 0;  ///< 0: none
  uint8_t sampler = 0;
  AlphaMode alpha = AlphaMode::opaque;
  bool two_sided = false;
  uint32_t first_index = 0, index_count = 0;
};

struct GlMesh {
  GLuint vertex_array = 0;
  GLuint buffers[2] = {0, 0};  ///< vertices, indices; no vertex array: the slot is free
  GLenum index_type = GL_UNSIGNED_SHORT;
  bool has_normals = false, has_colors = false;
  std::vector<DrawGroup> groups;
  Box box;
  uint64_t bytes = 0;
};

struct GlTexture {
  GLuint id = 0;  ///< 0: the slot is free
  uint64_t bytes = 0;
};

/// An item with its matrices of this frame.
struct PreparedItem {
  const GlMesh* mesh = nullptr;
  NodeId node = kNoNode;
  glm::mat4 clip_from_mesh{1}, eye_from_mesh{1};
  glm::mat3 model_from_mesh_normal{1};
  bool mirrored = false;
  float distance_m = 0;
  glm::vec2 fade{0, 1};  ///< DrawItem::fade_from, fade_to
  bool fades() const { return fade.x > 0 || fade.y < 1; }
};

/// Which groups one sweep over the items draws.
struct Pass {
  bool textured = false;
  bool masked = false;
  bool blended = false;
  bool ids = false;
  bool fading = false;

  bool takes(const DrawGroup& group, bool textures) const {
    const bool masks = group.alpha == AlphaMode::mask, blends = group.alpha == AlphaMode::blend;
    if (masks != masked || blends != blended) return false;
    // Opacity matters to the ids of masked surfaces only.
    return (group.texture != 0 && textures && (!ids || masks)) == textured;
  }
};

glm::vec4 linear_color(const glm::u8vec4& color) {
  return {srgb_to_linear(color.r), srgb_to_linear(color.g), srgb_to_linear(color.b), float(color.a) / 255.0F};
}

uint8_t sampler_index(Wrap u, Wrap v) { return static_cast<uint8_t>(static_cast<int>(u) * 3 + static_cast<int>(v)); }

GLint gl_wrap(int wrap) {
  switch (static_cast<Wrap>(wrap)) {
    case Wrap::repeat:
      return GL_REPEAT;
    case Wrap::mirror:
      return GL_MIRRORED_REPEAT;
    case Wrap::clamp:
      return GL_CLAMP_TO_EDGE;
  }
  return GL_REPEAT;
}

class Renderer33 final : public GlRenderer {
 public:
  Renderer33(GlContext& context, const GlRendererOptions& options)
      : gl_(context.functions()), options_(options), target_(gl_) {}
  Renderer33(const Renderer33&) = delete;
  Renderer33& operator=(const Renderer33&) = delete;
  ~Renderer33() override;

  Status prepare();

  std::unique_ptr<StagedMesh> stage_mesh(const Mesh& mesh, std::span<const Material> materials) const override {
    return std::make_unique<GlStagedMesh>(stage_gl_mesh(mesh, materials));
  }
  std::unique_ptr<StagedTexture> stage_texture(const Image& image, uint32_t largest_side) const override {
    return std::make_unique<GlStagedTexture>(stage_gl_texture(image, std::min(largest_side, max_texture_side_)));
  }
  Result<MeshHandle> create_mesh(const StagedMesh& staged, std::span<const TextureHandle> textures) override;
  Result<TextureHandle> create_texture(const StagedTexture& staged) override;
  void destroy(MeshHandle mesh) override;
  void destroy(TextureHandle texture) override;

  uint64_t bytes_of(MeshHandle mesh) const override { return meshes_[static_cast<uint32_t>(mesh)].bytes; }
  uint64_t bytes_of(TextureHandle texture) const override { return textures_[static_cast<uint32_t>(texture)].bytes; }
  uint64_t mesh_bytes_bound(uint64_t vertices, uint64_t triangles) const override {
    return gl_mesh_bytes_bound(vertices, triangles);
  }
  uint64_t texture_bytes_bound(uint32_t width, uint32_t height) const override {
    return gl_texture_bytes(std::min(width, max_texture_side_), std::min(height, max_texture_side_));
  }
  uint64_t bytes() const override { return bytes_; }
  uint64_t frame_bytes(uint32_t width_px, uint32_t height_px, bool) const override {
    return GlFrameTarget::bytes(width_px, height_px);
  }

  Status draw(const FrameView& view, std::span<const DrawItem> items) override;
  DrawCounts counts() const override { return counts_; }
  Result<Image> read_color() override;
  Result<std::vector<float>> read_depth() override;
  Result<std::vector<uint32_t>> read_nodes() override;
  void present(uint32_t width_px, uint32_t height_px) override;

 private:
  void prepare_items(std::span<const DrawItem> items);
  void clear_depth() const;
  void draw_pass(const Pass& pass, const std::vector<uint32_t>& order);
  void draw_item(const GlProgram& program, const Pass& pass, const PreparedItem& item, bool two_sided);
  void draw_sky();
  const GlProgram& program_of(const Pass& pass) const {
    return surface_programs_[size_t(pass.textured) + size_t(pass.masked) * 2 + size_t(pass.ids) * 4 +
                             size_t(pass.fading) * 8];
  }
  void create_samplers();
  void set_vertex_layout() const;
  Status check(const char* what) const;

  const GlFunctions& gl_;
  GlRendererOptions options_;
  GlFrameTarget target_;
  bool reversed_ = false;
  uint32_t max_texture_side_ = 2048;
  std::array<GlProgram, 16> surface_programs_{};
  GlProgram sky_program_;
  GLuint empty_vertex_array_ = 0;
  std::array<GLuint, 9> samplers_{};

  std::vector<GlMesh> meshes_;
  std::vector<GlTexture> textures_;
  std::vector<uint32_t> free_meshes_, free_textures_;
  uint64_t bytes_ = 0;

  // The frame drawn last.
  bool drawn_ = false;
  FrameView view_;
  double far_m_ = 0;
  std::vector<PreparedItem> prepared_;
  std::vector<uint32_t> whole_, fading_, by_distance_;  ///< items; those without and with fades as given
  DrawCounts counts_;
};

Renderer33::~Renderer33() {
  for (GlMesh& mesh : meshes_) {
    if (mesh.vertex_array == 0) continue;
    gl_.delete_vertex_arrays(1, &mesh.vertex_array);
    gl_.delete_buffers(2, mesh.buffers);
  }
  for (const GlTexture& texture : textures_)
    if (texture.id != 0) gl_.delete_textures(1, &texture.id);
  for (const GlProgram& program : surface_programs_)
    if (program.id != 0) gl_.delete_program(program.id);
  if (sky_program_.id != 0) gl_.delete_program(sky_program_.id);
  if (empty_vertex_array_ != 0) gl_.delete_vertex_arrays(1, &empty_vertex_array_);
  gl_.delete_samplers(static_cast<GLsizei>(samplers_.size()), samplers_.data());
}

Status Renderer33::check(const char* what) const {
  const GLenum error = gl_.get_error();
  if (error == GL_NO_ERROR) return Done{};
  if (error == GL_OUT_OF_MEMORY) return Error{fmt::format("OpenGL: out of memory while {}", what)};
  return Error{fmt::format("OpenGL: error {:#x} while {}", error, what)};
}

Status Renderer33::prepare() {
  GLint side = 0;
  gl_.get_integerv(GL_MAX_TEXTURE_SIZE, &side);
  max_texture_side_ = static_cast<uint32_t>(std::max(side, 64));
  for (size_t i = 0; i < surface_programs_.size(); ++i) {
    const SurfaceVariant variant{(i & 1U) != 0, (i & 2U) != 0, (i & 4U) != 0, (i & 8U) != 0};
    if (variant.ids && variant.textured && !variant.masked) continue;  // never asked for
    const Result<GlProgram> program = build_surface_program(gl_, variant);
    if (!program) return program.error();
    surface_programs_[i] = *program;
  }
  const Result<GlProgram> sky = build_sky_program(gl_);
  if (!sky) return sky.error();
  sky_program_ = *sky;
  gl_.gen_vertex_arrays(1, &empty_vertex_array_);
  create_samplers();
  reversed_ = options_.reversed_depth && gl_.clip_control != nullptr;
  if (reversed_) gl_.clip_control(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  return check("preparing the renderer");
}

void Renderer33::create_samplers() {
  float anisotropy = 1;
  if (gl_.anisotropic) {
    float most = 1;
    gl_.get_floatv(kMaxAnisotropy, &most);
    anisotropy = std::clamp(options_.anisotropy, 1.0F, most);
  }
  gl_.gen_samplers(static_cast<GLsizei>(samplers_.size()), samplers_.data());
  for (int i = 0; i < static_cast<int>(samplers_.size()); ++i) {
    const GLuint sampler = samplers_[static_cast<size_t>(i)];
    gl_.sampler_parameteri(sampler, GL_TEXTURE_WRAP_S, gl_wrap(i / 3));
    gl_.sampler_parameteri(sampler, GL_TEXTURE_WRAP_T, gl_wrap(i % 3));
    gl_.sampler_parameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl_.sampler_parameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    if (anisotropy > 1) gl_.sampler_parameterf(sampler, kTextureAnisotropy, anisotropy);
  }
}

void Renderer33::set_vertex_layout() const {
  const auto attribute = [this](GLuint index, GLint size, GLenum type, GLboolean normalized, size_t offset) {
    gl_.enable_vertex_attrib_array(index);
    gl_.vertex_attrib_pointer(index, size, type, normalized, sizeof(GlVertex), reinterpret_cast<const void*>(offset));
  };
  attribute(kPositionAttribute, 3, GL_FLOAT, GL_FALSE, offsetof(GlVertex, position));
  attribute(kNormalAttribute, 4, GL_INT_2_10_10_10_REV, GL_TRUE, offsetof(GlVertex, normal));
  attribute(kColorAttribute, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(GlVertex, color));
  attribute(kTexcoordAttribute, 2, GL_FLOAT, GL_FALSE, offsetof(GlVertex, texcoord));
}

Result<MeshHandle> Renderer33::create_mesh(const StagedMesh& base, std::span<const TextureHandle> textures) {
  const auto& staged = static_cast<const GlStagedMesh&>(base);
  GlMesh mesh;
  gl_.gen_vertex_arrays(1, &mesh.vertex_array);
  gl_.bind_vertex_array(mesh.vertex_array);
  gl_.gen_buffers(2, mesh.buffers);
  gl_.bind_buffer(GL_ARRAY_BUFFER, mesh.buffers[0]);
  gl_.buffer_data(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(staged.vertices.size() * sizeof(GlVertex)),
                  staged.vertices.data(), GL_STATIC_DRAW);
  gl_.bind_buffer(GL_ELEMENT_ARRAY_BUFFER, mesh.buffers[1]);
  const bool small = staged.indices32.empty();
  const size_t index_bytes = small ? staged.indices16.size() * 2 : staged.indices32.size() * 4;
  const void* index_data = small ? static_cast<const void*>(staged.indices16.data()) : staged.indices32.data();
  gl_.buffer_data(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(index_bytes), index_data, GL_STATIC_DRAW);
  set_vertex_layout();
  gl_.bind_vertex_array(0);
  if (Status status = check("uploading a mesh"); !status) {
    gl_.delete_vertex_arrays(1, &mesh.vertex_array);
    gl_.delete_buffers(2, mesh.buffers);
    return status.error();
  }

  mesh.index_type = small ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
  mesh.has_normals = staged.has_normals;
  mesh.has_colors = staged.has_colors;
  mesh.box = staged.box;
  mesh.groups.reserve(staged.groups.size());
  for (const GlGroup& group : staged.groups) {
    const Material& look = group.material;
    const TextureHandle texture = look.texture < textures.size() ? textures[look.texture] : kNoTextureHandle;
    mesh.groups.push_back({linear_color(look.color), float(look.alpha_cutoff) / 255.0F,
                           texture == kNoTextureHandle ? 0 : textures_[static_cast<uint32_t>(texture)].id,
                           sampler_index(look.wrap_u, look.wrap_v), look.alpha, look.two_sided, group.first_index,
                           group.index_count});
  }
  mesh.bytes = staged.buffer_bytes() + mesh.groups.size() * sizeof(DrawGroup);
  static_assert(sizeof(DrawGroup) <= kGroupBytesMax);
  bytes_ += mesh.bytes;

  uint32_t slot = static_cast<uint32_t>(meshes_.size());
  if (free_meshes_.empty()) {
    meshes_.push_back(std::move(mesh));
  } else {
    slot = free_meshes_.back();
    free_meshes_.pop_back();
    meshes_[slot] = std::move(mesh);
  }
  return MeshHandle{slot};
}

Result<TextureHandle> Renderer33::create_texture(const StagedTexture& base) {
  const auto& staged = static_cast<const GlStagedTexture&>(base);
  GlTexture texture;
  gl_.gen_textures(1, &texture.id);
  gl_.active_texture(GL_TEXTURE0);
  gl_.bind_texture(GL_TEXTURE_2D, texture.id);
  gl_.pixel_storei(GL_UNPACK_ALIGNMENT, 4);
  gl_.tex_parameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(staged.levels.size()) - 1);
  for (size_t level = 0; level < staged.levels.size(); ++level) {
    const Image& image = staged.levels[level];
    gl_.tex_image_2d(GL_TEXTURE_2D, static_cast<GLint>(level), GL_SRGB8_ALPHA8, static_cast<GLsizei>(image.width),
                     static_cast<GLsizei>(image.height), 0, GL_RGBA, GL_UNSIGNED_BYTE, image.pixels.data());
  }
  if (Status status = check("uploading a texture"); !status) {
    gl_.delete_textures(1, &texture.id);
    return status.error();
  }
  texture.bytes = staged.byte_size();
  bytes_ += texture.bytes;
  uint32_t slot = static_cast<uint32_t>(textures_.size());
  if (free_textures_.empty()) {
    textures_.push_back(texture);
  } else {
    slot = free_textures_.back();
    free_textures_.pop_back();
    textures_[slot] = texture;
  }
  return TextureHandle{slot};
}

void Renderer33::destroy(MeshHandle handle) {
  GlMesh& mesh = meshes_[static_cast<uint32_t>(handle)];
  gl_.delete_vertex_arrays(1, &mesh.vertex_array);
  gl_.delete_buffers(2, mesh.buffers);
  bytes_ -= mesh.bytes;
  mesh = GlMesh{};
  free_meshes_.push_back(static_cast<uint32_t>(handle));
  drawn_ = false;  // the frame's items may name it
}

void Renderer33::destroy(TextureHandle handle) {
  GlTexture& texture = textures_[static_cast<uint32_t>(handle)];
  gl_.delete_textures(1, &texture.id);
  bytes_ -= texture.bytes;
  texture = GlTexture{};
  free_textures_.push_back(static_cast<uint32_t>(handle));
  drawn_ = false;
}

/// Matrices of all items. Translations relative to the eye are made in double: a model far from its origin does not
/// shake.
void Renderer33::prepare_items(std::span<const DrawItem> items) {
  const Basis basis = basis_of(view_.camera.pose);
  const glm::dvec3 eye = view_.camera.pose.eye - view_.model_origin;
  const glm::dmat4 view_from_eye = glm::transpose(glm::dmat4(glm::dvec4(basis.right, 0), glm::dvec4(basis.up, 0),
                                                             glm::dvec4(-basis.forward, 0), glm::dvec4(0, 0, 0, 1)));
  prepared_.clear();
  prepared_.reserve(items.size());
  far_m_ = view_.camera.near_m * 2;
  for (const DrawItem& item : items) {
    PreparedItem p;
    p.mesh = &meshes_[static_cast<uint32_t>(item.mesh)];
    p.node = item.node;
    p.fade = {item.fade_from, item.fade_to};
    glm::dmat4 eye_from_mesh(item.model_from_mesh);
    eye_from_mesh[3] -= glm::dvec4(eye, 0);
    p.eye_from_mesh = glm::mat4(eye_from_mesh);
    const glm::dmat3 linear(eye_from_mesh);
    p.mirrored = glm::determinant(linear) < 0;
    p.model_from_mesh_normal = glm::mat3(glm::inverseTranspose(linear));
    const glm::dvec3 center = glm::dvec3(eye_from_mesh * glm::dvec4(glm::dvec3(p.mesh->box.center()), 1));
    p.distance_m = static_cast<float>(glm::length(center));
    const double reach = 0.5 * double(p.mesh->box.diagonal()) *
                         std::sqrt(std::max({glm::dot(linear[0], linear[0]), glm::dot(linear[1], linear[1]),
                                             glm::dot(linear[2], linear[2])}) *
                                   3.0);
    far_m_ = std::max(far_m_, glm::length(center) + reach);
    prepared_.push_back(p);
  }
  glm::dmat4 clip_from_view(promenade::clip_from_view(view_.camera, far_m_ * 1.01));
  if (reversed_) {
    // Depth near / distance: 1 at the near plane, 0 infinitely far away.
    clip_from_view[2][2] = 0;
    clip_from_view[3][2] = view_.camera.near_m;
  }
  const glm::dmat4 clip_from_eye = clip_from_view * view_from_eye;
  for (size_t i = 0; i < items.size(); ++i) {
    glm::dmat4 eye_from_mesh(items[i].model_from_mesh);
    eye_from_mesh[3] -= glm::dvec4(eye, 0);
    prepared_[i].clip_from_mesh = glm::mat4(clip_from_eye * eye_from_mesh);
  }
  whole_.clear();
  fading_.clear();
  by_distance_.clear();
  for (uint32_t i = 0; i < items.size(); ++i) {
    (prepared_[i].fades() ? fading_ : whole_).push_back(i);
    by_distance_.push_back(i);
  }
  std::stable_sort(by_distance_.begin(), by_distance_.end(),
                   [this](uint32_t a, uint32_t b) { return prepared_[a].distance_m > prepared_[b].distance_m; });
}

void Renderer33::clear_depth() const {
  gl_.depth_mask(GL_TRUE);
  const float depth = reversed_ ? 0.0F : 1.0F;
  gl_.clear_bufferfv(GL_DEPTH, 0, &depth);
  gl_.enable(GL_DEPTH_TEST);
  gl_.depth_func(reversed_ ? GL_GREATER : GL_LESS);
}

Status Renderer33::draw(const FrameView& view, std::span<const DrawItem> items) {
  PROMENADE_TRY(target_.resize(view.camera.width_px, view.camera.height_px));
  view_ = view;
  counts_ = {};
  prepare_items(items);
  target_.bind_color();
  gl_.enable(GL_FRAMEBUFFER_SRGB);
  gl_.disable(GL_BLEND);
  clear_depth();
  const glm::vec4 plain = linear_color(view.background.plain);
  gl_.clear_bufferfv(GL_COLOR, 0, glm::value_ptr(plain));
  for (const bool masked : {false, true})
    for (const bool textured : {false, true}) {
      draw_pass({textured, masked, false, false, false}, whole_);
      draw_pass({textured, masked, false, false, true}, fading_);
    }
  gl_.depth_mask(GL_FALSE);
  if (view.background.sky) draw_sky();
  gl_.enable(GL_BLEND);
  gl_.blend_func_separate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  // Item by item, so that textured and plain glass keep their order.
  std::vector<uint32_t> one(1);
  for (const uint32_t item : by_distance_) {
    const std::vector<DrawGroup>& groups = prepared_[item].mesh->groups;
    if (groups.empty() || groups.back().alpha != AlphaMode::blend) continue;
    one[0] = item;
    for (const bool textured : {false, true}) draw_pass({textured, false, true, false, prepared_[item].fades()}, one);
  }
  gl_.disable(GL_BLEND);
  gl_.depth_mask(GL_TRUE);
  gl_.finish();
  drawn_ = true;
  return check("drawing");
}

void Renderer33::draw_pass(const Pass& pass, const std::vector<uint32_t>& order) {
  const GlProgram& program = program_of(pass);
  bool started = false;
  for (const uint32_t index : order) {
    const PreparedItem& item = prepared_[index];
    bool one_sided = false, two_sided = false;
    for (const DrawGroup& group : item.mesh->groups)
      if (pass.takes(group, view_.textures)) (group.two_sided ? two_sided : one_sided) = true;
    if (!one_sided && !two_sided) continue;
    if (!started) {
      gl_.use_program(program.id);
      const glm::vec3 to_sun = glm::normalize(view_.lighting.to_sun);
      gl_.uniform_3fv(program.to_sun, 1, glm::value_ptr(to_sun));
      gl_.uniform_3fv(program.sun, 1, glm::value_ptr(view_.lighting.sun));
      gl_.uniform_3fv(program.sky_ambient, 1, glm::value_ptr(view_.lighting.sky_ambient));
      gl_.uniform_3fv(program.ground_ambient, 1, glm::value_ptr(view_.lighting.ground_ambient));
      gl_.uniform_1i(program.opaque, pass.blended ? 0 : 1);
      gl_.uniform_1i(program.picture, 0);
      gl_.active_texture(GL_TEXTURE0);
      started = true;
    }
    gl_.uniform_matrix_4fv(program.clip_from_mesh, 1, GL_FALSE, glm::value_ptr(item.clip_from_mesh));
    gl_.uniform_matrix_4fv(program.eye_from_mesh, 1, GL_FALSE, glm::value_ptr(item.eye_from_mesh));
    gl_.uniform_matrix_3fv(program.model_from_mesh_normal, 1, GL_FALSE, glm::value_ptr(item.model_from_mesh_normal));
    gl_.uniform_1i(program.has_normals, item.mesh->has_normals ? 1 : 0);
    gl_.uniform_1i(program.has_colors, item.mesh->has_colors ? 1 : 0);
    gl_.uniform_1ui(program.node, index_of(item.node));
    if (pass.fading) gl_.uniform_2fv(program.fade, 1, glm::value_ptr(item.fade));
    gl_.front_face(item.mirrored ? GL_CW : GL_CCW);
    gl_.bind_vertex_array(item.mesh->vertex_array);
    if (one_sided) draw_item(program, pass, item, false);
    if (two_sided) draw_item(program, pass, item, true);
  }
}

void Renderer33::draw_item(const GlProgram& program, const Pass& pass, const PreparedItem& item, bool two_sided) {
  (two_sided ? gl_.disable : gl_.enable)(GL_CULL_FACE);
  const size_t index_size = item.mesh->index_type == GL_UNSIGNED_SHORT ? 2 : 4;
  for (const DrawGroup& group : item.mesh->groups) {
    if (group.two_sided != two_sided || !pass.takes(group, view_.textures)) continue;
    gl_.uniform_4fv(program.base_color, 1, glm::value_ptr(group.base_color));
    if (pass.masked) gl_.uniform_1f(program.alpha_cutoff, group.alpha_cutoff);
    if (pass.textured) {
      gl_.bind_texture(GL_TEXTURE_2D, group.texture);
      gl_.bind_sampler(0, samplers_[group.sampler]);
    }
    gl_.draw_elements(GL_TRIANGLES, static_cast<GLsizei>(group.index_count), item.mesh->index_type,
                      reinterpret_cast<const void*>(group.first_index * index_size));
    counts_.triangles += group.index_count / 3;
    ++counts_.draw_calls;
  }
}

void Renderer33::draw_sky() {
  const Basis basis = basis_of(view_.camera.pose);
  const double tan_y = std::tan(glm::radians(view_.camera.vertical_fov_deg) / 2);
  const double tan_x = tan_y * double(view_.camera.width_px) / double(view_.camera.height_px);
  const glm::vec3 forward(basis.forward), right(basis.right * tan_x), up(basis.up * tan_y);
  gl_.use_program(sky_program_.id);
  gl_.uniform_3fv(sky_program_.forward, 1, glm::value_ptr(forward));
  gl_.uniform_3fv(sky_program_.right, 1, glm::value_ptr(right));
  gl_.uniform_3fv(sky_program_.up, 1, glm::value_ptr(up));
  const glm::vec3 zenith(linear_color(view_.background.zenith)), horizon(linear_color(view_.background.horizon)),
      below(linear_color(view_.background.below));
  gl_.uniform_3fv(sky_program_.zenith, 1, glm::value_ptr(zenith));
  gl_.uniform_3fv(sky_program_.horizon, 1, glm::value_ptr(horizon));
  gl_.uniform_3fv(sky_program_.below, 1, glm::value_ptr(below));
  gl_.uniform_1f(sky_program_.depth, reversed_ ? 0.0F : 1.0F);
  gl_.disable(GL_CULL_FACE);
  gl_.depth_func(reversed_ ? GL_GEQUAL : GL_LEQUAL);
  gl_.bind_vertex_array(empty_vertex_array_);
  gl_.draw_arrays(GL_TRIANGLES, 0, 3);
  gl_.depth_func(reversed_ ? GL_GREATER : GL_LESS);
}

Result<Image> Renderer33::read_color() {
  if (target_.width() == 0) return Error{"OpenGL: no frame has been drawn"};
  Image image = target_.read_color();
  PROMENADE_TRY(check("reading the picture"));
  return image;
}

Result<std::vector<float>> Renderer33::read_depth() {
  if (target_.width() == 0) return Error{"OpenGL: no frame has been drawn"};
  std::vector<float> depth = target_.read_depth();
  const float near = static_cast<float>(view_.camera.near_m);
  const double n = view_.camera.near_m, f = far_m_ * 1.01;
  for (float& d : depth) {
    if (reversed_)
      d = d > 0 ? near / d : std::numeric_limits<float>::infinity();
    else
      d = d < 1 ? static_cast<float>(2 * n * f / (f + n - (2 * double(d) - 1) * (f - n)))
                : std::numeric_limits<float>::infinity();
  }
  PROMENADE_TRY(check("reading depth"));
  return depth;
}

Result<std::vector<uint32_t>> Renderer33::read_nodes() {
  if (!drawn_) return Error{"OpenGL: no frame has been drawn, or its meshes are gone"};
  target_.bind_ids();
  gl_.disable(GL_FRAMEBUFFER_SRGB);
  gl_.disable(GL_BLEND);
  static constexpr GLuint kBackground[4] = {0xffffffffU, 0, 0, 0};
  gl_.clear_bufferuiv(GL_COLOR, 0, kBackground);
  clear_depth();
  const DrawCounts counts = counts_;
  for (const bool fading : {false, true}) {
    const std::vector<uint32_t>& items = fading ? fading_ : whole_;
    draw_pass({false, false, false, true, fading}, items);
    for (const bool textured : {false, true}) draw_pass({textured, true, false, true, fading}, items);
  }
  counts_ = counts;
  std::vector<uint32_t> ids = target_.read_ids();
  PROMENADE_TRY(check("drawing node ids"));
  return ids;
}

void Renderer33::present(uint32_t width_px, uint32_t height_px) {
  if (target_.width() == 0) return;
  gl_.disable(GL_FRAMEBUFFER_SRGB);  // bytes as they are
  gl_.bind_framebuffer(GL_READ_FRAMEBUFFER, target_.color_framebuffer());
  gl_.bind_framebuffer(GL_DRAW_FRAMEBUFFER, 0);
  const GLint w = static_cast<GLint>(target_.width()), h = static_cast<GLint>(target_.height());
  const bool same = width_px == target_.width() && height_px == target_.height();
  gl_.blit_framebuffer(0, 0, w, h, 0, 0, static_cast<GLint>(width_px), static_cast<GLint>(height_px),
                       GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
  gl_.bind_framebuffer(GL_FRAMEBUFFER, 0);
  gl_.viewport(0, 0, static_cast<GLsizei>(width_px), static_cast<GLsizei>(height_px));
}

}  // namespace

Result<std::unique_ptr<GlRenderer>> create_gl_renderer(GlContext& context, const GlRendererOptions& options) {
  auto renderer = std::make_unique<Renderer33>(context, options);
  PROMENADE_TRY(renderer->prepare());
  return std::unique_ptr<GlRenderer>(std::move(renderer));
}

}  // namespace promenade
