// Part of kernel.inl: edges smoothed after shading. Where a pixel and one of its four neighbours show different
// triangles in clearly different colours, the triangles that the five show are asked which of 16 places in the pixel
// they cover and which of them is nearest there: their own geometry, no guess at an edge from the picture. The pixel
// becomes the mean of the colours that the five already have. So each pixel is still shaded once.
//
// A place that none of the five covers belongs to a triangle that no centre lies in. Where the pixel's own triangle is
// large, it has ended there, and the neighbour on that side tells the colour; a small one says nothing about what is
// beside it, and the pixel keeps its colour. Of surfaces with holes the opacity is taken as linear across the pixel.

constexpr int kPlaces = 16;
constexpr uint32_t kAllPlaces = (1U << kPlaces) - 1U;
constexpr int kFewPlaces = 6;  // a triangle that covers fewer is small

/// Places in a pixel, pixels from its centre: each column and each row of 16 once (Hammersley's points).
struct Places {
  float x[kPlaces], y[kPlaces];
};
constexpr Places places_in_pixel() {
  Places p = {};
  for (int i = 0; i < kPlaces; ++i) {
    const int reversed = (i & 1) << 3 | (i & 2) << 1 | (i & 4) >> 1 | (i & 8) >> 3;
    p.x[i] = (static_cast<float>(i) + 0.5F) / kPlaces - 0.5F;
    p.y[i] = (static_cast<float>(reversed) + 0.5F) / kPlaces - 0.5F;
  }
  return p;
}
constexpr Places kPlacesInPixel = places_in_pixel();

/// Three corners' or four functions' numbers side by side.
using Four = float __attribute__((vector_size(16)));
PROMENADE_INLINE Four four_of(float a) { return Four{a, a, a, a}; }

/// A triangle over the picture near one of its pixels: its barycentric coordinates over w (all >= 0 inside) and, last,
/// its depth, as functions of pixels from (x, y), which lies in sub-pixels from the axis.
struct EdgeTriangle {
  uint32_t id = kNoSurface;
  bool usable = false;  ///< false: what it covers cannot be told from its corners
  int32_t px = 0;       ///< the pixel about which it was set up
  float x = 0, y = 0;
  Four at = {}, dx = {}, dy = {};
  bool holes = false;
};

/// Corners in the view; the fourth lane is the third once more.
struct ViewCorners {
  Four x, y, w;
};

/// The corners as seen from the pixel, so that little triangles keep their precision wherever they lie; sets w.
PROMENADE_INLINE ViewCorners corners_about(const Frame& f, const Item& item, uint32_t triangle, float x, float y,
                                           Four& depth) {
  uint32_t place[3];
  for (uint64_t i = 0; i < 3; ++i) place[i] = *vertex_of(item, 3 * static_cast<uint64_t>(triangle) + i);
  const float* positions[3] = {item.x, item.y, item.z};
  Four d[3];
  for (int k = 0; k < 3; ++k) {
    const float* p = positions[k];
    d[k] = (Four{p[place[0]], p[place[1]], p[place[2]], p[place[2]]} - item.eye_hi[k]) - item.eye_lo[k];
  }
  const auto row = [&](int r) { return (item.rows[r][0] * d[0] + item.rows[r][1] * d[1]) + item.rows[r][2] * d[2]; };
  ViewCorners c = {row(0), row(1), row(2)};
  depth = f.orthographic ? -c.w : four_of(1.0F);
  if (f.orthographic) c.w = four_of(1.0F);
  c.x = c.x - x * c.w, c.y = c.y - y * c.w;
  return c;
}

