// Part of kernel.inl: which triangles a few tiles side by side show, and bringing their corners into arrays.

constexpr int32_t kSpanTiles = 4, kSpanTriangles = 64;

/// What a tile shows throughout, if it is not one of a span's triangles.
enum TileShows : int32_t { tile_shows_nothing = -1, tile_shows_several = -2 };

/// Tiles of one row that have at most kSpanTriangles distinct triangles together.
struct Span {
  int32_t first, tiles;
  int32_t count;
  int32_t throughout[kSpanTiles];  ///< the one triangle of the whole tile, or TileShows
  alignas(64) uint32_t id[kSpanTriangles];
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
  alignas(64) float packed[kSpanTriangles];    ///< bits of RGBA8 where all of the triangle has one colour; else 0
  uint64_t flat;                               ///< bits: triangles whose corners have one colour and one normal
  const Surface* surfaces[kSpanTriangles];     ///< the distinct textured ones
  int32_t surface_count;
  bool varying;  ///< some triangle's lit colour may differ from corner to corner
};

void begin_span(Span& span, int32_t first) {
  span.first = first, span.tiles = 0, span.count = 0;
  __builtin_memset(span.id, 255, sizeof span.id);
}

/// The triangle's place in the span, which it is given if it has none; -1: there is no room. Most spans have few: all
/// of them are looked at, kLanes at a time.
PROMENADE_INLINE int32_t place_in_span(Span& span, uint32_t id) {
  const I wanted = splat(static_cast<int32_t>(id));
  for (int32_t k = 0; k < span.count; k += kLanes) {
    const uint32_t found = bits(equal(load(reinterpret_cast<const int32_t*>(span.id) + k), wanted));
    const int32_t place = k + (found == 0 ? kLanes : __builtin_ctz(found));
    if (found != 0 && place < span.count) return place;  // beyond: of a tile that was taken back
  }
  if (span.count == kSpanTriangles) return -1;
  span.id[span.count] = id;
  return span.count++;
}

