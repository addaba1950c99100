#include "raster/view.h"

#include <glm/geometric.hpp>

namespace promenade {

RasterView perspective_view(const Camera& camera, const glm::dvec3& model_origin) {
  const Basis basis = basis_of(camera.pose);
  RasterView view;
  view.eye = camera.pose.eye - model_origin;
  view.right = basis.right, view.up = basis.up, view.forward = basis.forward;
  view.width_px = camera.width_px, view.height_px = camera.height_px;
  view.scale_px = pixels_per_radian(camera);
  view.near_m = camera.near_m;
  return view;
}

RasterView cube_face_view(const glm::dvec3& eye, int face, uint32_t side_px, double near_m) {
  RasterView view;
  view.eye = eye;
  view.forward = glm::dvec3(0);
  view.forward[face / 2] = face % 2 == 0 ? 1 : -1;
  view.up = face == 4 ? glm::dvec3(-1, 0, 0) : face == 5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
  view.right = glm::cross(view.forward, view.up);
  view.width_px = side_px, view.height_px = side_px;
  view.scale_px = side_px / 2.0;
  view.near_m = near_m;
  return view;
}

RasterView orthographic_view(const Pose& pose, const glm::dvec3& model_origin, uint32_t width_px, uint32_t height_px,
                             double pixels_per_m, double near_m) {
  const Basis basis = basis_of(pose);
  RasterView view;
  view.eye = pose.eye - model_origin;
  view.right = basis.right, view.up = basis.up, view.forward = basis.forward;
  view.width_px = width_px, view.height_px = height_px;
  view.scale_px = pixels_per_m;
  view.near_m = near_m;
  view.orthographic = true;
  return view;
}

namespace {

glm::dvec3 across(const RasterView& view, double x_px, double y_px) {
  return view.right * ((x_px - view.width_px / 2.0) / view.scale_px) -
         view.up * ((y_px - view.height_px / 2.0) / view.scale_px);
}

}  // namespace

glm::dvec3 ray_direction(const RasterView& view, double x_px, double y_px) {
  return view.orthographic ? view.forward : view.forward + across(view, x_px, y_px);
}

glm::dvec3 ray_origin(const RasterView& view, double x_px, double y_px) {
  return view.orthographic ? view.eye + across(view, x_px, y_px) : view.eye;
}

}  // namespace promenade
