// The rasteriser, written once on the names of simd_*.h and included by each kernel_*.cpp inside its own unnamed
// namespace. Nothing here calls an inline function of a library: the linker would keep one copy of it, perhaps the one
// built for a processor that this machine is not.
//
// Coordinates: vertices are rounded to 1/256 pixel; edge functions are integers, so that a pixel centre lies on one
// side of a shared edge for both triangles, and the top-left rule gives it to exactly one. Depth is a plane through the
// unrounded vertices: 1/w (perspective) or -w (orthographic), larger is nearer, held within the triangle's own range.
// A pixel keeps the nearest surface, among equals the smaller id: the picture does not depend on the order of drawing,
// and a triangle is skipped only where it would lose.

using Int64 = int64_t;

constexpr int32_t kSmallExtent = 64 * kSubpixel;  // edge functions of smaller triangles fit 32 bits, in floats exactly
constexpr int32_t kPixelReach = kSubpixel / 2 + 2;  // half a pixel, and what rounding may move an edge
constexpr float kFloatMax = 3.402823466e38F;

constexpr bool is_outer(Coverage c) { return c == Coverage::outer || c == Coverage::probe; }

PROMENADE_INLINE int32_t min_of(int32_t a, int32_t b) { return a < b ? a : b; }
PROMENADE_INLINE int32_t max_of(int32_t a, int32_t b) { return a > b ? a : b; }
PROMENADE_INLINE float min_of(float a, float b) { return a < b ? a : b; }
PROMENADE_INLINE float max_of(float a, float b) { return a > b ? a : b; }
PROMENADE_INLINE float abs_of(float a) { return __builtin_fabsf(a); }

/// As round_to_int of simd_*.h: to the nearest, ties to even; |a| <= 2^22.
PROMENADE_INLINE int32_t rounded(float a) {
  const float shifted = a + 12582912.0F;  // 1.5 * 2^23: the sum's last bit is worth 1
  int32_t whole = 0;
  __builtin_memcpy(&whole, &shifted, sizeof whole);
  return whole - 0x4b400000;
}

/// Sub-pixels to pixels, rounded down; any float.
PROMENADE_INLINE int32_t pixel_of(float subpixels, int32_t axis) {
  const float limit = 4194304.0F;  // far outside every picture
  return (static_cast<int32_t>(max_of(-limit, min_of(limit, subpixels))) + axis) >> 8;
}

PROMENADE_INLINE bool any_of(const Numbers& numbers) { return numbers.narrow != nullptr || numbers.wide != nullptr; }
PROMENADE_INLINE uint32_t number_at(const Numbers& numbers, uint64_t i) {
  return numbers.narrow != nullptr ? numbers.narrow[i] : numbers.wide[i];
}
/// kLanes of them.
PROMENADE_INLINE I numbers_at(const Numbers& numbers, uint64_t i) {
  return numbers.narrow != nullptr ? load(numbers.narrow + i)
                                   : load(reinterpret_cast<const int32_t*>(numbers.wide) + i);
}

PROMENADE_INLINE uint32_t material_of(const Item& item, uint64_t triangle) {
  return any_of(item.materials) ? number_at(item.materials, triangle) : 0;
}
PROMENADE_INLINE const uint32_t* vertex_of(const Item& item, uint64_t corner) {
  return item.vertices + static_cast<uint64_t>(number_at(item.indices, corner)) * item.vertex_words;
}
PROMENADE_INLINE void position_of(const Item& item, const uint32_t* vertex, float* p) {
  p[0] = item.x[*vertex], p[1] = item.y[*vertex], p[2] = item.z[*vertex];
}
/// One of two floats.
PROMENADE_INLINE float texcoord_of(const Item& item, const uint32_t* vertex, int axis) {
  float out = 0;
  __builtin_memcpy(&out, vertex + item.texcoord_at + axis, sizeof out);
  return out;
}
/// Not unit; 0: the triangle's own.
PROMENADE_INLINE void normal_of(const Item& item, const uint32_t* vertex, float* n) {
  const uint32_t packed = vertex[item.normal_at];
  n[0] = n[1] = n[2] = 0;
  if (packed == kNoNormal) return;
  const float x = static_cast<float>(static_cast<int16_t>(packed & 0xffffU)),
              y = static_cast<float>(static_cast<int16_t>(packed >> 16));
  n[2] = static_cast<float>(kNormalScale) - abs_of(x) - abs_of(y);
  const float folded = n[2] < 0 ? n[2] : 0.0F;
  n[0] = x >= 0 ? x + folded : x - folded;
  n[1] = y >= 0 ? y + folded : y - folded;
}

struct ViewPoint {
  float x, y, w;
};

PROMENADE_INLINE ViewPoint rotated(const Item& item, const float* d) {
  ViewPoint p;
  p.x = (item.rows[0][0] * d[0] + item.rows[0][1] * d[1]) + item.rows[0][2] * d[2];
  p.y = (item.rows[1][0] * d[0] + item.rows[1][1] * d[1]) + item.rows[1][2] * d[2];
  p.w = (item.rows[2][0] * d[0] + item.rows[2][1] * d[1]) + item.rows[2][2] * d[2];
  return p;
}

PROMENADE_INLINE ViewPoint view_point(const Item& item, float x, float y, float z) {
  const float d[3] = {(x - item.eye_hi[0]) - item.eye_lo[0], (y - item.eye_hi[1]) - item.eye_lo[1],
                      (z - item.eye_hi[2]) - item.eye_lo[2]};
  return rotated(item, d);
}

struct ExactPoint {
  double x, y, w;
};

/// In double: a corner far away or far behind moves what is left of a triangle by as much as single precision loses.
PROMENADE_INLINE ExactPoint exact_point(const Item& item, float x, float y, float z) {
  const double d[3] = {x - item.exact_eye[0], y - item.exact_eye[1], z - item.exact_eye[2]};
  double p[3];
  for (int i = 0; i < 3; ++i)
    p[i] = (item.exact_rows[i][0] * d[0] + item.exact_rows[i][1] * d[1]) + item.exact_rows[i][2] * d[2];
  return {p[0], p[1], p[2]};
}

// --- Boxes against the picture -------------------------------------------------------------------------------------

/// The picture of a box that does not reach behind the near plane.
void bound_in_front(const Frame& f, const float* xs, const float* ys, const float* ws, BoxPicture& out) {
  float x0 = kFloatMax, y0 = kFloatMax, x1 = -kFloatMax, y1 = -kFloatMax;
  for (int k = 0; k < 8; ++k) {
    const float scale = f.orthographic ? 1.0F : 1.0F / ws[k];
    x0 = min_of(x0, xs[k] * scale), x1 = max_of(x1, xs[k] * scale);
    y0 = min_of(y0, ys[k] * scale), y1 = max_of(y1, ys[k] * scale);
  }
  out.needs_clip = x0 < -f.guard_x || x1 > f.guard_x || y0 < -f.guard_y || y1 > f.guard_y;
  out.x0 = pixel_of(x0, f.axis_x) - 1, out.x1 = pixel_of(x1, f.axis_x) + 1;
  out.y0 = pixel_of(y0, f.axis_y) - 1, out.y1 = pixel_of(y1, f.axis_y) + 1;
  out.culled = out.x1 < 0 || out.y1 < 0 || out.x0 >= f.width || out.y0 >= f.height;
}

