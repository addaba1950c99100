#pragma once
// What the compiled-three-times kernels and the rest of the room share: plain data only, no inline functions, so that
// no code built for one processor can end up in another's path.

#include <cstdint>

namespace promenade::raster_kernel {

constexpr int32_t kSubpixel = 256;  ///< steps a pixel; vertices are rounded to them
constexpr int32_t kTile = 8;        ///< a tile is 8 x 8 pixels: four blocks of 4 x 4, each row by row
constexpr int32_t kTilePixels = 64;
constexpr int32_t kBlockVertices = 64;  ///< a block of triangles uses at most so many: a table of four registers
constexpr int32_t kBlockTriangles = 128;
constexpr int32_t kLanePadding = 16;  ///< arrays of a block start at, and are filled up to, multiples of this
constexpr uint32_t kNoSurface = 0xffffffffU;
constexpr uint32_t kMaxMipLevels = 16;

/// probe: as outer, but nothing is written; whether a pixel would be is noted (Region::found).
enum class Coverage : uint8_t { center, inner, outer, probe };

enum BlockFlag : uint8_t {
  block_two_sided = 1,
  block_masked = 2,   ///< some of its surface is not there: textures with holes, or seen through
  block_blended = 4,  ///< seen through
};

/// Up to 64 vertices and 128 triangles that lie close together and face alike.
struct Block {
  float box_center[3];
  float box_half[3];
  float cone_axis[3];
  float cone_sin;  ///< sine of the half angle of the normals about the axis; > 1: no use
  uint32_t first_vertex;
  uint32_t first_triangle;
  uint16_t vertex_count;
  uint16_t triangle_count;
  uint8_t flags;
};

/// A picture and its mip levels. A texel holds the square roots of linear red, green and blue in ten bits each, red
/// lowest: finer than sRGB's eight, and made linear by one multiplication. Opacity, a byte a texel, apart. A row has
/// one texel more than the picture is wide, the first again: two neighbours are always one read.
struct Texture {
  const int32_t* texels;
  const uint8_t* opacity;  ///< null: opaque
  uint32_t level_offset[kMaxMipLevels];
  float level_width[kMaxMipLevels], level_height[kMaxMipLevels];  ///< texels
  uint32_t width, height, levels;
};

struct Surface {
  const Texture* texture;  ///< null: plain
  float color[4];          ///< linear
  uint8_t wrap_u, wrap_v;  ///< promenade::Wrap
  uint8_t alpha;           ///< promenade::AlphaMode
  float alpha_cutoff;      ///< [0, 1]
};

/// Whole numbers of two or of four bytes: at most one of the two is there.
struct Numbers {
  const uint16_t* narrow;
  const uint32_t* wide;
};

/// A vertex's normal as a point of an octahedron unfolded to a square, sixteen bits a side, x lowest; this one is none.
constexpr uint32_t kNoNormal = 0x80008000U;
constexpr int32_t kNormalScale = 32767;

/// One mesh in one place.
struct Item {
  const Block* blocks;
  const float *x, *y, *z;
  const uint8_t* corners[3];
  Numbers triangle_of;  ///< number in the mesh as given
  uint32_t block_count;
  uint32_t first_id;  ///< id of the mesh's triangle 0

  // Attributes by the mesh's own numbering; shading and holes only.
  const uint32_t* vertices;  ///< records of vertex_words, or null; first the place of its position in x, y and z
  uint32_t vertex_words;
  uint32_t normal_at, color_at, texcoord_at;  ///< words into a record: packed normal, RGBA8, two floats; 0: none
  Numbers indices;                            ///< three a triangle, of records
  Numbers materials;                          ///< or none
  const Surface* surfaces;
  uint32_t surface_count;

  // view = rows x (p - eye); x and y are in sub-pixels a metre (perspective: a unit of slope), y downwards, w in
  // metres.
  float rows[3][3];
  float eye_hi[3], eye_lo[3];
  double exact_rows[3][3], exact_eye[3];  ///< the same, for triangles that are cut
  float axis[3];                          ///< view axis in the mesh's frame; orthographic facing only
  float model_rows[3][4];                 ///< model space from the mesh's; shading only
  float normal_rows[3][3];                ///< model space's normals from the mesh's
  float fade_from, fade_to;               ///< drawn where the threshold of the 8 x 8 pattern lies in [from, to)
  bool fading;                            ///< that is not everywhere
  bool placed;                            ///< model_rows is not the identity
  bool mirrored;
  float error_m;  ///< how far off its surface may be; gaps only
};

/// Where an item's box lies in the picture.
struct BoxPicture {
  float nearest_z;         ///< no pixel of it is nearer
  int32_t x0, y0, x1, y1;  ///< pixels, inclusive, not clamped to the picture
  bool culled;
  bool needs_clip;
};

struct Frame {
  float* z;
  uint32_t* id;
  int32_t width, height, tiles_x, tiles_y;
  int32_t axis_x, axis_y;  ///< sub-pixels: where the view axis meets the picture
  float guard_x, guard_y;  ///< sub-pixels from the axis: vertices beyond are clipped
  float near_m;
  float clear_z;
  bool orthographic;
  bool cull_hidden;
  bool cull_back;     ///< false: every mesh is drawn from both sides
  bool one_sided;     ///< culls the backs of two-sided blocks, too
  bool draw_solid;    ///< what is not seen through
  bool draw_blended;  ///< what is
  bool screen_door;   ///< what is seen through takes its share of the pixels; otherwise all of them: a layer

