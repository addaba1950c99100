// Part of kernel.inl: colours, after the visibility is known, so that each pixel is shaded once. The distinct triangles
// of a few tiles side by side (a span) are set up kLanes at a time (light at their corners, and every attribute divided
// by w as a linear function over the picture); then each tile's pixels are coloured kLanes at a time from those
// functions and the depth that they have.

constexpr int32_t kSpanTiles = 4, kSpanTriangles = 64;

/// Tiles of one row that have at most kSpanTriangles distinct triangles together.
struct Span {
  int32_t first, tiles;
  int32_t count;
  uint32_t id[kSpanTriangles];
  uint8_t slots[2 * kSpanTriangles];                   ///< hash table of places in `id`; 255: none
  alignas(64) int32_t which[kSpanTiles][kTilePixels];  ///< triangle of each pixel; -1: none
};

/// A span's triangles, corner by corner, in model space.
struct SpanTriangles {
  int32_t count;
  alignas(64) float p[3][3][kSpanTriangles];  ///< corner, axis
  alignas(64) float normal[3][3][kSpanTriangles];
  alignas(
      64) float color[3][3][kSpanTriangles];   ///< linear, the material's included; the first corner's unless varying
  alignas(64) float uv[3][2][kSpanTriangles];  ///< textured ones only
  alignas(64) int32_t smooth[kSpanTriangles];  ///< 1: has normals
  alignas(64) float texture[kSpanTriangles];   ///< which of `surfaces`; -1: none
  const Surface* surfaces[kSpanTriangles];     ///< the distinct textured ones
  int32_t surface_count;
  bool varying;  ///< some triangle's lit colour may differ from corner to corner
};

enum Slot : int {
  slot_u,
  slot_ux,
  slot_uy,
  slot_v,
  slot_vx,
  slot_vy,  // NOLINT: one attribute after the other
  slot_zx,
  slot_zy,
  slot_z,
  slot_r,
  slot_rx,
  slot_ry,
  slot_g,
  slot_gx,
  slot_gy,
  slot_b,
  slot_bx,
  slot_by,
  slot_count
};

/// Value at the span's first pixel and change a pixel of each attribute times 1/w (orthographic: times 1).
struct SpanFunctions {
  alignas(64) float a[slot_count][kSpanTriangles];
};

void begin_span(Span& span, int32_t first) {
  span.first = first, span.tiles = 0, span.count = 0;
  __builtin_memset(span.slots, 255, sizeof span.slots);
}

/// The triangle's place in the span, which it is given if it has none; -1: there is no room.
PROMENADE_INLINE int32_t place_in_span(Span& span, uint32_t id) {
  constexpr uint32_t kSlots = sizeof span.slots;
  static_assert(kSlots == 128);
  uint32_t slot = (id * 0x9e3779b1U) >> 25;
  while (span.slots[slot] != 255 && span.id[span.slots[slot]] != id) slot = (slot + 1) & (kSlots - 1);
  if (span.slots[slot] != 255) return span.slots[slot];
  if (span.count == kSpanTriangles) return -1;
  span.slots[slot] = static_cast<uint8_t>(span.count), span.id[span.count] = id;
  return span.count++;
}

/// Finds the tile's triangles; false: with them the span would have too many, and it is complete without the tile.
bool add_tile(const Frame& f, const float* z, const uint32_t* id, Span& span) {
  if (span.tiles == kSpanTiles) return false;
  const int32_t before = span.count;
  const int32_t* ids = reinterpret_cast<const int32_t*>(id);
  int32_t* which = span.which[span.tiles];
  constexpr uint32_t kAll = (1U << kLanes) - 1U;
  const I first = splat(ids[0]), none = splat(static_cast<int32_t>(kNoSurface));
  M same = mask_of(kAll);
  for (int i = 0; i < kTilePixels; i += kLanes)
    same = same & equal(load(ids + i), first) & (load(z + i) > splat(f.clear_z));
  const bool one = id[0] != kNoSurface && bits(same) == kAll;
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const I here = load(ids + i);
    I places = splat(-1);
    uint32_t left = one ? kAll : bits(load(z + i) > splat(f.clear_z)) & ~bits(equal(here, none));
    while (left != 0) {
      const uint32_t next = id[i + __builtin_ctz(left)];
      const int32_t place = place_in_span(span, next);
      if (place < 0) {
        span.count = before;
        return false;
      }
      const M like = equal(here, splat(static_cast<int32_t>(next))) & mask_of(left);  // ids outlive their pixels
      places = select(like, splat(place), places), left &= ~bits(like);
    }
    store(which + i, places);
  }
  ++span.tiles;
  return true;
}

