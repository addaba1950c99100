// Part of kernel.inl: textures. What a tile's pixels want of one texture is first written down, one bilinear sample of
// one mip level after the other, kLanes of them side by side whatever pixels they belong to; then each step of sampling
// goes over all of them: where their texels lie, reading these, mixing them, adding the samples to their pixels. Short
// loops without a choice in them keep the processor's units busy, where a pixel's own chain of steps would wait for
// each of them.

/// Where the pixels of a tile lie in their textures.
struct TexturePlaces {
  alignas(64) float u[kTilePixels], v[kTilePixels];
  alignas(64) float dux[kTilePixels], duy[kTilePixels], dvx[kTilePixels], dvy[kTilePixels];  ///< change a pixel
  alignas(64) float surface[kTilePixels];  ///< which of the surfaces; -1: none
};

/// Samples of one texture that are waiting to be taken, in the order of the steps that they come from.
struct Samples {
  static constexpr int kMost = 256, kRoom = kMost + 16;
  alignas(64) float u[kRoom], v[kRoom], weight[kRoom];
  alignas(64) int32_t level[kRoom];
  int32_t count;
  /// Some lanes of a block of pixels; their samples follow one another.
  struct Step {
    uint32_t lanes;
    int32_t first;  ///< pixel of the tile
  };
  Step steps[kMost];
  int32_t step_count;

  // On the way to their colours.
  alignas(64) int32_t upper[kRoom], lower[kRoom];  ///< the left texel's number, in the upper and in the lower row
  alignas(64) float across[kRoom], down[kRoom];    ///< share of the right texel, and of the lower row
  alignas(64) uint64_t upper_pair[kRoom], lower_pair[kRoom];
  alignas(64) float color[3][kRoom];
};

PROMENADE_INLINE void add_samples(Samples& s, M lanes, int32_t first, F u, F v, I level, F weight) {
  const uint32_t chosen = bits(lanes);
  if (chosen == 0) return;
  pack(s.u + s.count, lanes, u);
  pack(s.v + s.count, lanes, v);
  pack(s.level + s.count, lanes, level);
  pack(s.weight + s.count, lanes, weight);
  s.steps[s.step_count++] = {chosen, first};
  s.count += __builtin_popcount(chosen);
}

/// A texture coordinate in texels from the first one's centre, wrapped; >= -0.5, and < size - 0.5 but for rounding.
PROMENADE_INLINE F wrapped(F t, uint8_t wrap, F size) {
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
  return t * size - splat(0.5F);
}

/// Which texels the samples lie between.
PROMENADE_INLINE void find_texels(const Surface& surface, Samples& s) {
  const Texture& t = *surface.texture;
  const Table16 offsets(t.level_offset);
  const Table<16> widths(t.level_width), heights(t.level_height);
  const I zero = splat(0), one = splat(1);
  for (int32_t k = 0; k < s.count; k += kLanes) {
    const I level = load(s.level + k);
    const F width = widths[level], height = heights[level];
    const F x = wrapped(load(s.u + k), surface.wrap_u, width), y = wrapped(load(s.v + k), surface.wrap_v, height);
    const F whole_x = floor(x), whole_y = floor(y);
    const I stride = truncate(width) + one, last_x = stride - splat(2), last_y = truncate(height) - one;
    F across = x - whole_x;
    I left = truncate(whole_x), top = truncate(whole_y), bottom = top + one;
    if (surface.wrap_u == 0)
      left = select(left < zero, last_x, left);  // the row's last texel is its first again
    else
      across = select((left < zero) | (left > last_x - one), splat(0.0F), across), left = max(left, zero);
    if (surface.wrap_v == 0)
      top = select(top < zero, last_y, top), bottom = select(bottom > last_y, zero, bottom);
    else
      top = max(top, zero), bottom = min(bottom, last_y);
    left = offsets[level] + left;
    store(s.upper + k, left + top * stride);
    store(s.lower + k, left + bottom * stride);
    store(s.across + k, across);
    store(s.down + k, y - whole_y);
  }
}

/// Texels and their right neighbours, by single reads: in two thirds of the time of the processors' own gathers.
PROMENADE_INLINE void read_pairs(const int32_t* texels, const int32_t* at, int32_t count, uint64_t* pairs) {
  for (int32_t k = 0; k < count; ++k) {
    uint64_t pair = 0;
    __builtin_memcpy(&pair, texels + at[k], sizeof pair);
    asm("" : "+r"(pair));  // not a gather
    pairs[k] = pair;
  }
}

/// Adds a row's share of a bilinear sample.
PROMENADE_INLINE void add_row(const uint64_t* pairs, F left_weight, F right_weight, F* sum) {
  const I low = splat(1023);
  I texel[2];
  load_pairs(pairs, texel[0], texel[1]);
  for (int i = 0; i < 2; ++i) {
    const F weight = i == 0 ? left_weight : right_weight;
    const F r = to_float(texel[i] & low), g = to_float(shift_right<10>(texel[i]) & low),
            b = to_float(shift_right<20>(texel[i]));
    sum[0] = sum[0] + weight * (r * r), sum[1] = sum[1] + weight * (g * g), sum[2] = sum[2] + weight * (b * b);
  }
}

