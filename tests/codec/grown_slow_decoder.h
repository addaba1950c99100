#pragma once
// A second decoder of grown meshes, written from FORMAT.md, slow and with no checks.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "codec/quantized_mesh.h"

namespace promenade {

class SlowGrownDecoder {
 public:
  /// mesh: with every field but the arrays.
  SlowGrownDecoder(std::span<const std::byte> bytes, QuantizedMesh mesh, bool normals, bool texcoords, bool colors)
      : mesh_(std::move(mesh)) {
    size_t at = 0, n = 0;
    for (unsigned shift = 0;; shift += 7) {
      const auto byte = std::to_integer<uint32_t>(bytes[at++]);
      n |= size_t(byte & 127U) << shift;
      if (byte < 128) break;
    }
    for (size_t i = 0; i < 8 * n; ++i)
      bits_.push_back(std::to_integer<uint32_t>(bytes[at + i / 8]) >> (7 - i % 8) & 1U);
    choices_.assign(bytes.begin() + std::ptrdiff_t(at + n), bytes.end());
    for (size_t i = 0; i < choices_.size() % 4; ++i) state_ |= std::to_integer<uint64_t>(choices_[at_++]) << 8 * i;
    fill();
    for (const MaterialRun& run : mesh_.runs) triangles(run.triangles);
    places();
    if (normals) tell_normals();
    if (texcoords) tell_texcoords();
    if (colors) tell_colors();
    for (const uint32_t place : place_of_)
      mesh_.positions.emplace_back(at_place_[place + 3][0], at_place_[place + 3][1], at_place_[place + 3][2]);
  }
  const QuantizedMesh& mesh() const { return mesh_; }
  bool is_at_end() const {
    return state_ == 1U << 24U && at_ == choices_.size() && bits_.size() - bit_ < 8 &&
           std::count(bits_.begin() + std::ptrdiff_t(bit_), bits_.end(), 1U) == 0;
  }

 private:
  // ---- choices and bits

  enum Asked : uint32_t {
    ask_way,
    ask_others_of_two,
    ask_others_of_three,
    ask_which_vertex,
    ask_far_vertex,
    ask_far_place,
    ask_begin_place,
    ask_is_new,
    ask_is_not_latest,
    ask_fine,
    ask_like,
    ask_kind,
    ask_rank,
    ask_value_rank,
    ask_sign,
    ask_width,
    ask_none,
    ask_normal_kind,
    ask_first,
    ask_second,
    ask_palette,
    ask_others,
    ask_color
  };
  using Key = std::array<uint32_t, 7>;
  struct Two {
    uint32_t p = 32768, asked = 0;
  };
  struct Sixteen {
    std::array<int, 17> start{};
    uint32_t asked = 0;
    Sixteen() {
      for (int i = 0; i <= 16; ++i) start[size_t(i)] = i * 1024;
    }
  };
  static uint32_t rate(uint32_t asked) { return asked == 0 ? 1 : asked < 3 ? 2 : asked < 6 ? 3 : asked < 15 ? 4 : 5; }
  void fill() {
    while (state_ < 1U << 24U) {
      uint64_t word = 0;
      for (unsigned i = 0; i < 4 && at_ < choices_.size(); ++i)
        word |= std::to_integer<uint64_t>(choices_[at_++]) << 8 * i;
      state_ = state_ << 32U | word;
    }
  }
  void take(uint64_t start, uint64_t size) {
    state_ = size * (state_ / 16384) + state_ % 16384 - start;
    fill();
  }
  uint32_t two(const Key& key) {
    Two& model = twos_[key];
    const uint32_t zero = model.p / 4, r = rate(model.asked++), bit = state_ % 16384 < zero ? 0 : 1;
    take(bit == 0 ? 0 : zero, bit == 0 ? zero : 16384 - zero);
    model.p = bit == 0 ? model.p + ((65536 - model.p) >> r) : model.p - (model.p >> r);
    return bit;
  }
  uint32_t sixteen(const Key& key) {
    Sixteen& model = sixteens_[key];
    const auto place = int(state_ % 16384);
    size_t c = 0;
    while (model.start[c + 1] <= place) ++c;
    take(uint64_t(model.start[c]), uint64_t(model.start[c + 1] - model.start[c]));
    const uint32_t r = rate(model.asked++);
    for (size_t i = 0; i < 16; ++i) {
      const int goal = i <= c ? int(2 * i) : 16384 - int(2 * (16 - i));
      model.start[i] += (goal - model.start[i]) >> r;
    }
    return uint32_t(c);
  }
  uint32_t bits(uint32_t count) {
    uint32_t value = 0;
    for (; count > 0; --count) value = value * 2 + bits_[bit_++];
    return value;
  }
  uint32_t low_bits(uint32_t width) { return width < 2 ? width : 1U << (width - 1) | bits(width - 1); }
  uint32_t count(const Key& key) {
    uint32_t width = sixteen(key);
    if (width == 15) width += bits(5);
    return low_bits(width);
  }
  static uint32_t from_folded(uint32_t y) { return y % 2 == 0 ? y / 2 : 0 - (y / 2) - 1; }

