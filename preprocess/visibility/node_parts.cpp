#include "preprocess/visibility/node_parts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <mutex>
#include <optional>
#include <queue>
#include <utility>

namespace promenade {
namespace {

constexpr size_t kMostPieces = 8192;  // bounds the work that one mesh of huge triangles makes
constexpr float kSmallTriangleM = 4;  // longer ones are cut up first: a slanted wall's box is mostly empty
constexpr float kSmallPartM = 1.5F;   // a part of this size is not worth halving
constexpr size_t kFewPieces = 8;

/// A triangle or a piece of one.
struct Piece {
  std::array<glm::vec3, 3> corners;
  glm::vec3 center, normal;  ///< normal: unit, or 0 for a triangle without area
  bool any_side;             ///< two-sided
};

struct Group {
  size_t first = 0, count = 0;
  Box box;
  float size() const { return box.diagonal(); }
};

/// Halves a piece across its longest side until it is small.
void cut_up(const Piece& piece, float longest_m, std::vector<Piece>& pieces) {
  std::vector<Piece> open = {piece};
  while (!open.empty()) {
    Piece p = open.back();
    open.pop_back();
    size_t side = 0;
    for (size_t k = 1; k < 3; ++k)
      if (glm::distance(p.corners[k], p.corners[(k + 1) % 3]) >
          glm::distance(p.corners[side], p.corners[(side + 1) % 3]))
        side = k;
    const glm::vec3 a = p.corners[side], b = p.corners[(side + 1) % 3], c = p.corners[(side + 2) % 3];
    if (glm::distance(a, b) <= longest_m || pieces.size() + open.size() > kMostPieces) {
      p.center = (a + b + c) / 3.0F;
      pieces.push_back(p);
      continue;
    }
    const glm::vec3 middle = (a + b) * 0.5F;  // both halves have the very same corner
    p.corners = {a, middle, c};
    open.push_back(p);
    p.corners = {middle, b, c};
    open.push_back(p);
  }
}

std::vector<Piece> pieces_of(const Mesh& mesh, std::span<const Material> materials) {
  std::vector<Piece> pieces;
  pieces.reserve(mesh.triangle_count());
  const float longest_m = std::max(kSmallTriangleM, bounds(mesh).diagonal() / 24);
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto corner = [&](size_t k) { return mesh.positions[mesh.indices[t * 3 + k]]; };
    const glm::vec3 cross = triangle_cross(mesh, t);
    const float length = glm::length(cross);
    const uint32_t material = mesh.material_of(t);
    cut_up({{corner(0), corner(1), corner(2)},
            glm::vec3(0),
            length > 0 ? cross / length : glm::vec3(0),
            material < materials.size() && materials[material].two_sided},
           longest_m, pieces);
  }
  return pieces;
}

Box box_of(std::span<const Piece> pieces) {
  Box box;
  for (const Piece& piece : pieces)
    for (const glm::vec3& corner : piece.corners) box.add(corner);
  return box;
}

NodePart part_of(std::span<const Piece> pieces) {
  NodePart part{box_of(pieces), {}};
  glm::vec3 sum(0);
  bool any_side = false;
  for (const Piece& piece : pieces) sum += piece.normal, any_side |= piece.any_side;
  const float length = glm::length(sum);
  if (any_side || length <= 0) return part;
  part.cone = {sum / length, 1};
  for (const Piece& piece : pieces)
    if (piece.normal != glm::vec3(0))
      part.cone.cos_angle = std::min(part.cone.cos_angle, glm::dot(piece.normal, part.cone.axis));
  // Wider than computed, so that rounding never makes it too narrow.
  part.cone.cos_angle = std::max(-1.0F, part.cone.cos_angle - 1e-5F);
  return part;
}

/// In the middle of the longest axis of the pieces' places; by number where they all share one place.
size_t halve(std::span<Piece> pieces) {
  Box centers;
  for (const Piece& piece : pieces) centers.add(piece.center);
  const int axis = centers.longest_axis();
  const float middle = centers.center()[axis];
  const auto half = std::stable_partition(pieces.begin(), pieces.end(),
                                          [&](const Piece& piece) { return piece.center[axis] < middle; });
  const auto at = static_cast<size_t>(half - pieces.begin());
  return at == 0 || at == pieces.size() ? pieces.size() / 2 : at;
}

}  // namespace

std::vector<NodePart> cut_into_parts(const Mesh& mesh, std::span<const Material> materials, uint32_t most_parts) {
  std::vector<Piece> pieces = pieces_of(mesh, materials);
  if (pieces.empty()) return {};
  // The largest group is halved, again and again.
  const auto smaller = [](const Group& a, const Group& b) {
    return a.size() != b.size() ? a.size() < b.size() : a.first > b.first;
  };
  std::priority_queue<Group, std::vector<Group>, decltype(smaller)> open(smaller);
  std::vector<Group> done;
  open.push({0, pieces.size(), box_of(pieces)});
  while (!open.empty()) {
    const Group group = open.top();
    open.pop();
    const bool small = group.count < kFewPieces && group.size() < 2 * kSmallTriangleM;
    if (group.count < 2 || small || group.size() < kSmallPartM || open.size() + done.size() + 2 > most_parts) {
      done.push_back(group);
      continue;
    }
    const std::span<Piece> of_group(pieces.data() + group.first, group.count);
    const size_t half = halve(of_group);
    open.push({group.first, half, box_of(of_group.subspan(0, half))});
    open.push({group.first + half, group.count - half, box_of(of_group.subspan(half))});
  }
  std::sort(done.begin(), done.end(), [](const Group& a, const Group& b) { return a.first < b.first; });
  std::vector<NodePart> parts;
  parts.reserve(done.size());
  for (const Group& group : done) parts.push_back(part_of(std::span(pieces).subspan(group.first, group.count)));
  return parts;
}