PROMENADE_INLINE void mix_texels(Samples& s) {
  const F one = splat(1.0F), scale = splat(1.0F / (1023.0F * 1023.0F));
  for (int32_t k = 0; k < s.count; k += kLanes) {
    const F weight = load(s.weight + k) * scale, right = load(s.across + k), left = one - right;
    const F lower = load(s.down + k) * weight, upper = weight - lower;
    F sum[3] = {splat(0.0F), splat(0.0F), splat(0.0F)};
    add_row(s.upper_pair + k, left * upper, right * upper, sum);
    add_row(s.lower_pair + k, left * lower, right * lower, sum);
    for (int c = 0; c < 3; ++c) store(s.color[c] + k, sum[c]);
  }
}

/// Takes the samples and adds them to the pixels' colours.
void take_samples(const Surface& surface, Samples& s, float (*sum)[kTilePixels]) {
  if (s.count == 0) return;
  // What fills up the last lanes is sampled, too, and must lie in the texture.
  store(s.u + s.count, splat(0.0F));
  store(s.v + s.count, splat(0.0F));
  store(s.level + s.count, splat(0));
  find_texels(surface, s);
  const int32_t whole = (s.count + kLanes - 1) / kLanes * kLanes;
  read_pairs(surface.texture->texels, s.upper, whole, s.upper_pair);
  read_pairs(surface.texture->texels, s.lower, whole, s.lower_pair);
  mix_texels(s);
  int32_t at = 0;
  for (int32_t i = 0; i < s.step_count; ++i) {
    const Samples::Step& step = s.steps[i];
    for (int c = 0; c < 3; ++c) {
      float* to = sum[c] + step.first;
      store(to, load(to) + unpack(s.color[c] + at, mask_of(step.lanes)));
    }
    at += __builtin_popcount(step.lanes);
  }
  s.count = 0, s.step_count = 0;
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
struct MipChoice {
  I level, next;
  F weight, next_weight;
  M both;  ///< lanes that want the next level, too
  MipChoice(const Texture& t, F lod, F share) {
    const F whole = floor(lod + splat(0.25F));  // from there on the level is the next one
    const F mixed = max(min((lod - whole) * splat(2.0F) - splat(0.5F), splat(1.0F)), splat(0.0F));
    level = truncate(whole);
    next = min(level + splat(1), splat(static_cast<int32_t>(t.levels - 1)));
    next_weight = share * mixed, weight = share - next_weight;
    both = mixed > splat(0.0F);
  }
};

/// Writes down the samples of those of kLanes pixels from `first` on that are `active`: trilinear ones; where the
/// footprint is long, several along it.
PROMENADE_INLINE void want_samples(const Surface& surface, const TexturePlaces& p, int32_t first, M active,
                                   float anisotropy, Samples& s, float (*sum)[kTilePixels]) {
  const Texture& t = *surface.texture;
  const F u = load(p.u + first), v = load(p.v + first), dux = load(p.dux + first), duy = load(p.duy + first),
          dvx = load(p.dvx + first), dvy = load(p.dvy + first);
  const F width = splat(static_cast<float>(t.width)), height = splat(static_cast<float>(t.height));
  const F ax = dux * width, ay = dvx * height, bx = duy * width, by = dvy * height;
  const F a = min(ax * ax + ay * ay, splat(1e30F)), b = min(bx * bx + by * by, splat(1e30F));
  const F top = splat(static_cast<float>(t.levels - 1)), zero = splat(0.0F), one = splat(1.0F);
  const F longest = max(max(a, b), splat(1e-30F)), shortest = max(min(a, b), one);  // squares; no finer than a texel
  F count = one;
  uint32_t several = 0;
  for (float k = 2; k <= anisotropy; k += 1.0F) {
    const M more = longest >= shortest * splat((k - 0.5F) * (k - 0.5F));
    if (bits(active & more) == 0) break;
    several |= bits(active & more), count = select(more, splat(k), count);
  }
  const F share = several == 0 ? one : one / count;
  const F lod = max(min(rough_log2(longest * (share * share)) * splat(0.5F), top), zero);
  const MipChoice mip(t, lod, share);
  F along_u = zero, along_v = zero;
  if (several != 0) along_u = select(a >= b, dux, duy), along_v = select(a >= b, dvx, dvy);
  for (float i = 0;; i += 1.0F) {
    const M taken = active & (count > splat(i));
    if (bits(taken) == 0) return;
    const F offset = (splat(i) + splat(0.5F)) * share - splat(0.5F);
    const F iu = u + along_u * offset, iv = v + along_v * offset;
    if (s.count + 2 * kLanes > Samples::kMost) take_samples(surface, s, sum);
    add_samples(s, taken, first, iu, iv, mip.level, mip.weight);
    add_samples(s, taken & mip.both, first, iu, iv, mip.next, mip.next_weight);
  }
}

/// The texture's colour at those of a tile's pixels that show the surface with that number, added to `sum`.
void sample_surface(const Surface& surface, int32_t number, const TexturePlaces& places, float anisotropy, Samples& s,
                    float (*sum)[kTilePixels]) {
  const F own = splat(static_cast<float>(number));
  s.count = 0, s.step_count = 0;
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const F here = load(places.surface + i);
    const M active = (here >= own) & (here <= own);
    if (bits(active) != 0) want_samples(surface, places, i, active, anisotropy, s, sum);
  }
  take_samples(surface, s, sum);
}
