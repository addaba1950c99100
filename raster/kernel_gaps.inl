// Part of kernel.inl: which pixels may be gaps between meshes (gaps.h). First which tiles have more than one item in or
// beside them, and depths that differ; there, what the depths alone can tell, kLanes pixels at a time. Few are left to
// be looked at closely.

constexpr int32_t kGapRows = kTile + 2 * kGapReach;

void find_items_row(const Frame& f, const GapRoom& room, int32_t ty) {
  const I none = splat(static_cast<int32_t>(kNoSurface)), flip = splat(INT32_MIN);  // ids have no sign
  const F clear = splat(f.clear_z);
  for (int32_t tx = 0; tx < f.tiles_x; ++tx) {
    GapTile& tile = room.tiles[static_cast<Int64>(ty) * f.tiles_x + tx];
    const Int64 first = (static_cast<Int64>(ty) * f.tiles_x + tx) * kTilePixels;
    I low = none + flip, high = flip;
    F far = load(f.z + first), near = far;
    for (int i = 0; i < kTilePixels; i += kLanes) {
      const I id = load(reinterpret_cast<const int32_t*>(f.id) + first + i);
      const F z = load(f.z + first + i);
      const M seen = (z > clear) & less_unsigned(id, none);
      low = min(low, select(seen, id + flip, none + flip)), high = max(high, select(seen, id + flip, flip));
      far = min(far, z), near = max(near, z);
    }
    int32_t lows[kLanes], highs[kLanes];
    float fars[kLanes], nears[kLanes];
    store(lows, low), store(highs, high), store(fars, far), store(nears, near);
    for (int i = 1; i < kLanes; ++i) {
      lows[0] = min_of(lows[0], lows[i]), highs[0] = max_of(highs[0], highs[i]);
      fars[0] = min_of(fars[0], fars[i]), nears[0] = max_of(nears[0], nears[i]);
    }
    const uint32_t lowest = static_cast<uint32_t>(lows[0]) ^ 0x80000000U,
                   highest = static_cast<uint32_t>(highs[0]) ^ 0x80000000U;
    const bool any = lowest != kNoSurface;
    tile = {any ? room.item_of_run[lowest >> room.run_bits] : kNoSurface,
            any ? room.item_of_run[highest >> room.run_bits] : 0, fars[0], nears[0]};
    // Beyond the picture's sides depths are there, and ids are anything.
    if ((tx + 1) * kTile > f.width || (ty + 1) * kTile > f.height) tile.lowest = 0, tile.highest = kNoSurface;
  }
}

/// Whether a pixel of the tile may be a gap: more than one item is seen in the tile and those around it, and something
/// there is so much nearer than something in it.
PROMENADE_INLINE bool may_gape(const Frame& f, const GapRoom& room, int32_t tx, int32_t ty) {
  const GapTile* const here = room.tiles + static_cast<Int64>(ty) * f.tiles_x + tx;
  uint32_t low = here->lowest, high = here->highest;
  float near = here->nearest_z;
  for (int32_t y = max_of(ty - 1, 0); y <= min_of(ty + 1, f.tiles_y - 1); ++y)
    for (int32_t x = max_of(tx - 1, 0); x <= min_of(tx + 1, f.tiles_x - 1); ++x) {
      const GapTile& tile = room.tiles[static_cast<Int64>(y) * f.tiles_x + x];
      low = low < tile.lowest ? low : tile.lowest;
      high = high > tile.highest ? high : tile.highest;
      near = max_of(near, tile.nearest_z);
    }
  return low < high && near > here->farthest_z * kGapNearer;
}

/// Depths of one row of pixels of some tiles, one after the other, and a tile on either side; at the picture's ends,
/// copies of them.
void lay_out_depths(const Frame& f, int32_t first, int32_t last, int32_t y, float* row) {
  y = max_of(0, min_of(y, f.height - 1));
  const float* z = f.z + static_cast<Int64>(y >> 3) * f.tiles_x * kTilePixels + (y >> 2 & 1) * 32 + (y & 3) * 4;
  const int32_t end = min_of((last + 1) * 2, (f.width + 3) / 4);
  for (int32_t q = max_of(first - 1, 0) * 2; q < end; ++q)
    __builtin_memcpy(row + 4 * q, z + static_cast<Int64>(q >> 1) * kTilePixels + (q & 1) * 16, 16);
  for (int32_t i = 1; first == 0 && i <= kGapReach; ++i) row[-i] = row[0];
  for (int32_t i = 0; end * 4 >= f.width && i < kGapReach + kLanes; ++i) row[f.width + i] = row[f.width - 1];
}

/// Whether along a line through each of kLanes pixels something nearer than `before` lies on both sides: next to it on
/// one, within reach on the other.
PROMENADE_INLINE M between(F before, const float* const* rows, int32_t x, int32_t across, int32_t down) {
  static_assert(kGapReach == 2);
  const auto at = [&](int32_t i) { return load(rows[i * down] + x + i * across); };
  const F left = at(-1), right = at(1);
  return max(min(left, max(right, at(2))), min(right, at(-2))) > before;
}

/// The tiles from `first` to before `last`.
void find_gaps_among(const Frame& f, GapRoom& room, int32_t first, int32_t last, int32_t ty) {
  float* rows[kGapRows];
  const int32_t y = ty * kTile, height = min_of(kTile, f.height - y), end = min_of(last * kTile, f.width);
  for (int32_t i = 0; i < height + 2 * kGapReach; ++i) {
    rows[i] = room.depths + static_cast<Int64>(i) * room.stride + kLanePadding;
    lay_out_depths(f, first, last, y + i - kGapReach, rows[i]);
  }
  for (int32_t i = 0; i < height; ++i) {
    const float* const* row = rows + i + kGapReach;
    for (int32_t x = first * kTile; x < end; x += kLanes) {
      const F before = load(*row + x) * splat(kGapNearer);
      const M found = between(before, row, x, 1, 0) | between(before, row, x, 0, 1) | between(before, row, x, 1, 1) |
                      between(before, row, x, -1, 1);
      uint32_t lanes = bits(found);
      if (end - x < kLanes) lanes &= (1U << (end - x)) - 1U;
      for (; lanes != 0; lanes &= lanes - 1)
        room.found[room.count++] = static_cast<uint32_t>(y + i) << 16 | static_cast<uint32_t>(x + __builtin_ctz(lanes));
    }
  }
}

void find_gaps_row(const Frame& f, GapRoom& room, int32_t ty) {
  room.count = 0;
  for (int32_t first = 0; first < f.tiles_x; ++first) {
    if (!may_gape(f, room, first, ty)) continue;
    int32_t last = first + 1;
    while (last < f.tiles_x && may_gape(f, room, last, ty)) ++last;
    find_gaps_among(f, room, first, last, ty);
    first = last;
  }
}