PROMENADE_INLINE void to_model(const Item& item, float* p) {
  const float x = p[0], y = p[1], z = p[2];
  for (int i = 0; i < 3; ++i)
    p[i] =
        (item.model_rows[i][0] * x + item.model_rows[i][1] * y) + (item.model_rows[i][2] * z + item.model_rows[i][3]);
}

/// Has memory bring what lies there, by reading it, one read beside the other: the prefetch instruction was measured to
/// do nothing for triangles that lie anywhere.
template <class T>
PROMENADE_INLINE void ask_for(const T* p) {
  static_cast<void>(*const_cast<const volatile T*>(p));
}

/// Ask for what fetch_triangle will read of all triangles at once, because they lie anywhere in memory: first for their
/// corners' numbers, then for what these name.
void ask_for_triangles(const Shading& s, const Span& span) {
  for (int32_t k = 0; k < span.count; ++k) ask_for(&s.items[s.item_of_run[span.id[k] >> s.run_bits]].indices);
  for (int32_t k = 0; k < span.count; ++k) {
    const Item& item = s.items[s.item_of_run[span.id[k] >> s.run_bits]];
    if (item.indices == nullptr) continue;
    const uint64_t triangle = span.id[k] - item.first_id;
    ask_for(item.indices + 3 * triangle);
    if (item.materials != nullptr) ask_for(item.materials + triangle);
  }
}
void ask_for_corners(const Shading& s, const Span& span) {
  for (int32_t k = 0; k < span.count; ++k) {
    const Item& item = s.items[s.item_of_run[span.id[k] >> s.run_bits]];
    if (item.indices == nullptr) continue;
    const uint32_t* index = item.indices + 3 * static_cast<uint64_t>(span.id[k] - item.first_id);
    for (int i = 0; i < 3; ++i) ask_for(item.positions + 3 * static_cast<uint64_t>(index[i]));
    if (item.texcoords != nullptr) ask_for(item.texcoords + 2 * static_cast<uint64_t>(index[0]));
    if (item.normals != nullptr) ask_for(item.normals + 3 * static_cast<uint64_t>(index[0]));
  }
}

float number_of_surface(SpanTriangles& t, const Surface* surface) {
  for (int32_t i = 0; i < t.surface_count; ++i)
    if (t.surfaces[i] == surface) return static_cast<float>(i);
  t.surfaces[t.surface_count] = surface;
  return static_cast<float>(t.surface_count++);
}

/// Colours and normals of a triangle whose corners differ; `color` holds the material's.
void fetch_corners(const Shading& s, const Item& item, const uint32_t* index, SpanTriangles& t, int32_t k) {
  const float material[3] = {t.color[0][0][k], t.color[0][1][k], t.color[0][2][k]};
  for (int v = 0; v < 3; ++v) {
    const uint64_t at = index[v];
    for (int c = 0; c < 3; ++c)
      t.color[v][c][k] =
          item.colors != nullptr ? material[c] * s.linear_of_srgb[item.colors[at] >> (8 * c) & 255U] : material[c];
    if (item.normals == nullptr) continue;
    const float* n = item.normals + 3 * at;
    if (n[0] != 0 || n[1] != 0 || n[2] != 0) t.smooth[k] = 1;
    for (int c = 0; c < 3; ++c)
      t.normal[v][c][k] =
          item.placed ? (item.normal_rows[c][0] * n[0] + item.normal_rows[c][1] * n[1]) + item.normal_rows[c][2] * n[2]
                      : n[c];
  }
}

