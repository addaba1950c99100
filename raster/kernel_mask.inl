// Part of kernel.inl: surfaces that are not there everywhere. `mask` drops what is below the cut-off; `blend` drops a
// share of the pixels by an 8 x 8 ordered pattern (a screen door), so that one surface a pixel is enough and nothing is
// sorted. Reached only after a pixel has won its depth test, so that opaque triangles pay nothing.

constexpr float kLeastOpacity = 1.0F / 255;  ///< of a layer's pixel: less could not be seen

/// u / w and v / w over the picture, and how far apart neighbouring pixels lie in the texture.
struct MaskTriangle {
  const Surface* surface = nullptr;  ///< null: solid
  double u[3], v[3];                 ///< x, y, constant; sub-pixels from the axis
  float opacity = 1;                 ///< of vertices and material
  float texels_a_pixel = 0;          ///< perspective: at 1 m
  int32_t axis_x = 0, axis_y = 0;
  uint32_t door = 0;  ///< shifts the screen door's pattern, so that two panes do not hide the same pixels
  bool orthographic = false;
  bool screen_door = true;
};

/// Solves for the linear function of (x, y, w) that takes three values at three points; orthographic: w is 1.
PROMENADE_INLINE bool linear_over(const ViewPoint* p, const double (*values)[3], int count, double (*out)[3]) {
  const auto cross = [](const ViewPoint& a, const ViewPoint& b, double* c) {
    c[0] = double(a.y) * b.w - double(a.w) * b.y;
    c[1] = double(a.w) * b.x - double(a.x) * b.w;
    c[2] = double(a.x) * b.y - double(a.y) * b.x;
  };
  double n[3][3];
  cross(p[1], p[2], n[0]), cross(p[2], p[0], n[1]), cross(p[0], p[1], n[2]);
  const double det = p[0].x * n[0][0] + p[0].y * n[0][1] + p[0].w * n[0][2];
  if (det == 0) return false;
  const double inverse = 1.0 / det;
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k)
      out[i][k] = (values[i][0] * n[0][k] + values[i][1] * n[1][k] + values[i][2] * n[2][k]) * inverse;
  return true;
}

void set_up_mask(const Frame& f, const Item& item, uint32_t triangle, MaskTriangle& m) {
  m.surface = nullptr;
  if (item.vertices == nullptr) return;
  const uint32_t material = material_of(item, triangle);
  if (item.surfaces == nullptr || material >= item.surface_count) return;
  const Surface& surface = item.surfaces[material];
  if (surface.alpha == 0) return;
  m.opacity = surface.color[3];
  m.axis_x = f.axis_x, m.axis_y = f.axis_y, m.orthographic = f.orthographic, m.screen_door = f.screen_door;
  m.door = (item.first_id >> 8) * 5U + material * 3U;
  const uint32_t* vertex[3];
  for (uint64_t i = 0; i < 3; ++i) vertex[i] = vertex_of(item, 3 * static_cast<uint64_t>(triangle) + i);
  if (item.color_at != 0) {
    float sum = 0;
    for (int i = 0; i < 3; ++i) sum += static_cast<float>(vertex[i][item.color_at] >> 24);
    m.opacity *= sum / (3.0F * 255.0F);
  }
  m.surface = &surface;
  m.texels_a_pixel = 0;
  if (surface.texture == nullptr || surface.texture->opacity == nullptr || item.texcoord_at == 0) return;
  ViewPoint p[3];
  double uv[2][3], solved[2][3] = {};
  float at[3][3];
  for (int i = 0; i < 3; ++i) {
    position_of(item, vertex[i], at[i]);
    p[i] = view_point(item, at[i][0], at[i][1], at[i][2]);
    if (f.orthographic) p[i].w = 1.0F;
    for (int k = 0; k < 2; ++k) uv[k][i] = texcoord_of(item, vertex[i], k);
  }
  linear_over(p, uv, 2, solved);
  for (int k = 0; k < 3; ++k) m.u[k] = solved[0][k], m.v[k] = solved[1][k];
  float e1[3], e2[3], row = 0;
  for (int k = 0; k < 3; ++k)
    e1[k] = at[1][k] - at[0][k], e2[k] = at[2][k] - at[0][k], row += item.rows[0][k] * item.rows[0][k];
  const float cx = e1[1] * e2[2] - e1[2] * e2[1], cy = e1[2] * e2[0] - e1[0] * e2[2],
              cz = e1[0] * e2[1] - e1[1] * e2[0];
  const float area = __builtin_sqrtf((cx * cx + cy * cy) + cz * cz);
  const double uv_area = (uv[0][1] - uv[0][0]) * (uv[1][2] - uv[1][0]) - (uv[0][2] - uv[0][0]) * (uv[1][1] - uv[1][0]);
  const float texels = static_cast<float>(__builtin_fabs(uv_area)) * static_cast<float>(surface.texture->width) *
                       static_cast<float>(surface.texture->height);
  if (area > 0 && row > 0)
    m.texels_a_pixel = __builtin_sqrtf(texels / area) * static_cast<float>(kSubpixel) / __builtin_sqrtf(row);
}

