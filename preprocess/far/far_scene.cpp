#include "preprocess/far/far_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/cube_side.h"
#include "layout/cell_front.h"

namespace promenade {
namespace {

constexpr double kFrontErrorTexels = 0.5;

}  // namespace

Result<std::shared_ptr<const MipTexture>> FarScene::texture(uint32_t index) const {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = textures_.find(index); found != textures_.end())
      if (std::shared_ptr<const MipTexture> there = found->second.lock()) return there;
  }
  const Result<Image> image = model_.read_texture(index);
  if (!image) return image.error();
  Result<MipTexture> mips = MipTexture::make(*image);
  if (!mips) return mips.error();
  auto made = std::make_shared<const MipTexture>(std::move(*mips));
  const std::lock_guard lock(mutex_);
  textures_[index] = made;
  return made;
}

Result<FarScene::Held> FarScene::read(NodeId id) const {
  const Result<Mesh> mesh = model_.read_mesh(id);
  if (!mesh) return mesh.error();
  Result<PreparedMesh> prepared = prepare(*mesh, model_.model().tables.materials);
  if (!prepared) return prepared.error();
  Held held{std::make_shared<const PreparedMesh>(std::move(*prepared)), {}};
  for (const uint32_t index : model_.model().textures_of(id)) {
    Result<std::shared_ptr<const MipTexture>> picture = texture(index);
    if (!picture) return picture.error();
    held.textures.emplace_back(index, std::move(*picture));
  }
  return held;
}

Result<FarScene::Held> FarScene::get(NodeId id) const {
  return nodes_.get(
      id, [&] { return read(id); },
      [](const Held& held) {
        uint64_t bytes = held.mesh->byte_size();
        for (const auto& [index, picture] : held.textures) bytes += picture->byte_size();
        return bytes;
      });
}

Result<FarView> FarView::make(const FarScene& scene, const FarReach& reach, uint32_t levels) {
  const Model& model = scene.model().model();
  FarView view;
  view.reach_ = reach, view.levels_ = levels;
  const glm::dvec3 centre = reach.centre;
  const double half_m = reach.box_m / 2;
  const Box eye{glm::vec3(centre), glm::vec3(centre)};
  const Box near{glm::vec3(centre - half_m), glm::vec3(centre + half_m)};
  const FrontBound bound{kFrontErrorTexels, {double(1U << levels) / 2, 0}};
  std::vector<const MipTexture*> textures(model.tables.textures.size(), nullptr);
  for (const NodeId id : cell_front(model, eye, bound)) {
    if (model.is_moving(id)) continue;  // drawn where it is, whatever the distance
    const Box& box = model.tables.nodes[index_of(id)].box;
    if (near.contains(box)) continue;
    if (reach.within && !reach.within->overlaps(DBox{box.min, box.max})) continue;
    Result<FarScene::Held> held = scene.get(id);
    if (!held) return held.error();
    for (const auto& [index, picture] : held->textures) textures[index] = picture.get();
    view.items_.push_back({held->mesh.get(), index_of(id), nullptr, std::nullopt});
    view.held_.push_back(std::move(*held));
  }
  view.surfaces_ = std::make_unique<SurfaceTable>(model.tables.materials, textures);
  for (RasterItem& item : view.items_) item.surfaces = view.surfaces_.get();
  return view;
}

/// What another shell shows.
void FarView::cut_off(uint32_t side, std::vector<float>& depth_m) const {
  if (!reach_.within) return;
  const CubeSide axes = cube_side(side);
  const uint32_t pixels = (1U << levels_) + 1;
  const double middle = double(pixels - 1) / 2;
  for (uint32_t y = 0, i = 0; y < pixels; ++y)
    for (uint32_t x = 0; x < pixels; ++x, ++i) {
      if (!std::isfinite(depth_m[i])) continue;
      const glm::dvec3 way = axes.forward + (x - middle) / middle * axes.right + (middle - y) / middle * axes.up;
      if (!reach_.within->contains(reach_.centre + double(depth_m[i]) * way))
        depth_m[i] = std::numeric_limits<float>::infinity();
    }
}

Result<bool> FarView::draw(uint32_t side, Image& colors, std::vector<float>& depth_m) {
  // Ninety degrees between the centres of the outermost pixels: sides meet in them. What lies within the box is cut
  // off by the near plane: the six pyramids beyond it are all that is outside.
  const uint32_t pixels = (1U << levels_) + 1;
  RasterView view = cube_face_view(reach_.centre, static_cast<int>(side), pixels, reach_.box_m / 2);
  view.scale_px = double(1U << levels_) / 2;
  VisibilityOptions options;
  options.threads = 1;  // cells are what runs at once
  PROMENADE_TRY(buffer_.draw(view, items_, options));
  depth_m.resize(size_t(pixels) * pixels);
  buffer_.read_depth_m(depth_m);
  cut_off(side, depth_m);
  if (std::none_of(depth_m.begin(), depth_m.end(), [](float d) { return std::isfinite(d); })) return false;
  ShadeOptions shading;
  shading.threads = 1;
  shading.sky = false, shading.plain = shading.horizon;  // what smoothed rims are mixed with
  shading.anisotropy = 4;
  shade(buffer_, shading, plain_);
  smooth_edges(buffer_, shading, plain_, colors);
  for (size_t i = 0; i < depth_m.size(); ++i) colors.pixels[i].a = std::isfinite(depth_m[i]) ? 255 : 0;
  return true;
}

}  // namespace promenade
