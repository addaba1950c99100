#pragma once
// The far pictures that are in memory: of the view cell that the eye is in, of those beside it, and of the last one.

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/model_source.h"
#include "runtime/renderer.h"

namespace promenade {

/// Thread: functions marked render on the render thread only, choose on whichever one thread selects, loader on the
/// loader's; the others from any. Everything shared is guarded by one mutex that is not held while reading, decoding or
/// uploading. A frame never waits for a picture.
class FarStore {
 public:
  /// source must have far pictures, and outlive it, as must the renderer. memory_bytes: of the whole session.
  FarStore(const ModelSource& source, const Renderer& renderer, uint64_t memory_bytes);
  ~FarStore();
  FarStore(const FarStore&) = delete;
  FarStore& operator=(const FarStore&) = delete;

  /// The most that all pictures take, with one being decoded: room for three cells at least, for a dozen if they are
  /// small.
  uint64_t bound_bytes() const;

  // --- choose ---
  /// Cells in the order in which they matter. Others stay while there is room.
  void want(std::span<const FarCellId> cells);
  /// A cell's sides in the renderer; nullopt: they are not all there (yet). May be drawn in the frame that
  /// is being chosen.
  struct Picture {
    std::vector<MeshHandle> meshes;
    uint64_t triangles = 0;
  };
  std::optional<Picture> find(FarCellId cell) const;
  /// Handles of pictures that the loader made room of, to be destroyed before the frame that is chosen next is drawn,
  /// and after those chosen before it, which may show them. Their bytes count until then.
  struct Leaving {
    std::vector<MeshHandle> meshes;
    std::vector<TextureHandle> textures;
    uint64_t bytes = 0;
  };
  Leaving take_leaving();

  // --- render ---
  void let_go(const Leaving& leaving, Renderer& renderer);
  /// Hands sides that were loaded to the renderer: one, and more until budget_ms are over.
  void upload(Renderer& renderer, double budget_ms);
  /// Destroys every handle.
  void clear(Renderer& renderer);

  // --- loader ---
  struct Step {
    bool worked = false;
    uint64_t bytes = 0;  ///< read from disk
  };
  /// Reads, decodes and stages one side of the most important cell that is not there. A cell that cannot be read is
  /// never asked for again: geometry serves.
  Step load_next();

  // --- any ---
  uint64_t bytes() const;         ///< that the pictures in memory take, at most bound_bytes()
  uint64_t sides_loaded() const;  ///< since the beginning
  uint64_t sides_uploaded() const;
  uint64_t bytes_read() const;
  std::vector<std::string> failures() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace promenade
