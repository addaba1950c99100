#include "runtime/far_store.h"

#include <algorithm>
#include <chrono>
#include <optional>

#include "runtime/far_stage.h"

namespace promenade {
namespace {

constexpr uint64_t kComfortableCells = 12;  // the eye's, the last one's, six ahead, and some beside
constexpr uint64_t kLeastCells = 3;         // the eye's, the last one's, the next; and what is around two of them
constexpr uint64_t kMemoryPart = 4;         // of the session's: no more than this, unless those need it
constexpr size_t kMostFailures = 8;

}  // namespace

/// Everything is guarded by `mutex` but for what says otherwise.
struct FarStore::State {
  State(const ModelSource& from, const Renderer& draws_with)
      : source(from), renderer(draws_with), tables(*from.far()) {}

  /// A cell's way through memory.
  struct Cell {
    std::vector<StagedFarSide> staged;    ///< loaded, waiting for upload
    uint32_t loaded = 0, uploaded = 0;    ///< sides
    uint64_t bytes = 0;                   ///< reserved
    bool failed = false;                  ///< never asked for again
    uint32_t holders = 0;                 ///< of its sides, the loader and the renderer: not to be dropped
    Picture picture;                      ///< written by the render thread
    std::vector<TextureHandle> textures;  ///< render thread's own
  };

  const FarCellRecord& record(FarCellId id) const { return tables.cells[index_of(id)]; }
  /// Each side staged or uploaded; while one is handed over it may be both, which `handing_bytes` has.
  uint64_t bytes_of(FarCellId id) const {
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < record(id).face_count; ++i)
      bytes += far_side_bytes(source, renderer, record(id).first_face + i).staged;
    return bytes;
  }
  size_t place_of(FarCellId id) const {
    return static_cast<size_t>(std::find(wanted.begin(), wanted.end(), id) - wanted.begin());
  }
  bool make_room(uint64_t bytes, size_t importance);
  void give_up(std::map<FarCellId, Cell>::iterator cell);
  void fail(FarCellId id, const Error& error);
  std::optional<FarCellId> choose();
  bool upload_one(Renderer& into);

  const ModelSource& source;
  const Renderer& renderer;
  const FarTables& tables;
  FarKey key;  ///< the loader's own
  uint64_t capacity_bytes = 0, decoding_bytes = 0, handing_bytes = 0;
  mutable std::mutex mutex;
  std::vector<FarCellId> wanted;
  std::map<FarCellId, Cell> cells;
  std::vector<Cell> leaving;  ///< until the render thread destroys their handles; their bytes still count
  uint64_t used_bytes = 0;
  uint64_t sides_loaded = 0, sides_uploaded = 0, bytes_read = 0;
  std::vector<std::string> failures;
};

/// Its handles go when the render thread next begins a frame, and its bytes with them.
void FarStore::State::give_up(std::map<FarCellId, Cell>::iterator cell) {
  if (cell->second.picture.meshes.empty() && cell->second.textures.empty())
    used_bytes -= cell->second.bytes;
  else
    leaving.push_back(std::move(cell->second));
  cells.erase(cell);
}

/// Geometry serves from now on.
void FarStore::State::fail(FarCellId id, const Error& error) {
  if (failures.size() < kMostFailures) failures.push_back(error.message);
  leaving.push_back(std::move(cells.at(id)));
  cells.at(id) = {};
  cells.at(id).failed = true;
}

/// Drops what nobody wants, then what is wanted less than the cell at that place of the list. What the renderer holds
/// leaves with the next frame: until then there is no room.
bool FarStore::State::make_room(uint64_t bytes, size_t importance) {
  while (used_bytes + bytes > capacity_bytes) {
    auto worst = cells.end();
    size_t worst_place = importance;
    for (auto it = cells.begin(); it != cells.end(); ++it)
      if (!it->second.failed && it->second.holders == 0 && it->second.bytes > 0 && place_of(it->first) > worst_place)
        worst = it, worst_place = place_of(it->first);
    if (worst == cells.end()) return false;
    give_up(worst);
  }
  return true;
}