/// mask: set only if the triangle has holes.
void set_up_edge_triangle(const Frame& f, const Shading& s, uint32_t id, int32_t px, float x, float y, EdgeTriangle& e,
                          MaskTriangle& mask) {
  e.id = id, e.px = px, e.x = x, e.y = y, e.usable = false, e.holes = false;
  const Item& item = s.items[s.item_of_run[id >> s.run_bits]];
  if (item.vertices == nullptr || item.fading) return;
  const uint32_t triangle = id - item.first_id;
  const uint32_t material = material_of(item, triangle);
  if (item.surfaces != nullptr && material < item.surface_count && item.surfaces[material].alpha != 0) {
    if (item.surfaces[material].alpha != 1) return;  // seen through
    set_up_mask(f, item, triangle, mask);
    e.holes = true;
  }
  Four depth;
  const ViewCorners p = corners_about(f, item, triangle, x, y, depth);
  const auto next = [](Four v) { return __builtin_shufflevector(v, v, 1, 2, 0, 0); };
  const auto last = [](Four v) { return __builtin_shufflevector(v, v, 2, 0, 1, 1); };
  const ViewCorners q = {next(p.x), next(p.y), next(p.w)}, r = {last(p.x), last(p.y), last(p.w)};
  const Four nx = q.y * r.w - q.w * r.y, ny = q.w * r.x - q.x * r.w, nw = q.x * r.y - q.y * r.x;
  const float det = (p.x[0] * nx[0] + p.y[0] * ny[0]) + p.w[0] * nw[0];
  const float inverse = 1.0F / det;
  if (!(abs_of(det) > 0) || !(abs_of(inverse) < kFloatMax)) return;
  const auto with_depth = [&](Four v) {
    const Four of = depth * v;
    v[3] = (of[0] + of[1]) + of[2];
    return v;
  };
  const float pixel = static_cast<float>(kSubpixel);
  e.at = with_depth(nw * inverse);
  e.dx = with_depth(nx * inverse * pixel), e.dy = with_depth(ny * inverse * pixel);
  e.usable = true;
}

/// The triangles met last; a row of tiles meets the same ones again and again.
struct EdgeTriangles {
  static constexpr int kSlotBits = 7;
  static constexpr int32_t kReach = 64;  // pixels: farther away, a function's precision is not enough
  EdgeTriangle slots[1 << kSlotBits];
  MaskTriangle masks[1 << kSlotBits];
  static uint32_t slot_of(uint32_t id) { return (id * 0x9e3779b1U) >> (32 - kSlotBits); }
  bool has(uint32_t id) const { return slots[slot_of(id)].id == id; }
  /// Its slot.
  uint32_t at(const Frame& f, const Shading& s, uint32_t id, int32_t px, float x, float y) {
    const uint32_t slot = slot_of(id);
    EdgeTriangle& e = slots[slot];
    if (e.id != id || px - e.px > kReach) set_up_edge_triangle(f, s, id, px, x, y, e, masks[slot]);
    return slot;
  }
};

/// A linear function across a pixel.
struct PixelFunction {
  float at, dx, dy;
  PROMENADE_INLINE F over(F x, F y) const { return splat(at) + (splat(dx) * x + splat(dy) * y); }
};

/// Opacity less the cut-off.
PixelFunction opacity_across(const MaskTriangle& m, const PixelFunction& z, float x, float y) {
  const auto opacity = [&](float dx, float dy) {
    const float depth = m.orthographic ? 1.0F : max_of(z.at + (z.dx * dx + z.dy * dy), abs_of(z.at) * 0.25F + 1e-30F);
    return opacity_at(m, x + dx * static_cast<float>(kSubpixel), y + dy * static_cast<float>(kSubpixel), depth);
  };
  const float here = opacity(0, 0);
  return {here - m.surface->alpha_cutoff, opacity(1, 0) - here, opacity(0, 1) - here};
}