  // ---- triangles

  static constexpr uint32_t kNobody = ~0U;
  struct Edge {
    uint32_t u, v, c, before = kNobody, next = kNobody;
    bool is_open = true;
  };
  struct Likely {
    uint32_t family, a, b, c;
  };  ///< places, three more before the first
  struct Looks {
    uint32_t known = 0, a = 0, b = 0, c = 0, twin = kNobody;
  };  ///< vertices

  uint32_t place(uint32_t vertex) const { return place_of_[vertex]; }
  uint32_t latest(uint32_t of_place, uint32_t but, uint32_t rank) const {
    for (auto v = uint32_t(place_of_.size()); v-- > 0;)
      if (place_of_[v] == of_place && v != but && --rank == 0) return v;
    return kNobody;
  }
  uint32_t new_place(const Likely& likely) {
    likely_.push_back(likely);
    last_edge_.push_back(kNobody);
    return uint32_t(likely_.size()) - 1;
  }
  uint32_t new_vertex(uint32_t at, const Looks& looks) {
    place_of_.push_back(at);
    looks_.push_back(looks);
    return uint32_t(place_of_.size()) - 1;
  }
  uint32_t other_vertex(uint32_t likely, uint32_t& newest) {
    const uint32_t at = place(likely);
    const uint32_t told = latest(at, likely, 1) == kNobody ? 0 : sixteen({ask_which_vertex});
    if (told == 15) return uint32_t(place_of_.size()) - 1 - count({ask_far_vertex});
    if (told > 0) return latest(at, likely, told);
    return newest = new_vertex(at, {1, newest != kNobody ? newest : likely, 0, 0, likely});
  }
  void link(uint32_t e, uint32_t f) {
    if (e != kNobody) border_[e].next = f;
    if (f != kNobody) border_[f].before = e;
  }
  uint32_t push(uint32_t u, uint32_t v, uint32_t c) {
    border_.push_back({u, v, c});
    return last_edge_[place(u)] = uint32_t(border_.size()) - 1;
  }
  void begin_part() {
    std::array<uint32_t, 3> v{};
    uint32_t newest = place_of_.empty() ? kNobody : uint32_t(place_of_.size()) - 1;
    for (uint32_t i = 0; i < 3; ++i) {
      const auto n = uint32_t(likely_.size());
      if (two({ask_is_new, i}) != 0) {
        Likely likely{0, n + 2, n + 1, n};
        if (i > 0) {
          likely = {1, place(v[i - 1]) + 3, n + 2, n + 1};
          if (likely.a == n + 2) likely = {1, n + 2, n + 1, n};
        }
        v[i] = newest = new_vertex(new_place(likely), {newest != kNobody ? 1U : 0U, newest});
        continue;
      }
      v[i] = latest(n - 1 - count({ask_begin_place}), kNobody, 1);
      if (two({ask_is_not_latest, i}) != 0) v[i] = other_vertex(v[i], newest);
    }
    mesh_.indices.insert(mesh_.indices.end(), v.begin(), v.end());
    const uint32_t a = push(v[0], v[1], v[2]), b = push(v[1], v[2], v[0]), c = push(v[2], v[0], v[1]);
    link(a, b), link(b, c), link(c, a);
  }
  void triangles(uint32_t wanted) {
    border_.clear();
    uint32_t was_other = 0, last = 0, before_last = 0;
    const size_t end = mesh_.indices.size() + 3 * size_t(wanted);
    while (mesh_.indices.size() < end) {
      while (!border_.empty() && !border_.back().is_open) border_.pop_back();
      if (border_.empty()) {
        begin_part();
        continue;
      }
      const Edge e = border_.back();
      border_.pop_back();
      const uint32_t p = place(e.u), q = place(e.v);
      uint32_t ahead = kNobody, behind = kNobody;
      if (e.next != kNobody && place(border_[e.next].v) != p) ahead = place(border_[e.next].v);
      if (e.before != kNobody && place(border_[e.before].u) != q) behind = place(border_[e.before].u);
      uint32_t kind = (ahead != kNobody ? 1U : 0U) + (behind != kNobody ? 2U : 0U);
      if (kind == 3 && ahead == behind) kind = 4;
      uint32_t way = sixteen({ask_way, was_other, kind, before_last, last});
      was_other = way > 4 ? 1 : 0;
      way -= 4 * was_other;
      before_last = last, last = way;
      if (way == 0) {
        link(e.before, kNobody), link(kNobody, e.next);
        continue;
      }
      grow(e, kind, way, was_other != 0);
    }
  }
  void grow(const Edge& e, uint32_t kind, uint32_t way, bool has_others) {
    uint32_t v = e.v, u = e.u, w = kNobody, newest = kNobody;
    if (way == 2) w = border_[e.next].v;
    if (way == 3) w = border_[e.before].u;
    if (way == 4) w = latest(uint32_t(likely_.size()) - 1 - count({ask_far_place}), kNobody, 1);
    if (has_others) {
      const uint32_t others = sixteen({way == 1 ? ask_others_of_two : ask_others_of_three});
      if ((others & 1U) != 0) v = other_vertex(v, newest);
      if ((others & 2U) != 0) u = other_vertex(u, newest);
      if (way != 1 && (others & 4U) != 0) w = other_vertex(w, newest);
    }
    if (way == 1) {
      const uint32_t at = new_place({2, place(u) + 3, place(v) + 3, place(e.c) + 3});
      w = new_vertex(at, newest != kNobody ? Looks{1, newest} : Looks{3, u, v, e.c});
    }
    mesh_.indices.insert(mesh_.indices.end(), {v, u, w});
    if (way == 4) return split(e, u, v, w);
    if (kind == 4 && way != 1) {
      border_[e.next].is_open = border_[e.before].is_open = false;
      return link(border_[e.before].before, border_[e.next].next);
    }
    uint32_t before = e.before, next = e.next;
    if (way == 2) border_[next].is_open = false, next = border_[next].next;
    if (way == 3) border_[before].is_open = false, before = border_[before].before;
    const uint32_t w_v = way != 2 ? push(w, v, u) : kNobody, u_w = way != 3 ? push(u, w, v) : kNobody;
    if (way == 1) link(u_w, w_v);
    link(before, way != 3 ? u_w : w_v), link(way != 2 ? w_v : u_w, next);
  }
  void split(const Edge& e, uint32_t u, uint32_t v, uint32_t w) {
    uint32_t f = last_edge_[place(w)];
    if (f != kNobody && (f >= border_.size() || !border_[f].is_open || place(border_[f].u) != place(w))) f = kNobody;
    const uint32_t g = f != kNobody ? border_[f].before : kNobody;
    if (g != kNobody && place(border_[g].u) == place(v)) {
      border_[g].is_open = false;
      link(border_[g].before, e.next);
    } else {
      const uint32_t w_v = push(w, v, u);
      link(g, w_v), link(w_v, e.next);
    }
    if (f != kNobody && place(border_[f].v) == place(u)) {
      border_[f].is_open = false;
      link(e.before, border_[f].next);
    } else {
      const uint32_t u_w = push(u, w, v);
      link(e.before, u_w), link(u_w, f);
    }
  }