/// Whether all eight corners lie outside one side of the view pyramid; for a box that reaches behind the near plane.
bool beside_pyramid(const Frame& f, const float* xs, const float* ys, const float* ws) {
  const float reach_x = static_cast<float>(f.axis_x + 2 * kSubpixel),
              reach_y = static_cast<float>(f.axis_y + 2 * kSubpixel);
  int left = 0, right = 0, above = 0, below = 0;
  for (int k = 0; k < 8; ++k) {
    const float q = f.orthographic ? 1.0F : ws[k];
    left += xs[k] < -reach_x * q;
    right += xs[k] > reach_x * q;
    above += ys[k] < -reach_y * q;
    below += ys[k] > reach_y * q;
  }
  return left == 8 || right == 8 || above == 8 || below == 8;
}

BoxPicture project_box(const Frame& f, const Item& item, const float* center, const float* half) {
  float d[3], slack = 0;
  for (int i = 0; i < 3; ++i) {
    d[i] = (center[i] - item.eye_hi[i]) - item.eye_lo[i];
    slack += abs_of(item.rows[2][i]) * (abs_of(d[i]) + half[i]);
  }
  slack *= 1e-6F;  // a few roundings
  const ViewPoint c = rotated(item, d);
  float xs[8], ys[8], ws[8];
  float nearest = kFloatMax, farthest = -kFloatMax;
  for (int k = 0; k < 8; ++k) {
    const float hx = k & 1 ? half[0] : -half[0], hy = k & 2 ? half[1] : -half[1], hz = k & 4 ? half[2] : -half[2];
    xs[k] = c.x + ((item.rows[0][0] * hx + item.rows[0][1] * hy) + item.rows[0][2] * hz);
    ys[k] = c.y + ((item.rows[1][0] * hx + item.rows[1][1] * hy) + item.rows[1][2] * hz);
    ws[k] = c.w + ((item.rows[2][0] * hx + item.rows[2][1] * hy) + item.rows[2][2] * hz);
    nearest = min_of(nearest, ws[k]), farthest = max_of(farthest, ws[k]);
  }
  BoxPicture out = {};
  out.culled = farthest + slack < f.near_m;
  const float w = max_of(nearest - slack, f.near_m);
  out.nearest_z = f.orthographic ? -w : 1.00001F / w;
  if (out.culled) return out;
  if (nearest - slack >= f.near_m) {
    bound_in_front(f, xs, ys, ws, out);
    return out;
  }
  out.culled = beside_pyramid(f, xs, ys, ws);
  out.needs_clip = true;
  out.x0 = 0, out.y0 = 0, out.x1 = f.width - 1, out.y1 = f.height - 1;
  return out;
}

// --- Hierarchical depth --------------------------------------------------------------------------------------------

/// The farthest depth in a tile.
float farthest_of_tile(const float* z) {
  F m = load(z);
  for (int i = kLanes; i < kTilePixels; i += kLanes) m = min(m, load(z + i));
  float lanes[kLanes];
  store(lanes, m);
  float r = lanes[0];
  for (int i = 1; i < kLanes; ++i) r = min_of(r, lanes[i]);
  return r;
}

PROMENADE_INLINE float* tile_of(const Frame& f, float* plane, int32_t tx, int32_t ty) {
  return plane + (static_cast<Int64>(ty) * f.tiles_x + tx) * kTilePixels;
}

/// Whether something no nearer than `z` might win a pixel in the tiles that the pixels x0..x1, y0..y1 touch.
bool may_be_seen(const Frame& f, Region& r, const BoxPicture& box) {
  const int32_t tx0 = max_of(box.x0 >> 3, r.tx0), tx1 = min_of(box.x1 >> 3, r.tx1 - 1);
  const int32_t ty0 = max_of(box.y0 >> 3, r.ty0), ty1 = min_of(box.y1 >> 3, r.ty1 - 1);
  if (tx0 > tx1 || ty0 > ty1) return false;
  if (!f.cull_hidden) return true;
  const F z = splat(box.nearest_z);
  for (int32_t ty = ty0; ty <= ty1; ++ty) {
    const Int64 row = static_cast<Int64>(ty - r.ty0) * r.stride - r.tx0;
    for (int32_t tx = tx0; tx <= tx1; tx += kLanes) {
      uint32_t open = bits(load(r.hz + row + tx) <= z);
      if (tx1 - tx + 1 < kLanes) open &= (1U << (tx1 - tx + 1)) - 1U;
      for (; open != 0; open &= open - 1) {
        const int32_t t = tx + __builtin_ctz(open);
        if (!r.dirty[row + t]) return true;
        const float farthest = farthest_of_tile(tile_of(f, f.z, t, ty));
        if (!r.read_only) r.dirty[row + t] = 0, r.hz[row + t] = farthest;
        if (farthest <= box.nearest_z) return true;
      }
    }
  }
  return false;
}

// --- Surfaces with holes -------------------------------------------------------------------------------------------

#include "raster/kernel_mask.inl"

// --- Pixels --------------------------------------------------------------------------------------------------------

/// Depth over the picture: z + gx (x - x0) + gy (y - y0), within [z_min, z_max]; sub-pixels from the axis.
struct Plane {
  float x0, y0, z0, gx, gy, z_min, z_max;
};

template <Coverage C>
PROMENADE_INLINE F depth_at(const Plane& p, F x, F y) {
  F z = splat(p.gx) * (x - splat(p.x0)) + (splat(p.gy) * (y - splat(p.y0)) + splat(p.z0));
  if constexpr (C != Coverage::center) {
    const float reach = (abs_of(p.gx) + abs_of(p.gy)) * static_cast<float>(kPixelReach) + abs_of(p.z_max) * 1e-6F;
    z = is_outer(C) ? z + splat(reach) : z - splat(reach);
  }
  return min(max(z, splat(p.z_min)), splat(p.z_max));
}

/// Pixel offsets of the lanes inside a block of 4 x 4; part: which kLanes of the sixteen.
struct LaneOffsets {
  float x[16], y[16];
};
constexpr LaneOffsets kOffsets = {{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3},
                                  {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3}};
constexpr int kParts = 16 / kLanes;

/// Writes what is covered and wins. at: the lanes' place in the planes. True: something was written (probe: would be).
template <Coverage C, bool kMasked>
PROMENADE_INLINE bool write_lanes(const Frame& f, Int64 at, M inside, F z, uint32_t id, LazyMask* mask, F x, F y) {
  const F old = load(f.z + at);
  const M not_behind = inside & (z >= old);
  if (bits(not_behind) == 0) return false;
  if constexpr (C == Coverage::probe) return true;
  int32_t* ids = reinterpret_cast<int32_t*>(f.id + at);
  const I new_id = splat(static_cast<int32_t>(id));
  M wins = inside & (z > old);
  if (bits(wins) != bits(not_behind))  // some are as near as what is there: else nobody waits for the ids
    wins = not_behind & ((z > old) | less_unsigned(new_id, load(ids)));
  if constexpr (kMasked) {
    wins = wins & shown_lanes(f, *mask->item, at, z, new_id);
    if (bits(wins) == 0) return false;
    wins = mask_of(solid_lanes(mask->ready(f), bits(wins), x, y, z));
    if (bits(wins) == 0) return false;
  }
  store(f.z + at, select(wins, z, old));
  store_chosen(ids, wins, new_id);
  return true;
}

