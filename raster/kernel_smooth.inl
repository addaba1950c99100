// Part of kernel.inl: edges smoothed after shading. Where a pixel and one of its four neighbours show different
// triangles in clearly different colours, the triangles that the five show are asked which of 16 places in the pixel
// they cover and which of them is nearest there: their own geometry, no guess at an edge from the picture. The pixel
// becomes the mean of the colours that the five already have. So each pixel is still shaded once.
//
// A place that none of the five covers belongs to a triangle that no centre lies in. Where the pixel's own triangle is
// large, it has ended there, and the neighbour on that side tells the colour; a small one says nothing about what is
// beside it, and the pixel keeps its colour. Of surfaces with holes the opacity is taken as linear across the pixel.

constexpr int kPlaces = 16;
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

/// A triangle over the picture: functions of (x, y, 1), sub-pixels from the axis.
struct EdgeTriangle {
  uint32_t id = kNoSurface;
  bool usable = false;  ///< false: what it covers cannot be told from its corners
  double corner[3][3];  ///< barycentric coordinates over w: all >= 0 inside
  double depth[3];      ///< as in the picture
  MaskTriangle mask;    ///< surface null: no holes
};

void set_up_edge_triangle(const Frame& f, const Shading& s, uint32_t id, EdgeTriangle& e) {
  e.id = id, e.usable = false;
  const Item& item = s.items[s.item_of_run[id >> s.run_bits]];
  if (item.indices == nullptr || item.fading) return;
  const uint32_t triangle = id - item.first_id;
  set_up_mask(f, item, triangle, e.mask);
  if (e.mask.surface != nullptr && e.mask.surface->alpha != 1) return;  // seen through
  ViewPoint p[3];
  double w[3];
  for (int i = 0; i < 3; ++i) {
    const float* at =
        item.positions +
        3 * static_cast<uint64_t>(item.indices[3 * static_cast<uint64_t>(triangle) + static_cast<uint64_t>(i)]);
    p[i] = view_point(item, at[0], at[1], at[2]);
    w[i] = f.orthographic ? -double(p[i].w) : 1.0;
    if (f.orthographic) p[i].w = 1.0F;
  }
  const double corners[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (!linear_over(p, corners, 3, e.corner)) return;
  for (int k = 0; k < 3; ++k) e.depth[k] = w[0] * e.corner[0][k] + w[1] * e.corner[1][k] + w[2] * e.corner[2][k];
  e.usable = true;
}

/// The triangles met last; a row of tiles meets the same ones again and again.
struct EdgeTriangles {
  static constexpr uint32_t kSlots = 64;
  EdgeTriangle slots[kSlots];
  const EdgeTriangle& at(const Frame& f, const Shading& s, uint32_t id) {
    EdgeTriangle& e = slots[(id * 0x9e3779b1U) >> 26];
    if (e.id != id) set_up_edge_triangle(f, s, id, e);
    return e;
  }
};

/// A linear function across a pixel.
struct PixelFunction {
  float at, dx, dy;
  PROMENADE_INLINE F over(F x, F y) const { return splat(at) + (splat(dx) * x + splat(dy) * y); }
};
PROMENADE_INLINE PixelFunction across(const double* v, double x, double y) {
  return {static_cast<float>(v[0] * x + v[1] * y + v[2]), static_cast<float>(v[0] * kSubpixel),
          static_cast<float>(v[1] * kSubpixel)};
}

/// Opacity less the cut-off.
PixelFunction opacity_across(const MaskTriangle& m, const PixelFunction& z, float x, float y) {
  const auto opacity = [&](float dx, float dy) {
    const float depth = m.orthographic ? 1.0F : max_of(z.at + (z.dx * dx + z.dy * dy), abs_of(z.at) * 0.25F + 1e-30F);
    return opacity_at(m, x + dx * static_cast<float>(kSubpixel), y + dy * static_cast<float>(kSubpixel), depth);
  };
  const float here = opacity(0, 0);
  return {here - m.surface->alpha_cutoff, opacity(1, 0) - here, opacity(0, 1) - here};
}

/// The places of a pixel: which of its five triangles is nearest there, -1 none.
struct PlaceOwners {
  alignas(64) float z[kPlaces];
  alignas(64) int32_t owner[kPlaces];
};

/// Lets a triangle take the places that it covers nearest. x, y: the pixel's centre, sub-pixels from the axis.
void take_places(const Frame& f, const EdgeTriangle& e, int32_t number, double x, double y, PlaceOwners& o) {
  const PixelFunction corner[3] = {across(e.corner[0], x, y), across(e.corner[1], x, y), across(e.corner[2], x, y)};
  const PixelFunction depth = across(e.depth, x, y);
  PixelFunction solid = {1, 0, 0};
  if (e.mask.surface != nullptr) solid = opacity_across(e.mask, depth, static_cast<float>(x), static_cast<float>(y));
  const F zero = splat(0.0F), nearest = splat(f.orthographic ? -f.near_m : 1.0F / f.near_m);
  for (int i = 0; i < kPlaces; i += kLanes) {
    const F px = load(kPlacesInPixel.x + i), py = load(kPlacesInPixel.y + i), old = load(o.z + i);
    const F inside = min(min(corner[0].over(px, py), corner[1].over(px, py)), corner[2].over(px, py));
    const F z = depth.over(px, py);
    const M taken = (inside >= zero) & (solid.over(px, py) >= zero) & (z > old) & (z <= nearest);
    store(o.z + i, select(taken, z, old));
    store(o.owner + i, select(taken, splat(number), load(o.owner + i)));
  }
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
  float linear[kLanes] = {};
  for (int k = 0; k < 5; ++k) {
    if (places[k] == 0) continue;
    const uint32_t color = static_cast<uint32_t>(five.color[k]);
    const float share = static_cast<float>(places[k]) * (1.0F / kPlaces);
    for (int c = 0; c < 3; ++c) linear[c] += share * s.linear_of_srgb[color >> (8 * c) & 255U];
  }
  int32_t bytes[kLanes];
  store(bytes, to_srgb(load(linear)));
  return static_cast<int32_t>(0xff000000U) | bytes[2] << 16 | bytes[1] << 8 | bytes[0];
}

int32_t smoothed_pixel(const Frame& f, const Shading& s, EdgeTriangles& triangles, const Five& five, int32_t px,
                       int32_t py) {
  PlaceOwners o;
  for (int i = 0; i < kPlaces; ++i) o.z[i] = f.clear_z, o.owner[i] = -1;
  const double x = static_cast<double>(px * kSubpixel + kSubpixel / 2 - f.axis_x),
               y = static_cast<double>(py * kSubpixel + kSubpixel / 2 - f.axis_y);
  for (int k = 0; k < 5; ++k) {
    bool known = five.id[k] == kNoSurface;
    for (int j = 0; j < k; ++j) known |= five.id[j] == five.id[k];
    if (known) continue;
    const EdgeTriangle& e = triangles.at(f, s, five.id[k]);
    if (e.usable)
      take_places(f, e, k, x, y, o);
    else if (k == 0)
      return five.color[0];
  }
  int places[5] = {};
  for (int i = 0; i < kPlaces; ++i)
    if (o.owner[i] >= 0) ++places[o.owner[i]];
  const bool ended = five.id[0] != kNoSurface && places[0] >= kFewPlaces;
  for (int i = 0; i < kPlaces; ++i)
    if (o.owner[i] < 0) ++places[ended ? neighbour_of_place(five, i) : 0];
  return places[0] == kPlaces ? five.color[0] : mean_color(s, five, places);
}

/// Ids of a row of pixels, one after the other; a pixel more on each side and lanes behind.
void lay_out_ids(const Frame& f, int32_t y, int32_t* row) {
  y = max_of(0, min_of(y, f.height - 1));
  const Int64 first = static_cast<Int64>(y >> 3) * f.tiles_x * kTilePixels + (y >> 2 & 1) * 32 + (y & 3) * 4;
  const int32_t quads = (f.width + 3) / 4;
  for (int32_t q = 0; q < quads; ++q) {
    const Int64 at = first + (q >> 1) * kTilePixels + (q & 1) * 16;
    for (int i = 0; i < 4; ++i)
      row[4 * q + i] = static_cast<int32_t>(f.z[at + i] > f.clear_z ? f.id[at + i] : kNoSurface);
  }
  row[-1] = row[0];
  for (int i = 0; i < kLanes + 1; ++i) row[f.width + i] = row[f.width - 1];
}

void lay_out_colors(const Frame& f, const uint32_t* in, int32_t y, int32_t* row) {
  y = max_of(0, min_of(y, f.height - 1));
  __builtin_memcpy(row, in + static_cast<Int64>(y) * f.width, static_cast<uint64_t>(f.width) * 4);
  row[-1] = row[0];
  for (int i = 0; i < kLanes + 1; ++i) row[f.width + i] = row[f.width - 1];
}

/// The largest difference of a channel.
PROMENADE_INLINE I difference(I a, I b) {
  const I low = splat(255);
  const I red = abs((a & low) - (b & low));
  const I green = abs((shift_right<8>(a) & low) - (shift_right<8>(b) & low));
  const I blue = abs((shift_right<16>(a) & low) - (shift_right<16>(b) & low));
  return max(max(red, green), blue);
}

/// Three rows, one above the other.
struct Rows {
  const int32_t* row[3];
};

/// The pixels from x on that are to be smoothed: they differ from a neighbour both in triangle and in colour, and show
/// the sky or a triangle that two of their neighbours show, too. Where every pixel has a triangle of its own there is
/// no edge to find, and it would cost the most.
PROMENADE_INLINE uint32_t edges_among(const Rows& id, const Rows& color, int32_t x, int32_t least) {
  const I own = load(id.row[1] + x), none = splat(0), one = splat(1);
  const I sides[4] = {load(id.row[1] + x - 1), load(id.row[1] + x + 1), load(id.row[0] + x), load(id.row[2] + x)};
  I same = none;
  for (const I& side : sides) same = same + select(equal(own, side), one, none);
  const M to_do = (same < splat(4)) & ((same > one) | equal(own, splat(static_cast<int32_t>(kNoSurface))));
  if (bits(to_do) == 0) return 0;
  const I here = load(color.row[1] + x);
  const I colors[4] = {load(color.row[1] + x - 1), load(color.row[1] + x + 1), load(color.row[0] + x),
                       load(color.row[2] + x)};
  I most = none;
  for (int i = 0; i < 4; ++i) most = max(most, select(equal(own, sides[i]), none, difference(here, colors[i])));
  return bits(to_do & (most > splat(least - 1)));
}

/// A pixel of the middle row and its neighbours.
PROMENADE_INLINE Five five_at(const Rows& id, const Rows& color, int32_t x) {
  const int32_t at[5] = {x, x - 1, x + 1, x, x};
  const int line[5] = {1, 1, 1, 0, 2};
  Five five;
  for (int k = 0; k < 5; ++k) {
    five.id[k] = static_cast<uint32_t>(id.row[line[k]][at[k]]);
    five.color[k] = color.row[line[k]][at[k]];
  }
  return five;
}

void smooth_row(const Frame& f, const Shading& s, const Smoothing& smoothing, int32_t ty) {
  EdgeTriangles triangles;
  int32_t* ids[10];
  int32_t* colors[10];
  for (int i = 0; i < 10; ++i) {
    ids[i] = smoothing.room + static_cast<Int64>(i) * smoothing.stride + 16;
    colors[i] = ids[i] + static_cast<Int64>(10) * smoothing.stride;
    lay_out_ids(f, ty * kTile + i - 1, ids[i]);
    lay_out_colors(f, smoothing.in, ty * kTile + i - 1, colors[i]);
  }
  const int32_t rows = min_of(kTile, f.height - ty * kTile);
  uint32_t* out = smoothing.out + static_cast<Int64>(ty) * kTile * f.width;
  __builtin_memcpy(out, smoothing.in + static_cast<Int64>(ty) * kTile * f.width,
                   static_cast<uint64_t>(f.width) * static_cast<uint64_t>(rows) * 4);
  // Column by column, so that the rows of a triangle find it among those met last.
  for (int32_t x = 0; x < f.width; x += kLanes) {
    for (int32_t i = 1; i <= rows; ++i) {
      const Rows id = {{ids[i - 1], ids[i], ids[i + 1]}}, color = {{colors[i - 1], colors[i], colors[i + 1]}};
      uint32_t edges = edges_among(id, color, x, smoothing.least_difference);
      if (f.width - x < kLanes) edges &= (1U << (f.width - x)) - 1U;
      for (; edges != 0; edges &= edges - 1) {
        const int32_t p = x + __builtin_ctz(edges);
        out[static_cast<Int64>(i - 1) * f.width + p] =
            static_cast<uint32_t>(smoothed_pixel(f, s, triangles, five_at(id, color, p), p, ty * kTile + i - 1));
      }
    }
  }
}