/// Brings one triangle's corners into the span's arrays; false: its corners' colours may differ.
PROMENADE_INLINE bool fetch_triangle(const Shading& s, uint32_t id, SpanTriangles& t, int32_t k) {
  const Item& item = s.items[s.item_of_run[id >> s.run_bits]];
  const uint64_t triangle = id - item.first_id;
  t.texture[k] = -1, t.smooth[k] = 0;
  const bool bare = item.indices == nullptr;
  const uint32_t material = bare || item.materials == nullptr ? 0 : item.materials[triangle];
  const Surface* surface =
      item.surfaces != nullptr && material < item.surface_count ? item.surfaces + material : nullptr;
  for (int c = 0; c < 3; ++c) t.color[0][c][k] = surface == nullptr ? 1.0F : surface->color[c];
  if (bare) {
    for (int v = 0; v < 3; ++v)
      for (int c = 0; c < 3; ++c) t.p[v][c][k] = item.placed ? item.model_rows[c][3] : 0;
    return true;
  }
  const uint32_t* index = item.indices + 3 * triangle;
  for (int v = 0; v < 3; ++v) {
    const float* at = item.positions + 3 * static_cast<uint64_t>(index[v]);
    float p[3] = {at[0], at[1], at[2]};
    if (item.placed) to_model(item, p);
    for (int c = 0; c < 3; ++c) t.p[v][c][k] = p[c];
  }
  if (s.has_textures && surface != nullptr && surface->texture != nullptr && item.texcoords != nullptr) {
    t.texture[k] = number_of_surface(t, surface);
    for (int v = 0; v < 3; ++v) {
      const float* at = item.texcoords + 2 * static_cast<uint64_t>(index[v]);
      t.uv[v][0][k] = at[0], t.uv[v][1][k] = at[1];
    }
  }
  if (item.normals == nullptr && item.colors == nullptr) return true;
  fetch_corners(s, item, index, t, k);
  return false;
}

/// Brings all of a span's triangles into its arrays.
void fetch_triangles(const Shading& s, const Span& span, SpanTriangles& t) {
  t.count = span.count, t.surface_count = 0;
  uint64_t flat = 0;
  for (int32_t k = 0; k < span.count; ++k) flat |= (fetch_triangle(s, span.id[k], t, k) ? uint64_t(1) : 0) << k;
  t.varying = flat != (span.count == 64 ? ~uint64_t(0) : (uint64_t(1) << span.count) - 1);
  if (!t.varying) return;
  for (; flat != 0; flat &= flat - 1) {
    const int k = __builtin_ctzll(flat);
    for (int c = 0; c < 3; ++c) t.color[1][c][k] = t.color[2][c][k] = t.color[0][c][k];
  }
}

/// Light on a surface: a sun, a sky above and the ground below.
PROMENADE_INLINE void light_on(const Shading& s, const F* n, F* out) {
  const F zero = splat(0.0F), half = splat(0.5F);
  const F facing = max((n[0] * splat(s.to_sun[0]) + n[1] * splat(s.to_sun[1])) + n[2] * splat(s.to_sun[2]), zero);
  const F up = half + half * n[2];
  for (int c = 0; c < 3; ++c)
    out[c] = splat(s.sun[c]) * facing + (splat(s.ground[c]) + up * splat(s.sky[c] - s.ground[c]));
}

PROMENADE_INLINE void make_unit(F* n) {
  const F length = sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
  const F inverse = splat(1.0F) / max(length, splat(1e-30F));
  for (int c = 0; c < 3; ++c) n[c] = n[c] * inverse;
}

/// Lit colours at the corners, in place of the plain ones.
PROMENADE_INLINE void light_corners(const Shading& s, SpanTriangles& t, int32_t first) {
  F e1[3], e2[3], n[3], to_eye[3];
  for (int c = 0; c < 3; ++c) {
    const F a = load(t.p[0][c] + first);
    e1[c] = load(t.p[1][c] + first) - a, e2[c] = load(t.p[2][c] + first) - a;
    to_eye[c] = s.orthographic ? splat(-s.rows[2][c]) : (splat(s.eye_hi[c]) - a) + splat(s.eye_lo[c]);
  }
  for (int c = 0; c < 3; ++c) {
    const int i = (c + 1) % 3, j = (c + 2) % 3;
    n[c] = e1[i] * e2[j] - e1[j] * e2[i];
  }
  make_unit(n);
  const F zero = splat(0.0F);
  const F seen_from = (n[0] * to_eye[0] + n[1] * to_eye[1]) + n[2] * to_eye[2];
  const M back = seen_from < zero;
  for (int c = 0; c < 3; ++c) n[c] = select(back, zero - n[c], n[c]);
  const M smooth = load(t.smooth + first) > splat(0);
  const bool any_smooth = bits(smooth) != 0;
  F light[3];
  light_on(s, n, light);
  for (int v = 0; v < (t.varying ? 3 : 1); ++v) {
    F here[3] = {light[0], light[1], light[2]};
    if (any_smooth) {
      F m[3];
      for (int c = 0; c < 3; ++c) m[c] = load(t.normal[v][c] + first);
      const M own = ((m[0] * m[0] + m[1] * m[1]) + m[2] * m[2]) > zero;
      make_unit(m);
      for (int c = 0; c < 3; ++c) m[c] = select(smooth & own, select(back, zero - m[c], m[c]), n[c]);
      light_on(s, m, here);
    }
    for (int c = 0; c < 3; ++c) store(t.color[v][c] + first, load(t.color[v][c] + first) * here[c]);
  }
}

