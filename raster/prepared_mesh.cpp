#include "raster/prepared_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

namespace promenade {

namespace {

using raster_kernel::Block;
using raster_kernel::kBlockVertices;
using raster_kernel::kLanePadding;

constexpr size_t kAim = 64;  // triangles a block: four full registers, and about 45 vertices in a closed surface
constexpr uint32_t kNone = 0xffffffffU;
constexpr uint32_t kMostNarrow = 0x10000;  // numbers below it take two bytes

/// A triangle as the partition sees it: where it lies, which way it faces, how it must be drawn.
struct Piece {
  std::array<float, 6> at;  ///< centre, then the normal in metres of the same weight
  uint32_t triangle;
  uint8_t flags;
};

/// Vertices with equal positions get the number of the first of them.
std::vector<uint32_t> welded(const Mesh& mesh) {
  const size_t count = mesh.vertex_count();
  const size_t slots = std::bit_ceil(count * 2 + 1);
  std::vector<uint32_t> table(slots, kNone), first(count);
  for (size_t v = 0; v < count; ++v) {
    const glm::vec3 p = mesh.positions[v] + 0.0F;  // -0 and 0 are one place
    uint64_t hash = std::bit_cast<uint32_t>(p.x) * 0x9e3779b97f4a7c15ULL;
    hash = (hash ^ std::bit_cast<uint32_t>(p.y)) * 0xbf58476d1ce4e5b9ULL;
    hash = (hash ^ (hash >> 29) ^ std::bit_cast<uint32_t>(p.z)) * 0x94d049bb133111ebULL;
    size_t slot = (hash >> 24) & (slots - 1);
    while (table[slot] != kNone && mesh.positions[table[slot]] != mesh.positions[v]) slot = (slot + 1) & (slots - 1);
    if (table[slot] == kNone) table[slot] = static_cast<uint32_t>(v);
    first[v] = table[slot];
  }
  return first;
}

uint8_t flags_of(const Mesh& mesh, std::span<const Material> materials, size_t triangle, bool attributes) {
  const uint32_t m = mesh.material_of(triangle);
  if (m >= materials.size()) return 0;
  const bool holes = attributes && materials[m].alpha != AlphaMode::opaque;
  return static_cast<uint8_t>((materials[m].two_sided ? raster_kernel::block_two_sided : 0) |
                              (holes ? raster_kernel::block_masked : 0) |
                              (materials[m].alpha == AlphaMode::blend ? raster_kernel::block_blended : 0));
}

/// Cuts a mesh's triangles into blocks, depth first.
class Cutter {
 public:
  Cutter(const Mesh& mesh, const std::vector<uint32_t>& weld, PreparedMesh& out)
      : mesh_(mesh), weld_(weld), out_(out), slot_of_(mesh.vertex_count(), kNone), place_of_(mesh.vertex_count(), 0) {}

  void cut(std::span<Piece> pieces) {
    if (pieces.size() <= kAim && fits(pieces)) return emit(pieces);
    std::array<float, 6> low, high;
    low = high = pieces[0].at;
    for (const Piece& p : pieces)
      for (size_t i = 0; i < 6; ++i) low[i] = std::min(low[i], p.at[i]), high[i] = std::max(high[i], p.at[i]);
    size_t axis = 0;
    for (size_t i = 1; i < 6; ++i)
      if (high[i] - low[i] > high[axis] - low[axis]) axis = i;
    const size_t unit = pieces.size() > kAim ? kAim : pieces.size() > 16 ? 16 : 1;
    const size_t half = std::clamp((pieces.size() / 2 + unit - 1) / unit * unit, size_t(1), pieces.size() - 1);
    std::nth_element(pieces.begin(), pieces.begin() + static_cast<std::ptrdiff_t>(half), pieces.end(),
                     [axis](const Piece& a, const Piece& b) {
                       return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.triangle < b.triangle;
                     });
    cut(pieces.first(half));
    cut(pieces.subspan(half));
  }

  const std::vector<uint32_t>& triangle_of() const { return triangle_of_; }  ///< number in the mesh as given
  /// Where a welded vertex' position lies in the blocks, in one of them; 0 where none has it.
  const std::vector<uint32_t>& place_of() const { return place_of_; }

 private:
  /// Whether the pieces use at most kBlockVertices places.
  bool fits(std::span<const Piece> pieces) {
    if (pieces.size() * 3 <= size_t(kBlockVertices)) return true;
    used_.clear();
    for (const Piece& p : pieces)
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t v = weld_[mesh_.indices[3 * size_t(p.triangle) + c]];
        if (slot_of_[v] == kNone) slot_of_[v] = 0, used_.push_back(v);
      }
    for (const uint32_t v : used_) slot_of_[v] = kNone;
    return used_.size() <= size_t(kBlockVertices);
  }