  // Layers of what is seen through: only what lies behind this picture, nothing where it has no id; null: no matter
  // where.
  const float* before_z;
  const uint32_t* before_id;
};

struct Counts {
  uint64_t items_drawn, items_hidden, blocks_drawn, blocks_hidden, blocks_facing_away, triangles_set_up,
      triangles_drawn, triangles_clipped;
};

/// A part of the picture that one thread owns, in tiles; hz and dirty have a row of `stride` a tile row.
struct Region {
  int32_t tx0, ty0, tx1, ty1;
  int32_t stride;
  float* hz;  ///< farthest depth of each tile, or farther
  uint8_t* dirty;
  bool read_only;  ///< probe: several threads may ask at once
  bool found;      ///< probe: something may be seen
  Counts counts;
};

/// What shading needs besides the picture. Colours are linear.
struct Shading {
  const Item* items;
  const uint32_t* item_of_run;
  uint32_t run_bits;
  float rows[3][3];  ///< as Item's, for model space
  float eye_hi[3], eye_lo[3];
  const float* linear_of_srgb;  ///< 256
  float to_sun[3], sun[3], sky[3], ground[3];
  float ray_axis[3], ray_x[3], ray_y[3];  ///< view ray: axis + x ray_x + y ray_y, x and y in sub-pixels from the axis
  float zenith[3], horizon[3], below[3];
  uint32_t plain;  ///< RGBA8 where nothing is, unless has_sky
  bool has_sky;
  bool has_textures;
  bool orthographic;
  float anisotropy;  ///< most samples along a texture's footprint, >= 1
  uint32_t* out;     ///< RGBA8, rows of the picture's width
};

/// A layer of what is seen through, over a picture.
struct Layer {
  const float* z;
  const uint32_t* id;
};

/// Layers, the nearest first, where the tiles from tx0 to tx1 - 1 of a row may show something of them.
struct Layers {
  const Layer* layers;
  int32_t count;
  int32_t tx0, tx1;
};

constexpr int32_t kSmoothRows = 10, kSmoothPadding = 48;
constexpr int32_t kSmoothChunk = 16;  ///< pixels that are looked at together, whatever the processor

constexpr int32_t kMostTilesAcross = 2048;  ///< kMaxPictureSide / kTile
constexpr int32_t kStrengths = 256;

/// A pixel of the picture and the colour that it is to get.
struct Smoothed {
  uint32_t at, color;
};

/// Edges of the picture `in` smoothed; RGBA8, rows of the picture's width. In two passes: how much each pixel differs
/// from its neighbours, then those that differ enough. Their colours come last: neighbours want the ones that were.
struct Smoothing {
  const uint32_t* in;
  Smoothed* smoothed;        ///< smoothing only: room for those of the row whose strength is large enough
  int32_t* room;             ///< for kSmoothRows rows of `stride`, a thread's own
  uint8_t* strength;         ///< rows of `stride`: largest difference of a channel from a neighbour across an edge
  uint32_t* counts;          ///< kStrengths a row of tiles: pixels of each strength above 0
  int32_t stride;            ///< at least the picture's width and kSmoothPadding
  int32_t least_difference;  ///< finding: lesser strengths count as 0; smoothing: strength of the pixels to be smoothed
};

constexpr int32_t kGapReach = 2;          ///< pixels from a gap's to those that lie beside it
constexpr float kGapNearer = 65.0F / 64;  ///< what lies beside a gap is nearer than what is seen through it by so much

/// What a tile of 8 x 8 pixels shows.
struct GapTile {
  uint32_t lowest, highest;  ///< items; kNoSurface and 0: none
  float farthest_z, nearest_z;
};

/// Room to look for gaps in, a row of tiles at a time, and what was found.
struct GapRoom {
  const uint32_t* item_of_run;  ///< as Shading's
  uint32_t run_bits;
  GapTile* tiles;   ///< of the whole picture
  float* depths;    ///< kTile + 2 kGapReach rows of `stride`
  int32_t stride;   ///< at least the picture's width and 3 kLanePadding
  uint32_t* found;  ///< room for all pixels of the row: y << 16 | x
  uint32_t count;
};

/// One processor's kernels.
struct Kernels {
  int lanes;
  BoxPicture (*project_box)(const Frame&, const Item&, const float* center, const float* half);
  void (*clear)(const Frame&, Region&);
  void (*draw)(const Frame&, const Item&, const BoxPicture& item_box, Region&, Coverage);
  void (*shade)(const Frame&, const Shading&, int32_t tile_row);
  /// Blends layers, the nearest first, over the picture that shade left; nothing is seen through beside those tiles.
  void (*shade_layers)(const Frame&, const Shading&, const Layers&, int32_t tile_row);
  void (*find_edges)(const Frame&, const Smoothing&, int32_t tile_row);
  void (*smooth)(const Frame&, const Shading&, const Smoothing&, int32_t tile_row);
  /// What the tiles of a row show.
  void (*find_items)(const Frame&, const GapRoom&, int32_t tile_row);
  /// After find_items for all rows.
  void (*find_gaps)(const Frame&, GapRoom&, int32_t tile_row);
};

const Kernels& portable_kernels();
const Kernels& avx2_kernels();
const Kernels& avx512_kernels();

}  // namespace promenade::raster_kernel