/// What a tile learns from its pixels.
template <Coverage C>
PROMENADE_INLINE void note(Region& r, Int64 local, bool written) {
  if constexpr (C == Coverage::probe)
    r.found |= written;
  else
    r.dirty[local] |= static_cast<uint8_t>(written);
}

/// The part of a pixel rectangle that an `outer` triangle may touch: its edges alone would let sharp corners run on.
struct PixelRect {
  int32_t x0, y0, x1, y1;
};
PROMENADE_INLINE M within(const PixelRect& rect, const Frame& f, F x, F y) {
  const auto low = [](int32_t px, int32_t axis) { return splat(static_cast<float>(px * kSubpixel - axis)); };
  return (x > low(rect.x0, f.axis_x)) & (x < low(rect.x1 + 1, f.axis_x)) & (y > low(rect.y0, f.axis_y)) &
         (y < low(rect.y1 + 1, f.axis_y));
}

// --- Small triangles: set up many at a time --------------------------------------------------------------------------

/// Set-up of kLanes triangles, each at most 64 pixels wide and high. e at the centre of the first pixel of the block of
/// 4 x 4 that holds (px0, py0), in whole pixels of the edge function (floor(e / 256)); all are integers below 2^24.
struct Batch {
  alignas(64) float e[3][kLanes], a[3][kLanes], b[3][kLanes];
  alignas(64) float x0[kLanes], y0[kLanes], z0[kLanes], gx[kLanes], gy[kLanes], z_min[kLanes], z_max[kLanes];
  alignas(64) int32_t px0[kLanes], py0[kLanes], px1[kLanes], py1[kLanes], id[kLanes];
};

template <Coverage C, bool kMasked>
PROMENADE_INLINE void draw_small(const Frame& f, Region& r, const Batch& s, int t, LazyMask* mask) {
  const F lane_x = load(kOffsets.x), lane_y = load(kOffsets.y);
  const Plane plane = {s.x0[t], s.y0[t], s.z0[t], s.gx[t], s.gy[t], s.z_min[t], s.z_max[t]};
  const PixelRect rect = {s.px0[t], s.py0[t], s.px1[t], s.py1[t]};
  const int32_t bx0 = rect.x0 >> 2, by0 = rect.y0 >> 2, bx1 = rect.x1 >> 2, by1 = rect.y1 >> 2;
  constexpr int32_t kPartRows = kLanes / 4;
  constexpr float kPixel = static_cast<float>(kSubpixel);
  // Edge functions and coordinates are whole numbers, so that sums over the blocks are exact.
  F row[3], right[3], down[3];
  for (int i = 0; i < 3; ++i) {
    const F a = splat(s.a[i][t]), b = splat(s.b[i][t]);
    row[i] = splat(s.e[i][t]) + (a * lane_x + b * lane_y);
    right[i] = a * splat(4.0F), down[i] = b * splat(static_cast<float>(kPartRows));
  }
  const F x_first = splat(static_cast<float>(bx0 * 4 * kSubpixel + kSubpixel / 2 - f.axis_x)) + lane_x * splat(kPixel);
  F y = splat(static_cast<float>(by0 * 4 * kSubpixel + kSubpixel / 2 - f.axis_y)) + lane_y * splat(kPixel);
  for (int32_t by = by0; by <= by1; ++by) {
    const Int64 row_local = static_cast<Int64>((by >> 1) - r.ty0) * r.stride - r.tx0;
    const Int64 row_at = static_cast<Int64>(by >> 1) * f.tiles_x * kTilePixels + (by & 1) * 32;
    F e[kParts][3], ys[kParts];
    for (int part = 0; part < kParts; ++part) {
      ys[part] = y, y = y + splat(kPixel * kPartRows);
      for (int i = 0; i < 3; ++i) e[part][i] = row[i], row[i] = row[i] + down[i];
    }
    F x = x_first;
    for (int32_t bx = bx0; bx <= bx1; ++bx) {
      const Int64 local = row_local + (bx >> 1);
      if (!(plane.z_max < r.hz[local])) {
        const Int64 at = row_at + (bx >> 1) * kTilePixels + (bx & 1) * 16;
        bool written = false;
        for (int part = 0; part < kParts; ++part) {
          M inside = min(min(e[part][0], e[part][1]), e[part][2]) >= splat(0.0F);
          if constexpr (is_outer(C)) inside = inside & within(rect, f, x, ys[part]);
          // Even where nothing is inside: one unforeseen branch less.
          const F z = depth_at<C>(plane, x, ys[part]);
          written |= write_lanes<C, kMasked>(f, at + part * kLanes, inside, z, static_cast<uint32_t>(s.id[t]), mask, x,
                                             ys[part]);
        }
        note<C>(r, local, written);
      }
      x = x + splat(4 * kPixel);
      for (int part = 0; part < kParts; ++part)
        for (int i = 0; i < 3; ++i) e[part][i] = e[part][i] + right[i];
    }
  }
}

// --- Large triangles: one at a time, tile by tile --------------------------------------------------------------------

struct Corner {
  float x, y, z;  ///< sub-pixels from the axis; depth
};

struct EdgeSetup {
  Int64 e[3];          ///< at the centre of the first pixel of the first tile, floor(e / 256)
  int32_t a[3], b[3];  ///< change a pixel
};

/// Edge functions of a triangle with positive area; px, py: the pixel that e belongs to.
template <Coverage C>
PROMENADE_INLINE void set_up_edges(const Int64* x, const Int64* y, int32_t px, int32_t py, EdgeSetup& s) {
  const Int64 cx = static_cast<Int64>(px) * kSubpixel + kSubpixel / 2,
              cy = static_cast<Int64>(py) * kSubpixel + kSubpixel / 2;
  for (int i = 0; i < 3; ++i) {
    const int j = i == 2 ? 0 : i + 1;
    const Int64 a = y[i] - y[j], b = x[j] - x[i];
    Int64 e = a * (cx - x[i]) + b * (cy - y[i]);
    const Int64 reach = ((a < 0 ? -a : a) + (b < 0 ? -b : b)) * kPixelReach;
    if (C == Coverage::center) e -= a > 0 || (a == 0 && b > 0) ? 0 : 1;  // top-left rule
    if (C == Coverage::inner) e -= reach;
    if (is_outer(C)) e += reach;
    s.e[i] = e >> 8, s.a[i] = static_cast<int32_t>(a), s.b[i] = static_cast<int32_t>(b);
  }
}