  void emit(std::span<Piece> pieces) {
    std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.triangle < b.triangle; });
    Block block = {};
    block.first_vertex = static_cast<uint32_t>(out_.x.size());
    block.first_triangle = static_cast<uint32_t>(triangle_of_.size());
    block.triangle_count = static_cast<uint16_t>(pieces.size());
    block.flags = pieces[0].flags;
    used_.clear();
    Box box;
    for (const Piece& p : pieces) {
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t v = weld_[mesh_.indices[3 * size_t(p.triangle) + c]];
        if (slot_of_[v] == kNone) {
          slot_of_[v] = static_cast<uint32_t>(used_.size());
          used_.push_back(v);
          place_of_[v] = static_cast<uint32_t>(out_.x.size());
          add_vertex(mesh_.positions[v]);
          box.add(mesh_.positions[v]);
        }
        out_.corners[c].push_back(static_cast<uint8_t>(slot_of_[v]));
      }
      triangle_of_.push_back(p.triangle);
    }
    block.vertex_count = static_cast<uint16_t>(used_.size());
    for (const uint32_t v : used_) slot_of_[v] = kNone;
    set_box(block, box);
    set_cone(block, pieces);
    pad();
    out_.blocks.push_back(block);
  }

  void add_vertex(const glm::vec3& p) { out_.x.push_back(p.x), out_.y.push_back(p.y), out_.z.push_back(p.z); }

  /// Fills up to whole registers: the last vertex again, triangles without area.
  void pad() {
    while (out_.x.size() % kLanePadding != 0) add_vertex({out_.x.back(), out_.y.back(), out_.z.back()});
    while (triangle_of_.size() % kLanePadding != 0) {
      for (std::vector<uint8_t>& c : out_.corners) c.push_back(0);
      triangle_of_.push_back(0);
    }
  }

  static void set_box(Block& block, const Box& box) {
    const glm::vec3 center = box.center();
    for (int i = 0; i < 3; ++i) {
      block.box_center[i] = center[i];
      const float half = std::max(box.max[i] - center[i], center[i] - box.min[i]);
      block.box_half[i] = half + (std::abs(center[i]) + half) * 2e-7F;  // covers the roundings
    }
  }

  void set_cone(Block& block, std::span<const Piece> pieces) const {
    block.cone_sin = 2;
    glm::dvec3 sum(0);
    for (const Piece& p : pieces) sum += unit_normal(p.triangle);
    if (glm::length(sum) < 1e-6) return;
    const glm::dvec3 axis = glm::normalize(sum);
    double least = 1;
    for (const Piece& p : pieces) least = std::min(least, glm::dot(axis, unit_normal(p.triangle)));
    if (least <= 0.01) return;
    for (int i = 0; i < 3; ++i) block.cone_axis[i] = static_cast<float>(axis[i]);
    block.cone_sin = static_cast<float>(std::sqrt(std::max(0.0, 1 - least * least))) + 1e-5F;
  }

  glm::dvec3 unit_normal(uint32_t t) const {
    const glm::dvec3 a = mesh_.positions[mesh_.indices[3 * size_t(t)]];
    const glm::dvec3 b = mesh_.positions[mesh_.indices[3 * size_t(t) + 1]];
    const glm::dvec3 c = mesh_.positions[mesh_.indices[3 * size_t(t) + 2]];
    const glm::dvec3 n = glm::cross(b - a, c - a);
    return n / std::max(glm::length(n), 1e-300);
  }

  const Mesh& mesh_;
  const std::vector<uint32_t>& weld_;
  PreparedMesh& out_;
  std::vector<uint32_t> slot_of_;
  std::vector<uint32_t> used_;
  std::vector<uint32_t> triangle_of_, place_of_;
};

/// Rounded to the nearest place on the octahedron; a normal of length 0 has a code of its own.
uint32_t packed_normal(const glm::vec3& normal) {
  const float sum = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  if (!(sum > 0)) return raster_kernel::kNoNormal;
  glm::vec2 at = glm::vec2(normal) / sum;
  if (normal.z < 0)
    at = {(1 - std::abs(at.y)) * (at.x >= 0 ? 1.0F : -1.0F), (1 - std::abs(at.x)) * (at.y >= 0 ? 1.0F : -1.0F)};
  const auto word = [](float a) {
    const float scaled = std::round(std::clamp(a, -1.0F, 1.0F) * float(raster_kernel::kNormalScale));
    return uint32_t(static_cast<uint16_t>(static_cast<int16_t>(scaled)));
  };
  return word(at.x) | word(at.y) << 16;
}

PreparedAttributes attributes_of(const Mesh& mesh, const std::vector<uint32_t>& weld,
                                 const std::vector<uint32_t>& place_of) {
  PreparedAttributes out;
  if (!mesh.normals.empty()) out.normal_at = std::exchange(out.words, out.words + 1);
  if (!mesh.colors.empty()) out.color_at = std::exchange(out.words, out.words + 1);
  if (!mesh.texcoords.empty()) out.texcoord_at = std::exchange(out.words, out.words + 2);
  out.vertices.reserve(mesh.vertex_count() * out.words);
  for (size_t v = 0; v < mesh.vertex_count(); ++v) {
    out.vertices.push_back(place_of[weld[v]]);
    if (out.normal_at != 0) out.vertices.push_back(packed_normal(mesh.normals[v]));
    if (out.color_at != 0) out.vertices.push_back(std::bit_cast<uint32_t>(mesh.colors[v]));
    if (out.texcoord_at != 0)
      for (int axis = 0; axis < 2; ++axis) out.vertices.push_back(std::bit_cast<uint32_t>(mesh.texcoords[v][axis]));
  }
  out.indices = PackedNumbers(mesh.indices), out.materials = PackedNumbers(mesh.materials);
  return out;
}