/// Finds the tile's triangles; false: with them the span would have too many, and it is complete without the tile.
bool add_tile(const Frame& f, const float* z, const uint32_t* id, Span& span) {
  if (span.tiles == kSpanTiles) return false;
  const int32_t before = span.count;
  const int32_t* ids = reinterpret_cast<const int32_t*>(id);
  constexpr int32_t kPixelsAhead = 6 * kTilePixels;
  for (int32_t i = 0; i < kTilePixels; i += 16)
    __builtin_prefetch(z + kPixelsAhead + i), __builtin_prefetch(id + kPixelsAhead + i);
  int32_t* which = span.which[span.tiles];
  constexpr uint32_t kAll = (1U << kLanes) - 1U;
  const I first = splat(ids[0]), none = splat(static_cast<int32_t>(kNoSurface));
  M same = mask_of(kAll);
  for (int i = 0; i < kTilePixels; i += kLanes)
    same = same & equal(load(ids + i), first) & (load(z + i) > splat(f.clear_z));
  int32_t& throughout = span.throughout[span.tiles];
  if (id[0] != kNoSurface && bits(same) == kAll) {
    throughout = place_in_span(span, id[0]);
    if (throughout < 0) return false;
    for (int i = 0; i < kTilePixels; i += kLanes) store(which + i, splat(throughout));
    ++span.tiles;
    return true;
  }
  throughout = tile_shows_nothing;
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const I here = load(ids + i);
    I places = splat(-1);
    uint32_t left = bits(load(z + i) > splat(f.clear_z)) & ~bits(equal(here, none));
    if (left != 0) throughout = tile_shows_several;
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

PROMENADE_INLINE const Item& item_of(const Shading& s, uint32_t id) { return s.items[s.item_of_run[id >> s.run_bits]]; }

PROMENADE_INLINE void ask_for(const Numbers& numbers, uint64_t i) {
  if (numbers.narrow != nullptr)
    ask_for(numbers.narrow + i);
  else if (numbers.wide != nullptr)
    ask_for(numbers.wide + i);
}
PROMENADE_INLINE void ask_for_triangle(const Item& item, uint32_t id) {
  if (item.vertices == nullptr) return;
  const uint64_t triangle = id - item.first_id;
  ask_for(item.indices, 3 * triangle);
  ask_for(item.materials, triangle);
}
PROMENADE_INLINE void ask_for_vertices(const Item& item, uint32_t id) {
  if (item.vertices == nullptr) return;
  for (uint64_t i = 0; i < 3; ++i) ask_for(vertex_of(item, 3 * static_cast<uint64_t>(id - item.first_id) + i));
}
PROMENADE_INLINE void ask_for_positions(const Item& item, uint32_t id) {
  if (item.vertices == nullptr) return;
  for (uint64_t i = 0; i < 3; ++i) {
    const uint32_t place = *vertex_of(item, 3 * static_cast<uint64_t>(id - item.first_id) + i);
    ask_for(item.x + place), ask_for(item.y + place), ask_for(item.z + place);
  }
}

/// Ask for what fetch_triangle will read of all triangles at once, because they lie anywhere in memory: first for their
/// corners' numbers, then for the vertices that these name, then for where they lie.
void ask_for_triangles(const Shading& s, const Span& span) {
  for (int32_t k = 0; k < span.count; ++k) ask_for(&item_of(s, span.id[k]).vertices);
  for (int32_t k = 0; k < span.count; ++k) ask_for_triangle(item_of(s, span.id[k]), span.id[k]);
}
void ask_for_corners(const Shading& s, const Span& span) {
  for (int32_t k = 0; k < span.count; ++k) ask_for_vertices(item_of(s, span.id[k]), span.id[k]);
  for (int32_t k = 0; k < span.count; ++k) ask_for_positions(item_of(s, span.id[k]), span.id[k]);
}

float number_of_surface(SpanTriangles& t, const Surface* surface) {
  for (int32_t i = 0; i < t.surface_count; ++i)
    if (t.surfaces[i] == surface) return static_cast<float>(i);
  t.surfaces[t.surface_count] = surface;
  return static_cast<float>(t.surface_count++);
}

/// Whether a triangle's corners have the same word there; 0: none.
PROMENADE_INLINE bool corners_agree(const uint32_t* const* vertex, uint32_t at) {
  return at == 0 || (vertex[0][at] == vertex[1][at] && vertex[0][at] == vertex[2][at]);
}

/// Colours and normals of a triangle's corners; `color` holds the material's. False: its corners' lit colours may
/// differ.
bool fetch_corners(const Shading& s, const Item& item, const uint32_t* const* vertex, SpanTriangles& t, int32_t k) {
  const float material[3] = {t.color[0][0][k], t.color[0][1][k], t.color[0][2][k]};
  const bool one_color = corners_agree(vertex, item.color_at), one_normal = corners_agree(vertex, item.normal_at);
  for (int v = 0; v < (one_color ? 1 : 3); ++v)
    for (int c = 0; c < 3; ++c)
      t.color[v][c][k] =
          item.color_at != 0 ? material[c] * s.linear_of_srgb[vertex[v][item.color_at] >> (8 * c) & 255U] : material[c];
  if (one_color)
    for (int c = 0; c < 3; ++c) t.color[1][c][k] = t.color[2][c][k] = t.color[0][c][k];
  const bool bare = item.normal_at == 0 || (one_normal && vertex[0][item.normal_at] == kNoNormal);
  for (int v = 0; v < (bare ? 0 : 3); ++v) {
    float n[3];
    normal_of(item, vertex[v], n);
    if (n[0] != 0 || n[1] != 0 || n[2] != 0) t.smooth[k] = 1;
    for (int c = 0; c < 3; ++c)
      t.normal[v][c][k] =
          item.placed ? (item.normal_rows[c][0] * n[0] + item.normal_rows[c][1] * n[1]) + item.normal_rows[c][2] * n[2]
                      : n[c];
  }
  return one_color && one_normal;
}

/// Brings one triangle's corners into the span's arrays; false: its corners' colours may differ.
PROMENADE_INLINE bool fetch_triangle(const Shading& s, uint32_t id, SpanTriangles& t, int32_t k) {
  const Item& item = item_of(s, id);
  const uint64_t triangle = id - item.first_id;
  t.texture[k] = -1, t.smooth[k] = 0;
  const bool bare = item.vertices == nullptr;
  const uint32_t material = bare ? 0 : material_of(item, triangle);
  const Surface* surface =
      item.surfaces != nullptr && material < item.surface_count ? item.surfaces + material : nullptr;
  for (int c = 0; c < 3; ++c) t.color[0][c][k] = surface == nullptr ? 1.0F : surface->color[c];
  if (bare) {
    for (int v = 0; v < 3; ++v)
      for (int c = 0; c < 3; ++c) t.p[v][c][k] = item.placed ? item.model_rows[c][3] : 0;
    return true;
  }
  const uint32_t* vertex[3];
  for (int v = 0; v < 3; ++v) {
    vertex[v] = vertex_of(item, 3 * triangle + static_cast<uint64_t>(v));
    float p[3];
    position_of(item, vertex[v], p);
    if (item.placed) to_model(item, p);
    for (int c = 0; c < 3; ++c) t.p[v][c][k] = p[c];
  }
  if (s.has_textures && surface != nullptr && surface->texture != nullptr && item.texcoord_at != 0) {
    t.texture[k] = number_of_surface(t, surface);
    for (int v = 0; v < 3; ++v)
      for (int c = 0; c < 2; ++c) t.uv[v][c][k] = texcoord_of(item, vertex[v], c);
  }
  if (item.normal_at == 0 && item.color_at == 0) return true;
  return fetch_corners(s, item, vertex, t, k);
}

/// Brings all of a span's triangles into its arrays.
void fetch_triangles(const Shading& s, const Span& span, SpanTriangles& t) {
  t.count = span.count, t.surface_count = 0;
  uint64_t flat = 0;
  for (int32_t k = 0; k < span.count; ++k) flat |= (fetch_triangle(s, span.id[k], t, k) ? uint64_t(1) : 0) << k;
  t.varying = flat != (span.count == 64 ? ~uint64_t(0) : (uint64_t(1) << span.count) - 1);
  t.flat = flat;
  if (!t.varying) return;
  for (; flat != 0; flat &= flat - 1) {
    const int k = __builtin_ctzll(flat);
    for (int c = 0; c < 3; ++c) t.color[1][c][k] = t.color[2][c][k] = t.color[0][c][k];
  }
}