/// Draws the covered part of one tile. e: edge functions at its first pixel; edges whose bit is not set in `cut` hold
/// throughout.
template <Coverage C, bool kMasked>
void draw_tile(const Frame& f, int32_t tx, int32_t ty, const EdgeSetup& s, const int32_t* e, uint32_t cut,
               const Plane& plane, const PixelRect& rect, uint32_t id, LazyMask* mask, bool& written) {
  const Int64 tile = (static_cast<Int64>(ty) * f.tiles_x + tx) * kTilePixels;
  const F lane_x = load(kOffsets.x), lane_y = load(kOffsets.y), scale = splat(static_cast<float>(kSubpixel));
  const I ix = round_to_int(lane_x), iy = round_to_int(lane_y);
  const float x_first = static_cast<float>(tx * kTile * kSubpixel + kSubpixel / 2 - f.axis_x);
  const float y_first = static_cast<float>(ty * kTile * kSubpixel + kSubpixel / 2 - f.axis_y);
  for (int block = 0; block < 4; ++block) {
    const int32_t bx = (block & 1) * 4, by = (block >> 1) * 4;
    const F x = splat(x_first) + (lane_x + splat(static_cast<float>(bx))) * scale;
    for (int part = 0; part < kParts; ++part) {
      const int32_t row = by + part * (kLanes / 4);
      M inside = mask_of((1U << kLanes) - 1U);
      for (int i = 0; i < 3; ++i) {
        if ((cut >> i & 1U) == 0) continue;
        const I value = splat(e[i] + s.a[i] * bx + s.b[i] * row) + (splat(s.a[i]) * ix + splat(s.b[i]) * iy);
        inside = inside & (value > splat(-1));
      }
      const F y = splat(y_first) + (lane_y + splat(static_cast<float>(row))) * scale;
      if constexpr (is_outer(C)) inside = inside & within(rect, f, x, y);
      if (bits(inside) == 0) continue;
      const F z = depth_at<C>(plane, x, y);
      const Int64 p = tile + block * 16 + part * kLanes;
      written |= write_lanes<C, kMasked>(f, p, inside, z, id, mask, x, y);
    }
  }
}

/// The nearest depth that any pixel centre of a tile may get: depth_at is monotonic in x and y, rounding included.
template <Coverage C>
float nearest_in_tile(const Frame& f, const Plane& plane, int32_t tx, int32_t ty) {
  const int32_t px = tx * kTile + (plane.gx > 0 ? kTile - 1 : 0), py = ty * kTile + (plane.gy > 0 ? kTile - 1 : 0);
  const float x = static_cast<float>(px * kSubpixel + kSubpixel / 2 - f.axis_x);
  const float y = static_cast<float>(py * kSubpixel + kSubpixel / 2 - f.axis_y);
  float z = plane.gx * (x - plane.x0) + (plane.gy * (y - plane.y0) + plane.z0);  // as depth_at
  if constexpr (C != Coverage::center) {
    const float reach =
        (abs_of(plane.gx) + abs_of(plane.gy)) * static_cast<float>(kPixelReach) + abs_of(plane.z_max) * 1e-6F;
    z = is_outer(C) ? z + reach : z - reach;
  }
  return min_of(max_of(z, plane.z_min), plane.z_max);
}

/// A triangle of positive area, any size within the guard band.
template <Coverage C, bool kMasked>
void draw_large(const Frame& f, Region& r, const Int64* x, const Int64* y, const Plane& plane, uint32_t id,
                LazyMask* mask) {
  const auto low = [](const Int64* v) {
    return v[0] < v[1] ? (v[0] < v[2] ? v[0] : v[2]) : (v[1] < v[2] ? v[1] : v[2]);
  };
  const auto high = [](const Int64* v) {
    return v[0] > v[1] ? (v[0] > v[2] ? v[0] : v[2]) : (v[1] > v[2] ? v[1] : v[2]);
  };
  constexpr int32_t kIn = is_outer(C) ? -2 : kSubpixel / 2 - 1, kOut = is_outer(C) ? -2 : kSubpixel / 2;
  PixelRect rect = {static_cast<int32_t>((low(x) + kIn) >> 8), static_cast<int32_t>((low(y) + kIn) >> 8),
                    static_cast<int32_t>((high(x) - kOut) >> 8), static_cast<int32_t>((high(y) - kOut) >> 8)};
  rect.x0 = max_of(rect.x0, r.tx0 * kTile), rect.y0 = max_of(rect.y0, r.ty0 * kTile);
  rect.x1 = min_of(rect.x1, min_of(r.tx1 * kTile, f.width) - 1),
  rect.y1 = min_of(rect.y1, min_of(r.ty1 * kTile, f.height) - 1);
  if (rect.x0 > rect.x1 || rect.y0 > rect.y1) return;
  const int32_t tx0 = rect.x0 >> 3, ty0 = rect.y0 >> 3, tx1 = rect.x1 >> 3, ty1 = rect.y1 >> 3;
  EdgeSetup s;
  set_up_edges<C>(x, y, tx0 * kTile, ty0 * kTile, s);
  Int64 highest[3], lowest[3];  // of the edge function within a tile, from its value at the first pixel
  for (int i = 0; i < 3; ++i) {
    const Int64 a = s.a[i] * Int64(kTile - 1), b = s.b[i] * Int64(kTile - 1);
    highest[i] = (a > 0 ? a : 0) + (b > 0 ? b : 0), lowest[i] = (a < 0 ? a : 0) + (b < 0 ? b : 0);
  }
  for (int32_t ty = ty0; ty <= ty1; ++ty) {
    Int64 e[3];
    for (int i = 0; i < 3; ++i) e[i] = s.e[i] + static_cast<Int64>(s.b[i]) * (kTile * (ty - ty0));
    bool entered = false;
    for (int32_t tx = tx0; tx <= tx1; ++tx) {
      int32_t here[3];
      uint32_t cut = 0;
      bool outside = false;
      for (int i = 0; i < 3; ++i) {
        outside |= e[i] + highest[i] < 0;
        cut |= (e[i] + lowest[i] < 0 ? 1U : 0U) << i;
        here[i] = static_cast<int32_t>(e[i]);  // used only where it is cut: then it is within a tile of 0
        e[i] += static_cast<Int64>(s.a[i]) * kTile;
      }
      if (outside) {
        if (entered) break;  // convex: the row is left for good
        continue;
      }
      entered = true;
      const Int64 local = static_cast<Int64>(ty - r.ty0) * r.stride + (tx - r.tx0);
      if (nearest_in_tile<C>(f, plane, tx, ty) < r.hz[local]) continue;
      bool written = false;
      draw_tile<C, kMasked>(f, tx, ty, s, here, cut, plane, rect, id, mask, written);
      note<C>(r, local, written);
    }
  }
}

/// Depth over the picture from three corners of positive area. From the corner farthest away, where little is left of
/// the precision of the near ones.
template <Coverage C>
Plane plane_of(const Corner* c) {
  const double x1 = double(c[1].x) - c[0].x, y1 = double(c[1].y) - c[0].y, z1 = double(c[1].z) - c[0].z;
  const double x2 = double(c[2].x) - c[0].x, y2 = double(c[2].y) - c[0].y, z2 = double(c[2].z) - c[0].z;
  const double area = x1 * y2 - x2 * y1;
  int far = c[1].z < c[0].z ? 1 : 0;
  if (c[2].z < c[far].z) far = 2;
  const float z_min = c[far].z, z_max = max_of(c[0].z, max_of(c[1].z, c[2].z));
  if (!(area > 1.0)) {  // a sliver: its corners' order is rounding
    const float z = is_outer(C) ? z_max : z_min;
    return {0, 0, z, 0, 0, z_min, z_max};
  }
  return {c[far].x,
          c[far].y,
          c[far].z,
          static_cast<float>((z1 * y2 - z2 * y1) / area),
          static_cast<float>((x1 * z2 - x2 * z1) / area),
          z_min,
          z_max};
}

