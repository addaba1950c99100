#pragma once
// The source's pictures, shared by all leaves: each stored once, as a work unit, whichever parts bring it.

#include <array>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "geometry/mesh.h"
#include "preprocess/scene.h"
#include "preprocess/work_folder.h"

namespace promenade {

struct TextureStoreOptions {
  uint32_t max_texture_px = 2048;  ///< longest side stored
  int jpeg_quality = 85;
  uint64_t memory_bytes = 0;  ///< for decoded pictures, all together
  uint64_t tool_hash = 0;     ///< of the program's version
};

/// A picture as the model will hold it.
struct StoredTexture {
  struct Size {
    uint32_t width = 0, height = 0;
  };
  uint32_t width = 0, height = 0;
  bool has_opacity = false;
  float reduction = 1;        ///< source pixels to a stored one, along a side
  uint64_t bytes = 0;         ///< encoded, smaller versions included
  std::vector<Size> smaller;  ///< versions of it for surfaces far away: each kTextureStep times smaller than the last
  std::string unit;           ///< in the work folder
};

/// Pixels along a side of a texture to one of its next smaller version, which exists while its longer side has
/// kSmallestTexture.
constexpr uint32_t kTextureStep = 4;
constexpr uint32_t kSmallestTexture = 16;

/// Pictures by number, in order of first appearance. add: one thread, before all others; image and encoded: any thread.
class TextureStore {
 public:
  TextureStore(const WorkFolder& folder, const TextureStoreOptions& options) : folder_(folder), options_(options) {}

  /// The numbers of a part's pictures; kNoTexture for those that are missing, unreadable, too large to decode in
  /// memory_bytes, or not `used`; a note says so. New ones are decoded, made smaller where they exceed max_texture_px,
  /// and stored (as the bytes that they came as, where those may stay; else as JPEG, or PNG when they have opacity).
  /// Error: the disk.
  Result<std::vector<uint32_t>> add(std::span<const SourceTexture> textures, const std::vector<bool>& used,
                                    std::vector<std::string>& notes);

  size_t size() const { return textures_.size(); }
  const StoredTexture& operator[](uint32_t texture) const { return textures_[texture]; }
  /// version: 0: as it is; i: its smaller[i - 1].
  Result<std::vector<std::byte>> encoded(uint32_t texture, uint32_t version = 0) const;
  /// Decoded, its sides halved `halvings` times; kept for the next who asks while memory lasts.
  Result<std::shared_ptr<const Image>> image(uint32_t texture, uint32_t halvings) const;
  /// Work units that were found done, and all.
  uint64_t resumed() const { return resumed_; }

 private:
  struct Prepared;
  Prepared prepare(const SourceTexture& texture, uint64_t content) const;
  std::shared_ptr<const Image> cached(uint64_t key) const;
  void keep(uint64_t key, const std::shared_ptr<const Image>& image) const;

  const WorkFolder& folder_;
  TextureStoreOptions options_;
  std::vector<StoredTexture> textures_;
  std::unordered_map<uint64_t, uint32_t> by_content_;
  uint64_t resumed_ = 0;

  struct Cached {
    std::shared_ptr<const Image> image;
    std::list<uint64_t>::iterator place;
  };
  mutable std::array<std::mutex, 16> decoding_;         ///< by texture: one thread decodes it; before mutex_
  mutable std::mutex mutex_;                            ///< guards what follows
  mutable std::unordered_map<uint64_t, Cached> cache_;  ///< by texture and halvings
  mutable std::list<uint64_t> recent_;                  ///< last asked for first
  mutable uint64_t cached_bytes_ = 0;
};

}  // namespace promenade
