#pragma once
// Lines over a picture: where boxes and view pyramids show in it.

#include <array>
#include <functional>
#include <glm/vec2.hpp>

#include "geometry/box.h"
#include "geometry/camera.h"
#include "raster/view.h"

namespace promenade {

using Line = std::array<glm::vec2, 2>;  ///< pixels from the top left

/// Calls draw for each part of the line from a to b (model space) that lies before the near plane. Perspective only.
void draw_line(const RasterView& view, const glm::dvec3& a, const glm::dvec3& b,
               const std::function<void(const Line&)>& draw);
/// The twelve edges of a box.
void draw_box(const RasterView& view, const Box& box, const std::function<void(const Line&)>& draw);
/// The edges of a camera's view pyramid up to `length_m` ahead, in a model whose zero stands at model_origin.
void draw_pyramid(const RasterView& view, const Camera& camera, const glm::dvec3& model_origin, double length_m,
                  const std::function<void(const Line&)>& draw);

/// The camera that looks down on an eye from `height_m` above and behind it: what lies ahead of the eye is up.
Camera birds_eye(const Camera& camera, double height_m);

/// A colour between blue (0) and red (1): what false colours are made of.
glm::u8vec4 false_color(double share);

}  // namespace promenade
