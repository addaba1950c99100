// Part of kernel.inl: what is seen through, layer by layer over the finished picture of the solid surfaces, from the
// farthest to the nearest, in linear light.

/// Opacities of the pixels that a layer covers in a tile. which: their triangles in the span.
void find_opacities(const Frame& f, const Shading& s, const Span& span, const int32_t* which, const float* z,
                    int32_t tx, int32_t ty, float* opacity) {
  MaskTriangle masks[kSpanTriangles];
  Frame flat = f;
  flat.screen_door = false;
  for (int32_t k = 0; k < span.count; ++k) {
    const Item& item = s.items[s.item_of_run[span.id[k] >> s.run_bits]];
    set_up_mask(flat, item, span.id[k] - item.first_id, masks[k]);
  }
  const float x = first_center(tx, f.axis_x), y = first_center(ty, f.axis_y);
  for (int i = 0; i < kTilePixels; ++i) {
    opacity[i] = 0;
    if (which[i] < 0) continue;
    const MaskTriangle& m = masks[which[i]];
    const float dx = static_cast<float>(((i >> 4 & 1) * 4 + (i & 3)) * kSubpixel),
                dy = static_cast<float>(((i >> 5) * 4 + (i >> 2 & 3)) * kSubpixel);
    opacity[i] = m.surface == nullptr ? 1.0F : max_of(0.0F, min_of(1.0F, opacity_at(m, x + dx, y + dy, z[i])));
  }
}

void blend_layer(const Frame& f, const Shading& s, const Layer& layer, int32_t tx, int32_t ty, ShadeRoom& room,
                 LinearTile& under) {
  LinearTile linear;
  const Int64 tile = (static_cast<Int64>(ty) * f.tiles_x + tx) * kTilePixels;
  Span span;
  alignas(64) float opacity[kTilePixels];
  const float* z = layer.z + tile;
  begin_span(span, tx);
  add_tile(f, z, layer.id + tile, span);  // a span has room for the triangles of one tile
  if (span.count == 0) return;
  set_up_span(f, s, span, ty, room.triangles, room.functions);
  color_tile(f, s, {z, span.which[0], 0}, room, linear);
  find_opacities(f, s, span, span.which[0], z, tx, ty, opacity);
  for (int i = 0; i < kTilePixels; i += kLanes) {
    const M covered = load(span.which[0] + i) > splat(-1);
    const F share = load(opacity + i);
    for (int c = 0; c < 3; ++c) {
      const F below = load(under.color[c] + i), color = load(linear.color[c] + i);
      store(under.color[c] + i, select(covered, below + share * (color - below), below));
    }
  }
}

PROMENADE_INLINE bool is_empty(const uint32_t* id) {
  M none = mask_of((1U << kLanes) - 1U);
  for (int i = 0; i < kTilePixels; i += kLanes)
    none = none & equal(load(reinterpret_cast<const int32_t*>(id) + i), splat(static_cast<int32_t>(kNoSurface)));
  return bits(none) == (1U << kLanes) - 1U;
}

void shade_layers_row(const Frame& f, const Shading& s, const Layers& of, int32_t ty) {
  const Layer* layers = of.layers;
  ShadeRoom& room = shade_room();
  for (int32_t tx = of.tx0; tx < of.tx1; ++tx) {
    const Int64 tile = (static_cast<Int64>(ty) * f.tiles_x + tx) * kTilePixels;
    if (is_empty(layers[0].id + tile)) continue;  // then the layers behind it are empty, too
    LinearTile linear;
    uint32_t* pixels[kTilePixels];
    for (int i = 0; i < kTilePixels; ++i) {
      const int32_t px = tx * kTile + (i >> 4 & 1) * 4 + (i & 3), py = ty * kTile + (i >> 5) * 4 + (i >> 2 & 3);
      pixels[i] = px < f.width && py < f.height ? s.out + static_cast<Int64>(py) * f.width + px : nullptr;
      for (int c = 0; c < 3; ++c)
        linear.color[c][i] = pixels[i] == nullptr ? 0.0F : s.linear_of_srgb[*pixels[i] >> (8 * c) & 255U];
    }
    for (int32_t l = of.count - 1; l >= 0; --l) blend_layer(f, s, layers[l], tx, ty, room, linear);
    for (int i = 0; i < kTilePixels; i += kLanes) {
      const F color[3] = {load(linear.color[0] + i), load(linear.color[1] + i), load(linear.color[2] + i)};
      int32_t rgba[kLanes];
      store(rgba, packed_srgb(color));
      for (int k = 0; k < kLanes; ++k)
        if (pixels[i + k] != nullptr && layers[0].id[tile + i + k] != kNoSurface)
          *pixels[i + k] = static_cast<uint32_t>(rgba[k]);
    }
  }
}
