#include "preprocess/patches.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

#include "geometry/box.h"
#include "geometry/closest_point.h"

namespace promenade {

namespace {

constexpr uint32_t kNone = WorkMesh::kNone;
/// Cosine between a patch's triangles.
constexpr float kFlatCosine = 0.999F;
/// Colours that differ by less pass for one.
constexpr float kLeastContrast = 0.04F;
/// Of a patch's outline, how much must border on another colour: a node's border may run through it.
constexpr float kLeastBordered = 0.55F;
/// Cosine between normals that face the same way.
constexpr float kSameWayCosine = 0.5F;
/// Sheets stacked above each other that are told apart.
constexpr uint32_t kMostStacked = 2;

glm::vec3 cross_of(const WorkMesh& work, uint32_t triangle) {
  const uint32_t c = triangle * 3;
  return glm::cross(work.at(c + 1) - work.at(c), work.at(c + 2) - work.at(c));
}

/// Grows patches and judges them.
class PatchFinder {
 public:
  PatchFinder(WorkMesh& work, const Mesh& source)
      : work_(work), source_(source), patch_of_(work.triangle_count(), kNone) {}

  std::vector<Patch> run() {
    std::vector<Patch> found;
    const auto triangles = static_cast<uint32_t>(work_.triangle_count());
    uint32_t patches = 0;
    std::vector<Candidate> candidates;
    Candidate grown;
    for (uint32_t t = 0; t < triangles; ++t) {
      if (patch_of_[t] != kNone) continue;
      grown.start(patches++);
      if (grow(t, grown)) candidates.push_back(grown);
    }
    // Small ones first; of two that border on each other one is the ground.
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.area < b.area; });
    std::vector<uint8_t> taken(patches, 0);
    for (Candidate& candidate : candidates) {
      if (std::any_of(candidate.around.begin(), candidate.around.end(),
                      [&](uint32_t t) { return taken[patch_of_[t]] != 0; }))
        continue;
      taken[candidate.number] = 1;
      add_copy(candidate.patch);
      found.push_back(std::move(candidate.patch));
    }
    return found;
  }

 private:
  struct Candidate {
    Patch patch;
    uint32_t number = 0;
    float area = 0;
    std::vector<uint32_t> around;  // triangles of another colour

    /// Forgets all but its memory.
    void start(uint32_t its_number) {
      number = its_number, area = 0;
      patch.triangles.clear(), patch.ground.clear(), patch.outline.clear(), around.clear();
    }
  };

  uint32_t material(uint32_t triangle) const { return source_.material_of(work_.source_triangle[triangle]); }
  const glm::u8vec4& color(uint32_t corner) const { return source_.colors[work_.attributes[corner]]; }

  /// The corner, at the same end as `corner`, of the one other triangle on the edge from it to the next; kNone where
  /// there is none. False: there are several, or one that turns the same way.
  bool across(uint32_t corner, uint32_t& other) const {
    other = kNone;
    const uint32_t from = work_.place[corner], to = work_.place[next_in_triangle(corner)];
    for (uint32_t c = work_.first_corner[from]; c != kNone; c = work_.next_corner[c]) {
      if (c == corner) continue;
      if (work_.place[next_in_triangle(c)] == to) return false;
      if (work_.place[previous_in_triangle(c)] != to) continue;
      if (other != kNone) return false;
      other = c;
    }
    return true;
  }