/// One triangle by the long way. Corners in the mesh's order; `given`: a plane that is known better than the corners
/// say.
template <Coverage C, bool kMasked>
void draw_one(const Frame& f, Region& r, const Corner* corners, bool mirrored, bool two_sided, uint32_t id,
              LazyMask* mask, const Plane* given) {
  Corner c[3] = {corners[0], corners[mirrored ? 1 : 2], corners[mirrored ? 2 : 1]};
  Int64 x[3], y[3];
  for (int i = 0; i < 3; ++i) x[i] = rounded(c[i].x) + f.axis_x, y[i] = rounded(c[i].y) + f.axis_y;
  const Int64 area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
  const Int64 slip = is_outer(C) ? kSmallExtent * Int64(1024) : 0;  // rounding may have turned it over
  if (!is_outer(C) && area == 0) return;
  if (area < 0) {
    if (!two_sided && area < -slip) return;
    const Corner swap = c[1];
    c[1] = c[2], c[2] = swap;
    const Int64 sx = x[1], sy = y[1];
    x[1] = x[2], y[1] = y[2], x[2] = sx, y[2] = sy;
  }
  ++r.counts.triangles_drawn;
  draw_large<C, kMasked>(f, r, x, y, given ? *given : plane_of<C>(c), id, mask);
}

// --- Triangles that reach out of the guard band or behind the near plane ---------------------------------------------

struct ClipVertex {
  double x, y, w;
  bool original;
  Corner corner;  ///< of an original vertex: as every neighbour has it
};

struct ClipPlane {
  double x, y, w, offset;  ///< inside: x x + y y + w w + offset >= 0
};

PROMENADE_INLINE double side_of(const ClipPlane& p, const ClipVertex& v) {
  return p.x * v.x + p.y * v.y + p.w * v.w + p.offset;
}

/// Cuts a convex polygon. A new vertex goes from the inner to the outer one, so that both triangles of an edge get the
/// same.
int clip(const ClipVertex* in, int count, const ClipPlane& plane, ClipVertex* out) {
  int n = 0;
  for (int i = 0; i < count; ++i) {
    const ClipVertex &p = in[i], &q = in[i + 1 == count ? 0 : i + 1];
    const double dp = side_of(plane, p), dq = side_of(plane, q);
    if (dp >= 0) out[n++] = p;
    if ((dp >= 0) == (dq >= 0)) continue;
    const ClipVertex &a = dp >= 0 ? p : q, &b = dp >= 0 ? q : p;
    const double da = dp >= 0 ? dp : dq, db = dp >= 0 ? dq : dp;
    const double t = da / (da - db);
    out[n++] = {a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.w + (b.w - a.w) * t, false, {}};
  }
  return n;
}

/// The depth plane of a triangle from its points in view space; false: the eye lies in it.
bool plane_in_view(const Frame& f, const ClipVertex* v, Plane& out) {
  const double ax = v[1].x - v[0].x, ay = v[1].y - v[0].y, aw = v[1].w - v[0].w;
  const double bx = v[2].x - v[0].x, by = v[2].y - v[0].y, bw = v[2].w - v[0].w;
  const double nx = ay * bw - aw * by, ny = aw * bx - ax * bw, nw = ax * by - ay * bx;
  const double d = nx * v[0].x + ny * v[0].y + nw * v[0].w;
  const double by_what = f.orthographic ? nw : d;
  const double size = __builtin_fabs(nx * v[0].x) + __builtin_fabs(ny * v[0].y) + __builtin_fabs(nw * v[0].w);
  if (__builtin_fabs(by_what) <= 1e-12 * (f.orthographic ? __builtin_fabs(nx) + __builtin_fabs(ny) : size) ||
      by_what == 0)
    return false;
  // Perspective: 1/w = (n . (x/w, y/w, 1)) / d. Orthographic: -w = (nx x + ny y - d) / nw.
  const double gx = nx / by_what, gy = ny / by_what, at_axis = f.orthographic ? -d / nw : nw / d;
  out.gx = static_cast<float>(gx), out.gy = static_cast<float>(gy);
  out.z0 = static_cast<float>(at_axis + gx * out.x0 + gy * out.y0);
  return true;
}

Corner corner_of(const Frame& f, const ClipVertex& v) {
  if (v.original) return v.corner;
  if (f.orthographic) return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(-v.w)};
  return {static_cast<float>(v.x / v.w), static_cast<float>(v.y / v.w), static_cast<float>(1.0 / v.w)};
}

template <Coverage C, bool kMasked>
void draw_clipped(const Frame& f, Region& r, const ExactPoint* points, const Corner* corners, bool mirrored,
                  bool two_sided, uint32_t id, LazyMask* mask) {
  ++r.counts.triangles_clipped;
  ClipVertex a[10], b[10];
  for (int i = 0; i < 3; ++i) a[i] = {points[i].x, points[i].y, points[i].w, true, corners[i]};
  const ClipVertex triangle[3] = {a[0], a[1], a[2]};
  const double q = f.orthographic ? 0.0 : 1.0, gx = f.guard_x, gy = f.guard_y;
  const ClipPlane planes[5] = {{0, 0, 1, -double(f.near_m)},
                               {1, 0, q * gx, (1 - q) * gx},
                               {-1, 0, q * gx, (1 - q) * gx},
                               {0, 1, q * gy, (1 - q) * gy},
                               {0, -1, q * gy, (1 - q) * gy}};
  int n = 3;
  for (const ClipPlane& plane : planes) {
    n = clip(a, n, plane, b);
    if (n < 3) return;
    for (int i = 0; i < n; ++i) a[i] = b[i];
  }
  Corner c[10];
  Plane plane = {};
  plane.z_min = kFloatMax, plane.z_max = -kFloatMax;
  for (int i = 0; i < n; ++i) {
    c[i] = corner_of(f, a[i]);
    if (c[i].z < plane.z_min) plane.z_min = c[i].z, plane.x0 = c[i].x, plane.y0 = c[i].y;
    plane.z_max = max_of(plane.z_max, c[i].z);
  }
  if (!plane_in_view(f, triangle, plane)) {
    if (!is_outer(C)) return;
    plane.gx = 0, plane.gy = 0, plane.z0 = plane.z_max;
  }
  for (int i = 1; i + 1 < n; ++i) {
    const Corner fan[3] = {c[0], c[i], c[i + 1]};
    draw_one<C, kMasked>(f, r, fan, mirrored, two_sided, id, mask, &plane);
  }
}

// --- Blocks ----------------------------------------------------------------------------------------------------------

