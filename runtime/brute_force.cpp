#include "runtime/brute_force.h"

#include <algorithm>
#include <utility>

namespace promenade {
namespace {

Box transformed_box(const Box& box, const glm::mat4& matrix) {
  Box out;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 p((corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                      (corner & 4) != 0 ? box.max.z : box.min.z);
    out.add(glm::vec3(matrix * glm::vec4(p, 1)));
  }
  return out;
}

}  // namespace

BruteForceScene::BruteForceScene(BruteForceScene&& other) noexcept { *this = std::move(other); }

BruteForceScene& BruteForceScene::operator=(BruteForceScene&& other) noexcept {
  if (this == &other) return *this;
  clear();
  renderer_ = std::exchange(other.renderer_, nullptr);
  meshes_ = std::exchange(other.meshes_, {});
  textures_ = std::exchange(other.textures_, {});
  instances_ = std::exchange(other.instances_, {});
  items_ = std::exchange(other.items_, {});
  box_ = other.box_;
  return *this;
}

BruteForceScene::~BruteForceScene() { clear(); }

void BruteForceScene::clear() {
  if (renderer_ == nullptr) return;
  for (const MeshHandle mesh : meshes_) renderer_->destroy(mesh);
  for (const TextureHandle texture : textures_) renderer_->destroy(texture);
}

Status BruteForceScene::add(std::span<const Mesh> meshes, std::span<const Material> materials,
                            std::span<const Image> textures, std::span<const PlacedMesh> placed) {
  std::vector<TextureHandle> handles;
  for (const Image& image : textures) {
    handles.push_back(kNoTextureHandle);
    if (image.pixels.empty()) continue;
    const Result<TextureHandle> handle = renderer_->create_texture(*renderer_->stage_texture(image));
    if (!handle) return handle.error();
    handles.back() = *handle;
    textures_.push_back(*handle);
  }
  const size_t first = meshes_.size();
  std::vector<Box> boxes;
  for (const Mesh& mesh : meshes) {
    const Result<MeshHandle> handle = renderer_->create_mesh(*renderer_->stage_mesh(mesh, materials), handles);
    if (!handle) return handle.error();
    meshes_.push_back(*handle);
    boxes.push_back(bounds(mesh));
  }
  for (const PlacedMesh& p : placed) {
    if (boxes[p.mesh].empty()) continue;
    const Box box = transformed_box(boxes[p.mesh], p.model_from_mesh);
    instances_.push_back({{meshes_[first + p.mesh], p.id, p.model_from_mesh}, box});
    box_.add(box);
  }
  return Done{};
}

Status BruteForceScene::draw(const FrameView& view) {
  const Frustum frustum = frustum_of(view.camera, view.model_origin);
  const glm::vec3 eye(view.camera.pose.eye - view.model_origin);
  std::vector<std::pair<float, size_t>> visible;
  for (size_t i = 0; i < instances_.size(); ++i)
    if (classify(frustum, instances_[i].box) != Overlap::outside)
      visible.emplace_back(instances_[i].box.distance(eye), i);
  std::sort(visible.begin(), visible.end());
  items_.clear();
  for (const auto& [distance_m, i] : visible) items_.push_back(instances_[i].item);
  return renderer_->draw(view, items_);
}

}  // namespace promenade