/// Lets a triangle take the places that it covers nearest; returns which. x, y: the pixel's centre, sub-pixels from the
/// axis; z: the nearest depth at each place so far.
PROMENADE_INLINE uint32_t take_places(const Frame& f, const EdgeTriangle& e, const MaskTriangle& mask, float x, float y,
                                      float* z) {
  const float across = (x - e.x) * (1.0F / kSubpixel), down = (y - e.y) * (1.0F / kSubpixel);
  const Four at = e.at + (e.dx * across + e.dy * down);
  PixelFunction fn[4];
  for (int i = 0; i < 4; ++i) fn[i] = {at[i], e.dx[i], e.dy[i]};
  PixelFunction solid = {1, 0, 0};
  if (e.holes) solid = opacity_across(mask, fn[3], x, y);
  const F zero = splat(0.0F), nearest = splat(f.orthographic ? -f.near_m : 1.0F / f.near_m);
  uint32_t taken = 0;
  for (int i = 0; i < kPlaces; i += kLanes) {
    const F px = load(kPlacesInPixel.x + i), py = load(kPlacesInPixel.y + i), old = load(z + i);
    const F inside = min(min(fn[0].over(px, py), fn[1].over(px, py)), fn[2].over(px, py));
    const F here = fn[3].over(px, py);
    M wins = (inside >= zero) & (here > old) & (here <= nearest);
    if (e.holes) wins = wins & (solid.over(px, py) >= zero);
    store(z + i, select(wins, here, old));
    taken |= bits(wins) << i;
  }
  return taken;
}

/// A pixel and its left, right, upper and lower neighbours.
struct Five {
  uint32_t id[5];
  int32_t color[5];
};

/// Who is beside a place: the neighbour on its side, across the nearer border first.
PROMENADE_INLINE int neighbour_of_place(const Five& five, int i) {
  const float x = kPlacesInPixel.x[i], y = kPlacesInPixel.y[i];
  const int across = x < 0 ? 1 : 2, along = y < 0 ? 3 : 4;
  const bool sideways = abs_of(x) > abs_of(y);
  const int first = sideways ? across : along, second = sideways ? along : across;
  if (five.id[first] != five.id[0]) return first;
  return five.id[second] != five.id[0] ? second : 0;
}

int32_t mean_color(const Shading& s, const Five& five, const int* places) {
  Four linear = {};
  for (int k = 0; k < 5; ++k) {
    if (places[k] == 0) continue;
    const uint32_t color = static_cast<uint32_t>(five.color[k]);
    const float share = static_cast<float>(places[k]) * (1.0F / kPlaces);
    linear = linear + share * Four{s.linear_of_srgb[color & 255U], s.linear_of_srgb[color >> 8 & 255U],
                                   s.linear_of_srgb[color >> 16 & 255U], 0.0F};
  }
  float lanes[kLanes] = {};
  __builtin_memcpy(lanes, &linear, sizeof linear);
  int32_t bytes[kLanes];
  store(bytes, to_srgb(load(lanes)));
  return static_cast<int32_t>(0xff000000U) | bytes[2] << 16 | bytes[1] << 8 | bytes[0];
}

/// Which of the five show a triangle that none before them shows; bits.
PROMENADE_INLINE uint32_t distinct_among(const uint32_t* id) {
  uint32_t found = 0;
  for (int k = 0; k < 5; ++k) {
    bool fresh = id[k] != kNoSurface;
    for (int j = 0; j < k; ++j) fresh = fresh & (id[j] != id[k]);
    found |= (fresh ? 1U : 0U) << k;
  }
  return found;
}

int32_t smoothed_pixel(const Frame& f, const Shading& s, EdgeTriangles& triangles, const Five& five, int32_t px,
                       int32_t py) {
  alignas(64) float z[kPlaces];
  for (int i = 0; i < kPlaces; i += kLanes) store(z + i, splat(f.clear_z));
  const float x = static_cast<float>(px * kSubpixel + kSubpixel / 2 - f.axis_x),
              y = static_cast<float>(py * kSubpixel + kSubpixel / 2 - f.axis_y);
  uint32_t owned[5] = {}, all = 0;
  for (uint32_t left = distinct_among(five.id); left != 0; left &= left - 1) {
    const int k = __builtin_ctz(left);
    const uint32_t slot = triangles.at(f, s, five.id[k], px, x, y);
    const EdgeTriangle& e = triangles.slots[slot];
    if (!e.usable) {
      if (k == 0) return five.color[0];
      continue;
    }
    const uint32_t taken = take_places(f, e, triangles.masks[slot], x, y, z);
    for (uint32_t& o : owned) o &= ~taken;
    owned[k] = taken, all |= taken;
  }
  if (owned[0] == kAllPlaces) return five.color[0];
  int places[5];
  for (int k = 0; k < 5; ++k) places[k] = __builtin_popcount(owned[k]);
  const bool ended = five.id[0] != kNoSurface && places[0] >= kFewPlaces;
  const uint32_t open = kAllPlaces & ~all;
  if (!ended) places[0] += __builtin_popcount(open);
  for (uint32_t left = ended ? open : 0; left != 0; left &= left - 1)
    ++places[neighbour_of_place(five, __builtin_ctz(left))];
  return places[0] == kPlaces ? five.color[0] : mean_color(s, five, places);
}

