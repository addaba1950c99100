// Source: [funkhouser1993] section 4.3 and [chhugani2003] section 6 measure against samples of the cell in this way.

#include "preprocess/visibility/hiders/sampled.h"

#include <algorithm>

namespace promenade {
namespace {

constexpr double kNearM = 0.02;  // closer than anybody's nose to a wall

class SampledHider : public Hider {
 public:
  SampledHider(const NodeMeshes& meshes, const SampledOptions& options) : meshes_(meshes), options_(options) {}

  std::string_view name() const override { return "sampled"; }
  bool is_conservative() const override { return false; }

  Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const override {
    const Result<HeldNodes> held = hold_nodes(meshes_, question.front);
    if (!held) return held.error();
    std::vector<uint8_t> seen(question.front.size(), 0);
    VisibilityBuffer buffer;
    const uint32_t n = std::max(options_.points_a_side, 1U);
    const glm::dvec3 low(question.cell.min), size(question.cell.size());
    const auto share = [n](uint32_t i) { return n == 1 ? 0.5 : double(i) / double(n - 1); };
    for (uint32_t z = 0; z < n; ++z)
      for (uint32_t y = 0; y < n; ++y)
        for (uint32_t x = 0; x < n; ++x) {
          const glm::dvec3 eye = low + size * glm::dvec3(share(x), share(y), share(z));
          PROMENADE_TRY(look_around(eye, held->items, options_.picture_px, buffer, seen));
        }
    const Model& model = meshes_.model().model();
    for (size_t i = 0; i < seen.size(); ++i)
      if (seen[i] == 0 && !model.is_moving(question.front[i])) hidden[i] = 1;  // samples know one time only
    return Done{};
  }

 private:
  const NodeMeshes& meshes_;
  SampledOptions options_;
};

}  // namespace

Status look_around(const glm::dvec3& eye, std::span<const RasterItem> items, uint32_t picture_px,
                   VisibilityBuffer& buffer, std::span<uint8_t> seen) {
  VisibilityOptions options;
  options.threads = 1;  // cells are what runs at once
  for (int face = 0; face < 6; ++face) {
    PROMENADE_TRY(buffer.draw(cube_face_view(eye, face, picture_px, kNearM), items, options));
    for (uint32_t y = 0; y < picture_px; ++y)
      for (uint32_t x = 0; x < picture_px; ++x)
        if (const uint32_t item = buffer.item(x, y); item != kNoTriangle) seen[item] = 1;
  }
  return Done{};
}

std::unique_ptr<Hider> make_sampled_hider(const NodeMeshes& meshes, const SampledOptions& options) {
  return std::make_unique<SampledHider>(meshes, options);
}

}  // namespace promenade