/// The most important cell of which a side is to be loaded, with room for all of them.
std::optional<FarCellId> FarStore::State::choose() {
  for (size_t i = 0; i < wanted.size(); ++i) {
    const FarCellId id = wanted[i];
    if (record(id).face_count == 0) continue;
    const auto found = cells.find(id);
    if (found != cells.end()) {
      if (found->second.failed || found->second.loaded == record(id).face_count) continue;
      return id;
    }
    const uint64_t bytes = bytes_of(id);
    if (!make_room(bytes, i)) return std::nullopt;
    cells[id].bytes = bytes;
    used_bytes += bytes;
    return id;
  }
  return std::nullopt;
}

FarStore::FarStore(const ModelSource& source, const Renderer& renderer, uint64_t memory_bytes)
    : state_(std::make_unique<State>(source, renderer)) {
  State& s = *state_;
  uint64_t largest = 0;
  for (uint32_t i = 0; i < s.tables.cells.size(); ++i) largest = std::max(largest, s.bytes_of(FarCellId{i}));
  for (uint32_t i = 0; i < s.tables.faces.size(); ++i) {
    const FarSideBytes bytes = far_side_bytes(source, renderer, i);
    s.decoding_bytes = std::max(s.decoding_bytes, bytes.decoding);
    s.handing_bytes = std::max(s.handing_bytes, bytes.staged);
  }
  s.decoding_bytes += FarKey::byte_size(s.tables);
  s.capacity_bytes = std::max((kLeastCells + 2 * s.tables.outer.size()) * largest,
                              std::min(kComfortableCells * largest, memory_bytes / kMemoryPart));
}

FarStore::~FarStore() = default;

uint64_t FarStore::bound_bytes() const {
  return state_->capacity_bytes + state_->decoding_bytes + state_->handing_bytes;
}

void FarStore::want(std::span<const FarCellId> cells) {
  const std::lock_guard lock(state_->mutex);
  state_->wanted.assign(cells.begin(), cells.end());
}

std::optional<FarStore::Picture> FarStore::find(FarCellId cell) const {
  const State& s = *state_;
  const uint32_t sides = s.record(cell).face_count;
  if (sides == 0) return Picture{};  // nothing is seen beyond the box
  const std::lock_guard lock(s.mutex);
  const auto found = s.cells.find(cell);
  if (found == s.cells.end() || found->second.uploaded != sides) return std::nullopt;
  return found->second.picture;
}

FarStore::Leaving FarStore::take_leaving() {
  std::vector<State::Cell> cells;
  {
    const std::lock_guard lock(state_->mutex);
    cells.swap(state_->leaving);
  }
  Leaving leaving;
  for (const State::Cell& cell : cells) {
    leaving.meshes.insert(leaving.meshes.end(), cell.picture.meshes.begin(), cell.picture.meshes.end());
    leaving.textures.insert(leaving.textures.end(), cell.textures.begin(), cell.textures.end());
    leaving.bytes += cell.bytes;
  }
  return leaving;
}

void FarStore::let_go(const Leaving& leaving, Renderer& renderer) {
  if (leaving.bytes == 0 && leaving.meshes.empty() && leaving.textures.empty()) return;
  for (const MeshHandle mesh : leaving.meshes) renderer.destroy(mesh);
  for (const TextureHandle texture : leaving.textures) renderer.destroy(texture);
  const std::lock_guard lock(state_->mutex);
  state_->used_bytes -= leaving.bytes;
}

void FarStore::upload(Renderer& renderer, double budget_ms) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  while (state_->upload_one(renderer) &&
         std::chrono::duration<double, std::milli>(Clock::now() - begin).count() < budget_ms) {
  }
}