/// The triangles with an area, grouped by how they must be drawn.
std::vector<Piece> pieces_of(const Mesh& mesh, std::span<const Material> materials, const Box& box, bool attributes) {
  std::vector<Piece> pieces;
  pieces.reserve(mesh.triangle_count());
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::dvec3 a = mesh.positions[mesh.indices[3 * t]], b = mesh.positions[mesh.indices[3 * t + 1]],
                     c = mesh.positions[mesh.indices[3 * t + 2]];
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double length = glm::length(n);
    if (length == 0) continue;
    Piece p = {};
    p.flags = flags_of(mesh, materials, t, attributes);
    // Facing counts as much as a quarter of the mesh's size, so that backs share blocks and can be skipped together.
    const double weight = (p.flags & raster_kernel::block_two_sided) != 0 ? 0 : 0.25 * box.diagonal();
    for (int i = 0; i < 3; ++i) {
      p.at[size_t(i)] = static_cast<float>((a[i] + b[i] + c[i]) / 3);
      p.at[size_t(i) + 3] = static_cast<float>(n[i] / length * weight);
    }
    p.triangle = static_cast<uint32_t>(t);
    pieces.push_back(p);
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.flags < b.flags; });
  return pieces;
}

}  // namespace

uint64_t prepared_bytes_bound(uint64_t vertices, uint64_t triangles) {
  // The cutter leaves no block of fewer than 16 triangles but one for each way of drawing them.
  constexpr uint64_t kWays = 8, kPadding = kLanePadding - 1;
  const uint64_t blocks = triangles / 16 + kWays;
  const uint64_t block_vertices = std::min(3 * triangles, blocks * kBlockVertices) + blocks * kPadding;
  const uint64_t block_triangles = triangles + blocks * kPadding;
  const auto number_bytes = [](uint64_t numbers) {
    return numbers <= kMostNarrow ? sizeof(uint16_t) : sizeof(uint32_t);
  };
  const uint64_t attributes = vertices * (1 + 1 + 1 + 2) * sizeof(uint32_t) +
                              triangles * (3 * number_bytes(vertices) + sizeof(uint32_t));  // any material may come
  return blocks * sizeof(Block) + block_vertices * 3 * sizeof(float) + block_triangles * (3 + number_bytes(triangles)) +
         attributes;
}

bool has_blended(const PreparedMesh& mesh) {
  return std::any_of(mesh.blocks.begin(), mesh.blocks.end(),
                     [](const Block& b) { return (b.flags & raster_kernel::block_blended) != 0; });
}

uint64_t PreparedMesh::byte_size() const {
  return blocks.size() * sizeof(Block) + (x.size() + y.size() + z.size()) * sizeof(float) + 3 * corners[0].size() +
         triangle_of.byte_size() + attributes.byte_size();
}

PackedNumbers::PackedNumbers(std::span<const uint32_t> numbers) {
  if (std::all_of(numbers.begin(), numbers.end(), [](uint32_t n) { return n < kMostNarrow; }))
    narrow_.assign(numbers.begin(), numbers.end());
  else
    wide_.assign(numbers.begin(), numbers.end());
}

Result<PreparedMesh> prepare(const Mesh& mesh, std::span<const Material> materials, const PrepareOptions& options) {
  if (std::string defect = find_defect(mesh); !defect.empty()) return Error{"mesh to draw: " + defect};
  PreparedMesh out;
  out.box = bounds(mesh);
  out.triangle_count = static_cast<uint32_t>(mesh.triangle_count());
  if (!out.box.empty())
    for (int i = 0; i < 3; ++i)
      if (std::max(std::abs(out.box.min[i]), std::abs(out.box.max[i])) > kMaxCoordinateM)
        return Error{"mesh to draw: a coordinate beyond 1e12 m; scale the model or move its origin"};
  const std::vector<uint32_t> weld = welded(mesh);
  std::vector<Piece> pieces = pieces_of(mesh, materials, out.box, options.attributes);
  Cutter cutter(mesh, weld, out);
  for (size_t first = 0; first < pieces.size();) {
    size_t last = first;
    while (last < pieces.size() && pieces[last].flags == pieces[first].flags) ++last;
    cutter.cut(std::span(pieces).subspan(first, last - first));
    first = last;
  }
  for (std::vector<float>* v : {&out.x, &out.y, &out.z}) v->shrink_to_fit();
  for (std::vector<uint8_t>& corner : out.corners) corner.shrink_to_fit();
  out.blocks.shrink_to_fit();
  out.triangle_of = PackedNumbers(cutter.triangle_of());
  if (options.attributes) out.attributes = attributes_of(mesh, weld, cutter.place_of());
  return out;
}

}  // namespace promenade