struct BlockVertices {
  alignas(64) float x[kBlockVertices], y[kBlockVertices], z[kBlockVertices];
  alignas(64) float code[kBlockVertices];  ///< bits, as a float table: which sides of the guard band it lies beyond
};

enum OutCode : int32_t { out_near = 1, out_left = 2, out_right = 4, out_above = 8, out_below = 16 };

void transform_vertices(const Frame& f, const Item& item, const Block& block, bool needs_clip, BlockVertices& v) {
  const F near = splat(f.near_m), one = splat(1.0F), gx = splat(f.guard_x), gy = splat(f.guard_y), zero = splat(0.0F);
  for (int i = 0; i < block.vertex_count; i += kLanes) {
    const uint32_t at = block.first_vertex + static_cast<uint32_t>(i);
    const F dx = (load(item.x + at) - splat(item.eye_hi[0])) - splat(item.eye_lo[0]);
    const F dy = (load(item.y + at) - splat(item.eye_hi[1])) - splat(item.eye_lo[1]);
    const F dz = (load(item.z + at) - splat(item.eye_hi[2])) - splat(item.eye_lo[2]);
    F x = (splat(item.rows[0][0]) * dx + splat(item.rows[0][1]) * dy) + splat(item.rows[0][2]) * dz;
    F y = (splat(item.rows[1][0]) * dx + splat(item.rows[1][1]) * dy) + splat(item.rows[1][2]) * dz;
    const F w = (splat(item.rows[2][0]) * dx + splat(item.rows[2][1]) * dy) + splat(item.rows[2][2]) * dz;
    const F inverse = one / max(w, near);
    if (!f.orthographic) x = x * inverse, y = y * inverse;
    if (needs_clip) {
      const I none = splat(0);
      I code = select(w < near, splat(int32_t(out_near)), none);
      code = code | select(x < zero - gx, splat(int32_t(out_left)), none) |
             select(x > gx, splat(int32_t(out_right)), none);
      code = code | select(y < zero - gy, splat(int32_t(out_above)), none) |
             select(y > gy, splat(int32_t(out_below)), none);
      store(v.code + i, as_float(code));
      x = max(min(x, gx), zero - gx), y = max(min(y, gy), zero - gy);
    }
    store(v.x + i, x);
    store(v.y + i, y);
    store(v.z + i, f.orthographic ? zero - w : inverse);
  }
}

/// kLanes corners of triangles, rounded.
struct LaneCorner {
  F x, y, z;
  I ix, iy;
};

PROMENADE_INLINE void exchange(M m, LaneCorner& a, LaneCorner& b) {
  const LaneCorner c = a;
  a = {select(m, b.x, a.x), select(m, b.y, a.y), select(m, b.z, a.z), select(m, b.ix, a.ix), select(m, b.iy, a.iy)};
  b = {select(m, c.x, b.x), select(m, c.y, b.y), select(m, c.z, b.z), select(m, c.ix, b.ix), select(m, c.iy, b.iy)};
}

/// Edge functions, depth planes and pixel rectangles of small triangles; returns the lanes that may cover a pixel.
template <Coverage C>
PROMENADE_INLINE uint32_t set_up_small(const Frame& f, const Region& r, LaneCorner* c, M lanes, bool two_sided,
                                       Batch& s) {
  const I x_low = min(min(c[0].ix, c[1].ix), c[2].ix), x_high = max(max(c[0].ix, c[1].ix), c[2].ix);
  const I y_low = min(min(c[0].iy, c[1].iy), c[2].iy), y_high = max(max(c[0].iy, c[1].iy), c[2].iy);
  constexpr int32_t kIn = is_outer(C) ? -2 : kSubpixel / 2 - 1, kOut = is_outer(C) ? -2 : kSubpixel / 2;
  const I px0 = max(shift_right<8>(x_low + splat(kIn)), splat(r.tx0 * kTile));
  const I py0 = max(shift_right<8>(y_low + splat(kIn)), splat(r.ty0 * kTile));
  const I px1 = min(shift_right<8>(x_high - splat(kOut)), splat(min_of(r.tx1 * kTile, f.width) - 1));
  const I py1 = min(shift_right<8>(y_high - splat(kOut)), splat(min_of(r.ty1 * kTile, f.height) - 1));
  lanes = lanes & (px0 < px1 + splat(1)) & (py0 < py1 + splat(1));
  if (bits(lanes) == 0) return 0;
  const I area = (c[1].ix - c[0].ix) * (c[2].iy - c[0].iy) - (c[2].ix - c[0].ix) * (c[1].iy - c[0].iy);
  const M back = area < splat(0);
  const M thin = abs(area) < splat(2 * kSmallExtent * 2);  // outer: rounding may have turned it over, or to nothing
  M turned = back;
  if (two_sided)
    lanes = is_outer(C) ? lanes : lanes & (back | (area > splat(0)));
  else if (is_outer(C))
    lanes = lanes & (thin | (area > splat(0)));
  else
    lanes = lanes & (area > splat(0)), turned = mask_of(0);
  const uint32_t left = bits(lanes);
  if (left == 0) return 0;
  if (bits(turned) != 0) exchange(turned, c[1], c[2]);

  const I block_x = shift_left<8>(px0 & splat(~3)) + splat(kSubpixel / 2),
          block_y = shift_left<8>(py0 & splat(~3)) + splat(kSubpixel / 2);
  for (int i = 0; i < 3; ++i) {
    const LaneCorner &p = c[i], &q = c[i == 2 ? 0 : i + 1];
    const I a = p.iy - q.iy, b = q.ix - p.ix;
    I e = a * (block_x - p.ix) + b * (block_y - p.iy);
    if constexpr (C == Coverage::center) {
      const M top_left = (a > splat(0)) | (equal(a, splat(0)) & (b > splat(0)));
      e = e + select(top_left, splat(0), splat(-1));
    } else {
      const I reach = (abs(a) + abs(b)) * splat(kPixelReach);
      e = is_outer(C) ? e + reach : e - reach;
    }
    store(s.e[i], to_float(shift_right<8>(e)));
    store(s.a[i], to_float(a));
    store(s.b[i], to_float(b));
  }
  const F x1 = c[1].x - c[0].x, y1 = c[1].y - c[0].y, z1 = c[1].z - c[0].z;
  const F x2 = c[2].x - c[0].x, y2 = c[2].y - c[0].y, z2 = c[2].z - c[0].z;
  const F float_area = x1 * y2 - x2 * y1, zero = splat(0.0F);
  const M sound = float_area > splat(1.0F);  // otherwise a sliver: its corners' order is rounding
  const F inverse = splat(1.0F) / select(sound, float_area, splat(1.0F));
  const F z_min = min(min(c[0].z, c[1].z), c[2].z), z_max = max(max(c[0].z, c[1].z), c[2].z);
  store(s.gx, select(sound, (z1 * y2 - z2 * y1) * inverse, zero));
  store(s.gy, select(sound, (x1 * z2 - x2 * z1) * inverse, zero));
  store(s.x0, c[0].x);
  store(s.y0, c[0].y);
  store(s.z0, select(sound, c[0].z, is_outer(C) ? z_max : z_min));
  store(s.z_min, z_min);
  store(s.z_max, z_max);
  store(s.px0, px0);
  store(s.py0, py0);
  store(s.px1, px1);
  store(s.py1, py1);
  return left;
}

