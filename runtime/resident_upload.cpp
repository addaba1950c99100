// What the render thread does: what was loaded becomes handles, and what leaves is destroyed.

#include "runtime/resident_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "runtime/decode_part.h"

namespace promenade {

using residency::kFailuresKept, residency::NodeStage, residency::PartStatus, residency::Transfer;

namespace {

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void ResidentSet::let_go(const Leaving& leaving, Renderer& renderer) {
  if (leaving.nodes.empty() && leaving.textures.empty()) return;
  State& s = *state_;
  for (const NodeId id : leaving.nodes) {
    renderer.destroy(s.meshes[index_of(id)]);
    s.meshes[index_of(id)] = kNoMeshHandle;
  }
  for (const uint32_t part : leaving.textures) {
    TextureHandle& handle = s.textures[s.texture_of_part[part]];
    renderer.destroy(handle);
    handle = kNoTextureHandle;
  }
  const std::lock_guard lock(s.mutex);
  for (const NodeId id : leaving.nodes) {
    const uint32_t part = s.mesh_part(id);
    s.pending_bytes -= s.parts[part].bytes;
    s.set_part_locked(part, PartStatus::absent, 0);
    s.nodes[index_of(id)].stage = NodeStage::absent;
  }
  for (const uint32_t part : leaving.textures) {
    s.pending_bytes -= s.parts[part].bytes;
    s.set_part_locked(part, PartStatus::absent, 0);
  }
}

/// The part is marked `uploading`: nobody else touches it. True: it was a node's mesh, and the node is there now.
bool ResidentSet::State::upload_part(uint32_t part, Renderer& target) {
  std::unique_ptr<StagedMesh> mesh;
  std::unique_ptr<StagedTexture> texture;
  NodeId id = kNoNode;
  {
    const std::lock_guard lock(mutex);
    Transfer& transfer = transfers[part];
    mesh = std::move(transfer.mesh);
    texture = std::move(transfer.texture);
    id = transfer.node;
  }
  uint64_t bytes = 0;
  std::string problem;
  if (texture) {
    const Result<TextureHandle> handle = target.create_texture(*texture);
    if (handle) {
      textures[texture_of_part[part]] = *handle;
      bytes = target.bytes_of(*handle);
    } else {
      problem = handle.error().message;
    }
  } else {
    const Result<MeshHandle> handle = target.create_mesh(*mesh, textures);
    if (handle) {
      meshes[index_of(id)] = *handle;
      bytes = target.bytes_of(*handle);
    } else {
      problem = handle.error().message;
    }
  }
  const bool is_mesh = mesh != nullptr;
  mesh.reset();
  texture.reset();
  const std::lock_guard lock(mutex);
  transfers.erase(part);
  if (!problem.empty()) {
    ++counts.failed_uploads;
    if (failures.size() < kFailuresKept) failures.push_back(problem);
    set_part_locked(part, PartStatus::absent, 0);
    if (is_mesh) fail_node_locked(id);
    return false;
  }
  set_part_locked(part, PartStatus::uploaded, bytes);
  if (is_mesh) {
    nodes[index_of(id)].stage = NodeStage::resident;
    arrived.push_back(id);
    ++counts.nodes_loaded;
    return true;
  }
  ++counts.textures_loaded;
  if (parts[part].references == 0) {  // its nodes were given up during the upload
    ++parts[part].references;
    release_texture_locked(part);
  }
  return false;
}

uint32_t ResidentSet::upload(Renderer& renderer, double budget_ms) {
  State& s = *state_;
  const double begin = now_ms();
  uint32_t arrived = 0;
  for (bool first = true; first || now_ms() - begin < budget_ms; first = false) {
    uint32_t part = 0;
    {
      const std::lock_guard lock(s.mutex);
      if (s.ready.empty()) break;
      part = s.ready.front();
      s.ready.pop_front();
      s.set_part_locked(part, PartStatus::uploading, s.parts[part].bytes);
    }
    if (s.upload_part(part, renderer)) ++arrived;
  }
  return arrived;
}

Status ResidentSet::State::load_root(NodeId root, Renderer& target) {
  {
    const std::lock_guard lock(mutex);
    begin_loading_locked(root);
  }
  Status outcome = Done{};
  each_part(root, [&](uint32_t part) {
    if (!outcome.ok()) return;
    {
      const std::lock_guard lock(mutex);
      if (parts[part].status == PartStatus::uploaded) return;
      const uint64_t needed = stored_bytes(part) + decoding_bytes(part, root);
      if (memory.total() + needed > memory_bytes) {
        outcome = Error{
            fmt::format("the memory bound of {} bytes is too small: {} bytes are taken by tables and the roots loaded "
                        "so far, and root {} takes {} to load; give more",
                        memory_bytes, memory.total(), index_of(root), needed)};
        return;
      }
      set_part_locked(part, PartStatus::decoding, needed);
      transfers[part].node = root;
      transfers[part].stored.resize(stored_bytes(part));
      parts[part].useful = false;
      counts.bytes_read += stored_bytes(part);
      ++counts.pieces;
      ++counts.reads;
    }
    Transfer& transfer = transfers[part];
    outcome = source.read_piece(part, 0, transfer.stored);
    if (!outcome.ok()) return;
    StagedPart staged;
    outcome = decode_part(source, renderer, root, texture_of_part[part], texture_limit, transfer.stored, staged);
    if (!outcome.ok()) return;
    {
      const std::lock_guard lock(mutex);
      transfer.stored = {};
      transfer.mesh = std::move(staged.mesh);
      transfer.texture = std::move(staged.texture);
      set_part_locked(part, PartStatus::uploading, staged_bound(part, root) + copy_bound(part, root));
    }
    upload_part(part, target);
    if (counts.failed_uploads > 0) outcome = Error{failures.back()};
  });
  if (!outcome.ok()) return Error{fmt::format("root {}: {}", index_of(root), outcome.error().message)};
  const std::lock_guard lock(mutex);
  list.update(root, 0);
  list.set_loaded(root, true);
  return Done{};
}

Status ResidentSet::load_roots(Renderer& renderer) {
  for (const NodeId root : state_->model.tables.roots) PROMENADE_TRY(state_->load_root(root, renderer));
  refresh();  // nothing is leaving yet
  const std::lock_guard lock(state_->mutex);
  state_->pinned_bytes = state_->memory.uploaded;
  return Done{};
}

void ResidentSet::clear(Renderer& renderer) {
  State& s = *state_;
  for (MeshHandle& mesh : s.meshes) {
    if (mesh != kNoMeshHandle) renderer.destroy(mesh);
    mesh = kNoMeshHandle;
  }
  for (TextureHandle& texture : s.textures) {
    if (texture != kNoTextureHandle) renderer.destroy(texture);
    texture = kNoTextureHandle;
  }
  std::fill(s.resident.begin(), s.resident.end(), uint8_t(0));
}

}  // namespace promenade
