#include "codec/grown_source.h"

#include <algorithm>
#include <bit>

namespace promenade {

GrownSource::GrownSource(const QuantizedMesh& mesh) : mesh_(mesh), place_of_(mesh.positions.size()) {
  find_places();
  grown_place_.assign(places_, kNone);
  grown_vertex_.assign(mesh.positions.size(), kNone);
  vertex_sources_.reserve(mesh.positions.size());
  place_sources_.reserve(places_);
  is_grown_.assign(mesh.indices.size() / 3, 0);
  link_edges();
}

GrownSource::Corners GrownSource::next_triangle() {
  while (is_grown_[next_] != 0) ++next_;
  is_grown_[next_] = 1;
  Corners v{mesh_.indices[3 * next_], mesh_.indices[3 * next_ + 1], mesh_.indices[3 * next_ + 2]};
  for (int turn = 0; turn < 2 && grown_place(v[0]) == kNone; ++turn) std::rotate(v.begin(), v.begin() + 1, v.end());
  return v;
}

bool GrownSource::beyond(uint32_t grown_from, uint32_t grown_to, Corners& corners) {
  const uint32_t from = place_of_[vertex_sources_[grown_from]], to = place_of_[vertex_sources_[grown_to]];
  for (uint32_t* link = &edges_[slot_of(to, from)]; *link != kNone;) {
    const uint32_t c = *link;
    const size_t t = c / 3;
    if (is_grown_[t] != 0) {  // nobody asks for it again: however many lie there, each is passed once
      *link = next_same_[c];
    } else if (t < first_ || t >= end_ || place_at(c) != to || place_at(after(c)) != from) {
      link = &next_same_[c];
    } else {
      is_grown_[t] = 1;
      corners = {mesh_.indices[c], mesh_.indices[after(c)], mesh_.indices[after(after(c))]};
      return true;
    }
  }
  return false;
}

void GrownSource::grow_place(uint32_t vertex) {
  grown_place_[place_of_[vertex]] = static_cast<uint32_t>(place_sources_.size());
  place_sources_.push_back(vertex);
}

void GrownSource::grow_vertex(uint32_t vertex) {
  grown_vertex_[vertex] = static_cast<uint32_t>(vertex_sources_.size());
  vertex_sources_.push_back(vertex);
}

size_t GrownSource::slot_of(uint32_t from, uint32_t to) const {
  return ((uint64_t(from) << 32U | to) * 0x9e3779b97f4a7c15ULL >> 32U) & (edges_.size() - 1);
}

void GrownSource::find_places() {
  const std::vector<glm::u32vec3>& positions = mesh_.positions;
  std::vector<uint32_t> table(std::bit_ceil(positions.size() * 2 + 1), kNone);  // open addressing: a vertex there
  for (uint32_t v = 0; v < positions.size(); ++v) {
    const glm::u32vec3& p = positions[v];
    const uint64_t hash =
        ((uint64_t(p.x) * 0x9e3779b97f4a7c15ULL ^ p.y) * 0xbf58476d1ce4e5b9ULL ^ p.z) * 0x94d049bb133111ebULL;
    size_t slot = (hash >> 32U) & (table.size() - 1);
    while (table[slot] != kNone && positions[table[slot]] != p) slot = (slot + 1) & (table.size() - 1);
    place_of_[v] = table[slot] == kNone ? places_++ : place_of_[table[slot]];
    if (table[slot] == kNone) table[slot] = v;
  }
}

void GrownSource::link_edges() {
  edges_.assign(std::bit_ceil(mesh_.indices.size() + 1), kNone);
  next_same_.assign(mesh_.indices.size(), kNone);
  for (auto c = static_cast<uint32_t>(mesh_.indices.size()); c-- > 0;) {  // so that the first comes first
    uint32_t& first = edges_[slot_of(place_at(c), place_at(after(c)))];
    next_same_[c] = first;
    first = c;
  }
}

}  // namespace promenade