  /// The patch of a triangle and everything about it; false where it cannot be lifted.
  bool grow(uint32_t seed, Candidate& candidate) {
    Patch& patch = candidate.patch;
    const uint32_t number = candidate.number;
    const glm::vec3 cross = cross_of(work_, seed);
    const float twice_m2 = glm::length(cross);
    patch_of_[seed] = number;
    patch.triangles.push_back(seed);
    if (!(twice_m2 > 0)) return false;
    const glm::vec3 normal = cross / twice_m2;
    float length = 0, bordered = 0;
    bool liftable = true;
    ground_.clear();
    for (size_t i = 0; i < patch.triangles.size(); ++i) {
      const uint32_t t = patch.triangles[i];
      candidate.area += glm::length(cross_of(work_, t));
      for (uint32_t c = t * 3; c < t * 3 + 3; ++c) {
        uint32_t other = kNone;
        const bool manifold = across(c, other);
        liftable = liftable && manifold;
        const float edge_m = glm::length(work_.at(next_in_triangle(c)) - work_.at(c));
        if (!manifold || other == kNone) {
          length += edge_m;
          patch.outline.push_back(c);
          continue;
        }
        const uint32_t t2 = other / 3;
        if (patch_of_[t2] == number) continue;
        const glm::vec3 cross2 = cross_of(work_, t2);
        const float twice2_m2 = glm::length(cross2);
        const bool flat = glm::dot(cross2, normal) >= kFlatCosine * twice2_m2;
        const float contrast = std::max(color_contrast(color(c), color(other)),
                                        color_contrast(color(next_in_triangle(c)), color(previous_in_triangle(other))));
        const bool same_material = material(t) == material(t2);
        if (flat && same_material && contrast < kLeastContrast) {
          if (patch_of_[t2] == kNone && patch.triangles.size() <= kMostSheetTriangles) {
            patch_of_[t2] = number;
            patch.triangles.push_back(t2);
          } else {
            liftable = false;  // larger than it seemed
          }
          continue;
        }
        if (!liftable) continue;  // grows to its end, so that no part of it passes for a patch, but is forgotten
        length += edge_m;
        patch.outline.push_back(c);
        if (!same_material || contrast < kLeastContrast) continue;
        bordered += edge_m;
        candidate.around.push_back(t2);
        ground_.push_back({work_.place[c], work_.attributes[other], edge_m});
        ground_.push_back({work_.place[next_in_triangle(c)], work_.attributes[previous_in_triangle(other)], edge_m});
      }
    }
    if (!liftable || ground_.empty() || patch.triangles.size() > kMostSheetTriangles ||
        bordered < kLeastBordered * length)
      return false;
    keep_longest_ground();
    for (uint32_t& corner : patch.outline) corner = work_.place[corner];
    std::sort(patch.outline.begin(), patch.outline.end());
    patch.outline.erase(std::unique(patch.outline.begin(), patch.outline.end()), patch.outline.end());
    for (const uint32_t t : patch.triangles)
      for (uint32_t c = t * 3; c < t * 3 + 3; ++c) patch.ground.push_back(ground_at(work_.place[c]));
    return true;
  }

  /// Of several grounds, that along most of the border alone: what closes beneath the patch would run from one colour
  /// into another, and large triangles made of it, too.
  void keep_longest_ground() {
    color_lengths_.clear();
    for (const Ground& g : ground_) {
      const glm::u8vec4& its = source_.colors[g.attributes];
      const auto known = std::find_if(color_lengths_.begin(), color_lengths_.end(),
                                      [&its](const auto& other) { return other.first == its; });
      if (known == color_lengths_.end())
        color_lengths_.emplace_back(its, g.edge_m);
      else
        known->second += g.edge_m;
    }
    const auto longest = std::max_element(color_lengths_.begin(), color_lengths_.end(),
                                          [](const auto& a, const auto& b) { return a.second < b.second; });
    std::erase_if(ground_, [&](const Ground& g) { return source_.colors[g.attributes] != longest->first; });
  }

  uint32_t ground_at(uint32_t place) const {
    for (const Ground& g : ground_)
      if (g.place == place) return g.attributes;
    return ground_.front().attributes;
  }

  void add_copy(Patch& patch) {
    patch.first_copy = static_cast<uint32_t>(work_.triangle_count());
    copies_.clear();
    const auto copy_of = [&](uint32_t place) {
      for (const auto& [original, copy] : copies_)
        if (original == place) return copy;
      const auto copy = static_cast<uint32_t>(work_.place_count());
      const glm::vec3 position = work_.positions[place], model_position = work_.model_positions[place];
      work_.positions.push_back(position), work_.model_positions.push_back(model_position);
      work_.first_corner.push_back(kNone), work_.merged_into.push_back(copy);
      copies_.push_back({place, copy});
      return copy;
    };
    for (const uint32_t t : patch.triangles) {
      const uint32_t source_triangle = work_.source_triangle[t];
      work_.source_triangle.push_back(source_triangle);
      work_.alive.push_back(0);
      for (uint32_t c = t * 3; c < t * 3 + 3; ++c) {
        const uint32_t place = copy_of(work_.place[c]), attributes = work_.attributes[c];
        const auto corner = static_cast<uint32_t>(work_.place.size());
        work_.place.push_back(place), work_.attributes.push_back(attributes);
        work_.next_corner.push_back(work_.first_corner[place]);
        work_.first_corner[place] = corner;
      }
    }
  }