/// Four ids, and what four pixels that lie together show.
using FourIds = int32_t __attribute__((vector_size(16)));
PROMENADE_INLINE FourIds shown_ids(const Frame& f, Int64 at) {
  Four z;
  FourIds ids;
  __builtin_memcpy(&z, f.z + at, sizeof z), __builtin_memcpy(&ids, f.id + at, sizeof ids);
  return ids | ~(z > f.clear_z);  // kNoSurface: all bits set
}

/// Ids of a row of tiles and of the rows of pixels above and below it, laid out one after the other; tile by tile, as
/// they are asked for. Beyond the picture's sides, copies of what lies at them.
class IdRows {
 public:
  /// room: kSmoothRows rows of `stride`.
  IdRows(const Frame& f, const Smoothing& smoothing, int32_t ty) : f_(f), ty_(ty) {
    for (int i = 0; i < kSmoothRows; ++i) rows_[i] = smoothing.room + static_cast<Int64>(i) * smoothing.stride + 16;
    __builtin_memset(done_, 0, sizeof done_);
  }
  /// Row i of the eight is at(i + 1); valid from x - 1 to x + kSmoothChunk after ask_for(x).
  const int32_t* at(int32_t i) const { return rows_[i]; }
  void ask_for(int32_t x) {
    const int32_t tx = x / kTile;
    for (int32_t t = max_of(0, tx - 1); t <= min_of(tx + 2, f_.tiles_x - 1); ++t)
      if ((done_[t >> 6] >> (t & 63) & 1U) == 0) lay_out(t);
    if (x == 0)
      for (int32_t* row : rows_) row[-1] = row[0];
    if (x + kSmoothChunk < f_.width) return;
    for (int32_t* row : rows_)
      for (int i = 0; i < kSmoothChunk + 1; ++i) row[f_.width + i] = row[f_.width - 1];
  }

 private:
  /// Has memory bring what a tile a little farther on will want: no processor foresees the rows above and below.
  PROMENADE_INLINE void look_ahead(int32_t tx) const {
    if (tx >= f_.tiles_x) return;
    const Int64 row = static_cast<Int64>(f_.tiles_x) * kTilePixels;
    const Int64 tile = static_cast<Int64>(ty_) * row + static_cast<Int64>(tx) * kTilePixels;
    const auto line = [this](Int64 at) { __builtin_prefetch(f_.z + at), __builtin_prefetch(f_.id + at); };
    for (int i = 0; i < kTilePixels; i += 16) line(tile + i);
    if (ty_ > 0) line(tile - row + 32), line(tile - row + 48);
    if (ty_ + 1 < f_.tiles_y) line(tile + row), line(tile + row + 16);
  }
  void lay_out(int32_t tx) {
    done_[tx >> 6] |= uint64_t(1) << (tx & 63);
    look_ahead(tx + kTilesAhead);
    const Int64 tile = (static_cast<Int64>(ty_) * f_.tiles_x + tx) * kTilePixels;
    for (int q = 0; q < kTilePixels / 4; ++q) put(tx, (q >> 3) * 4 + (q & 3) + 1, q >> 2 & 1, tile + 4 * q);
    // The last row of the tile above, the first one of that below.
    const int32_t rows = min_of(kTile, f_.height - ty_ * kTile);
    const Int64 row = static_cast<Int64>(f_.tiles_x) * kTilePixels;
    const Int64 above = ty_ > 0 ? tile - row + 44 : tile;
    const Int64 last = tile + ((rows - 1) & 4) * 8 + ((rows - 1) & 3) * 4;
    const Int64 below = (ty_ + 1) * kTile < f_.height ? tile + row : last;
    for (int half = 0; half < 2; ++half)
      put(tx, 0, half, above + 16 * half), put(tx, rows + 1, half, below + 16 * half);
  }
  PROMENADE_INLINE void put(int32_t tx, int32_t row, int half, Int64 from) {
    const FourIds ids = shown_ids(f_, from);
    __builtin_memcpy(rows_[row] + tx * kTile + 4 * half, &ids, sizeof ids);
  }