  // ---- places and texture coordinates

  using List = std::array<uint32_t, 16>;
  static void to_front(List& list, size_t rank, uint32_t value) {
    for (; rank > 0; --rank) list[rank] = list[rank - 1];
    list[0] = value;
  }
  /// what: tells apart places and texture coordinates, components and fineness.
  uint32_t offset(uint32_t what, uint32_t kind, uint32_t expected, uint32_t shift) {
    List &sizes = lists_[{what, 0}], &values = lists_[{what, 1}];
    uint32_t off = 0;
    if (kind == 5) {
      const uint32_t rank = sixteen({ask_value_rank, what}), value = values[rank];
      to_front(values, rank, value);
      return value - expected;
    }
    if (kind == 4) {
      const uint32_t rank = sixteen({ask_rank, what});
      off = sizes[rank];
      to_front(sizes, rank, off);
      if (two({ask_sign, what}) != 0) off = 0 - off;
    } else {
      off = from_folded((kind == 15 ? count({ask_width, what}) : low_bits(kind - 1)) + 1) << shift;
      to_front(sizes, 15, std::min(off, 0 - off));
    }
    const auto known = std::find(values.begin(), values.end(), expected + off);
    const auto rank = kind == 4 && known != values.end() ? size_t(known - values.begin()) : 15;
    to_front(values, rank, expected + off);
    return off;
  }
  void places() {
    constexpr uint64_t kM = 0xbf58476d1ce4e5b9, kN = 0x9e3779b97f4a7c15;
    using Found = std::array<std::pair<uint32_t, uint32_t>, 3>;  // slot, offset
    unsigned s = 0;
    while (likely_.size() >> s != 0) ++s;
    s = std::clamp(s, 6U, 16U);
    std::map<std::pair<int, uint64_t>, size_t> after;
    std::vector<Found> traces;
    std::array<uint64_t, 3> h{};
    uint32_t same_before = 0;
    at_place_.assign(3, {});
    for (const Likely& likely : likely_) {
      const uint32_t family = mesh_.on_grid ? likely.family : std::min(likely.family, 1U);
      const std::array<uint32_t, 3> three{likely.a, likely.b, likely.c};
      uint32_t fine = 0;
      if (mesh_.fine_bits > 0) fine = two({ask_fine, family, at_place_[three[0]][3], at_place_[three[1]][3]});
      const uint32_t shift = fine != 0 ? 0U : mesh_.fine_bits;
      std::array<std::array<uint32_t, 3>, 4> slots{};
      for (size_t i = 0; i < 3; ++i) {
        for (size_t k = 0; k < 3; ++k) slots[k + 1][i] = at_place_[three[k]][i];
        slots[0][i] = family == 2 ? slots[1][i] + slots[2][i] - slots[3][i] : slots[1][i];
        for (auto& slot : slots) slot[i] = slot[i] >> shift << shift;
      }
      const uint64_t a = (2 * family + fine + 1 + h[0]) * kN, b = ((a ^ h[1]) * kN ^ h[2]) * kN;
      auto twin = after.find({1, b >> (64 - s)});
      const uint32_t by_three = twin != after.end() ? 1 : 0;
      if (by_three == 0) twin = after.find({0, a >> (64 - s)});
      Found found{};
      uint32_t same = 0;
      if (twin != after.end()) {
        found = traces[twin->second];
        same = sixteen({ask_like, by_three, same_before}) & 7U;
      }
      same_before = same;
      std::array<uint32_t, 3> kinds{};
      std::array<uint32_t, 2> before{5, 5};
      for (uint32_t i = 0; i < 3; ++i) {
        uint32_t kind = found[i].second != 0 ? 4 : found[i].first;
        if ((same >> i & 1U) == 0) {
          kinds[i] = kind = sixteen({ask_kind, i, family, fine, before[0], before[1]});
          found[i] = {kind < 4 ? kind : 0, 0};
        }
        if (i < 2) before[i] = std::min(kind, 4U);
      }
      std::array<uint32_t, 4> at{0, 0, 0, fine};
      uint64_t hash = 1;
      for (uint32_t i = 0; i < 3; ++i) {
        if (kinds[i] >= 4) found[i].second = offset(i * 2 + fine, kinds[i], slots[0][i], shift);
        at[i] = slots[found[i].first][i] + found[i].second;
        hash = (hash ^ ((uint64_t(found[i].first) << 32U) + found[i].second)) * kM;
      }
      after[{1, b >> (64 - s)}] = after[{0, a >> (64 - s)}] = traces.size();
      traces.push_back(found);
      h = {hash ^ hash >> 32U, h[0], h[1]};
      at_place_.push_back(at);
    }
  }
  void tell_texcoords() {
    constexpr uint32_t kWhat = 100;
    std::vector<glm::u32vec2>& t = mesh_.texcoords;
    for (uint32_t v = 0; v < looks_.size(); ++v) {
      const Looks& looks = looks_[v];
      const auto at = [&](uint32_t vertex) { return vertex < v ? t[vertex] : glm::u32vec2(0); };
      const bool is_three = looks.known == 3;
      const std::array<glm::u32vec2, 3> three{at(looks.known == 0 ? v - 1 : looks.a), at(is_three ? looks.b : v - 1),
                                              at(is_three ? looks.c : v - 2)};
      const glm::u32vec2 expected = is_three ? three[0] + three[1] - three[2] : three[0];
      glm::u32vec2 value(0);
      uint32_t before = 5;
      for (uint32_t i = 0; i < 2; ++i) {
        const uint32_t kind = sixteen({ask_kind, kWhat + i, std::min(looks.known, 2U), 0, before});
        value[int(i)] = kind == 0 ? expected[int(i)] : kind < 4 ? three[kind - 1][int(i)] : 0;
        if (kind >= 4) value[int(i)] = expected[int(i)] + offset(kWhat + i, kind, expected[int(i)], 0);
        before = std::min(kind, 4U);
      }
      t.push_back(value);
    }
  }