/// Writes one pixel for each of the lanes: the pixel (dx, dy) beyond the first of its triangle's rectangle.
PROMENADE_INLINE void write_single_pixels(const Frame& f, Region& r, const Batch& s, uint32_t lanes, int32_t dx,
                                          int32_t dy) {
  const I px = load(s.px0) + splat(dx), py = load(s.py0) + splat(dy), three = splat(3), four = splat(4);
  const I tx = shift_right<3>(px), ty = shift_right<3>(py);
  const I at = shift_left<6>(ty * splat(f.tiles_x) + tx) +
               ((shift_left<3>(py & four) | shift_left<2>(px & four)) | (shift_left<2>(py & three) | (px & three)));
  const I local = (ty - splat(r.ty0)) * splat(r.stride) + (tx - splat(r.tx0));
  const F x = to_float(shift_left<8>(px) + splat(kSubpixel / 2 - f.axis_x)),
          y = to_float(shift_left<8>(py) + splat(kSubpixel / 2 - f.axis_y));
  const F plane = load(s.gx) * (x - load(s.x0)) + (load(s.gy) * (y - load(s.y0)) + load(s.z0));
  alignas(64) int32_t places[kLanes], tiles[kLanes];
  alignas(64) float depths[kLanes];
  store(places, at), store(tiles, local);
  store(depths, min(max(plane, load(s.z_min)), load(s.z_max)));
  for (; lanes != 0; lanes &= lanes - 1) {
    const int t = __builtin_ctz(lanes);
    const float z = depths[t], old = f.z[places[t]];
    if (z < old) continue;
    const uint32_t id = static_cast<uint32_t>(s.id[t]);
    if (!(z > old) && id >= f.id[places[t]]) continue;
    f.z[places[t]] = z, f.id[places[t]] = id, r.dirty[tiles[t]] = 1;
  }
}

/// Draws those of the triangles that lie within 2 x 2 pixels, and returns the others. Most of such triangles cover one
/// pixel's centre or none; all are asked at once.
PROMENADE_INLINE uint32_t draw_tiny(const Frame& f, Region& r, const Batch& s, uint32_t lanes) {
  const I px0 = load(s.px0), py0 = load(s.py0), two = splat(2);
  const uint32_t tiny = lanes & bits((load(s.px1) - px0 < two) & (load(s.py1) - py0 < two));
  if (tiny == 0) return lanes;
  const F x = to_float(px0 & splat(3)), y = to_float(py0 & splat(3)), zero = splat(0.0F);
  F e[3], a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = load(s.a[i]), b[i] = load(s.b[i]);
    e[i] = load(s.e[i]) + (a[i] * x + b[i] * y);  // whole numbers: exact
  }
  // Pixels beyond the rectangle: the triangle does not reach them, or they belong to another region.
  const uint32_t wide = bits(load(s.px1) > px0), high = bits(load(s.py1) > py0);
  const uint32_t one = tiny & bits(min(min(e[0], e[1]), e[2]) >= zero);
  const uint32_t right = tiny & wide & bits(min(min(e[0] + a[0], e[1] + a[1]), e[2] + a[2]) >= zero);
  const uint32_t below = tiny & high & bits(min(min(e[0] + b[0], e[1] + b[1]), e[2] + b[2]) >= zero);
  const uint32_t both =
      tiny & wide & high & bits(min(min(e[0] + (a[0] + b[0]), e[1] + (a[1] + b[1])), e[2] + (a[2] + b[2])) >= zero);
  if (one != 0) write_single_pixels(f, r, s, one, 0, 0);
  if (right != 0) write_single_pixels(f, r, s, right, 1, 0);
  if (below != 0) write_single_pixels(f, r, s, below, 0, 1);
  if (both != 0) write_single_pixels(f, r, s, both, 1, 1);
  return lanes & ~tiny;
}

/// Triangles of a block that need the long way: large, or clipped.
template <Coverage C, bool kMasked>
void draw_long_way(const Frame& f, const Item& item, const Block& block, Region& r, const BlockVertices& v,
                   uint32_t triangle, bool clipped, bool two_sided) {
  const uint32_t at = block.first_triangle + triangle;
  const uint32_t id = item.first_id + number_at(item.triangle_of, at);
  LazyMask mask(item);
  if constexpr (kMasked) mask.begin(number_at(item.triangle_of, at));
  Corner corners[3];
  ExactPoint points[3];
  for (int i = 0; i < 3; ++i) {
    const uint32_t k = item.corners[i][at], p = block.first_vertex + k;
    corners[i] = {v.x[k], v.y[k], v.z[k]};
    if (clipped) points[i] = exact_point(item, item.x[p], item.y[p], item.z[p]);
  }
  if (clipped)
    draw_clipped<C, kMasked>(f, r, points, corners, item.mirrored, two_sided, id, &mask);
  else
    draw_one<C, kMasked>(f, r, corners, item.mirrored, two_sided, id, &mask, nullptr);
}

bool is_two_sided(const Block& block, const Frame& f) { return (block.flags & block_two_sided) != 0 && !f.one_sided; }

template <Coverage C, bool kMasked>
void draw_block(const Frame& frame, const Item& item, const Block& block, Region& region, bool needs_clip) {
  const Frame f = frame;  // copies: the compiler need not fear that pixels written change them
  Region r = region;
  BlockVertices v;
  transform_vertices(f, item, block, needs_clip, v);
  const Table64 xs(v.x), ys(v.y), zs(v.z);
  const bool two_sided = is_two_sided(block, f) || !f.cull_back;
  const int order[3] = {0, item.mirrored ? 1 : 2, item.mirrored ? 2 : 1};  // fronts get positive area with y downwards
  Batch s;
  LazyMask mask(item);
  for (uint32_t first = 0; first < block.triangle_count; first += kLanes) {
    const uint32_t at = block.first_triangle + first;
    const I index[3] = {load(item.corners[order[0]] + at), load(item.corners[order[1]] + at),
                        load(item.corners[order[2]] + at)};
    const uint32_t left = block.triangle_count - first;
    uint32_t lanes = left >= uint32_t(kLanes) ? (1U << kLanes) - 1U : (1U << left) - 1U;
    uint32_t clipped = 0;
    if (needs_clip) {
      const Table64 codes(v.code);
      const I c0 = as_int(codes[index[0]]), c1 = as_int(codes[index[1]]), c2 = as_int(codes[index[2]]);
      lanes &= bits(equal(c0 & c1 & c2, splat(0)));
      clipped = lanes & ~bits(equal(c0 | c1 | c2, splat(0)));
      lanes &= ~clipped;
    }
    r.counts.triangles_set_up += static_cast<uint64_t>(__builtin_popcount(lanes | clipped));
    LaneCorner c[3];
    for (int i = 0; i < 3; ++i) {
      c[i].x = xs[index[i]], c[i].y = ys[index[i]], c[i].z = zs[index[i]];
      c[i].ix = round_to_int(c[i].x) + splat(f.axis_x), c[i].iy = round_to_int(c[i].y) + splat(f.axis_y);
    }
    const I width = max(max(c[0].ix, c[1].ix), c[2].ix) - min(min(c[0].ix, c[1].ix), c[2].ix);
    const I height = max(max(c[0].iy, c[1].iy), c[2].iy) - min(min(c[0].iy, c[1].iy), c[2].iy);
    const uint32_t large = lanes & bits(max(width, height) > splat(kSmallExtent));
    for (uint32_t m = large | clipped; m != 0; m &= m - 1) {
      const uint32_t t = static_cast<uint32_t>(__builtin_ctz(m));
      draw_long_way<C, kMasked>(f, item, block, r, v, first + t, (clipped >> t & 1U) != 0, two_sided);
    }
    lanes &= ~large;
    if (lanes == 0) continue;
    uint32_t small = set_up_small<C>(f, r, c, mask_of(lanes), two_sided, s);
    if (small == 0) continue;
    const I ids = numbers_at(item.triangle_of, at) + splat(static_cast<int32_t>(item.first_id));
    store(s.id, ids);
    r.counts.triangles_drawn += static_cast<uint64_t>(__builtin_popcount(small));
    if constexpr (C == Coverage::center && !kMasked) small = draw_tiny(f, r, s, small);
    for (; small != 0; small &= small - 1) {
      const int t = __builtin_ctz(small);
      if constexpr (kMasked) mask.begin(static_cast<uint32_t>(s.id[t]) - item.first_id);
      draw_small<C, kMasked>(f, r, s, t, &mask);
    }
  }
  region.counts = r.counts, region.found = r.found;
}