  static constexpr int32_t kTilesAhead = 6;
  const Frame& f_;
  int32_t ty_;
  int32_t* rows_[kSmoothRows];
  uint64_t done_[kMostTilesAcross / 64];
};

/// The largest of a colour's red, green and blue.
PROMENADE_INLINE I largest_channel(I a) {
  const I low = splat(255);
  return max(max(a & low, shift_right<8>(a) & low), shift_right<16>(a) & low);
}

/// Three rows, one above the other.
struct Rows {
  const int32_t* row[3];
};

/// How much each of kSmoothChunk pixels from x on differs from those of its neighbours that show other triangles; 0: by
/// less than `least`, or it is no edge. An edge's pixel shows the sky or a triangle that two of its neighbours show,
/// too: where every pixel has a triangle of its own there is none to find, and it would cost the most. Returns which do
/// not have 0.
PROMENADE_INLINE uint32_t edges_among(const Rows& id, const Rows& color, int32_t x, int32_t least, int32_t* strength) {
  const I none = splat(0), one = splat(1);
  uint32_t found = 0;
  for (int part = 0; part < kSmoothChunk; part += kLanes) {
    const int32_t p = x + part;
    const I own = load(id.row[1] + p);
    const I sides[4] = {load(id.row[1] + p - 1), load(id.row[1] + p + 1), load(id.row[0] + p), load(id.row[2] + p)};
    I same = none;
    for (const I& side : sides) same = same + select(equal(own, side), one, none);
    const M to_do = (same < splat(4)) & ((same > one) | equal(own, splat(static_cast<int32_t>(kNoSurface))));
    I most = none;
    if (bits(to_do) != 0) {
      const I here = load(color.row[1] + p);
      const I colors[4] = {load(color.row[1] + p - 1), load(color.row[1] + p + 1), load(color.row[0] + p),
                           load(color.row[2] + p)};
      for (int i = 0; i < 4; ++i)
        most = max_bytes(most, select(equal(own, sides[i]), none, difference_of_bytes(here, colors[i])));
      most = largest_channel(most);
      most = select(to_do & (most > splat(least - 1)), most, none);
      found |= bits(most > none) << part;
    }
    store(strength + part, most);
  }
  return found;
}

/// A chunk of the picture's rows y - 1 to y + 8; at the picture's sides a copy, so that every pixel has neighbours.
struct ColorChunk {
  const int32_t* row[kTile + 2];  ///< row[i][x] for columns x of the picture
  int32_t copy[kTile + 2][kSmoothChunk + 2];
  void look_at(const Frame& f, const uint32_t* in, int32_t x, int32_t y) {
    const bool inner = x > 0 && x + kSmoothChunk < f.width;
    for (int i = 0; i < kTile + 2; ++i) {
      const int32_t line = max_of(0, min_of(y + i - 1, f.height - 1));
      row[i] = reinterpret_cast<const int32_t*>(in) + static_cast<Int64>(line) * f.width;
      if (inner) continue;
      for (int k = 0; k < kSmoothChunk + 2; ++k) copy[i][k] = row[i][max_of(0, min_of(x + k - 1, f.width - 1))];
      row[i] = copy[i] + 1 - x;
    }
  }
};