/// Takes nodes' parts from several threads.
class NodeParts::Maker {
 public:
  Maker(const ModelReader& model, const NodePartsOptions& options) : model_(model), options_(options) {}

  Status start() {
    const size_t nodes = model_.model().tables.nodes.size();
    parts_.by_node_.resize(nodes);
    if (options_.folder.empty() || nodes * kMostParts * sizeof(NodePart) <= options_.memory_bytes) return Done{};
    Result<AtomicFile> file = AtomicFile::create(path(), files());
    if (!file) return file.error();
    file_ = std::move(*file);
    return Done{};
  }

  Status cut(uint32_t node) {
    const ModelTables& tables = model_.model().tables;
    if (node >= model_.model().first_moving_node()) {  // anywhere in what it sweeps, from any side
      const NodePart swept{tables.nodes[node].box, {}};
      return add(node, std::span(&swept, 1));
    }
    const Result<Mesh> mesh = model_.read_mesh(NodeId{node});
    if (!mesh) return mesh.error();
    return add(node, cut_into_parts(*mesh, tables.materials, kMostParts));
  }

  Result<NodeParts> finish() {
    if (file_) {
      PROMENADE_TRY(file_->commit());
      Result<RandomAccessFile> file = RandomAccessFile::open(path(), files());
      if (!file) return file.error();
      parts_.file_ = std::move(*file);
    }
    return std::move(parts_);
  }

 private:
  std::filesystem::path path() const { return options_.folder / "node-parts"; }
  FileSystem& files() const { return options_.files != nullptr ? *options_.files : real_file_system(); }

  Status add(uint32_t node, std::span<const NodePart> parts) {
    const std::lock_guard lock(mutex_);
    parts_.by_node_[node] = {count_, static_cast<uint32_t>(parts.size())};
    count_ += parts.size();
    if (file_) return file_->write(std::as_bytes(parts));
    parts_.parts_.append(parts);
    return Done{};
  }

  const ModelReader& model_;
  const NodePartsOptions& options_;
  std::mutex mutex_;  // guards everything below
  NodeParts parts_;
  uint64_t count_ = 0;
  std::optional<AtomicFile> file_;
};

Result<NodeParts> NodeParts::make(const ModelReader& model, JobMonitor& monitor, const NodePartsOptions& options) {
  const size_t count = model.model().tables.nodes.size();
  Maker maker(model, options);
  PROMENADE_TRY(maker.start());
  std::atomic<size_t> done = 0;
  std::mutex mutex;
  std::optional<std::pair<size_t, Error>> failed;  // the first by node
  tbb::parallel_for(size_t(0), count, [&](size_t i) {
    if (monitor.cancelled()) return;
    if (const Status status = maker.cut(static_cast<uint32_t>(i)); !status.ok()) {
      const std::lock_guard lock(mutex);
      if (!failed || i < failed->first) failed = {i, status.error()};
    }
    if (++done % 64 == 0) monitor.progress("parts", done, count);
  });
  if (failed) return failed->second;
  if (monitor.cancelled()) return Error{"interrupted"};
  monitor.progress("parts", count, count);
  return maker.finish();
}

Result<HeldParts> NodeParts::hold(std::span<const NodeId> nodes, std::span<const uint8_t> left_out) const {
  const auto is_left_out = [&](size_t i) { return i < left_out.size() && left_out[i] != 0; };
  HeldParts held;
  held.by_node_.resize(nodes.size());
  if (file_) {
    size_t count = 0;
    for (size_t i = 0; i < nodes.size(); ++i) count += is_left_out(i) ? 0 : by_node_[index_of(nodes[i])].count;
    held.read_.resize(count);
  }
  size_t at = 0;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (is_left_out(i)) continue;
    const Range& range = by_node_[index_of(nodes[i])];
    if (file_) {
      const std::span<NodePart> into(held.read_.data() + at, range.count);
      PROMENADE_TRY(file_->read(range.first * sizeof(NodePart), std::as_writable_bytes(into)));
      held.by_node_[i] = into;
      at += range.count;
    } else {
      held.by_node_[i] = {parts_.data() + range.first, range.count};
    }
  }
  return held;
}

bool faces_away_from_cell(const NormalCone& cone, const Box& box, const Box& cell) {
  if (cone.cos_angle <= 0) return false;
  // A pixel's width of margin: the rasteriser rounds corners, which turns triangles that are seen edge-on.
  constexpr double kMargin = 0.005;
  const double sine = std::sqrt(std::max(0.0, 1 - double(cone.cos_angle) * double(cone.cos_angle))) + kMargin;
  const glm::dvec3 low = glm::dvec3(box.min) - glm::dvec3(cell.max), high = glm::dvec3(box.max) - glm::dvec3(cell.min);
  for (unsigned i = 0; i < 8; ++i) {
    const glm::dvec3 d((i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z);
    if (glm::dot(glm::dvec3(cone.axis), d) <= sine * glm::length(d)) return false;
  }
  return true;
}

}  // namespace promenade
