#pragma once
// What a picture is taken through: a pinhole, one face of a cube of pinholes, or parallel rays.

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "geometry/camera.h"

namespace promenade {

/// Largest width and height of a picture, in pixels.
constexpr uint32_t kMaxPictureSide = 16384;

/// A view into model space (world minus the model's origin), metres. The axis meets the picture at its centre; the
/// centre of pixel (column, row) lies at (column + 0.5, row + 0.5), row 0 at the top.
struct RasterView {
  glm::dvec3 eye{0};
  glm::dvec3 right{1, 0, 0}, up{0, 0, 1}, forward{0, 1, 0};  ///< unit, at right angles
  uint32_t width_px = 0;
  uint32_t height_px = 0;
  /// Perspective: pixels a unit of slope (the distance of the picture plane in pixels). Orthographic: pixels a metre.
  double scale_px = 1;
  double near_m = 0.1;  ///< what is nearer along `forward` is cut off; > 0 in perspective
  bool orthographic = false;
};

RasterView perspective_view(const Camera& camera, const glm::dvec3& model_origin);

/// A face of a cube about the eye: 0 to 5 look along +x, -x, +y, -y, +z, -z; 90 degrees wide and high. The sides have z
/// up; +z has -x up, -z has +x up.
RasterView cube_face_view(const glm::dvec3& eye, int face, uint32_t side_px, double near_m);

/// Parallel rays along the pose's view axis; what lies at least near_m in front of the eye is seen.
RasterView orthographic_view(const Pose& pose, const glm::dvec3& model_origin, uint32_t width_px, uint32_t height_px,
                             double pixels_per_m, double near_m);

/// Direction (perspective; forward component 1) of the ray through a point of the picture, in pixels from its top left.
glm::dvec3 ray_direction(const RasterView& view, double x_px, double y_px);
/// Where that ray starts: the eye, or (orthographic) the point of the eye's plane.
glm::dvec3 ray_origin(const RasterView& view, double x_px, double y_px);

}  // namespace promenade