/// Which of a chunk's rows hold a pixel that differs from a neighbour by at least `least` in some channel, whatever
/// they show: most of a picture does not, and needs no second look.
PROMENADE_INLINE uint32_t rows_with_differences(const ColorChunk& colors, int32_t rows, int32_t x, int32_t least) {
  const I most = splat(static_cast<int32_t>(0xff000000U | static_cast<uint32_t>(least - 1) * 0x10101U));
  constexpr uint32_t kAll = (1U << kLanes) - 1U;
  const auto differs = [&](I a) { return bits(equal(max_bytes(a, most), most)) != kAll; };
  uint32_t found = 0;
  for (int part = 0; part < kSmoothChunk; part += kLanes) {
    const int32_t p = x + part;
    I above = load(colors.row[0] + p);
    for (int32_t i = 0; i <= rows; ++i) {
      const I here = load(colors.row[i + 1] + p);
      if (differs(difference_of_bytes(above, here))) found |= 3U << i;
      above = here;
      if (i == rows) break;
      const I left = load(colors.row[i + 1] + p - 1), right = load(colors.row[i + 1] + p + 1);
      if (differs(max_bytes(difference_of_bytes(left, here), difference_of_bytes(right, here)))) found |= 2U << i;
    }
  }
  return found >> 1 & ((1U << rows) - 1U);
}

void find_edges_row(const Frame& f, const Smoothing& smoothing, int32_t ty) {
  IdRows ids(f, smoothing, ty);
  const int32_t y = ty * kTile, rows = min_of(kTile, f.height - y), least = smoothing.least_difference;
  uint32_t* count = smoothing.counts + static_cast<Int64>(ty) * kStrengths;
  __builtin_memset(count, 0, sizeof(uint32_t) * kStrengths);
  uint8_t* strengths = smoothing.strength + static_cast<Int64>(y) * smoothing.stride;
  __builtin_memset(strengths, 0, static_cast<uint64_t>(rows) * static_cast<uint64_t>(smoothing.stride));
  ColorChunk colors;
  constexpr int32_t kAhead = 6 * kSmoothChunk;
  for (int32_t x = 0; x < f.width; x += kSmoothChunk) {
    colors.look_at(f, smoothing.in, x, y);
    for (int32_t i = 0; i < rows + 2 && x + kAhead < f.width; ++i)
      __builtin_prefetch(smoothing.in + static_cast<Int64>(max_of(0, min_of(y + i - 1, f.height - 1))) * f.width + x +
                         kAhead);
    uint32_t to_do = rows_with_differences(colors, rows, x, least);
    if (to_do != 0) ids.ask_for(x);
    for (; to_do != 0; to_do &= to_do - 1) {
      const int32_t i = __builtin_ctz(to_do);
      const Rows id = {{ids.at(i), ids.at(i + 1), ids.at(i + 2)}};
      const Rows color = {{colors.row[i], colors.row[i + 1], colors.row[i + 2]}};
      int32_t strength[kSmoothChunk];
      uint32_t found = edges_among(id, color, x, least, strength);
      if (found == 0) continue;
      uint8_t* out = strengths + static_cast<Int64>(i) * smoothing.stride + x;
      for (int k = 0; k < kSmoothChunk; ++k) out[k] = static_cast<uint8_t>(strength[k]);
      if (f.width - x < kSmoothChunk) found &= (1U << (f.width - x)) - 1U;
      for (; found != 0; found &= found - 1) ++count[strength[__builtin_ctz(found)]];
    }
  }
}

/// Of kSmoothChunk pixels those whose strength is at least that.
PROMENADE_INLINE uint32_t at_least(const uint8_t* strength, int32_t least) {
  uint64_t halves[2];
  __builtin_memcpy(halves, strength, sizeof halves);
  if ((halves[0] | halves[1]) == 0) return 0;  // least > 0
  uint32_t found = 0;
  for (int part = 0; part < kSmoothChunk; part += kLanes)
    found |= bits(load(strength + part) > splat(least - 1)) << part;
  return found;
}