/// The long way for triangles that reach behind the near plane or far out of the picture: in double, without dividing
/// by their w.
void set_up_far_reaching(const Frame& f, const Shading& s, const SpanTriangles& t, int32_t k, float x, float y,
                         SpanFunctions& out) {
  ViewPoint p[3];
  for (int v = 0; v < 3; ++v) {
    const float d[3] = {(t.p[v][0][k] - s.eye_hi[0]) - s.eye_lo[0], (t.p[v][1][k] - s.eye_hi[1]) - s.eye_lo[1],
                        (t.p[v][2][k] - s.eye_hi[2]) - s.eye_lo[2]};
    Item frame;  // only its rows are read
    __builtin_memcpy(frame.rows, s.rows, sizeof frame.rows);
    p[v] = rotated(frame, d);
    if (f.orthographic) p[v].w = 1.0F;
  }
  double values[6][3], solved[6][3] = {};
  for (int v = 0; v < 3; ++v) {
    values[0][v] = t.uv[v][0][k], values[1][v] = t.uv[v][1][k], values[2][v] = 1;
    for (int c = 0; c < 3; ++c) values[3 + c][v] = t.color[v][c][k];
  }
  linear_over(p, values, 6, solved);
  const int slots[6] = {slot_u, slot_v, -1, slot_r, slot_g, slot_b};
  for (int i = 0; i < 6; ++i) {
    const float dx = static_cast<float>(solved[i][0] * kSubpixel), dy = static_cast<float>(solved[i][1] * kSubpixel);
    const float at = static_cast<float>(solved[i][0] * x + solved[i][1] * y + solved[i][2]);
    if (slots[i] < 0) {
      out.a[slot_zx][k] = dx, out.a[slot_zy][k] = dy, out.a[slot_z][k] = at;
      continue;
    }
    if (i >= 3 && !t.varying) continue;  // set_up_lanes has put the plain colour there
    out.a[slots[i]][k] = at, out.a[slots[i] + 1][k] = dx, out.a[slots[i] + 2][k] = dy;
  }
}

