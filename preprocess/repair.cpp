// Faces that are nothing or there twice, and faces that look the wrong way. Three passes over flat arrays, with
// vertices at one place named by one number; memory is a few words a triangle, freed before the mesh is copied.

#include "preprocess/repair.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "preprocess/import_index_table.h"

namespace promenade {

namespace {

constexpr uint32_t kNone = 0xffffffffU;
constexpr uint32_t kMany = 0xfffffffeU;
// Sine of the angle below which three corners are a line: what the rounding of float coordinates leaves is larger.
constexpr double kFlatSine = 1e-9;

/// For each vertex the first vertex at the same place.
std::vector<uint32_t> weld(const Mesh& mesh) {
  std::vector<uint32_t> place(mesh.vertex_count());
  IndexTable table(mesh.vertex_count() / 2);
  const auto hash = [&](uint32_t v) {
    const glm::vec3 p = mesh.positions[v] + 0.0F;  // -0 is 0
    const auto xy = uint64_t(std::bit_cast<uint32_t>(p.x)) << 32 | std::bit_cast<uint32_t>(p.y);
    return mixed_bits(xy ^ mixed_bits(std::bit_cast<uint32_t>(p.z)));
  };
  const auto equal = [&](uint32_t a, uint32_t b) { return mesh.positions[a] == mesh.positions[b]; };
  for (uint32_t v = 0; v < place.size(); ++v) place[v] = table.find_or_add(v, hash, equal);
  return place;
}

/// A mesh's triangles by the places of their corners.
struct Places {
  const Mesh& mesh;
  const std::vector<uint32_t>& place;

  uint32_t corner(uint32_t half_edge) const { return place[mesh.indices[half_edge]]; }
  uint32_t from(uint32_t half_edge) const { return corner(half_edge); }
  uint32_t to(uint32_t half_edge) const { return corner(half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1); }
  /// Corners with the smallest first; the winding stays.
  std::array<uint32_t, 3> triangle(uint32_t t) const {
    std::array<uint32_t, 3> c{corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    return c;
  }
};

bool is_degenerate(const Mesh& mesh, uint32_t t) {
  const std::array<glm::dvec3, 3> p{glm::dvec3(mesh.positions[mesh.indices[3 * size_t(t)]]),
                                    glm::dvec3(mesh.positions[mesh.indices[3 * size_t(t) + 1]]),
                                    glm::dvec3(mesh.positions[mesh.indices[3 * size_t(t) + 2]])};
  const glm::dvec3 a = p[1] - p[0];
  const glm::dvec3 b = p[2] - p[0];
  const glm::dvec3 c = p[2] - p[1];
  const double longest = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
  return !(glm::length(glm::cross(a, b)) > kFlatSine * longest);
}

/// Which triangles stay.
std::vector<bool> find_sound(const Places& places, Counts& counts) {
  const Mesh& mesh = places.mesh;
  std::vector<bool> sound(mesh.triangle_count(), true);
  uint64_t degenerate = 0;
  uint64_t duplicate = 0;
  IndexTable table(mesh.triangle_count());
  const auto hash = [&](uint32_t t) {
    const auto c = places.triangle(t);
    return mixed_bits((uint64_t(c[0]) << 32 | c[1]) ^ mixed_bits(c[2]));
  };
  const auto equal = [&](uint32_t a, uint32_t b) {
    return mesh.material_of(a) == mesh.material_of(b) && places.triangle(a) == places.triangle(b);
  };
  for (uint32_t t = 0; t < sound.size(); ++t) {
    if (is_degenerate(mesh, t)) {
      sound[t] = false;
      ++degenerate;
    } else if (table.find_or_add(t, hash, equal) != t) {
      sound[t] = false;
      ++duplicate;
    }
  }
  if (degenerate != 0) counts["faces_degenerate"] += degenerate;
  if (duplicate != 0) counts["faces_duplicate"] += duplicate;
  return sound;
}

/// For each half-edge (corner c of triangle t is 3 t + c, to the next corner) the one across the same edge; kNone: a
/// border; kMany: more than two faces meet there. Triangles that are not sound have none.
std::vector<uint32_t> find_mates(const Places& places, const std::vector<bool>& sound) {
  std::vector<uint32_t> mate(places.mesh.indices.size(), kNone);
  IndexTable table(places.mesh.triangle_count() + places.mesh.triangle_count() / 2);
  const auto ends = [&](uint32_t h) { return std::minmax({places.from(h), places.to(h)}); };
  const auto hash = [&](uint32_t h) {
    const auto [a, b] = ends(h);
    return mixed_bits(uint64_t(a) << 32 | b);
  };
  const auto equal = [&](uint32_t a, uint32_t b) { return ends(a) == ends(b); };
  for (uint32_t h = 0; h < mate.size(); ++h) {
    if (!sound[h / 3]) continue;
    const uint32_t first = table.find_or_add(h, hash, equal);
    if (first == h) continue;
    if (mate[first] == kNone) {
      mate[first] = h;
      mate[h] = first;
    } else {
      if (mate[first] != kMany) mate[mate[first]] = kMany;
      mate[first] = mate[h] = kMany;
    }
  }
  return mate;
}

/// Triangles joined into components, each knowing whether it is turned against its component's first.
class Components {
 public:
  explicit Components(size_t triangles)
      : parent_(triangles), turned_(triangles, false), contradiction_(triangles, false) {
    for (uint32_t t = 0; t < triangles; ++t) parent_[t] = t;
  }