/// A triangle's mask, made when the first of its pixels has won its depth test: most lie behind others.
struct LazyMask {
  const Item* item;
  uint32_t triangle = 0;
  bool made = false;
  MaskTriangle mask;
  explicit LazyMask(const Item& of) : item(&of) {}
  void begin(uint32_t next) { triangle = next, made = false; }
  PROMENADE_INLINE const MaskTriangle& ready(const Frame& f) {
    if (!made) set_up_mask(f, *item, triangle, mask), made = true;
    return mask;
  }
};

/// The two neighbouring texels' columns or rows at t (in units of the picture's size) and the share of the second.
PROMENADE_INLINE void neighbouring_texels(float t, uint8_t wrap, int32_t size, int32_t* texel, float& share) {
  t = max_of(-1e6F, min_of(1e6F, t));
  if (!(t == t)) t = 0;
  if (wrap == 2) {
    t = max_of(0.0F, min_of(1.0F, t));
  } else if (wrap == 1) {
    t = t * 0.5F, t = (t - __builtin_floorf(t)) * 2.0F;
    if (t > 1.0F) t = 2.0F - t;
  } else {
    t = t - __builtin_floorf(t);
  }
  const float x = t * static_cast<float>(size) - 0.5F, whole = __builtin_floorf(x);
  share = x - whole;
  texel[0] = static_cast<int32_t>(whole), texel[1] = texel[0] + 1;
  if (texel[0] < 0) texel[0] = wrap == 0 ? size - 1 : 0;
  if (texel[1] >= size) texel[1] = wrap == 0 ? 0 : size - 1;
  texel[0] = min_of(texel[0], size - 1);
}

/// Opacity at a point of the picture: bilinear, in the mip level whose texels are about as large as pixels.
PROMENADE_INLINE float opacity_at(const MaskTriangle& m, float x, float y, float z) {
  const Surface& s = *m.surface;
  if (m.texels_a_pixel <= 0) return m.opacity;
  const Texture& t = *s.texture;
  const float w = m.orthographic ? 1.0F : 1.0F / z;
  const float u = static_cast<float>((m.u[0] * x + m.u[1] * y) + m.u[2]) * w;
  const float v = static_cast<float>((m.v[0] * x + m.v[1] * y) + m.v[2]) * w;
  const float footprint = max_of(1.0F, min_of(65536.0F, m.texels_a_pixel * w));
  uint32_t level = static_cast<uint32_t>(31 - __builtin_clz(static_cast<uint32_t>(footprint)));
  if (level >= t.levels) level = t.levels - 1;
  const int32_t width = max_of(1, static_cast<int32_t>(t.width >> level)),
                height = max_of(1, static_cast<int32_t>(t.height >> level));
  int32_t tx[2], ty[2];
  float sx = 0, sy = 0;
  neighbouring_texels(u, s.wrap_u, width, tx, sx);
  neighbouring_texels(v, s.wrap_v, height, ty, sy);
  const uint8_t* texels = t.opacity + t.level_offset[level];
  const auto at = [&](int i, int j) {
    return static_cast<float>(texels[static_cast<Int64>(ty[j]) * (width + 1) + tx[i]]);
  };
  const float top = at(0, 0) + (at(1, 0) - at(0, 0)) * sx, bottom = at(0, 1) + (at(1, 1) - at(0, 1)) * sx;
  return m.opacity * (top + (bottom - top) * sy) / 255.0F;
}

/// Threshold of the screen door at a pixel, (0, 1): bits of x ^ y and y interleaved, the ordered dither of Bayer.
PROMENADE_INLINE constexpr float door_threshold(uint32_t px, uint32_t py) {
  const uint32_t a = px ^ py;
  const uint32_t rank =
      (a & 1U) << 5 | (py & 1U) << 4 | (a & 2U) << 2 | (py & 2U) << 1 | (a & 4U) >> 1 | (py & 4U) >> 2;
  return (static_cast<float>(rank) + 0.5F) / 64.0F;
}

/// The same for the pixels of a tile, in their order.
struct DoorTile {
  float threshold[kTilePixels];
};
constexpr DoorTile door_tile() {
  DoorTile d = {};
  for (uint32_t i = 0; i < kTilePixels; ++i)
    d.threshold[i] = door_threshold((i >> 4 & 1U) * 4U + (i & 3U), (i >> 5) * 4U + (i >> 2 & 3U));
  return d;
}
constexpr DoorTile kDoor = door_tile();

/// Those lanes that a fade leaves, and that lie behind the layer before. at: their place in the planes.
PROMENADE_INLINE M shown_lanes(const Frame& f, const Item& item, Int64 at, F z, I id) {
  M shown = mask_of((1U << kLanes) - 1U);
  if (item.fading) {
    const F threshold = load(kDoor.threshold + (at & (kTilePixels - 1)));
    shown = (threshold >= splat(item.fade_from)) & (threshold < splat(item.fade_to));
  }
  if (f.before_z == nullptr) return shown;
  const F before = load(f.before_z + at);
  const I before_id = load(reinterpret_cast<const int32_t*>(f.before_id) + at);
  shown = shown & less_unsigned(before_id, splat(static_cast<int32_t>(kNoSurface)));  // behind nothing: no depth
  return shown & ((z < before) | ((z <= before) & less_unsigned(before_id, id)));
}