/// A pixel and its neighbours; beyond the picture's sides, itself. i: the row of ids above it.
PROMENADE_INLINE Five five_at(const Frame& f, const uint32_t* in, const IdRows& ids, int32_t i, int32_t px,
                              int32_t py) {
  const int32_t left = max_of(px - 1, 0), right = min_of(px + 1, f.width - 1);
  const uint32_t* row = in + static_cast<Int64>(py) * f.width;
  const uint32_t *above = py > 0 ? row - f.width : row, *below = py + 1 < f.height ? row + f.width : row;
  const int32_t *own = ids.at(i + 1), *up = ids.at(i), *down = ids.at(i + 2);
  const int32_t id[5] = {own[px], own[left], own[right], up[px], down[px]};
  const uint32_t color[5] = {row[px], row[left], row[right], above[px], below[px]};
  Five five;
  __builtin_memcpy(five.id, id, sizeof id), __builtin_memcpy(five.color, color, sizeof color);
  return five;
}

/// Pixels that are about to be smoothed, so that memory is asked for all of their triangles at once.
struct WaitingPixels {
  static constexpr int kMost = 256;
  struct Pixel {
    int32_t x, y;
    Five five;
  };
  Pixel pixels[kMost];
  int count = 0;
  uint32_t wanted[5 * kMost];  ///< triangles that are not among those met last

  int find_wanted(const EdgeTriangles& triangles) {
    int found = 0;
    for (int i = 0; i < count; ++i)
      for (int k = 0; k < 5; ++k) {
        const uint32_t id = pixels[i].five.id[k];
        if (id == kNoSurface || (k > 0 && id == pixels[i].five.id[0]) || triangles.has(id)) continue;
        if (found > 0 && wanted[found - 1] == id) continue;
        wanted[found++] = id;
      }
    return found;
  }

  void ask_for_wanted(const Shading& s, int found) const {
    const auto item_of = [&](int i) -> const Item& { return s.items[s.item_of_run[wanted[i] >> s.run_bits]]; };
    for (int i = 0; i < found; ++i) ask_for(&item_of(i).vertices);
    for (int i = 0; i < found; ++i) ask_for_triangle(item_of(i), wanted[i]);
    for (int i = 0; i < found; ++i) ask_for_vertices(item_of(i), wanted[i]);
    for (int i = 0; i < found; ++i) ask_for_positions(item_of(i), wanted[i]);
  }

  Smoothed* smooth(const Frame& f, const Shading& s, EdgeTriangles& triangles, Smoothed* to) {
    ask_for_wanted(s, find_wanted(triangles));
    for (int i = 0; i < count; ++i, ++to) {
      const Pixel& p = pixels[i];
      *to = {static_cast<uint32_t>(p.y * f.width + p.x),
             static_cast<uint32_t>(smoothed_pixel(f, s, triangles, p.five, p.x, p.y))};
    }
    count = 0;
    return to;
  }
};

void smooth_row(const Frame& f, const Shading& s, const Smoothing& smoothing, int32_t ty) {
  EdgeTriangles triangles;
  WaitingPixels waiting;
  IdRows ids(f, smoothing, ty);
  const int32_t y = ty * kTile, rows = min_of(kTile, f.height - y);
  Smoothed* to = smoothing.smoothed;
  // Column by column, so that the rows of a triangle find it among those met last; in the same order on all
  // processors, because a triangle's functions depend a little on the pixel that asked for them first.
  for (int32_t x = 0; x < f.width; x += kSmoothChunk) {
    for (int32_t i = 0; i < rows; ++i) {
      uint32_t edges =
          at_least(smoothing.strength + static_cast<Int64>(y + i) * smoothing.stride + x, smoothing.least_difference);
      if (f.width - x < kSmoothChunk) edges &= (1U << (f.width - x)) - 1U;
      if (edges != 0) ids.ask_for(x);
      for (; edges != 0; edges &= edges - 1) {
        const int32_t px = x + __builtin_ctz(edges);
        waiting.pixels[waiting.count++] = {px, y + i, five_at(f, smoothing.in, ids, i, px, y + i)};
        if (waiting.count == WaitingPixels::kMost) to = waiting.smooth(f, s, triangles, to);
      }
    }
  }
  waiting.smooth(f, s, triangles, to);
}
