// Part of kernel.inl: colours, after the visibility is known, so that each pixel is shaded once. A tile's distinct
// triangles are set up kLanes at a time (light at their corners, and every attribute divided by w as a linear function
// over the picture); then its pixels are coloured kLanes at a time from those functions and the depth that they have.

/// The distinct triangles of a tile, corner by corner, in model space.
struct TileTriangles {
  uint32_t id[kTilePixels];
  int32_t count;
  alignas(64) float p[3][3][kTilePixels];  ///< corner, axis
  alignas(64) float normal[3][3][kTilePixels];
  alignas(64) float color[3][3][kTilePixels];  ///< linear, the material's included
  alignas(64) float uv[3][2][kTilePixels];
  alignas(64) int32_t smooth[kTilePixels];  ///< 1: has normals
  alignas(64) float texture[kTilePixels];   ///< which of `surfaces`; -1: none
  const Surface* surfaces[kTilePixels];     ///< the distinct textured ones
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

/// Value at the tile's first pixel and change a pixel of each attribute times 1/w (orthographic: times 1).
struct TileFunctions {
  alignas(64) float a[slot_count][kTilePixels];
};

/// Which distinct triangle each pixel of a tile shows; -1: none.
void find_distinct(const Frame& f, const float* z, const uint32_t* id, TileTriangles& t, int32_t* which) {
  t.count = 0;
  const int32_t* ids = reinterpret_cast<const int32_t*>(id);
  const I first = splat(ids[0]);
  M same = mask_of((1U << kLanes) - 1U);
  for (int i = 0; i < kTilePixels; i += kLanes)
    same = same & equal(load(ids + i), first) & (load(z + i) > splat(f.clear_z));
  if (id[0] != kNoSurface && bits(same) == (1U << kLanes) - 1U) {
    for (int i = 0; i < kTilePixels; i += kLanes) store(which + i, splat(0));
    t.id[t.count++] = id[0];
    return;
  }
  constexpr uint32_t kSlots = 128;
  uint8_t table[kSlots];
  bool table_ready = false;
  uint32_t last_id = kNoSurface;
  int32_t last = -1;
  for (int i = 0; i < kTilePixels; ++i) {
    if (z[i] == f.clear_z || id[i] == kNoSurface) {
      which[i] = -1;
      continue;
    }
    if (id[i] != last_id || last < 0) {
      if (!table_ready) {
        __builtin_memset(table, 255, kSlots);
        table_ready = true;
      }
      uint32_t slot = (id[i] * 0x9e3779b1U) >> 25;
      while (table[slot] != 255 && t.id[table[slot]] != id[i]) slot = (slot + 1) & (kSlots - 1);
      if (table[slot] == 255) table[slot] = static_cast<uint8_t>(t.count), t.id[t.count++] = id[i];
      last = table[slot], last_id = id[i];
    }
    which[i] = last;
  }
}

PROMENADE_INLINE void to_model(const Item& item, float* p) {
  const float x = p[0], y = p[1], z = p[2];
  for (int i = 0; i < 3; ++i)
    p[i] =
        (item.model_rows[i][0] * x + item.model_rows[i][1] * y) + (item.model_rows[i][2] * z + item.model_rows[i][3]);
}

/// Ask for what fetch_triangle will read of all triangles at once, because they lie anywhere in memory: first for their
/// corners' numbers, then for what these name.
void ask_for_triangles(const Shading& s, const TileTriangles& t) {
  for (int32_t k = 0; k < t.count; ++k) {
    const Item& item = s.items[s.item_of_run[t.id[k] >> s.run_bits]];
    if (item.indices == nullptr) continue;
    const uint64_t triangle = t.id[k] - item.first_id;
    __builtin_prefetch(item.indices + 3 * triangle);
    if (item.materials != nullptr) __builtin_prefetch(item.materials + triangle);
  }
}
void ask_for_corners(const Shading& s, const TileTriangles& t) {
  for (int32_t k = 0; k < t.count; ++k) {
    const Item& item = s.items[s.item_of_run[t.id[k] >> s.run_bits]];
    if (item.indices == nullptr) continue;
    const uint32_t* index = item.indices + 3 * static_cast<uint64_t>(t.id[k] - item.first_id);
    for (int i = 0; i < 3; ++i) __builtin_prefetch(item.positions + 3 * static_cast<uint64_t>(index[i]));
    if (item.texcoords != nullptr) __builtin_prefetch(item.texcoords + 2 * static_cast<uint64_t>(index[0]));
    if (item.normals != nullptr) __builtin_prefetch(item.normals + 3 * static_cast<uint64_t>(index[0]));
  }
}

float number_of_surface(TileTriangles& t, const Surface* surface) {
  for (int32_t i = 0; i < t.surface_count; ++i)
    if (t.surfaces[i] == surface) return static_cast<float>(i);
  t.surfaces[t.surface_count] = surface;
  return static_cast<float>(t.surface_count++);
}

/// Brings one triangle's corners into the tile's arrays.
void fetch_triangle(const Shading& s, TileTriangles& t, int32_t k) {
  const Item& item = s.items[s.item_of_run[t.id[k] >> s.run_bits]];
  const uint64_t triangle = t.id[k] - item.first_id;
  t.texture[k] = -1, t.smooth[k] = 0;
  bool textured = false;
  float base[3] = {1, 1, 1};
  const bool bare = item.indices == nullptr;
  t.varying |= item.normals != nullptr || item.colors != nullptr;
  const uint32_t material = bare || item.materials == nullptr ? 0 : item.materials[triangle];
  if (item.surfaces != nullptr && material < item.surface_count) {
    const Surface& surface = item.surfaces[material];
    for (int c = 0; c < 3; ++c) base[c] = surface.color[c];
    textured = s.has_textures && surface.texture != nullptr && item.texcoords != nullptr;
    if (textured) t.texture[k] = number_of_surface(t, &surface);
  }
  for (int v = 0; v < 3; ++v) {
    const uint64_t at = bare ? 0 : item.indices[3 * triangle + static_cast<uint64_t>(v)];
    float p[3] = {0, 0, 0};
    if (!bare) p[0] = item.positions[3 * at], p[1] = item.positions[3 * at + 1], p[2] = item.positions[3 * at + 2];
    if (item.placed) to_model(item, p);
    for (int c = 0; c < 3; ++c) t.p[v][c][k] = p[c], t.color[v][c][k] = base[c];
    t.uv[v][0][k] = 0, t.uv[v][1][k] = 0;
    if (textured) t.uv[v][0][k] = item.texcoords[2 * at], t.uv[v][1][k] = item.texcoords[2 * at + 1];
    if (!bare && item.colors != nullptr)
      for (int c = 0; c < 3; ++c) t.color[v][c][k] *= s.linear_of_srgb[item.colors[at] >> (8 * c) & 255U];
    if (bare || item.normals == nullptr) continue;
    const float* n = item.normals + 3 * at;
    if (n[0] != 0 || n[1] != 0 || n[2] != 0) t.smooth[k] = 1;
    for (int c = 0; c < 3; ++c)
      t.normal[v][c][k] =
          item.placed ? (item.normal_rows[c][0] * n[0] + item.normal_rows[c][1] * n[1]) + item.normal_rows[c][2] * n[2]
                      : n[c];
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
PROMENADE_INLINE void light_corners(const Shading& s, TileTriangles& t, int32_t first) {
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
  for (int v = 0; v < 3; ++v) {
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
void set_up_far_reaching(const Frame& f, const Shading& s, const TileTriangles& t, int32_t k, float x, float y,
                         TileFunctions& out) {
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

/// Functions over the picture of kLanes triangles from `first` on; x, y: centre of the tile's first pixel, sub-pixels
/// from the axis.
PROMENADE_INLINE void set_up_lanes(const Frame& f, const Shading& s, const TileTriangles& t, int32_t first, float x,
                                   float y, TileFunctions& out) {
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
  const auto corner = [&](const float(*v)[kTilePixels], int axis) { return load(v[axis] + first); };
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

// --- Textures
// ----------------------------------------------------------------------------------------------------------

/// A texture coordinate in texels from the first one's centre, wrapped; >= -0.5.
PROMENADE_INLINE F wrapped(F t, uint8_t wrap, I size) {
  const F zero = splat(0.0F), one = splat(1.0F);
  t = max(min(t, splat(1e6F)), splat(-1e6F));
  if (wrap == 2) {
    t = max(min(t, one), zero);
  } else if (wrap == 1) {
    t = t * splat(0.5F), t = (t - floor(t)) * splat(2.0F);
    t = min(t, splat(2.0F) - t);
  } else {
    t = t - floor(t);
  }
  return t * to_float(size) - splat(0.5F);
}

/// A bilinear sample of one mip level, linear.
PROMENADE_INLINE void sample_level(const Surface& surface, F u, F v, I level, M active, F* out) {
  const Texture& t = *surface.texture;
  const I zero = splat(0), width = max(shift_right_by(splat(static_cast<int32_t>(t.width)), level), splat(1));
  const I height = max(shift_right_by(splat(static_cast<int32_t>(t.height)), level), splat(1));
  const I offset = Table16(t.level_offset)[level];
  const F fu = wrapped(u, surface.wrap_u, width), fv = wrapped(v, surface.wrap_v, height);
  const F whole_u = floor(fu), whole_v = floor(fv), sy = fv - whole_v;
  F sx = fu - whole_u;
  const I last_x = width - splat(1), last_y = height - splat(1);
  I x = truncate(whole_u), y[2] = {truncate(whole_v), truncate(whole_v) + splat(1)};
  if (surface.wrap_u == 0)
    x = select(x < zero, last_x, x);  // the row's last texel is its first again
  else
    sx = select((x < zero) | (x > last_x - splat(1)), splat(0.0F), sx);
  if (surface.wrap_v == 0) y[0] = select(y[0] < zero, last_y, y[0]), y[1] = select(y[1] > last_y, zero, y[1]);
  x = max(min(x, last_x), zero);
  for (int c = 0; c < 3; ++c) out[c] = splat(0.0F);
  const I low = splat(1023);
  for (int j = 0; j < 2; ++j) {
    const I row = offset + max(min(y[j], last_y), zero) * (width + splat(1));
    I texel[2];
    gather_pairs(t.texels, select(active, row + x, zero), texel[0], texel[1]);
    const F down = j == 0 ? splat(1.0F) - sy : sy;
    for (int i = 0; i < 2; ++i) {
      const F weight = (i == 0 ? splat(1.0F) - sx : sx) * down;
      const F r = to_float(texel[i] & low), g = to_float(shift_right<10>(texel[i]) & low),
              b = to_float(shift_right<20>(texel[i]));
      out[0] = out[0] + weight * (r * r), out[1] = out[1] + weight * (g * g), out[2] = out[2] + weight * (b * b);
    }
  }
  for (int c = 0; c < 3; ++c) out[c] = out[c] * splat(1.0F / (1023.0F * 1023.0F));
}

/// Logarithm to the base 2 of a positive number, to 0.01: enough to choose mip levels by.
PROMENADE_INLINE F rough_log2(F a) {
  const I raw = as_int(a);
  const F exponent = to_float(shift_right<23>(raw) - splat(127));
  const F m = as_float((raw & splat(0x7fffff)) | splat(0x3f800000)) - splat(1.0F);
  return exponent + m * (splat(1.3465F) - m * splat(0.3465F));
}

/// Trilinear at one place of each lane's footprint. Levels are blended in the middle half between them only: nobody
/// sees it, and often one level is enough.
PROMENADE_INLINE void sample_mips(const Surface& surface, F u, F v, F lod, M active, F* out) {
  const F zero = splat(0.0F), one = splat(1.0F);
  const F whole = floor(lod + splat(0.25F));  // from there on the level is the next one
  const F share = max(min((lod - whole) * splat(2.0F) - splat(0.5F), one), zero);
  const I level = truncate(whole);
  sample_level(surface, u, v, level, active, out);
  const M between = active & (share > zero);
  if (bits(between) == 0) return;
  F coarse[3];
  const I next = min(level + splat(1), splat(static_cast<int32_t>(surface.texture->levels - 1)));
  sample_level(surface, u, v, next, between, coarse);
  for (int c = 0; c < 3; ++c) out[c] = out[c] + share * (coarse[c] - out[c]);
}

/// Trilinear; where the footprint is long, several samples along it. du..: change of u and v a pixel.
PROMENADE_INLINE void sample_texture(const Surface& surface, F u, F v, F dux, F duy, F dvx, F dvy, float anisotropy,
                                     M active, F* out) {
  const Texture& t = *surface.texture;
  const F width = splat(static_cast<float>(t.width)), height = splat(static_cast<float>(t.height));
  const F ax = dux * width, ay = dvx * height, bx = duy * width, by = dvy * height;
  const F a = min(ax * ax + ay * ay, splat(1e30F)), b = min(bx * bx + by * by, splat(1e30F));
  const F top = splat(static_cast<float>(t.levels - 1)), zero = splat(0.0F), one = splat(1.0F);
  const F longest = max(max(a, b), splat(1e-30F)), shortest = max(min(a, b), splat(1.0F));  // no finer than a texel
  const F wanted = floor(sqrt(max(longest / shortest, one)) + splat(0.5F));
  const F count = min(wanted, splat(anisotropy));
  const F lod = max(min(rough_log2(longest / (count * count)) * splat(0.5F), top), zero);
  if (bits(active & (count > one)) == 0) return sample_mips(surface, u, v, lod, active, out);
  const F along_u = select(a >= b, dux, duy), along_v = select(a >= b, dvx, dvy), share = one / count;
  for (int c = 0; c < 3; ++c) out[c] = zero;
  for (float i = 0;; i += 1.0F) {
    const M taken = active & (count > splat(i));
    if (bits(taken) == 0) return;
    const F offset = (splat(i) + splat(0.5F)) * share - splat(0.5F);
    F sample[3];
    sample_mips(surface, u + along_u * offset, v + along_v * offset, lod, taken, sample);
    for (int c = 0; c < 3; ++c) out[c] = out[c] + select(taken, sample[c] * share, zero);
  }
}

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

/// Multiplies the colours of the covered lanes by their textures.
PROMENADE_INLINE void apply_textures(const Frame& f, const TileTriangles& t, const TileFunctions& fn, I which,
                                     M covered, F dx, F dy, F w, float anisotropy, F* color) {
  const auto slot = [&](int k) { return Table64(fn.a[k])[which]; };
  const F ux = slot(slot_ux), uy = slot(slot_uy), vx = slot(slot_vx), vy = slot(slot_vy);
  const F u = (slot(slot_u) + (ux * dx + uy * dy)) * w, v = (slot(slot_v) + (vx * dx + vy * dy)) * w;
  F zx = splat(0.0F), zy = zx;
  if (!f.orthographic) zx = slot(slot_zx), zy = slot(slot_zy);
  const F dux = (ux - u * zx) * w, duy = (uy - u * zy) * w, dvx = (vx - v * zx) * w, dvy = (vy - v * zy) * w;
  const F texture = Table64(t.texture)[which];
  for (int32_t i = 0; i < t.surface_count; ++i) {
    const F number = splat(static_cast<float>(i));
    const M active = covered & (texture >= number) & (texture <= number);
    if (bits(active) == 0) continue;
    F texel[3];
    sample_texture(*t.surfaces[i], u, v, dux, duy, dvx, dvy, anisotropy, active, texel);
    for (int c = 0; c < 3; ++c) color[c] = select(active, color[c] * texel[c], color[c]);
  }
}

/// The centre of a tile's first pixel, in sub-pixels from the axis.
PROMENADE_INLINE float first_center(int32_t tile, int32_t axis) {
  return static_cast<float>(tile * kTile * kSubpixel + kSubpixel / 2 - axis);
}

/// Brings the triangles of a tile, which find_distinct has found, and their attributes as functions over it, into
/// place.
void set_up_tile(const Frame& f, const Shading& s, int32_t tx, int32_t ty, TileTriangles& t, TileFunctions& fn) {
  t.surface_count = 0, t.varying = false;
  for (int32_t k = 0; k < t.count; ++k) fetch_triangle(s, t, k);
  for (int32_t k = 0; k < t.count; k += kLanes) {
    light_corners(s, t, k);
    set_up_lanes(f, s, t, k, first_center(tx, f.axis_x), first_center(ty, f.axis_y), fn);
  }
}

/// Pixels of a tile, kLanes from `first` on: how far they lie from its first pixel.
struct LanePlace {
  F dx, dy;
  explicit LanePlace(int first)
      : dx(load(kOffsets.x) + splat(static_cast<float>((first / 16 & 1) * 4))),
        dy(load(kOffsets.y) + splat(static_cast<float>((first / 32) * 4 + first % 16 / 4))) {}
};

/// Linear colours of the covered lanes. z: their depths.
PROMENADE_INLINE void color_lanes(const Frame& f, const Shading& s, const TileTriangles& t, const TileFunctions& fn,
                                  I shown, M covered, F z, const LanePlace& at, F* color) {
  const I seen = max(shown, splat(0));
  const F w = f.orthographic ? splat(1.0F) : splat(1.0F) / select(covered, z, splat(1.0F));
  const auto slot = [&](int k) { return Table64(fn.a[k])[seen]; };
  for (int c = 0; c < 3; ++c) {
    color[c] = slot(slot_r + 3 * c);
    if (t.varying) color[c] = (color[c] + (slot(slot_rx + 3 * c) * at.dx + slot(slot_ry + 3 * c) * at.dy)) * w;
  }
  if (t.surface_count > 0) apply_textures(f, t, fn, seen, covered, at.dx, at.dy, w, s.anisotropy, color);
}

/// A tile on its way to its colours.
struct ShadedTile {
  TileTriangles triangles;
  alignas(64) int32_t which[kTilePixels];
};

void shade_tile(const Frame& f, const Shading& s, int32_t tx, int32_t ty, ShadedTile& shaded, TileFunctions& fn) {
  const Int64 tile = (static_cast<Int64>(ty) * f.tiles_x + tx) * kTilePixels;
  TileTriangles& t = shaded.triangles;
  set_up_tile(f, s, tx, ty, t, fn);
  const F x = splat(first_center(tx, f.axis_x)), y = splat(first_center(ty, f.axis_y)),
          pixel = splat(static_cast<float>(kSubpixel));
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const LanePlace at(i);
    const I shown = load(shaded.which + i);
    const M covered = shown > splat(-1);
    const uint32_t lanes = bits(covered);
    I out = splat(static_cast<int32_t>(s.plain));
    if (s.has_sky && lanes != (1U << kLanes) - 1U) out = sky_at(s, x + at.dx * pixel, y + at.dy * pixel);
    if (lanes != 0) {
      F color[3];
      color_lanes(f, s, t, fn, shown, covered, load(f.z + tile + i), at, color);
      out = select(covered, packed_srgb(color), out);
    }
    int32_t rgba[kLanes];
    store(rgba, out);
    for (int r = 0; r < kLanes / 4; ++r) {
      const int32_t px = tx * kTile + (i / 16 & 1) * 4, py = ty * kTile + (i / 32) * 4 + i % 16 / 4 + r;
      if (py >= f.height || px >= f.width) continue;
      const int32_t count = min_of(4, f.width - px);
      __builtin_memcpy(s.out + static_cast<Int64>(py) * f.width + px, rgba + 4 * r, static_cast<uint64_t>(count) * 4);
    }
  }
}

/// Tile by tile; the triangles of a tile are asked for two tiles ahead, their corners one.
void shade_row(const Frame& f, const Shading& s, int32_t ty) {
  constexpr int32_t kAhead = 3;
  ShadedTile tiles[kAhead];
  TileFunctions fn;
  // Lanes beyond the last triangle are computed and never looked at; they must only be numbers.
  __builtin_memset(tiles, 0, sizeof tiles);
  for (int32_t tx = 0; tx < f.tiles_x + kAhead - 1; ++tx) {
    if (tx < f.tiles_x) {
      const Int64 tile = (static_cast<Int64>(ty) * f.tiles_x + tx) * kTilePixels;
      ShadedTile& next = tiles[tx % kAhead];
      find_distinct(f, f.z + tile, f.id + tile, next.triangles, next.which);
      ask_for_triangles(s, next.triangles);
    }
    if (tx >= 1 && tx <= f.tiles_x) ask_for_corners(s, tiles[(tx - 1) % kAhead].triangles);
    if (tx >= kAhead - 1) shade_tile(f, s, tx - (kAhead - 1), ty, tiles[(tx - (kAhead - 1)) % kAhead], fn);
  }
}