  struct Ground {
    uint32_t place, attributes;
    float edge_m;  ///< of the border there
  };
  WorkMesh& work_;
  const Mesh& source_;
  std::vector<uint32_t> patch_of_;
  std::vector<Ground> ground_;
  std::vector<std::pair<glm::u8vec4, float>> color_lengths_;  ///< of the border
  std::vector<std::pair<uint32_t, uint32_t>> copies_;
};

}  // namespace

std::vector<Patch> add_patches(WorkMesh& work, const Mesh& source) {
  if (source.colors.empty()) return {};
  return PatchFinder(work, source).run();
}

void lift(const Patch& patch, WorkMesh& work, uint8_t stands_for) {
  for (uint32_t i = 0; i < patch.triangles.size(); ++i) {
    work.alive[patch.first_copy + i] = stands_for;
    ++work.alive_count, work.shown_count += stands_for;
    for (uint32_t c = 0; c < 3; ++c) work.attributes[patch.triangles[i] * 3 + c] = patch.ground[i * 3 + c];
  }
}

namespace {

/// A part all of whose triangles lie in one plane and face the same way.
struct Sheet {
  std::vector<uint32_t> triangles, places;
  glm::vec3 normal{0}, center{0};
  Box box;
  float rise_m = 0;
  uint32_t above = 0;  ///< sheets beneath it
};

uint32_t root_of(std::vector<uint32_t>& parent, uint32_t place) {
  while (parent[place] != place) place = parent[place] = parent[parent[place]];
  return place;
}

/// Sheets in the order of their first triangles; is_sheet: of each triangle.
std::vector<Sheet> find_sheets(const WorkMesh& work, std::vector<uint8_t>& in_sheet) {
  std::vector<uint32_t> parent(work.place_count());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto triangles = static_cast<uint32_t>(work.triangle_count());
  for (uint32_t t = 0; t < triangles; ++t)
    for (uint32_t c = 1; c < 3 && work.alive[t] != 0; ++c) {
      const uint32_t a = root_of(parent, work.place[size_t(t) * 3]), b = root_of(parent, work.place[size_t(t) * 3 + c]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  std::vector<uint32_t> sheet_of(work.place_count(), kNone);
  std::vector<Sheet> parts;
  for (uint32_t t = 0; t < triangles; ++t) {
    if (work.alive[t] == 0) continue;
    uint32_t& part = sheet_of[root_of(parent, work.place[size_t(t) * 3])];
    if (part == kNone) part = static_cast<uint32_t>(parts.size()), parts.emplace_back();
    parts[part].triangles.push_back(t);
    parts[part].normal += cross_of(work, t);
  }
  std::erase_if(parts, [&](Sheet& part) {
    const float length = glm::length(part.normal);
    if (part.triangles.size() > kMostSheetTriangles || !(length > 0)) return true;
    part.normal /= length;
    return !std::all_of(part.triangles.begin(), part.triangles.end(), [&](uint32_t t) {
      const glm::vec3 cross = cross_of(work, t);
      return glm::dot(cross, part.normal) >= kFlatCosine * glm::length(cross);
    });
  });
  in_sheet.assign(triangles, 0);
  for (Sheet& part : parts) {
    for (const uint32_t t : part.triangles) {
      in_sheet[t] = 1;
      for (uint32_t c = 0; c < 3; ++c) part.places.push_back(work.place[t * 3 + c]);
    }
    std::sort(part.places.begin(), part.places.end());
    part.places.erase(std::unique(part.places.begin(), part.places.end()), part.places.end());
    for (const uint32_t p : part.places) part.box.add(work.positions[p]), part.center += work.positions[p];
    part.center /= float(part.places.size());
  }
  return parts;
}

/// How much a sheet must rise to be height_m above what is near it, faces the same way and has another colour.
float rise_of(const Sheet& sheet, const WorkMesh& work, const Mesh& source, const ClosestPointTree& ground,
              const std::vector<uint32_t>& ground_triangles, float height_m, float reach_m) {
  const glm::u8vec4 color = source.colors[work.attributes[size_t(sheet.triangles.front()) * 3]];
  float rise = 0;
  const auto look_from = [&](const glm::vec3& p) {
    const ClosestPointTree::Nearest near = ground.nearest(p, {.max_distance2_m2 = reach_m * reach_m});
    if (near.triangle == kNoTriangle) return;
    const uint32_t t = ground_triangles[near.triangle];
    const glm::vec3 cross = cross_of(work, t);
    const float length = glm::length(cross);
    if (!(length > 0) || glm::dot(cross, sheet.normal) < kSameWayCosine * length) return;
    if (color_contrast(color, source.colors[work.attributes[size_t(t) * 3]]) < kLeastContrast) return;
    rise = std::max(rise, height_m - glm::dot(p - work.at(t * 3), cross / length));
  };
  look_from(sheet.center);
  // A little inside: the outline lies on edges to faces that look elsewhere.
  for (const uint32_t p : sheet.places) look_from(glm::mix(work.positions[p], sheet.center, 0.1F));
  return rise;
}

}  // namespace

bool raise_sheets(WorkMesh& work, const Mesh& source, const std::vector<uint8_t>& may_rise, float height_m,
                  float reach_m) {
  if (source.colors.empty()) return false;
  std::vector<uint8_t> in_sheet;
  std::vector<Sheet> sheets = find_sheets(work, in_sheet);
  std::vector<uint32_t> indices, ground_triangles;
  for (uint32_t t = 0; t < work.triangle_count(); ++t) {
    if (work.alive[t] == 0 || in_sheet[t] != 0) continue;
    ground_triangles.push_back(t);
    for (uint32_t c = 0; c < 3; ++c) indices.push_back(work.place[t * 3 + c]);
  }
  if (sheets.empty() || indices.empty()) return false;
  const ClosestPointTree ground(work.positions, indices);
  for (Sheet& sheet : sheets)
    if (may_rise[sheet.triangles.front()] != 0)
      sheet.rise_m = rise_of(sheet, work, source, ground, ground_triangles, height_m, reach_m);
  std::erase_if(sheets, [](const Sheet& sheet) { return !(sheet.rise_m > 0); });
  std::stable_sort(sheets.begin(), sheets.end(),
                   [](const Sheet& a, const Sheet& b) { return a.box.min.x < b.box.min.x; });
  const auto beneath = [&](const Sheet& a, const Sheet& b) {  // a beneath b
    if (glm::dot(a.normal, b.normal) < kFlatCosine || !a.box.grown(reach_m).overlaps(b.box)) return false;
    const float up = glm::dot(b.center - a.center, b.normal);
    const glm::vec3 side = (b.center - a.center) - up * b.normal;
    return up > 0 && up < reach_m && glm::length(side) < 0.5F * (a.box.diagonal() + b.box.diagonal());
  };
  for (uint32_t round = 0; round < kMostStacked; ++round)
    for (size_t i = 0; i < sheets.size(); ++i)
      for (size_t j = i + 1; j < sheets.size() && sheets[j].box.min.x <= sheets[i].box.max.x + reach_m; ++j) {
        Sheet &a = sheets[i], &b = sheets[j];
        if (beneath(a, b)) b.above = std::min(std::max(b.above, a.above + 1), kMostStacked);
        if (beneath(b, a)) a.above = std::min(std::max(a.above, b.above + 1), kMostStacked);
      }
  for (const Sheet& sheet : sheets) {
    const glm::vec3 step = sheet.normal * (sheet.rise_m + height_m * float(sheet.above));
    for (const uint32_t p : sheet.places) work.positions[p] += step, work.model_positions[p] += step;
  }
  return !sheets.empty();
}

}  // namespace promenade