/// Functions over the picture of kLanes triangles from `first` on; x, y: centre of the span's first pixel, sub-pixels
/// from the axis.
PROMENADE_INLINE void set_up_lanes(const Frame& f, const Shading& s, const SpanTriangles& t, int32_t first, float x,
                                   float y, SpanFunctions& out) {
  F px[3], py[3], pz[3];
  const F one = splat(1.0F), near = splat(f.near_m), pixel = splat(static_cast<float>(kSubpixel));
  M far = mask_of(0);
  for (int v = 0; v < 3; ++v) {
    F d[3];
    for (int c = 0; c < 3; ++c) d[c] = (load(t.p[v][c] + first) - splat(s.eye_hi[c])) - splat(s.eye_lo[c]);
    px[v] = (splat(s.rows[0][0]) * d[0] + splat(s.rows[0][1]) * d[1]) + splat(s.rows[0][2]) * d[2];
    py[v] = (splat(s.rows[1][0]) * d[0] + splat(s.rows[1][1]) * d[1]) + splat(s.rows[1][2]) * d[2];
    const F w = (splat(s.rows[2][0]) * d[0] + splat(s.rows[2][1]) * d[1]) + splat(s.rows[2][2]) * d[2];
    pz[v] = f.orthographic ? one : one / max(w, near);
    px[v] = px[v] * pz[v], py[v] = py[v] * pz[v];
    if (!f.orthographic) far = far | (w < near);
    far = far | (abs(px[v]) > splat(f.guard_x)) | (abs(py[v]) > splat(f.guard_y));
  }
  const F x1 = px[1] - px[0], y1 = py[1] - py[0], x2 = px[2] - px[0], y2 = py[2] - py[0];
  const F area = x1 * y2 - x2 * y1;
  const M sound = abs(area) > splat(0.5F);
  const F inverse = select(sound, pixel / select(sound, area, one), splat(0.0F));
  const F to_x = (splat(x) - px[0]) * splat(1.0F / kSubpixel), to_y = (splat(y) - py[0]) * splat(1.0F / kSubpixel);
  const auto put = [&](F a0, F a1, F a2, int at, int dx, int dy) {
    a0 = a0 * pz[0];
    const F d1 = a1 * pz[1] - a0, d2 = a2 * pz[2] - a0;
    const F gx = (d1 * y2 - d2 * y1) * inverse, gy = (x1 * d2 - x2 * d1) * inverse;
    store(out.a[dx] + first, gx);
    store(out.a[dy] + first, gy);
    store(out.a[at] + first, a0 + (gx * to_x + gy * to_y));
  };
  const auto corner = [&](const float(*v)[kSpanTriangles], int axis) { return load(v[axis] + first); };
  if (t.surface_count > 0) {
    put(corner(t.uv[0], 0), corner(t.uv[1], 0), corner(t.uv[2], 0), slot_u, slot_ux, slot_uy);
    put(corner(t.uv[0], 1), corner(t.uv[1], 1), corner(t.uv[2], 1), slot_v, slot_vx, slot_vy);
    put(one, one, one, slot_z, slot_zx, slot_zy);
  }
  for (int c = 0; c < 3; ++c) {
    if (t.varying)
      put(corner(t.color[0], c), corner(t.color[1], c), corner(t.color[2], c), slot_r + 3 * c, slot_rx + 3 * c,
          slot_ry + 3 * c);
    else
      store(out.a[slot_r + 3 * c] + first, corner(t.color[0], c));
  }
  const int32_t left = t.count - first;
  uint32_t redo = bits(far) & (left >= kLanes ? (1U << kLanes) - 1U : (1U << left) - 1U);
  for (; redo != 0; redo &= redo - 1) set_up_far_reaching(f, s, t, first + __builtin_ctz(redo), x, y, out);
}

#include "raster/kernel_texture.inl"

// --- Pixels
// ------------------------------------------------------------------------------------------------------------

/// Linear to sRGB bytes, in the lowest byte: the curve as a polynomial of the square root, within 0.2 of a step.
PROMENADE_INLINE I to_srgb(F a) {
  a = max(min(a, splat(1.0F)), splat(0.0F));
  const F r = sqrt(a);
  const F high = splat(1.55840883F) + r * (splat(-1.13839774F) + r * splat(0.337028849F));
  const F curve = splat(-0.0383227873F) + r * (splat(1.4829101F) + r * (splat(-1.20152822F) + r * high));
  const F low = splat(12.92F) * a;
  return truncate(select(a < splat(0.0031308F), low, curve) * splat(255.0F) + splat(0.5F));
}

PROMENADE_INLINE I packed_srgb(const F* c) {
  return to_srgb(c[0]) | shift_left<8>(to_srgb(c[1])) | shift_left<16>(to_srgb(c[2])) |
         splat(static_cast<int32_t>(0xff000000U));
}

PROMENADE_INLINE I sky_at(const Shading& s, F x, F y) {
  F d[3];
  for (int c = 0; c < 3; ++c) d[c] = (splat(s.ray_x[c]) * x + splat(s.ray_y[c]) * y) + splat(s.ray_axis[c]);
  make_unit(d);
  const F zero = splat(0.0F);
  const M above = d[2] > zero;
  const F share = select(above, sqrt(max(d[2], zero)), min(splat(1.0F), splat(-8.0F) * d[2]));
  F color[3];
  for (int c = 0; c < 3; ++c)
    color[c] =
        splat(s.horizon[c]) + share * (select(above, splat(s.zenith[c]), splat(s.below[c])) - splat(s.horizon[c]));
  return packed_srgb(color);
}

/// The centre of a tile's first pixel, in sub-pixels from the axis.
PROMENADE_INLINE float first_center(int32_t tile, int32_t axis) {
  return static_cast<float>(tile * kTile * kSubpixel + kSubpixel / 2 - axis);
}

/// Brings the triangles of a span, and their attributes as functions over it, into place.
void set_up_span(const Frame& f, const Shading& s, const Span& span, int32_t ty, SpanTriangles& t, SpanFunctions& fn) {
  fetch_triangles(s, span, t);
  for (int32_t k = 0; k < t.count; k += kLanes) {
    light_corners(s, t, k);
    set_up_lanes(f, s, t, k, first_center(span.first, f.axis_x), first_center(ty, f.axis_y), fn);
  }
}

