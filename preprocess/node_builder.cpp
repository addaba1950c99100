#include "preprocess/node_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "codec/image_codec.h"
#include "codec/quantized_mesh.h"
#include "preprocess/bake.h"
#include "preprocess/fins.h"
#include "preprocess/node_mesh.h"
#include "preprocess/simplify.h"

namespace promenade {

namespace {

constexpr uint32_t kLocalTexture = 0x80000000U;  // a child's atlas rather than a shared texture
constexpr double kStepShare = 1.0 / 8;           // of a node's error that its grid is wide: adds a tenth at most
// How exactly a node's distance to its children is measured: what their own errors hide, or what is small beside the
// node, need not be (a sixth of a build's time).
constexpr double kToleranceOfError = 0.25, kToleranceOfSize = 1e-4;
// How much the bound may exceed the largest distance that is really there: an eighth less error at 0.04 than at 0.25,
// for a few per cent of a build's time. At 0.02 a city's fronts are 1.4 % smaller than at 0.04, at no time that shows,
// but where colours meet is known by the bound too, and one triangle of a striped wall shows the wrong one.
constexpr double kSlack = 0.03;
constexpr int kMostHalvings = 12;  // of the grid, while it would take thin things away
constexpr int kMostSteps = 64;     // doublings of the grid until a mesh fits: more than any float needs

double power_of_two_below(double value) { return std::exp2(std::floor(std::log2(value))); }

float rounded_up(double value) {
  const auto rounded = static_cast<float>(value);
  return double(rounded) >= value ? rounded : std::nextafter(rounded, std::numeric_limits<float>::max());
}

/// What single precision may have moved a point when it was placed in the model.
double rounding_m(const Mesh& mesh) {
  const Box box = bounds(mesh);
  double farthest = 0;
  for (int axis = 0; axis < 3; ++axis)
    farthest = std::max({farthest, std::abs(double(box.min[axis])), std::abs(double(box.max[axis]))});
  return farthest * std::sqrt(3.0) * std::exp2(-24);
}

/// The triangles that are of other materials; positions and triangles only.
Mesh without_materials(const Mesh& mesh, const std::function<bool(uint32_t)>& left_out) {
  Mesh out;
  out.positions = mesh.positions;
  out.indices.reserve(mesh.indices.size());
  for (size_t t = 0; t < mesh.triangle_count(); ++t)
    if (!left_out(mesh.material_of(t)))
      for (size_t c = 0; c < 3; ++c) out.indices.push_back(mesh.indices[3 * t + c]);
  return out;
}

/// Some vertices on a finer grid than the others.
Mesh rounded_apart(const Mesh& mesh, const std::vector<uint8_t>& is_fine, float step_m, float fine_step_m) {
  Mesh rounded = mesh;
  for (size_t v = 0; v < mesh.vertex_count(); ++v)
    rounded.positions[v] = snapped(mesh.positions[v], is_fine[v] != 0 ? fine_step_m : step_m);
  return rounded;
}

double largest_distance_m(const Mesh& a, const Mesh& b) {
  double largest = 0;
  for (size_t v = 0; v < a.vertex_count(); ++v)
    largest = std::max(largest, glm::length(glm::dvec3(a.positions[v]) - glm::dvec3(b.positions[v])));
  return largest;
}

}  // namespace

MaterialBase::MaterialBase(std::vector<Material> source) : materials(std::move(source)) {
  for (uint32_t i = 0; i < kPlain; ++i) {
    Material plain_material;
    plain_material.two_sided = (i & 1) != 0;
    plain_material.alpha = (i & 2) != 0 ? AlphaMode::blend : AlphaMode::opaque;
    materials.push_back(plain_material);
  }
}

uint32_t MaterialBase::plain(bool two_sided, bool see_through) const {
  return size() - kPlain + (two_sided ? 1U : 0U) + (see_through ? 2U : 0U);
}

GeometryEncodeOptions encode_options(GeometryCodec codec, float step_m, float fine_step_m) {
  GeometryEncodeOptions options;
  options.codec = step_m > 0 ? codec : GeometryCodec::raw;
  if (options.codec != GeometryCodec::raw) options.position_step_m = step_m;
  options.fine_step_m = fine_step_m;
  return options;
}

/// The children's surfaces together.
struct NodeBuilder::Merged {
  Mesh mesh;
  std::vector<Material> materials;                    ///< the base, then all children's atlas materials
  std::vector<std::shared_ptr<const Image>> atlases;  ///< kLocalTexture | index
  Border border;
  bool textured = false;
};

bool NodeBuilder::is_textured(uint32_t material) const {
  return material >= base_.size() || base_.materials[material].texture != kNoTexture;
}

bool NodeBuilder::is_two_sided(uint32_t material, std::span<const Material> atlas_materials) const {
  return material < base_.size() ? base_.materials[material].two_sided
                                 : atlas_materials[material - base_.size()].two_sided;
}

Result<BuiltNode> NodeBuilder::leaf(Mesh mesh, Border border) const {
  const auto textured = [this](uint32_t m) { return is_textured(m); };
  drop_idle_attributes(mesh, textured);
  BuiltNode node;
  NodeSurface& surface = node.surface;
  surface.error_m = surface.p99_m = rounding_m(mesh);
  add_leaf_textures(mesh, node);
  PROMENADE_TRY(store({mesh, {}, false}, double(options_.leaf_step_m), {}, node));
  fold_colors(mesh, base_.materials, [this](uint32_t m) {
    const Material& material = base_.materials[m];
    return material.texture != kNoTexture ? m : base_.plain(material.two_sided, material.alpha == AlphaMode::blend);
  });
  drop_idle_attributes(mesh, textured);
  surface.mesh = std::move(mesh);
  surface.border = std::move(border);
  return node;
}

/// What a leaf shows, with the texels' sizes; what making pictures smaller has cost is part of its error.
void NodeBuilder::add_leaf_textures(const Mesh& mesh, BuiltNode& node) const {
  NodeSurface& surface = node.surface;
  std::map<uint32_t, double> texels_m;  // by texture: the largest
  for (const uint32_t material : materials_of(mesh)) {
    if (!is_textured(material)) continue;
    const uint32_t id = base_.materials[material].texture;
    const StoredTexture& texture = textures_[id];
    const double texel_m = texel_size_m(mesh, material, texture.width, texture.height);
    if (texture.reduction > 1) surface.texture_error_m = std::max(surface.texture_error_m, kTexelReach * texel_m);
    if (texel_m > 0 && (surface.texel_m == 0 || texel_m < double(surface.texel_m)))
      surface.texel_m = static_cast<float>(texel_m);
    // Where one of its materials is a palette, the picture stays whole.
    const double here_m = largest_texel_m(mesh, material, texture.width, texture.height);
    const auto [largest_m, is_new] = texels_m.try_emplace(id, here_m);
    if (!is_new) largest_m->second = here_m > 0 && largest_m->second > 0 ? std::max(here_m, largest_m->second) : 0;
  }
  for (const auto& [texture, texel_m] : texels_m) {
    node.stored.textures.push_back(texture);
    node.stored.texels_m.push_back(static_cast<float>(texel_m));
  }
}

NodeBuilder::Merged NodeBuilder::merge(std::span<const NodeSurface> children) const {
  const NodeProfile::Clock clock(profile_, NodeProfile::Part::merge);
  Merged merged;
  merged.materials = base_.materials;
  std::vector<const Border*> borders;
  std::vector<uint32_t> first_triangle;
  size_t vertices = 0, triangles = 0;
  for (const NodeSurface& child : children)
    vertices += child.mesh.vertex_count(), triangles += child.mesh.triangle_count();
  merged.mesh.positions.reserve(vertices), merged.mesh.normals.reserve(vertices), merged.mesh.colors.reserve(vertices);
  merged.mesh.indices.reserve(triangles * 3), merged.mesh.materials.reserve(triangles);
  for (const NodeSurface& child : children) {
    borders.push_back(&child.border), first_triangle.push_back(static_cast<uint32_t>(merged.mesh.triangle_count()));
    const auto offset = static_cast<uint32_t>(merged.materials.size()) - base_.size();
    append(merged.mesh, child.mesh);
    for (size_t t = first_triangle.back(); t < merged.mesh.materials.size(); ++t) {
      uint32_t& material = merged.mesh.materials[t];
      merged.textured = merged.textured || is_textured(material);
      if (material >= base_.size()) material += offset;
    }
    for (Material material : child.atlas_materials) {
      material.texture = kLocalTexture | static_cast<uint32_t>(merged.atlases.size());
      merged.materials.push_back(material);
    }
    if (child.atlas) merged.atlases.push_back(child.atlas);
  }
  merged.border = join_borders(merged.mesh, borders, first_triangle);
  return merged;
}

/// What the children were measured against, or the children themselves where that is too much.
Reference NodeBuilder::reference_of(std::span<const NodeSurface> children) const {
  size_t triangles = 0;
  for (const NodeSurface& child : children)
    triangles += std::max(child.reference.mesh.triangle_count(), child.mesh.triangle_count());
  const bool detailed = triangles <= kReferenceNodes * options_.node_triangles;
  Reference reference;
  size_t vertices = 0;
  for (const NodeSurface& child : children)
    vertices += std::max(child.reference.mesh.vertex_count(), child.mesh.vertex_count());
  reference.mesh.positions.reserve(vertices), reference.mesh.indices.reserve(triangles * 3);
  for (const NodeSurface& child : children) {
    const bool own = !detailed || child.reference.mesh.indices.empty();
    const Mesh& mesh = own ? child.mesh : child.reference.mesh;
    const auto first = static_cast<uint32_t>(reference.mesh.positions.size());
    reference.mesh.positions.insert(reference.mesh.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const uint32_t v : mesh.indices) reference.mesh.indices.push_back(first + v);
    reference.error_m = std::max(reference.error_m, own ? child.error_m : child.reference.error_m);
    reference.p99_m = std::max(reference.p99_m, own ? child.p99_m : child.reference.p99_m);
  }
  return reference;
}

Result<BuiltNode> NodeBuilder::inner(std::span<const NodeSurface> children) const {
  BuiltNode node;
  NodeSurface& surface = node.surface;
  for (const NodeSurface& child : children) {
    surface.error_m = std::max(surface.error_m, child.error_m);
    surface.p99_m = std::max(surface.p99_m, child.p99_m);
    surface.texture_error_m = std::max(surface.texture_error_m, child.texture_error_m);
    if (child.texel_m > 0 && (surface.texel_m == 0 || child.texel_m < surface.texel_m)) surface.texel_m = child.texel_m;
  }
  surface.reference = reference_of(children);
  Merged merged = merge(children);
  Mesh bare = merged.textured ? merged.mesh : std::move(merged.mesh);  // to be baked from
  bare.texcoords.clear();
  for (uint32_t& material : bare.materials) {
    const bool see_through =
        material < base_.size() && !is_textured(material) && base_.materials[material].alpha == AlphaMode::blend;
    material = base_.plain(merged.materials[material].two_sided, see_through);
  }
  const Shape shape = reduce(std::move(bare), merged.border, surface);
  if (surface.mesh.indices.empty()) return Error{"simplification left no triangle: please report this with the source"};
  if (merged.textured) PROMENADE_TRY(bake(merged, node));
  const double step_m = std::min(step_of(surface.error_m + surface.texture_error_m), shape.most_step_m);
  Shown shown{surface.mesh, {}, shape.has_fins};  // its parent begins with the exact colours
  round_colors(shown.mesh);
  shown.is_exact =
      add_fins(shown.mesh, surface.border,
               fin_options([&](uint32_t material) { return fin_material(material, node.stored.atlas_materials); }));
  PROMENADE_TRY(store(shown, step_m, children, node));
  return node;
}

FinOptions NodeBuilder::fin_options(std::function<uint32_t(uint32_t material)> fin_material) const {
  return {options_.leaf_step_m, std::move(fin_material)};
}

double NodeBuilder::step_of(double error_m) const {
  const double step_m = error_m > 0 ? power_of_two_below(error_m * kStepShare) : 0;
  return std::max(step_m, double(options_.leaf_step_m));
}

/// Positions and triangles only.
Mesh NodeBuilder::with_fins(const Mesh& mesh, const Border& border) const {
  Mesh out;
  out.positions = mesh.positions, out.indices = mesh.indices;
  add_fins(out, border, fin_options({}));
  return out;
}

/// Gives the surface its mesh and border and, fins included, its error.
NodeBuilder::Shape NodeBuilder::reduce(Mesh bare, Border border, NodeSurface& surface) const {
  Shape shape;
  SimplifyOptions options;
  options.target_triangles = options_.node_triangles;
  SimplifyFigures figures;
  const float diagonal_m = bounds(bare).diagonal();
  options.besides = [&](const Mesh& mesh, const Border& its_border) {
    return with_fins(mesh, its_border).triangle_count() - mesh.triangle_count();
  };
  {
    const NodeProfile::Clock clock(profile_, NodeProfile::Part::simplify);
    surface.mesh = simplify(bare, options, border, &figures);
  }
  const bool is_reduced = surface.mesh.triangle_count() < bare.triangle_count();
  surface.border = std::move(border);
  if (surface.mesh.indices.empty()) return shape;
  const Reference& reference = surface.reference;
  shape.most_step_m = figures.sheet_height_m > 0
                          ? std::max(double(figures.sheet_height_m), double(options_.leaf_step_m))
                          : std::numeric_limits<double>::infinity();
  const Mesh measured = with_fins(surface.mesh, surface.border);
  shape.has_fins = measured.indices.size() > surface.mesh.indices.size();
  if (!is_reduced && !shape.has_fins) return shape;
  const double tolerance_m = std::max(kToleranceOfError * reference.error_m, kToleranceOfSize * double(diagonal_m));
  const NodeProfile::Clock clock(profile_, NodeProfile::Part::measure);
  const SurfaceDistance distance = surface_distance(reference.mesh, measured, kSlack, tolerance_m);
  surface.error_m = reference.error_m + double(distance.bound_m);
  surface.p99_m = reference.p99_m + double(distance.p99_m);
  return shape;
}

/// The same, seen from both sides.
uint32_t NodeBuilder::fin_material(uint32_t material, std::vector<Material>& atlas_materials) const {
  if (is_two_sided(material, atlas_materials)) return material;
  if (material < base_.size()) return base_.plain(true, base_.materials[material].alpha == AlphaMode::blend);
  Material wanted = atlas_materials[material - base_.size()];
  wanted.two_sided = true;
  auto place = std::find(atlas_materials.begin(), atlas_materials.end(), wanted);
  if (place == atlas_materials.end()) place = atlas_materials.insert(place, wanted);
  return base_.size() + static_cast<uint32_t>(place - atlas_materials.begin());
}

/// Gives the node an atlas of its own.
Status NodeBuilder::bake(const Merged& merged, BuiltNode& node) const {
  const NodeProfile::Clock clock(profile_, NodeProfile::Part::bake);
  NodeSurface& surface = node.surface;
  BakeOptions options;
  // Half the error shows as half a pixel; finer than the source would add nothing.
  options.texel_m = std::max({surface.error_m / 2, double(surface.texel_m), 1e-6});
  options.max_side_px = options_.max_atlas_px;
  std::map<uint32_t, std::shared_ptr<const Image>> pictures;
  for (const uint32_t m : materials_of(merged.mesh)) {
    const Material& material = merged.materials[m];
    if (material.texture == kNoTexture) continue;
    if ((material.texture & kLocalTexture) != 0) {
      pictures[material.texture] = merged.atlases[material.texture & ~kLocalTexture];
      continue;
    }
    // No more pixels than the atlas can show: twice as fine as its texels.
    const StoredTexture& stored = textures_[material.texture];
    const double texel_m = largest_texel_m(merged.mesh, m, stored.width, stored.height);
    const double halvings = texel_m > 0 ? std::log2(options.texel_m / (2 * texel_m)) : 0;
    const auto level = static_cast<uint32_t>(std::clamp(halvings, 0.0, 16.0));
    Result<std::shared_ptr<const Image>> image = textures_.image(material.texture, level);
    if (!image.ok()) return image.error();
    std::shared_ptr<const Image>& kept = pictures[material.texture];
    if (!kept || (*image)->pixels.size() > kept->pixels.size()) kept = *image;
  }
  const auto picture = [&](uint32_t texture) -> const Image* {
    const auto found = pictures.find(texture);
    return found == pictures.end() ? nullptr : found->second.get();
  };
  Result<BakedMesh> baked = bake_atlas(surface.mesh, merged.mesh, merged.materials, picture, options);
  if (!baked.ok()) return baked.error();
  Material atlas_material;
  atlas_material.wrap_u = atlas_material.wrap_v = Wrap::clamp;
  baked->mesh.materials.resize(surface.mesh.materials.size());
  for (size_t t = 0; t < surface.mesh.materials.size(); ++t) {
    atlas_material.two_sided = base_.materials[surface.mesh.materials[t]].two_sided;
    atlas_material.alpha = baked->alpha[t];
    auto place = std::find(surface.atlas_materials.begin(), surface.atlas_materials.end(), atlas_material);
    if (place == surface.atlas_materials.end()) place = surface.atlas_materials.insert(place, atlas_material);
    baked->mesh.materials[t] = base_.size() + static_cast<uint32_t>(place - surface.atlas_materials.begin());
  }
  Result<std::vector<std::byte>> encoded =
      encode_image(baked->atlas, baked->has_opacity ? ImageFormat::png : ImageFormat::jpeg, options_.jpeg_quality);
  if (!encoded.ok()) return encoded.error();
  surface.mesh = std::move(baked->mesh);
  surface.texture_error_m += kTexelReach * baked->texel_m;
  surface.texel_m = static_cast<float>(baked->texel_m);
  node.stored.atlas = std::move(*encoded);
  node.stored.atlas_record.width = baked->atlas.width, node.stored.atlas_record.height = baked->atlas.height;
  node.stored.atlas_record.flags = TextureRecord::kAtlas | (baked->has_opacity ? TextureRecord::kHasOpacity : 0U);
  node.stored.atlas_materials = surface.atlas_materials;
  surface.atlas = std::make_shared<const Image>(std::move(baked->atlas));
  return Done{};
}

/// The leaves' grid, or one as much finer than the node's as can be coded.
float NodeBuilder::fine_step_of(double step_m) const {
  return std::max(options_.leaf_step_m, static_cast<float>(std::ldexp(step_m, -kMaxFineBits)));
}

/// Places where other nodes begin lie on a finer grid: these meet them there, whatever their own error is.
Status NodeBuilder::encode(const Shown& shown, double step_m, StoredNode& stored, double& error_m) const {
  const Mesh& mesh = shown.mesh;
  const bool has_exact = has_fine_grid(options_.codec) && !shown.is_exact.empty();
  bool loses = options_.codec != GeometryCodec::raw && loses_surface_on_grid(mesh, static_cast<float>(step_m));
  for (int i = 0; i < kMostHalvings && loses; ++i) {
    step_m /= 2;
    loses = loses_surface_on_grid(mesh, static_cast<float>(step_m));
  }
  std::string why;
  for (int i = 0; i < kMostSteps; ++i, step_m *= 2) {
    stored.step_m = static_cast<float>(step_m);
    const float fine_step_m = has_exact ? fine_step_of(step_m) : 0;
    const Mesh rounded = has_exact ? rounded_apart(mesh, shown.is_exact, stored.step_m, fine_step_m) : mesh;
    Result<EncodedMesh> encoded = encode_mesh(rounded, encode_options(options_.codec, stored.step_m, fine_step_m));
    // Smaller or thinner than any grid, and yet a node needs a box and its bound holds.
    if (i > 0 && options_.codec != GeometryCodec::raw) loses = loses_surface_on_grid(mesh, stored.step_m);
    if (encoded.ok() && options_.codec != GeometryCodec::raw && (encoded->triangles == 0 || loses)) {
      stored.step_m = 0;
      encoded = encode_mesh(mesh, encode_options(options_.codec, stored.step_m, 0));
    }
    if (encoded.ok()) {
      stored.mesh = std::move(encoded->bytes);
      error_m = double(encoded->position_error_m) + (stored.step_m > 0 ? largest_distance_m(mesh, rounded) : 0);
      return Done{};
    }
    why = encoded.error().message;
  }
  return Error{fmt::format("a node's mesh cannot be coded: {}", why)};
}

/// Codes the mesh and records what a reader will see of it, the children's extents included.
Status NodeBuilder::store(const Shown& shown, double step_m, std::span<const NodeSurface> children,
                          BuiltNode& node) const {
  const NodeProfile::Clock clock(profile_, NodeProfile::Part::code);
  double coding_error_m = 0;
  PROMENADE_TRY(encode(shown, step_m, node.stored, coding_error_m));
  const Result<Mesh> decoded = decode_mesh(node.stored.mesh);
  if (!decoded.ok()) return Error{fmt::format("a node's mesh cannot be read back: {}", decoded.error().message)};
  NodeRecord& record = node.stored.record;
  NodeSurface& surface = node.surface;
  record.box = bounds(*decoded);
  // Fins do not count: where the surface shows its back, what is beside it does so too, or stands before it.
  const auto two_sided = [&](uint32_t m) { return is_two_sided(m, node.stored.atlas_materials); };
  const std::vector<uint32_t> materials = materials_of(shown.has_fins ? surface.mesh : *decoded);
  record.cone = normal_cone(shown.has_fins ? without_materials(*decoded, two_sided) : *decoded);
  if (std::any_of(materials.begin(), materials.end(), two_sided)) record.cone.cos_angle = -1;
  record.average_normal = average_normal(*decoded);
  record.surface_m2 = static_cast<float>(surface_area_m2(*decoded));
  record.triangles = static_cast<uint32_t>(decoded->triangle_count());
  record.vertices = static_cast<uint32_t>(decoded->vertex_count());
  for (size_t t = 0; t < decoded->triangle_count(); ++t)
    record.textured_triangles += is_textured(decoded->material_of(t)) ? 1U : 0U;
  record.error_m = rounded_up(surface.error_m + surface.texture_error_m + coding_error_m);
  record.error_p99_m = rounded_up(surface.p99_m + surface.texture_error_m + coding_error_m);
  for (const NodeSurface& child : children) {
    record.box.add(child.box);
    record.cone = merged(record.cone, child.cone);
    record.error_m = std::max(record.error_m, child.stored_error_m);
    record.error_p99_m = std::max(record.error_p99_m, child.stored_p99_m);
  }
  record.error_p99_m = std::min(record.error_p99_m, record.error_m);
  surface.box = record.box, surface.cone = record.cone;
  surface.stored_error_m = record.error_m, surface.stored_p99_m = record.error_p99_m;
  return Done{};
}

}  // namespace promenade