  // ---- normals and colours

  bool has_like(uint32_t v) const { return looks_[v].known != 0; }

  /// Of every vertex.
  std::vector<glm::i16vec2> foretold_normals() const {
    std::vector<glm::i16vec2> codes(place_of_.size(), glm::i16vec2(0));
    if (!mesh_.on_grid) return codes;
    using Vec = std::array<double, 3>;
    const auto dot = [](const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    std::vector<Vec> sums(codes.size(), Vec{});
    for (size_t t = 0; t < mesh_.indices.size(); t += 3) {
      std::array<Vec, 3> p{};
      for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < 3; ++i) p[c][i] = at_place_[place(mesh_.indices[t + c]) + 3][i];
      const Vec d{p[1][0] - p[0][0], p[1][1] - p[0][1], p[1][2] - p[0][2]},
          e{p[2][0] - p[0][0], p[2][1] - p[0][1], p[2][2] - p[0][2]};
      Vec n{d[1] * e[2] - e[1] * d[2], d[2] * e[0] - e[2] * d[0], d[0] * e[1] - e[0] * d[1]};
      const double l = std::sqrt(dot(n, n));
      if (l == 0) continue;
      for (double& x : n) x = x * (1 / l);
      const double d_e = dot(d, e);
      const Vec parts{d_e, dot(d, d) - d_e, dot(e, e) - d_e};
      for (size_t c = 0; c < 3; ++c) {
        constexpr double kPi = 3.14159265358979323846;
        const double size = std::abs(parts[c]), x = std::min(size, l) / std::max(size, l);
        double y = x * (0.97239411 - 0.19194795 * x * x);
        if (size < l) y = kPi / 2 - y;
        if (parts[c] < 0) y = kPi - y;
        for (size_t i = 0; i < 3; ++i) sums[mesh_.indices[t + c]][i] += n[i] * y;
      }
    }
    for (size_t v = 0; v < sums.size(); ++v) {
      const double s = std::abs(sums[v][0]) + std::abs(sums[v][1]) + std::abs(sums[v][2]);
      if (!(s > 0)) continue;
      double x = sums[v][0] / s, y = sums[v][1] / s;
      if (sums[v][2] < 0)
        std::tie(x, y) = std::pair((1 - std::abs(y)) * (x >= 0 ? 1 : -1), (1 - std::abs(x)) * (y >= 0 ? 1 : -1));
      codes[v] = {int16_t(x * 256 + (x >= 0 ? 0.5 : -0.5)), int16_t(y * 256 + (y >= 0 ? 0.5 : -0.5))};
    }
    return codes;
  }
  void tell_normals() {
    constexpr uint32_t kHasNone = 5;
    std::vector<uint32_t> kinds;
    uint32_t none = 0;
    for (uint32_t v = 0; v < looks_.size(); ++v) {
      if (v % 4 == 0) none = sixteen({ask_none, none});
      const uint32_t likely = !has_like(v) ? 0 : kinds[looks_[v].a] == kHasNone ? 1 : 2;
      const bool has_none = (none >> v % 4 & 1U) != 0;
      kinds.push_back(has_none ? kHasNone : sixteen({ask_normal_kind, looks_[v].twin != kNobody ? 1U : 0U, likely}));
    }
    const std::vector<glm::i16vec2> foretold = foretold_normals();
    for (uint32_t v = 0; v < looks_.size(); ++v) {
      glm::i16vec2 n = kinds[v] == kHasNone ? kNoNormal : foretold[v];
      if (kinds[v] == 1) n = mesh_.normals[looks_[v].twin];
      if (kinds[v] == 2) n = mesh_.normals[looks_[v].a];
      if (kinds[v] == 3) n = mesh_.normals[v - 1];
      if (kinds[v] == 4) {
        const uint32_t first = count({ask_first});
        uint32_t width = 0;
        while (width < 7 && first >> width != 0) ++width;
        const uint32_t second = count({ask_second, width});
        n = {int16_t(uint32_t(n.x) + from_folded(first)), int16_t(uint32_t(n.y) + from_folded(second))};
      }
      mesh_.normals.push_back(n);
    }
  }
  void tell_colors() {
    const uint32_t all = bits(32);
    std::vector<glm::u8vec4> palette;
    glm::u8vec4 color(0);
    for (uint32_t k = 0; k < all; ++k) {
      for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t told = count({ask_palette, i});
        color[int(i)] = uint8_t(color[int(i)] + (i == 0 ? told : from_folded(told)));
      }
      palette.push_back(color);
    }
    List list{};
    uint32_t others = 0;
    for (uint32_t v = 0; v < looks_.size(); ++v) {
      if (v % 4 == 0) {
        uint32_t twins = 0;
        for (uint32_t i = 0; i < 4 && v + i < looks_.size(); ++i) twins |= looks_[v + i].twin != kNobody ? 1U << i : 0U;
        others = sixteen({ask_others, twins});
      }
      if ((others >> v % 4 & 1U) == 0) {
        const glm::u8vec4 same = mesh_.colors[looks_[v].a];
        mesh_.colors.push_back(same);
        continue;
      }
      size_t rank = sixteen({ask_color, looks_[v].twin != kNobody ? 1U : 0U});
      uint32_t value = list[rank];
      if (rank == 15) {
        uint32_t width = 0;
        while ((all - 1) >> width != 0) ++width;
        const uint32_t m = (1U << width) - all;
        value = width == 0 ? 0 : bits(width - 1);
        if (width != 0 && value >= m) value = 2 * value + bits(1) - m;
        rank = size_t(std::find(list.begin(), list.end(), value) - list.begin());
      }
      to_front(list, std::min<size_t>(rank, 15), value);
      mesh_.colors.push_back(palette[value]);
    }
  }

  QuantizedMesh mesh_;
  std::vector<uint32_t> bits_;
  std::vector<std::byte> choices_;
  size_t bit_ = 0, at_ = 0;
  uint64_t state_ = 0;
  std::map<Key, Two> twos_;
  std::map<Key, Sixteen> sixteens_;
  std::map<std::pair<uint32_t, uint32_t>, List> lists_;
  std::vector<Edge> border_;
  std::vector<Likely> likely_;                     ///< by place
  std::vector<uint32_t> last_edge_;                ///< by place
  std::vector<uint32_t> place_of_;                 ///< by vertex
  std::vector<Looks> looks_;                       ///< by vertex
  std::vector<std::array<uint32_t, 4>> at_place_;  ///< x, y, z, beside the grid; three more before the first
};

}  // namespace promenade