/// Pixels of a tile, kLanes from `first` on: how far they lie from the span's first pixel. tile: of the span.
struct LanePlace {
  F dx, dy;
  LanePlace(int32_t tile, int first)
      : dx(load(kOffsets.x) + splat(static_cast<float>(tile * kTile + (first / 16 & 1) * 4))),
        dy(load(kOffsets.y) + splat(static_cast<float>((first / 32) * 4 + first % 16 / 4))) {}
};

/// What is known of a tile's pixels: their depths, and their triangles as places in the span; -1: none.
struct TilePixels {
  const float* z;
  const int32_t* which;
  int32_t tile;  ///< of the span
};

/// Metres along the view axis; orthographic: 1.
PROMENADE_INLINE F distance_of(const Frame& f, const TilePixels& pixels, int first, M covered) {
  const F one = splat(1.0F);
  return f.orthographic ? one : one / select(covered, load(pixels.z + first), one);
}

/// kEntries: at least the span's triangles.
template <int kEntries>
PROMENADE_INLINE void place_textures(const Frame& f, const SpanTriangles& t, const SpanFunctions& fn,
                                     const TilePixels& pixels, TexturePlaces& out) {
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const I shown = load(pixels.which + i), seen = max(shown, splat(0));
    const M covered = shown > splat(-1);
    const LanePlace at(pixels.tile, i);
    const F w = distance_of(f, pixels, i, covered);
    const auto slot = [&](int k) { return Table<kEntries>(fn.a[k])[seen]; };
    const F ux = slot(slot_ux), uy = slot(slot_uy), vx = slot(slot_vx), vy = slot(slot_vy);
    const F u = (slot(slot_u) + (ux * at.dx + uy * at.dy)) * w, v = (slot(slot_v) + (vx * at.dx + vy * at.dy)) * w;
    F zx = splat(0.0F), zy = zx;
    if (!f.orthographic) zx = slot(slot_zx), zy = slot(slot_zy);
    store(out.u + i, u);
    store(out.v + i, v);
    store(out.dux + i, (ux - u * zx) * w);
    store(out.duy + i, (uy - u * zy) * w);
    store(out.dvx + i, (vx - v * zx) * w);
    store(out.dvy + i, (vy - v * zy) * w);
    store(out.surface + i, select(covered, Table<kEntries>(t.texture)[seen], splat(-1.0F)));
  }
}

/// A tile of the picture, linear.
struct LinearTile {
  alignas(64) float color[3][kTilePixels];
};

/// Room for one tile's textures.
struct TextureRoom {
  TexturePlaces places;
  Samples samples;
  LinearTile sum;
};

/// The textures' colours of a tile's pixels into room.sum; what has no texture gets 1.
template <int kEntries>
PROMENADE_INLINE void sample_textures(const Frame& f, const Shading& s, const SpanTriangles& t, const SpanFunctions& fn,
                                      const TilePixels& pixels, TextureRoom& room) {
  place_textures<kEntries>(f, t, fn, pixels, room.places);
  F most = splat(-1.0F);
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const F surface = load(room.places.surface + i);
    const F plain = select(surface < splat(0.0F), splat(1.0F), splat(0.0F));
    for (int c = 0; c < 3; ++c) store(room.sum.color[c] + i, plain);
    most = max(most, surface);
  }
  for (int32_t i = 0; i < t.surface_count; ++i) {
    if (bits(most >= splat(static_cast<float>(i))) == 0) return;
    sample_surface(*t.surfaces[i], i, room.places, s.anisotropy, room.samples, room.sum.color);
  }
}

/// Linear colours of a tile's covered pixels.
template <int kEntries>
PROMENADE_INLINE void color_tile_by(const Frame& f, const Shading& s, const SpanTriangles& t, const SpanFunctions& fn,
                                    const TilePixels& pixels, TextureRoom& room, LinearTile& out) {
  if (t.surface_count > 0) sample_textures<kEntries>(f, s, t, fn, pixels, room);
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const I shown = load(pixels.which + i), seen = max(shown, splat(0));
    const LanePlace at(pixels.tile, i);
    const auto slot = [&](int k) { return Table<kEntries>(fn.a[k])[seen]; };
    const F w = t.varying ? distance_of(f, pixels, i, shown > splat(-1)) : splat(1.0F);
    for (int c = 0; c < 3; ++c) {
      F color = slot(slot_r + 3 * c);
      if (t.varying) color = (color + (slot(slot_rx + 3 * c) * at.dx + slot(slot_ry + 3 * c) * at.dy)) * w;
      if (t.surface_count > 0) color = color * load(room.sum.color[c] + i);
      store(out.color[c] + i, color);
    }
  }
}

