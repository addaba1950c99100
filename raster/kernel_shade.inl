// Part of kernel.inl: colours, after the visibility is known, so that each pixel is shaded once. The distinct triangles
// of a few tiles side by side (a span) are set up kLanes at a time (light at their corners, and every attribute divided
// by w as a linear function over the picture); then each tile's pixels are coloured kLanes at a time from those
// functions and the depth that they have.

#include "raster/kernel_span.inl"

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

/// The finished colours of those of kLanes triangles that have one colour and no texture.
PROMENADE_INLINE void pack_flat_colors(SpanTriangles& t, int32_t first) {
  const F color[3] = {load(t.color[0][0] + first), load(t.color[0][1] + first), load(t.color[0][2] + first)};
  const M flat =
      mask_of(static_cast<uint32_t>(t.flat >> first) & ((1U << kLanes) - 1U)) & (load(t.texture + first) < splat(0.0F));
  store(t.packed + first, as_float(select(flat, packed_srgb(color), splat(0))));
}

/// Brings the triangles of a span, and their attributes as functions over it, into place.
void set_up_span(const Frame& f, const Shading& s, const Span& span, int32_t ty, SpanTriangles& t, SpanFunctions& fn) {
  fetch_triangles(s, span, t);
  for (int32_t k = 0; k < t.count; k += kLanes) {
    light_corners(s, t, k);
    pack_flat_colors(t, k);
    if (t.varying || t.surface_count > 0)
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

/// What kLanes pixels look up of their triangles. kEntries: at least the span's.
template <int kEntries>
struct OfSeveral {
  I seen;
  OfSeveral(const TilePixels& pixels, int first) : seen(max(load(pixels.which + first), splat(0))) {}
  PROMENADE_INLINE F operator()(const float* table) const { return Table<kEntries>(table)[seen]; }
};
/// The same where all of a tile shows one triangle.
struct OfOne {
  int32_t place;
  OfOne(const TilePixels& pixels, int /*first*/) : place(pixels.which[0]) {}
  PROMENADE_INLINE F operator()(const float* table) const { return splat(table[place]); }
};

template <class Of>
PROMENADE_INLINE void place_textures(const Frame& f, const SpanTriangles& t, const SpanFunctions& fn,
                                     const TilePixels& pixels, TexturePlaces& out) {
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const Of of(pixels, i);
    const M covered = load(pixels.which + i) > splat(-1);
    const LanePlace at(pixels.tile, i);
    const F w = distance_of(f, pixels, i, covered);
    const auto slot = [&](int k) { return of(fn.a[k]); };
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
    store(out.surface + i, select(covered, of(t.texture), splat(-1.0F)));
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
template <class Of>
PROMENADE_INLINE void sample_textures(const Frame& f, const Shading& s, const SpanTriangles& t, const SpanFunctions& fn,
                                      const TilePixels& pixels, TextureRoom& room) {
  place_textures<Of>(f, t, fn, pixels, room.places);
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

/// Linear colours of kLanes pixels of a tile from `first` on, whose textures are in `room`.
template <class Of>
PROMENADE_INLINE void color_lanes(const Frame& f, const SpanTriangles& t, const SpanFunctions& fn,
                                  const TilePixels& pixels, int first, const TextureRoom& room, F* color) {
  const Of of(pixels, first);
  const LanePlace at(pixels.tile, first);
  const M covered = load(pixels.which + first) > splat(-1);
  const F w = t.varying ? distance_of(f, pixels, first, covered) : splat(1.0F);
  for (int c = 0; c < 3; ++c) {
    color[c] = of(fn.a[slot_r + 3 * c]);
    if (t.varying) color[c] = (color[c] + (of(fn.a[slot_rx + 3 * c]) * at.dx + of(fn.a[slot_ry + 3 * c]) * at.dy)) * w;
    if (t.surface_count > 0) color[c] = color[c] * load(room.sum.color[c] + first);
  }
}

/// What shading a row of tiles works in. Lanes beyond the last triangle are computed and never looked at; they must
/// only be numbers.
struct ShadeRoom {
  SpanTriangles triangles;
  SpanFunctions functions;
  TextureRoom textures;
};

/// A thread's own, kept: 30 KiB are not to be cleared for each row.
PROMENADE_INLINE ShadeRoom& shade_room() {
  static thread_local ShadeRoom room;
  return room;
}

/// Linear colours of a tile's covered pixels.
template <class Of>
PROMENADE_INLINE void color_tile_by(const Frame& f, const Shading& s, const TilePixels& pixels, ShadeRoom& room,
                                    LinearTile& out) {
  const SpanTriangles& t = room.triangles;
  const bool same = !t.varying && t.surface_count == 0;
  if (t.surface_count > 0) sample_textures<Of>(f, s, t, room.functions, pixels, room.textures);
  for (int i = 0; i < kTilePixels; i += kLanes) {
    F color[3];
    if (same)
      for (int c = 0; c < 3; ++c) color[c] = Of(pixels, i)(t.color[0][c]);
    else
      color_lanes<Of>(f, t, room.functions, pixels, i, room.textures, color);
    for (int c = 0; c < 3; ++c) store(out.color[c] + i, color[c]);
  }
}

void color_tile(const Frame& f, const Shading& s, const TilePixels& pixels, ShadeRoom& room, LinearTile& out) {
  if (room.triangles.count <= 16) return color_tile_by<OfSeveral<16>>(f, s, pixels, room, out);
  if (room.triangles.count <= 32) return color_tile_by<OfSeveral<32>>(f, s, pixels, room, out);
  color_tile_by<OfSeveral<kSpanTriangles>>(f, s, pixels, room, out);
}

/// A tile's finished colours, in the order of its pixels.
struct PackedTile {
  alignas(64) int32_t rgba[kTilePixels];
};

PROMENADE_INLINE void put_tile(const Frame& f, const Shading& s, int32_t tx, int32_t ty, const PackedTile& tile) {
  uint32_t* to = s.out + static_cast<Int64>(ty) * kTile * f.width + tx * kTile;
  const int32_t width = min_of(kTile, f.width - tx * kTile), height = min_of(kTile, f.height - ty * kTile);
  for (int32_t y = 0; y < height; ++y, to += f.width) {
    const int32_t* row = tile.rgba + (y & 4) * 8 + (y & 3) * 4;
    if (width == kTile) {
      __builtin_memcpy(to, row, 16);
      __builtin_memcpy(to + 4, row + 16, 16);
      continue;
    }
    for (int32_t x = 0; x < width; ++x) to[x] = static_cast<uint32_t>(row[(x & 4) * 4 + (x & 3)]);
  }
}

/// What is seen where nothing is, at kLanes pixels of a tile.
PROMENADE_INLINE I background_at(const Frame& f, const Shading& s, int32_t tx, int32_t ty, int first) {
  if (!s.has_sky) return splat(static_cast<int32_t>(s.plain));
  const LanePlace at(0, first);
  const F pixel = splat(static_cast<float>(kSubpixel));
  return sky_at(s, splat(first_center(tx, f.axis_x)) + at.dx * pixel,
                splat(first_center(ty, f.axis_y)) + at.dy * pixel);
}

/// Finished colours of a tile: those of its triangles that have one are looked up, the others computed.
template <class Of>
PROMENADE_INLINE void shade_tile_by(const Frame& f, const Shading& s, int32_t tx, int32_t ty, const TilePixels& pixels,
                                    ShadeRoom& room, PackedTile& out) {
  constexpr uint32_t kAll = (1U << kLanes) - 1U;
  const SpanTriangles& t = room.triangles;
  bool sampled = t.surface_count == 0;
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const M covered = load(pixels.which + i) > splat(-1);
    I rgba = as_int(Of(pixels, i)(t.packed));
    const M flat = rgba < splat(0);  // by its opacity
    if ((bits(covered) & ~bits(flat)) != 0) {
      if (!sampled) sample_textures<Of>(f, s, t, room.functions, pixels, room.textures), sampled = true;
      F color[3];
      color_lanes<Of>(f, t, room.functions, pixels, i, room.textures, color);
      rgba = select(flat, rgba, packed_srgb(color));
    }
    if (bits(covered) != kAll) rgba = select(covered, rgba, background_at(f, s, tx, ty, i));
    store(out.rgba + i, rgba);
  }
}

void shade_tile(const Frame& f, const Shading& s, int32_t tx, int32_t ty, const TilePixels& pixels, int32_t throughout,
                ShadeRoom& room, PackedTile& out) {
  if (throughout == tile_shows_nothing) {
    for (int i = 0; i < kTilePixels; i += kLanes) store(out.rgba + i, background_at(f, s, tx, ty, i));
    return;
  }
  if (throughout >= 0) return shade_tile_by<OfOne>(f, s, tx, ty, pixels, room, out);
  if (room.triangles.count <= 16) return shade_tile_by<OfSeveral<16>>(f, s, tx, ty, pixels, room, out);
  if (room.triangles.count <= 32) return shade_tile_by<OfSeveral<32>>(f, s, tx, ty, pixels, room, out);
  shade_tile_by<OfSeveral<kSpanTriangles>>(f, s, tx, ty, pixels, room, out);
}

void shade_span(const Frame& f, const Shading& s, const Span& span, int32_t ty, ShadeRoom& room) {
  if (span.count > 0) set_up_span(f, s, span, ty, room.triangles, room.functions);
  for (int32_t i = 0; i < span.tiles; ++i) {
    const Int64 tile = (static_cast<Int64>(ty) * f.tiles_x + span.first + i) * kTilePixels;
    PackedTile rgba;
    shade_tile(f, s, span.first + i, ty, {f.z + tile, span.which[i], i}, span.throughout[i], room, rgba);
    put_tile(f, s, span.first + i, ty, rgba);
  }
}

/// Span by span; the triangles of a span are asked for two spans ahead, their corners one.
void shade_row(const Frame& f, const Shading& s, int32_t ty) {
  constexpr int32_t kAhead = 3;
  Span spans[kAhead];
  ShadeRoom& room = shade_room();
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