  uint32_t root(uint32_t t, bool& turned) {
    uint32_t r = t;
    bool parity = false;
    for (; parent_[r] != r; r = parent_[r]) parity = parity != turned_[r];
    turned = parity;
    while (parent_[t] != r) {  // compress
      const uint32_t next = parent_[t];
      const bool rest = parity != turned_[t];
      parent_[t] = r;
      turned_[t] = parity;
      parity = rest;
      t = next;
    }
    return r;
  }

  void join(uint32_t a, uint32_t b, bool opposed) {
    bool turned_a = false;
    bool turned_b = false;
    uint32_t root_a = root(a, turned_a);
    uint32_t root_b = root(b, turned_b);
    const bool opposed_roots = (turned_a != turned_b) != opposed;
    if (root_a == root_b) {
      if (opposed_roots) contradiction_[root_a] = true;
      return;
    }
    if (root_a > root_b) std::swap(root_a, root_b);  // the first triangle is the root: the same result always
    parent_[root_b] = root_a;
    turned_[root_b] = opposed_roots;
    if (contradiction_[root_b]) contradiction_[root_a] = true;
  }

  bool contradicts(uint32_t root) const { return contradiction_[root]; }

 private:
  std::vector<uint32_t> parent_;
  std::vector<bool> turned_, contradiction_;
};

Components connect(const Places& places, const std::vector<uint32_t>& mate) {
  Components components(places.mesh.triangle_count());
  for (uint32_t h = 0; h < mate.size(); ++h) {
    const uint32_t other = mate[h];
    if (other >= kMany || other < h) continue;
    components.join(h / 3, other / 3, places.from(h) == places.from(other));
  }
  return components;
}

/// Faces that the majority of their component opposes.
std::vector<uint32_t> find_minority(const Places& places, const std::vector<bool>& sound) {
  Components components = connect(places, find_mates(places, sound));
  const size_t triangles = places.mesh.triangle_count();
  std::vector<int32_t> balance(triangles, 0);  // at roots: faces as the first less faces against it
  bool turned = false;
  for (uint32_t t = 0; t < triangles; ++t) {
    if (!sound[t]) continue;
    const uint32_t root = components.root(t, turned);
    balance[root] += turned ? -1 : 1;
  }
  std::vector<uint32_t> minority;
  for (uint32_t t = 0; t < triangles; ++t) {
    if (!sound[t]) continue;
    const uint32_t root = components.root(t, turned);
    if (components.contradicts(root) || balance[root] == 0) continue;
    if (turned == (balance[root] > 0)) minority.push_back(t);
  }
  return minority;
}

/// Turns faces over, and with them the normals of vertices that only they use and that would look backwards.
void turn_faces(Mesh& mesh, const std::vector<uint32_t>& faces) {
  std::vector<bool> turned(mesh.triangle_count(), false);
  for (const uint32_t t : faces) {
    std::swap(mesh.indices[3 * size_t(t) + 1], mesh.indices[3 * size_t(t) + 2]);
    turned[t] = true;
  }
  if (mesh.normals.empty()) return;
  std::vector<bool> shared(mesh.vertex_count(), false);
  for (size_t i = 0; i < mesh.indices.size(); ++i)
    if (!turned[i / 3]) shared[mesh.indices[i]] = true;
  for (const uint32_t t : faces)
    for (size_t corner = 0; corner < 3; ++corner) {
      const uint32_t v = mesh.indices[3 * size_t(t) + corner];
      if (!shared[v] && glm::dot(mesh.normals[v], triangle_cross(mesh, t)) < 0) mesh.normals[v] = -mesh.normals[v];
    }
}

void keep_only(Mesh& mesh, const std::vector<bool>& sound) {
  std::vector<uint32_t> kept;
  for (uint32_t t = 0; t < sound.size(); ++t)
    if (sound[t]) kept.push_back(t);
  mesh = submesh(mesh, kept);
}

}  // namespace

void repair_mesh(Mesh& mesh, Counts& counts) {
  // Half-edges are numbered in 32 bits with two values to spare.
  if (mesh.indices.empty() || mesh.indices.size() >= kMany) return;
  std::vector<bool> sound;
  std::vector<uint32_t> minority;
  {
    const std::vector<uint32_t> place = weld(mesh);
    const Places places{mesh, place};
    sound = find_sound(places, counts);
    minority = find_minority(places, sound);
  }
  if (!minority.empty()) {
    counts["faces_reoriented"] += minority.size();
    turn_faces(mesh, minority);
  }
  if (std::find(sound.begin(), sound.end(), false) != sound.end()) keep_only(mesh, sound);
}

void drop_unused_vertices(Mesh& mesh) {
  std::vector<bool> used(mesh.vertex_count(), false);
  for (const uint32_t v : mesh.indices) used[v] = true;
  if (std::find(used.begin(), used.end(), false) == used.end()) return;
  keep_only(mesh, std::vector<bool>(mesh.triangle_count(), true));
}

std::vector<bool> solid_triangles(const Mesh& mesh) {
  std::vector<bool> solid(mesh.triangle_count(), false);
  if (mesh.indices.empty() || mesh.indices.size() >= kMany) return solid;
  const std::vector<uint32_t> place = weld(mesh);
  const Places places{mesh, place};
  const std::vector<uint32_t> mate = find_mates(places, std::vector<bool>(mesh.triangle_count(), true));
  Components components = connect(places, mate);
  std::vector<bool> open(mesh.triangle_count(), false);
  std::vector<double> volume(mesh.triangle_count(), 0);
  bool turned = false;
  const glm::dvec3 origin = glm::dvec3(mesh.positions[mesh.indices[0]]);
  for (uint32_t t = 0; t < solid.size(); ++t) {
    const uint32_t root = components.root(t, turned);
    for (uint32_t h = 3 * t; h < 3 * t + 3; ++h)
      if (mate[h] >= kMany || places.from(h) == places.from(mate[h])) open[root] = true;
    std::array<glm::dvec3, 3> p{};
    for (size_t c = 0; c < 3; ++c) p[c] = glm::dvec3(mesh.positions[mesh.indices[3 * size_t(t) + c]]) - origin;
    volume[root] += glm::dot(p[0], glm::cross(p[1], p[2]));
  }
  for (uint32_t t = 0; t < solid.size(); ++t) {
    const uint32_t root = components.root(t, turned);
    solid[t] = !open[root] && volume[root] > 0;
  }
  return solid;
}

}  // namespace promenade
