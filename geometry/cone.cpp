#include "geometry/cone.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace promenade {

NormalCone normal_cone(const Mesh& mesh) {
  glm::dvec3 sum(0);
  for (size_t t = 0; t < mesh.triangle_count(); ++t) sum += glm::dvec3(triangle_cross(mesh, t));
  const double length = glm::length(sum);
  if (length <= 0) return {};
  NormalCone cone{glm::vec3(sum / length), 1};
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::vec3 cross = triangle_cross(mesh, t);
    const float size = glm::length(cross);
    if (size > 0) cone.cos_angle = std::min(cone.cos_angle, glm::dot(cross / size, cone.axis));
  }
  // A little wider than computed, so that rounding never makes it too narrow.
  cone.cos_angle = std::max(-1.0F, cone.cos_angle - 1e-5F);
  return cone;
}

NormalCone merged(const NormalCone& a, const NormalCone& b) {
  if (a.cos_angle <= -1 || b.cos_angle <= -1) return {a.axis, -1};
  const double pi = std::acos(-1.0);
  const double angle_a = std::acos(std::clamp(double(a.cos_angle), -1.0, 1.0));
  const double angle_b = std::acos(std::clamp(double(b.cos_angle), -1.0, 1.0));
  const double between = std::acos(std::clamp(glm::dot(glm::dvec3(a.axis), glm::dvec3(b.axis)), -1.0, 1.0));
  if (between + angle_b <= angle_a) return a;
  if (between + angle_a <= angle_b) return b;
  const double half = (between + angle_a + angle_b) / 2;
  const double sine = std::sin(between);
  if (half >= pi || sine < 1e-6) return {a.axis, -1};
  const double t = (half - angle_a) / between;  // slerp from a towards b
  const glm::dvec3 axis =
      (std::sin((1 - t) * between) * glm::dvec3(a.axis) + std::sin(t * between) * glm::dvec3(b.axis)) / sine;
  return {glm::vec3(glm::normalize(axis)), std::max(-1.0F, static_cast<float>(std::cos(half)) - 1e-5F)};
}

bool faces_away(const NormalCone& cone, const Box& box, const glm::vec3& eye) {
  if (cone.cos_angle <= 0) return false;  // wider than a half-space: some triangle may face any eye
  // Back-facing for every point p and normal n: dot(n, p - eye) >= 0. The box as a ball gives a cone of directions
  // around centre - eye; every normal is within acos(cos_angle) of the axis.
  const glm::vec3 to_center = box.center() - eye;
  const float distance = glm::length(to_center), radius = 0.5F * box.diagonal();
  if (distance <= radius) return false;
  const float sin_cone = std::sqrt(std::max(0.0F, 1 - cone.cos_angle * cone.cos_angle));
  const float sin_ball = radius / distance, cos_ball = std::sqrt(std::max(0.0F, 1 - sin_ball * sin_ball));
  const float cos_between = glm::dot(cone.axis, to_center) / distance;
  // angle between + cone + ball <= 90 degrees, as cos(between) >= cos(90 - cone - ball) = sin(cone + ball)
  const float cos_sum = cone.cos_angle * cos_ball - sin_cone * sin_ball;
  return cos_sum > 0 && cos_between > sin_cone * cos_ball + cone.cos_angle * sin_ball + 1e-5F;
}

}  // namespace promenade