/// True only if every triangle of the block, anywhere in its box, shows its back.
bool faces_away(const Frame& f, const Item& item, const Block& block) {
  if (block.cone_sin > 1.0F) return false;
  float d[3], radius = 0, along = 0, length = 0;
  for (int i = 0; i < 3; ++i) {
    d[i] = f.orthographic ? item.axis[i] : (block.box_center[i] - item.eye_hi[i]) - item.eye_lo[i];
    along += d[i] * block.cone_axis[i], length += d[i] * d[i], radius += block.box_half[i] * block.box_half[i];
  }
  length = __builtin_sqrtf(length);
  radius = f.orthographic ? 0.0F : __builtin_sqrtf(radius);
  return along > block.cone_sin * length + radius + 1e-4F * length;
}

/// Whether this picture leaves the block out, whatever it may show.
template <Coverage C>
PROMENADE_INLINE bool left_out(const Frame& f, const Item& item, const Block& block) {
  if (C == Coverage::inner && (item.fading || (block.flags & block_masked) != 0)) return true;  // has holes
  return (block.flags & block_blended) != 0 ? !f.draw_blended : !f.draw_solid;
}

/// Asks memory for what drawing a block will read: short runs that no processor foresees.
PROMENADE_INLINE void ask_for_block(const Item& item, const Block& block) {
  constexpr uint32_t kLine = 64;
  for (uint32_t i = 0; i < block.vertex_count; i += kLine / sizeof(float)) {
    const uint32_t at = block.first_vertex + i;
    __builtin_prefetch(item.x + at), __builtin_prefetch(item.y + at), __builtin_prefetch(item.z + at);
  }
  if (item.triangle_of.narrow != nullptr)
    for (uint32_t i = 0; i < block.triangle_count; i += kLine / sizeof(uint16_t))
      __builtin_prefetch(item.triangle_of.narrow + block.first_triangle + i);
  else
    for (uint32_t i = 0; i < block.triangle_count; i += kLine / sizeof(uint32_t))
      __builtin_prefetch(item.triangle_of.wide + block.first_triangle + i);
  for (const uint8_t* corners : item.corners) __builtin_prefetch(corners + block.first_triangle);
}

template <Coverage C>
void draw_item(const Frame& f, const Item& item, const BoxPicture& item_box, Region& r) {
  if (!may_be_seen(f, r, item_box)) {
    ++r.counts.items_hidden;
    return;
  }
  ++r.counts.items_drawn;
  for (uint32_t i = 0; i < item.block_count; ++i) {
    const Block& block = item.blocks[i];
    if (left_out<C>(f, item, block)) continue;
    if (!is_outer(C) && f.cull_back && !is_two_sided(block, f) && faces_away(f, item, block)) {
      ++r.counts.blocks_facing_away;
      continue;
    }
    const BoxPicture box = project_box(f, item, block.box_center, block.box_half);
    if (box.culled || !may_be_seen(f, r, box)) {
      ++r.counts.blocks_hidden;
      continue;
    }
    ++r.counts.blocks_drawn;
    if (i + 1 < item.block_count) ask_for_block(item, item.blocks[i + 1]);
    // Conservative: what has holes hides nothing, and may show anywhere.
    const bool in_part = item.fading || (block.flags & block_masked) != 0 || f.before_z != nullptr;
    if (C == Coverage::center && in_part)
      draw_block<C, C == Coverage::center>(f, item, block, r, box.needs_clip);
    else
      draw_block<C, false>(f, item, block, r, box.needs_clip);
    if (C == Coverage::probe && r.found) return;
  }
}

void draw(const Frame& f, const Item& item, const BoxPicture& item_box, Region& r, Coverage coverage) {
  switch (coverage) {
    case Coverage::center:
      return draw_item<Coverage::center>(f, item, item_box, r);
    case Coverage::inner:
      return draw_item<Coverage::inner>(f, item, item_box, r);
    case Coverage::outer:
      return draw_item<Coverage::outer>(f, item, item_box, r);
    case Coverage::probe:
      return draw_item<Coverage::probe>(f, item, item_box, r);
  }
}

/// Empties the region. Pixels that fill up the last tiles get a depth that nothing beats.
void clear(const Frame& f, Region& r) {
  for (int32_t ty = r.ty0; ty < r.ty1; ++ty) {
    for (int32_t tx = r.tx0; tx < r.tx1; ++tx) {
      float* z = tile_of(f, f.z, tx, ty);
      for (int i = 0; i < kTilePixels; i += kLanes) store(z + i, splat(f.clear_z));
      const Int64 local = static_cast<Int64>(ty - r.ty0) * r.stride + (tx - r.tx0);
      r.hz[local] = f.clear_z, r.dirty[local] = 0;
      if ((tx + 1) * kTile <= f.width && (ty + 1) * kTile <= f.height) continue;
      for (int i = 0; i < kTilePixels; ++i) {
        const int32_t px = tx * kTile + (i >> 4 & 1) * 4 + (i & 3), py = ty * kTile + (i >> 5) * 4 + (i >> 2 & 3);
        if (px >= f.width || py >= f.height) z[i] = kFloatMax;
      }
    }
  }
  r.counts = {};
}

#include "raster/kernel_shade.inl"

#include "raster/kernel_layers.inl"

#include "raster/kernel_smooth.inl"

#include "raster/kernel_gaps.inl"

constexpr Kernels kKernels = {kLanes,           project_box,    clear,      draw,           shade_row,
                              shade_layers_row, find_edges_row, smooth_row, find_items_row, find_gaps_row};
