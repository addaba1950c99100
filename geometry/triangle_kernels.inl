// The code of triangle_kernels.h, on lanes of one width. Included by one file for each, inside an anonymous namespace:
// nothing here may be shared between them, nor call what the linker might take from the wrong one.

struct Vectors {
  Lanes x, y, z;
};
PROMENADE_INLINE Vectors operator-(const Vectors& a, const Vectors& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
PROMENADE_INLINE Vectors operator*(const Vectors& a, Lanes s) { return {a.x * s, a.y * s, a.z * s}; }
PROMENADE_INLINE Lanes dot(const Vectors& a, const Vectors& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PROMENADE_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
PROMENADE_INLINE Vectors selected3(Lanes mask, const Vectors& yes, const Vectors& no) {
  return {selected(mask, yes.x, no.x), selected(mask, yes.y, no.y), selected(mask, yes.z, no.z)};
}
PROMENADE_INLINE Vectors splat3(const float* p) { return {splat(p[0]), splat(p[1]), splat(p[2])}; }
PROMENADE_INLINE Vectors load3(const float* x, const float* y, const float* z) { return {load(x), load(y), load(z)}; }
PROMENADE_INLINE void store3(const Vectors& v, float* x, float* y, float* z) {
  store(x, v.x), store(y, v.y), store(z, v.z);
}
/// 1 / value, 0 for 0.
PROMENADE_INLINE Lanes inverse(Lanes value) { return where(less(splat(0), value), splat(1) / value); }
PROMENADE_INLINE Lanes clamp01(Lanes t) { return lower(upper(t, splat(0)), splat(1)); }

/// Eight triangles' frames, or one triangle's eight times.
struct Frames {
  Vectors origin, x, y, z;
  Lanes base, apex_x, apex_y, inverse_left2, inverse_right2;
};
PROMENADE_INLINE Frames frames_of(const TriangleFrames& f) {
  return {load3(f.origin_x, f.origin_y, f.origin_z),
          load3(f.x_x, f.x_y, f.x_z),
          load3(f.y_x, f.y_y, f.y_z),
          load3(f.z_x, f.z_y, f.z_z),
          load(f.base),
          load(f.apex_x),
          load(f.apex_y),
          load(f.inverse_left2),
          load(f.inverse_right2)};
}
PROMENADE_INLINE Frames frame_of(const TriangleFrames& f, size_t i) {
  const auto axis = [i](const float* x, const float* y, const float* z) {
    return Vectors{splat(x[i]), splat(y[i]), splat(z[i])};
  };
  return {axis(f.origin_x, f.origin_y, f.origin_z),
          axis(f.x_x, f.x_y, f.x_z),
          axis(f.y_x, f.y_y, f.y_z),
          axis(f.z_x, f.z_y, f.z_z),
          splat(f.base[i]),
          splat(f.apex_x[i]),
          splat(f.apex_y[i]),
          splat(f.inverse_left2[i]),
          splat(f.inverse_right2[i])};
}

/// Squared distances of points to triangles, each in its triangle's frame. Inside is judged strictly: a flat triangle
/// has none.
PROMENADE_INLINE Lanes distance2_in_frame(const Vectors& p, const Frames& f) {
  const Lanes x = p.x, y = p.y;
  const Lanes base = f.base, apex_x = f.apex_x, apex_y = f.apex_y;
  const Lanes base_dx = x - lower(upper(x, splat(0)), base);
  const Lanes base2 = base_dx * base_dx + y * y;

  const Lanes left_t = clamp01((x * apex_x + y * apex_y) * f.inverse_left2);
  const Lanes left_dx = x - left_t * apex_x;
  const Lanes left_dy = y - left_t * apex_y;
  const Lanes left2 = left_dx * left_dx + left_dy * left_dy;

  const Lanes from_base = x - base;
  const Lanes edge_x = apex_x - base;
  const Lanes right_t = clamp01((from_base * edge_x + y * apex_y) * f.inverse_right2);
  const Lanes right_dx = from_base - right_t * edge_x;
  const Lanes right_dy = y - right_t * apex_y;
  const Lanes right2 = right_dx * right_dx + right_dy * right_dy;

  const Lanes left_side = apex_y * x - apex_x * y;
  const Lanes right_side = edge_x * y - apex_y * from_base;
  const Lanes inside = less(splat(0), lower(lower(left_side, right_side), y));
  return where_not(inside, lower(lower(base2, left2), right2)) + p.z * p.z;
}

PROMENADE_INLINE Lanes distance2_to(const Frames& f, const Vectors& p) {
  const Vectors d = p - f.origin;
  return distance2_in_frame({dot(d, f.x), dot(d, f.y), dot(d, f.z)}, f);
}

/// Lanes that are no number, from what was too large to be squared, count as infinitely far. Nothing here branches on
/// which lane it is: no processor could foresee it.
PROMENADE_INLINE Lanes numbers(Lanes d2) {
  const Lanes infinite = splat(std::numeric_limits<float>::infinity());
  return selected(less(d2, infinite), d2, infinite);
}

uint32_t nearest(const TriangleFrames* frames, size_t groups, const float* point, float& distance2) {
  const Vectors p = splat3(point);
  uint32_t best = 0;
  float best2 = std::numeric_limits<float>::infinity();
  for (size_t g = 0; g < groups; ++g) {
    const Lanes d2 = numbers(distance2_to(frames_of(frames[g]), p));
    const float least2 = least(d2);
    if (!(least2 < best2)) continue;
    best2 = least2;
    best = static_cast<uint32_t>(g * kLanes) +
           static_cast<uint32_t>(__builtin_ctz(bits(less_or_equal(d2, splat(least2)))));
  }
  distance2 = best2;
  return best;
}

void distances(const TriangleFrames& frames, const float* point, float* distances2) {
  store(distances2, distance2_to(frames_of(frames), splat3(point)));
}

void distances_of(const TriangleFrames& frames, size_t triangle, const PointLanes& points, float* distances2) {
  const Vectors p = load3(points.x, points.y, points.z);
  store(distances2, distance2_to(frame_of(frames, triangle), p));
}

void make_frames(const TriangleCorners* corners, size_t groups, TriangleFrames* frames) {
  const Lanes zero = splat(0), one = splat(1);
  for (size_t g = 0; g < groups; ++g) {
    const auto& at = corners[g].at;
    const Vectors a = load3(at[0][0], at[0][1], at[0][2]);
    const Vectors b = load3(at[1][0], at[1][1], at[1][2]);
    const Vectors c = load3(at[2][0], at[2][1], at[2][2]);
    const Vectors base = b - a, apex = c - a, right = c - b;
    const Lanes length = root(dot(base, base));
    const Vectors x = selected3(less(zero, length), base * inverse(length), {one, zero, zero});
    const Lanes apex_x = dot(apex, x);
    const Vectors across = apex - x * apex_x;
    const Lanes apex_y = root(dot(across, across));
    const Lanes flat = less_or_equal(apex_y, splat(1e-6F) * length);  // the subtraction leaves noise
    // Perpendicular to x and to the axis that is less along it, of two.
    const Lanes steep = less(where_not(splat(-0.0F), x.x), splat(0.6F));
    const Vectors any = selected3(steep, Vectors{zero, x.z, zero - x.y}, Vectors{zero - x.z, zero, x.x});
    const Vectors y = selected3(flat, any * inverse(root(dot(any, any))), across * inverse(apex_y));
    TriangleFrames& f = frames[g];
    store3(a, f.origin_x, f.origin_y, f.origin_z);
    store3(x, f.x_x, f.x_y, f.x_z);
    store3(y, f.y_x, f.y_y, f.y_z);
    store3(cross(x, y), f.z_x, f.z_y, f.z_z);
    store(f.base, length);
    store(f.apex_x, apex_x);
    store(f.apex_y, where_not(flat, apex_y));
    store(f.inverse_left2, inverse(dot(apex, apex)));
    store(f.inverse_right2, inverse(dot(right, right)));
  }
}

PROMENADE_INLINE bool is_visible(const TreeSearch& s, uint32_t triangle) {
  return s.group_hidden == nullptr || s.group_hidden[s.group_of_triangle[triangle]] == 0;
}

PROMENADE_INLINE void search_leaf(const TriangleBlock* block, uint32_t blocks, const Vectors& p, TreeSearch& s) {
  for (const TriangleBlock* end = block + blocks; block != end; ++block) {
    const Lanes d2 = distance2_to(frames_of(*block), p);
    unsigned nearer = bits(less(d2, splat(s.distance2)));
    if (nearer == 0) continue;
    if (s.group_hidden == nullptr) {
      const Lanes valid = numbers(d2);
      s.distance2 = least(valid);
      s.triangle = block->triangle[__builtin_ctz(bits(less_or_equal(valid, splat(s.distance2))))];
      continue;
    }
    alignas(32) float lanes[kLanes];
    store(lanes, d2);
    for (; nearer != 0; nearer &= nearer - 1) {
      const auto i = static_cast<size_t>(__builtin_ctz(nearer));
      if (lanes[i] < s.distance2 && is_visible(s, block->triangle[i]))
        s.distance2 = lanes[i], s.triangle = block->triangle[i];
    }
  }
}

PROMENADE_INLINE Lanes outside(Lanes p, const float* low, const float* high) {
  return upper(upper(load(low) - p, p - load(high)), splat(0));
}

/// Squared distances of a point to a node's boxes.
PROMENADE_INLINE Lanes distances2_to(const BoxTreeNode& node, const Vectors& p) {
  const Lanes dx = outside(p.x, node.min_x, node.max_x), dy = outside(p.y, node.min_y, node.max_y),
              dz = outside(p.z, node.min_z, node.max_z);
  return dx * dx + dy * dy + dz * dz;
}

/// All bits set in one lane: a window of eight onto these that begins eight less its number in.
alignas(32) constexpr uint32_t kOneLane[2 * kLanes + 1] = {0, 0, 0, 0, 0, 0, 0, 0, 0xffffffffU};

/// Depth first, nearest boxes first. What a node has left is not sorted but looked through again on the way back, when
/// the nearest triangle so far nearly always leaves nothing of it.
void search(TreeSearch& s) {
  constexpr size_t kStackSize = 40;  // at most 24 + log8(2^32) levels
  constexpr uint32_t kNone = 0xffffffffU;
  struct alignas(32) Level {
    float distances2[kLanes];  // to the boxes left
    const BoxTreeNode* node;
  };
  Level stack[kStackSize];
  size_t top = 0;
  const Vectors p = splat3(s.point);
  const Lanes infinite = splat(std::numeric_limits<float>::infinity());
  const BoxTreeNode* node = s.nodes;
  Lanes left = distances2_to(*node, p);
  for (;;) {
    const unsigned nearer = bits(less(left, splat(s.distance2)));
    if (nearer == 0) {
      if (top == 0) return;
      --top;
      node = stack[top].node, left = load(stack[top].distances2);
      continue;
    }
    if (s.distance2 <= s.enough_distance2 && s.triangle != kNone) return;
    // Of equally near ones the last.
    const auto lane = 31U - static_cast<unsigned>(__builtin_clz(bits(less_or_equal(left, splat(least(left))))));
    left = selected(load_any(reinterpret_cast<const float*>(kOneLane + kLanes - lane)), infinite, left);
    const uint32_t child = node->child[lane];
    if ((child & BoxTreeNode::kLeafBit) != 0) {
      search_leaf(s.blocks + (child & ~BoxTreeNode::kLeafBit), node->blocks[lane], p, s);
      continue;
    }
    if ((nearer & (nearer - 1)) != 0) store(stack[top].distances2, left), stack[top++].node = node;
    node = s.nodes + child, left = distances2_to(*node, p);
  }
}

constexpr TriangleKernels kKernels = {nearest, distances, distances_of, make_frames, search};