void color_tile(const Frame& f, const Shading& s, const SpanTriangles& t, const SpanFunctions& fn,
                const TilePixels& pixels, TextureRoom& room, LinearTile& out) {
  if (t.count <= 16) return color_tile_by<16>(f, s, t, fn, pixels, room, out);
  if (t.count <= 32) return color_tile_by<32>(f, s, t, fn, pixels, room, out);
  color_tile_by<kSpanTriangles>(f, s, t, fn, pixels, room, out);
}

/// What shading a row of tiles works in. Lanes beyond the last triangle are computed and never looked at; they must
/// only be numbers.
struct ShadeRoom {
  SpanTriangles triangles;
  SpanFunctions functions;
  TextureRoom textures;
  LinearTile linear;
};

void put_tile(const Frame& f, const Shading& s, int32_t tx, int32_t ty, const int32_t* which,
              const LinearTile& linear) {
  const F x = splat(first_center(tx, f.axis_x)), y = splat(first_center(ty, f.axis_y)),
          pixel = splat(static_cast<float>(kSubpixel));
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const LanePlace at(0, i);
    const M covered = load(which + i) > splat(-1);
    const uint32_t lanes = bits(covered);
    I out = splat(static_cast<int32_t>(s.plain));
    if (s.has_sky && lanes != (1U << kLanes) - 1U) out = sky_at(s, x + at.dx * pixel, y + at.dy * pixel);
    if (lanes != 0) {
      const F color[3] = {load(linear.color[0] + i), load(linear.color[1] + i), load(linear.color[2] + i)};
      out = select(covered, packed_srgb(color), out);
    }
    int32_t rgba[kLanes];
    store(rgba, out);
    for (int r = 0; r < kLanes / 4; ++r) {
      const int32_t px = tx * kTile + (i / 16 & 1) * 4, py = ty * kTile + (i / 32) * 4 + i % 16 / 4 + r;
      if (py >= f.height || px >= f.width) continue;
      uint32_t* to = s.out + static_cast<Int64>(py) * f.width + px;
      const int32_t count = f.width - px;
      if (count >= 4)
        __builtin_memcpy(to, rgba + 4 * r, 16);
      else
        __builtin_memcpy(to, rgba + 4 * r, static_cast<uint64_t>(count) * 4);
    }
  }
}

void shade_span(const Frame& f, const Shading& s, const Span& span, int32_t ty, ShadeRoom& room) {
  if (span.count > 0) set_up_span(f, s, span, ty, room.triangles, room.functions);
  for (int32_t i = 0; i < span.tiles; ++i) {
    const Int64 tile = (static_cast<Int64>(ty) * f.tiles_x + span.first + i) * kTilePixels;
    const TilePixels pixels = {f.z + tile, span.which[i], i};
    if (span.count > 0) color_tile(f, s, room.triangles, room.functions, pixels, room.textures, room.linear);
    put_tile(f, s, span.first + i, ty, span.which[i], room.linear);
  }
}

/// Span by span; the triangles of a span are asked for two spans ahead, their corners one.
void shade_row(const Frame& f, const Shading& s, int32_t ty) {
  constexpr int32_t kAhead = 3;
  Span spans[kAhead];
  ShadeRoom room;
  __builtin_memset(&room, 0, sizeof room);
  int32_t found = 0, done = 0;
  for (int32_t next = 0; done < found || next < f.tiles_x;) {
    if (next < f.tiles_x) {
      Span& span = spans[found % kAhead];
      begin_span(span, next);
      for (Int64 tile = static_cast<Int64>(ty) * f.tiles_x + next; next < f.tiles_x; ++next, ++tile)
        if (!add_tile(f, f.z + tile * kTilePixels, f.id + tile * kTilePixels, span)) break;
      ask_for_triangles(s, span);
      if (found > 0) ask_for_corners(s, spans[(found - 1) % kAhead]);
      if (++found < kAhead && next < f.tiles_x) continue;
      if (next == f.tiles_x) ask_for_corners(s, span);
    }
    shade_span(f, s, spans[done % kAhead], ty, room);
    ++done;
  }
}