/// A side of the most important cell that has some; false: nothing waits.
bool FarStore::State::upload_one(Renderer& into) {
  State& s = *this;
  FarCellId id{};
  StagedFarSide side;
  {
    const std::lock_guard lock(s.mutex);
    auto best = s.cells.end();
    for (auto it = s.cells.begin(); it != s.cells.end(); ++it)
      if (!it->second.staged.empty() && (best == s.cells.end() || s.place_of(it->first) < s.place_of(best->first)))
        best = it;
    if (best == s.cells.end()) return false;
    id = best->first;
    side = std::move(best->second.staged.back());
    best->second.staged.pop_back();
    ++best->second.holders;
  }
  Result<TextureHandle> texture = into.create_texture(*side.texture);
  Result<MeshHandle> mesh = texture ? into.create_mesh(*side.mesh, std::span(&*texture, 1)) : texture.error();
  side.mesh.reset(), side.texture.reset();
  const std::lock_guard lock(s.mutex);
  State::Cell& cell = s.cells.at(id);
  --cell.holders;
  if (texture) cell.textures.push_back(*texture);
  if (mesh) cell.picture.meshes.push_back(*mesh), cell.picture.triangles += side.triangles;
  if (!mesh) {
    if (cell.holders == 0) s.fail(id, mesh.error());
    cell.failed = true;
    return true;
  }
  ++s.sides_uploaded;
  if (++cell.uploaded < s.record(id).face_count) return true;
  // From now on only what the renderer holds.
  uint64_t bytes = 0;
  for (const MeshHandle handle : cell.picture.meshes) bytes += into.bytes_of(handle);
  for (const TextureHandle handle : cell.textures) bytes += into.bytes_of(handle);
  s.used_bytes -= cell.bytes - std::min(cell.bytes, bytes);
  cell.bytes = std::min(cell.bytes, bytes);
  return true;
}

void FarStore::clear(Renderer& renderer) {
  {
    const std::lock_guard lock(state_->mutex);
    while (!state_->cells.empty()) {
      state_->leaving.push_back(std::move(state_->cells.begin()->second));
      state_->cells.erase(state_->cells.begin());
    }
    state_->wanted.clear();
  }
  let_go(take_leaving(), renderer);
}

FarStore::Step FarStore::load_next() {
  State& s = *state_;
  FarCellId id{};
  uint32_t face = 0;
  {
    const std::lock_guard lock(s.mutex);
    const std::optional<FarCellId> chosen = s.choose();
    if (!chosen) return {};
    id = *chosen;
    ++s.cells.at(id).holders;
    face = s.record(id).first_face + s.cells.at(id).loaded;
  }
  Result<StagedFarSide> side = stage_far_side(s.source, s.renderer, id, face, s.key);
  const std::lock_guard lock(s.mutex);
  State::Cell& cell = s.cells.at(id);
  --cell.holders;
  if (!side) {
    if (cell.holders == 0) s.fail(id, side.error());
    cell.failed = true;
    return {true, 0};
  }
  const uint64_t bytes = side->bytes_read;
  ++s.sides_loaded, ++cell.loaded;
  s.bytes_read += bytes;
  cell.staged.push_back(std::move(*side));
  return {true, bytes};
}

uint64_t FarStore::bytes() const {
  const std::lock_guard lock(state_->mutex);
  return state_->used_bytes;
}
uint64_t FarStore::sides_loaded() const {
  const std::lock_guard lock(state_->mutex);
  return state_->sides_loaded;
}
uint64_t FarStore::sides_uploaded() const {
  const std::lock_guard lock(state_->mutex);
  return state_->sides_uploaded;
}
uint64_t FarStore::bytes_read() const {
  const std::lock_guard lock(state_->mutex);
  return state_->bytes_read;
}
std::vector<std::string> FarStore::failures() const {
  const std::lock_guard lock(state_->mutex);
  return state_->failures;
}

}  // namespace promenade