/// The two neighbouring texels' columns or rows of kLanes points: the first one's number and the share of the second.
PROMENADE_INLINE I first_texel(F t, uint8_t wrap, I size, F& share) {
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
  const F x = t * to_float(size) - splat(0.5F), whole = floor(x);
  share = x - whole;
  return truncate(whole);
}

/// Opacity at those of kLanes points of the picture that `lanes` names; as opacity_at, many at a time.
PROMENADE_INLINE F opacity_lanes(const MaskTriangle& m, uint32_t lanes, F x, F y, F z) {
  if (m.texels_a_pixel <= 0) return splat(m.opacity);
  const Surface& s = *m.surface;
  const Texture& t = *s.texture;
  float xs[kLanes], ys[kLanes];
  store(xs, x), store(ys, y);
  // From the first pixel of the block of 4 x 4, whatever the number of lanes: single precision tells how far.
  const int32_t row = (static_cast<int32_t>(ys[0]) + m.axis_y) >> 8 & ~3;
  const float x0 = xs[0], y0 = static_cast<float>(row * kSubpixel + kSubpixel / 2 - m.axis_y);
  const F dx = x - splat(x0), dy = y - splat(y0), one = splat(1.0F);
  const F w = m.orthographic ? one : one / max(z, splat(1e-30F));
  const auto over = [&](const double* v) {
    const float at = static_cast<float>((v[0] * x0 + v[1] * y0) + v[2]);
    return (splat(at) + (splat(static_cast<float>(v[0])) * dx + splat(static_cast<float>(v[1])) * dy)) * w;
  };
  const F u = over(m.u), v = over(m.v);
  const F footprint = max(one, min(splat(65536.0F), splat(m.texels_a_pixel) * w));
  const I level = min(shift_right<23>(as_int(footprint)) - splat(127), splat(static_cast<int32_t>(t.levels) - 1));
  const I width = max(shift_right_by(splat(static_cast<int32_t>(t.width)), level), splat(1)),
          height = max(shift_right_by(splat(static_cast<int32_t>(t.height)), level), splat(1));
  const I none = splat(0), last_x = width - splat(1), last_y = height - splat(1);
  F sx, sy;
  I left = first_texel(u, s.wrap_u, width, sx), top = first_texel(v, s.wrap_v, height, sy);
  I bottom = top + splat(1);
  if (s.wrap_u == 0)
    left = select(left < none, last_x, left);  // the row's last texel is its first again
  else
    sx = select((left < none) | (left > last_x - splat(1)), splat(0.0F), sx);
  if (s.wrap_v == 0) top = select(top < none, last_y, top), bottom = select(bottom > last_y, none, bottom);
  left = max(min(left, last_x), none);
  const I first = Table16(t.level_offset)[level] + left, stride = width + splat(1);
  int32_t at[2][kLanes], pairs[2][kLanes] = {};
  store(at[0], first + max(min(top, last_y), none) * stride);
  store(at[1], first + max(min(bottom, last_y), none) * stride);
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    for (int k = 0; k < 2; ++k) {
      const uint8_t* pair = t.opacity + at[k][i];
      pairs[k][i] = pair[0] | pair[1] << 8;
    }
  }
  const I low = splat(255), above = load(pairs[0]), below = load(pairs[1]);
  const F texels[4] = {to_float(above & low), to_float(shift_right<8>(above)), to_float(below & low),
                       to_float(shift_right<8>(below))};
  const F upper = texels[0] + (texels[1] - texels[0]) * sx;
  const F lower = texels[2] + (texels[3] - texels[2]) * sx;
  return splat(m.opacity) * (upper + (lower - upper) * sy) * splat(1.0F / 255);
}

/// Those of the lanes at which the surface is there.
PROMENADE_INLINE uint32_t solid_lanes(const MaskTriangle& m, uint32_t lanes, F x, F y, F z) {
  if (m.surface == nullptr || lanes == 0) return lanes;
  const F opacity = opacity_lanes(m, lanes, x, y, z);
  if (m.surface->alpha == 1) return lanes & bits(opacity >= splat(m.surface->alpha_cutoff));
  if (!m.screen_door) return lanes & bits(opacity >= splat(kLeastOpacity));
  float xs[kLanes], ys[kLanes], thresholds[kLanes];
  store(xs, x), store(ys, y);
  for (int i = 0; i < kLanes; ++i) {
    const uint32_t px = static_cast<uint32_t>(static_cast<int32_t>(xs[i]) + m.axis_x) >> 8;
    const uint32_t py = static_cast<uint32_t>(static_cast<int32_t>(ys[i]) + m.axis_y) >> 8;
    thresholds[i] = door_threshold(px + m.door, py + (m.door >> 3));
  }
  return lanes & bits(opacity > load(thresholds));
}
