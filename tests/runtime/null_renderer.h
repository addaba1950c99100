#pragma once
// A renderer that draws nothing and remembers everything: which handles live, what was drawn, whether it was allowed.

#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <thread>
#include <vector>

#include "runtime/renderer.h"

namespace promenade {

class NullRenderer final : public Renderer {
 public:
  struct Sized {
    uint64_t bytes = 0;
  };
  class NullMesh final : public StagedMesh {
   public:
    explicit NullMesh(uint64_t bytes) : bytes_(bytes) {}
    uint64_t byte_size() const override { return bytes_; }

   private:
    uint64_t bytes_;
  };
  class NullTexture final : public StagedTexture {
   public:
    explicit NullTexture(uint64_t bytes) : bytes_(bytes) {}
    uint64_t byte_size() const override { return bytes_; }

   private:
    uint64_t bytes_;
  };

  std::unique_ptr<StagedMesh> stage_mesh(const Mesh& mesh, std::span<const Material>) const override {
    return std::make_unique<NullMesh>(mesh_bytes_bound(mesh.vertex_count(), mesh.triangle_count()));
  }
  std::unique_ptr<StagedTexture> stage_texture(const Image& image, uint32_t largest_side) const override {
    uint32_t width = image.width, height = image.height;
    for (; std::max(width, height) > largest_side; width /= 2, height /= 2) {
    }
    return std::make_unique<NullTexture>(texture_bytes_bound(width, height));
  }
  Result<MeshHandle> create_mesh(const StagedMesh& staged, std::span<const TextureHandle>) override {
    if (fail_uploads) return Error{"null: out of memory"};
    meshes.push_back(staged.byte_size());
    bytes_ += staged.byte_size();
    return MeshHandle{static_cast<uint32_t>(meshes.size() - 1)};
  }
  Result<TextureHandle> create_texture(const StagedTexture& staged) override {
    textures.push_back(staged.byte_size());
    bytes_ += staged.byte_size();
    return TextureHandle{static_cast<uint32_t>(textures.size() - 1)};
  }
  void destroy(MeshHandle mesh) override { release(meshes[static_cast<uint32_t>(mesh)]); }
  void destroy(TextureHandle texture) override { release(textures[static_cast<uint32_t>(texture)]); }
  uint64_t bytes_of(MeshHandle mesh) const override { return meshes[static_cast<uint32_t>(mesh)]; }
  uint64_t bytes_of(TextureHandle texture) const override { return textures[static_cast<uint32_t>(texture)]; }
  uint64_t mesh_bytes_bound(uint64_t vertices, uint64_t triangles) const override {
    return vertices * 28 + triangles * 6;
  }
  uint64_t texture_bytes_bound(uint32_t width, uint32_t height) const override { return uint64_t(width) * height * 4; }
  uint64_t bytes() const override { return bytes_; }
  uint64_t frame_bytes(uint32_t, uint32_t, bool) const override { return 0; }

  Status draw(const FrameView&, std::span<const DrawItem> items) override {
    drawn.clear();
    for (const DrawItem& item : items) {
      EXPECT_NE(item.mesh, kNoMeshHandle) << "a node that is not resident";
      EXPECT_GT(meshes[static_cast<uint32_t>(item.mesh)], 0U) << "a mesh that was destroyed";
      drawn.push_back(item.node);
    }
    ++frames;
    std::this_thread::sleep_for(draw_takes);
    return Done{};
  }
  DrawCounts counts() const override { return {}; }
  Result<Image> read_color() override { return Error{"null"}; }
  Result<std::vector<float>> read_depth() override { return Error{"null"}; }
  Result<std::vector<uint32_t>> read_nodes() override { return Error{"null"}; }

  std::vector<uint64_t> meshes, textures;  ///< bytes by handle; 0: destroyed
  std::vector<NodeId> drawn;
  uint32_t frames = 0;
  bool fail_uploads = false;
  std::chrono::milliseconds draw_takes{0};

 private:
  void release(uint64_t& bytes) {
    EXPECT_GT(bytes, 0U) << "destroyed twice";
    bytes_ -= bytes;
    bytes = 0;
  }
  uint64_t bytes_ = 0;
};

}  // namespace promenade
