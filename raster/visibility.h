#pragma once
// The visibility buffer: which triangle of which node is seen at each pixel, and how far away.
//
// A picture is drawn in three steps. The items' boxes are projected and sorted from near to far; the picture is cut
// into regions that one thread each fills, items in that order, skipping what lies outside the region or behind what is
// already there (a farthest depth a tile of 8 x 8 pixels); and what a pixel keeps is the nearest triangle, of equal
// ones the smaller (node, triangle). So the picture depends neither on the number of threads, nor on the order of the
// items, nor on the processor. Vertices are rounded to 1/256 pixel; a pixel belongs to a triangle when its centre does,
// by the top-left rule; no gap and no pixel twice along shared edges.

#include <glm/mat4x4.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/result.h"
#include "raster/prepared_mesh.h"
#include "raster/texture.h"
#include "raster/view.h"

namespace promenade {

/// A mesh in a picture.
struct RasterItem {
  const PreparedMesh* mesh = nullptr;
  uint32_t node = 0;                       ///< what the picture calls it
  const SurfaceTable* surfaces = nullptr;  ///< null: plain white, opaque
  /// Where the mesh stands; unset: as it is. Affine; a mirrored mesh keeps its fronts. One that flattens the mesh to a
  /// plane or a line draws nothing.
  std::optional<glm::dmat4> model_from_mesh;
  /// A fade: the mesh shows at the pixels whose threshold in an ordered 8 x 8 pattern lies in [fade_from, fade_to). A
  /// node with [0, a) and its children with [a, 1) share the picture exactly, each pixel to one side, the same ones in
  /// every frame. All of it: from <= 0, to >= 1.
  float fade_from = 0, fade_to = 1;
  /// Bound on the distance between the mesh's surface and what it stands for, in metres of model space; see close_gaps.
  float error_m = 0;
};

/// Which kernel runs. `best`: the widest that this processor has. Any other falls back to the widest below it.
enum class Simd : uint8_t { best, portable, avx2, avx512 };
Simd supported_simd(Simd wanted);

enum class PixelRule : uint8_t {
  center,  ///< a pixel belongs to the triangle that its centre lies in
  inner,   ///< only pixels wholly within one triangle, at that triangle's farthest depth within the pixel: hiders
  outer,   ///< every pixel that a triangle touches, at its nearest depth within the pixel: what may be hidden
};

struct VisibilityOptions {
  unsigned threads = 0;  ///< 0: one a processor. More threads repeat the set-up of what several regions show
  Simd simd = Simd::best;
  PixelRule rule = PixelRule::center;
  bool cull_hidden = true;  ///< false: draw behind what is there, too; the same picture, to measure what culling saves
  bool cull_back = true;    ///< false: draw every mesh from both sides
  bool one_sided = false;   ///< with cull_back: draw no backs of two-sided materials either
  /// What is seen through (AlphaMode::blend): drawn as a screen door, or left out (for draw_layer).
  bool draw_blended = true;
  /// Closes gaps between items that should meet but for their errors (gaps.h). For pictures that are looked at, not for
  /// what is hidden: a closed pixel shows a triangle that ends beside it.
  bool close_gaps = false;
};

/// What a picture took. Counts of all regions: an item that two regions show counts twice.
struct VisibilityStats {
  uint64_t items = 0, items_in_view = 0, items_drawn = 0, items_hidden = 0;
  uint64_t blocks_drawn = 0, blocks_hidden = 0, blocks_facing_away = 0;
  uint64_t triangles_set_up = 0, triangles_drawn = 0, triangles_clipped = 0;
  uint64_t gaps_closed = 0;  ///< pixels
  double cull_ms = 0, draw_ms = 0;
};

/// A picture of depths and ids; reused from frame to frame. One thread at a time.
class VisibilityBuffer {
 public:
  VisibilityBuffer();
  ~VisibilityBuffer();
  VisibilityBuffer(VisibilityBuffer&&) noexcept;
  VisibilityBuffer& operator=(VisibilityBuffer&&) noexcept;

  /// Draws the items as seen through the view. The items' meshes and surfaces must live until the last question about
  /// this picture. Refuses sizes of 0 or over kMaxPictureSide, a near plane that is not positive and finite
  /// (perspective), numbers that are not finite, and more than 2^32 - 2 triangles.
  Status draw(const RasterView& view, std::span<const RasterItem> items, const VisibilityOptions& options = {});

  /// Draws only what is seen through and lies before `solid` (drawn with draw_blended = false, from the same items,
  /// which gives the view), of that the nearest; with `before`, a layer of the same picture, the nearest of what lies
  /// behind that. Colours: blend_layers of shade.h.
  Status draw_layer(const VisibilityBuffer& solid, const VisibilityBuffer* before, std::span<const RasterItem> items,
                    const VisibilityOptions& options = {});

  /// Whether anything inside a box (model space) may be seen before this picture. False is a proof where the picture
  /// was drawn with PixelRule::inner: whatever the box holds, each ray from the eye meets one of the picture's
  /// triangles first. What lies before the near plane or beside the picture is not seen. True may be a false alarm. Any
  /// number of threads at once.
  bool may_be_seen(const Box& box) const;
  /// The same for a mesh, by its triangles, both sides of them, holes taken for solid.
  bool may_be_seen(const RasterItem& item) const;

  uint32_t width_px() const;
  uint32_t height_px() const;
  const RasterView& view() const;
  const VisibilityStats& stats() const;

  /// Metres along the view axis; infinity where nothing is.
  float depth_m(uint32_t x, uint32_t y) const;
  /// Index into the items of the last draw; kNoTriangle where nothing is.
  uint32_t item(uint32_t x, uint32_t y) const;
  uint32_t node(uint32_t x, uint32_t y) const;  ///< kNoTriangle (index_of(kNoNode)) where nothing is
  uint32_t triangle(uint32_t x, uint32_t y) const;

  /// The whole picture, rows from the top. Each span must hold width x height.
  void read_depth_m(std::span<float> out) const;
  void read_nodes(std::span<uint32_t> out) const;
  void read_triangles(std::span<uint32_t> out) const;

  struct State;
  const State& state() const { return *state_; }

 private:
  Status draw_over(const RasterView& view, const State* solid, const State* before, std::span<const RasterItem> items,
                   const VisibilityOptions& options);
  std::unique_ptr<State> state_;
};

}  // namespace promenade
