// Weights by angle do not depend on how a face is divided into triangles. Source: G. Thuermer and C. A. Wuethrich,
// Computing Vertex Normals from Polygonal Facets, 1998.
#include "codec/angle_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace promenade {
namespace {

/// The angles whose tangents are `cross` over each of the dots, 0 to pi. cross: more than 0. Without branches, so that
/// all are computed at once.
std::array<double, 4> angles_of(double cross, const std::array<double, 4>& dots) {
  constexpr double kPi = 3.14159265358979323846;
  std::array<double, 4> angles{};
  for (size_t i = 0; i < dots.size(); ++i) {
    const double size = std::abs(dots[i]);
    const double x = std::min(size, cross) / std::max(size, cross);
    // The arc tangent of 0 to 1, to 0.005. Source: S. Rajan et al., Efficient Approximations for the Arctangent
    // Function, 2006.
    const double angle = x * (0.97239411 - 0.19194795 * x * x);
    const double acute = size >= cross ? angle : kPi / 2 - angle;
    angles[i] = dots[i] < 0 ? kPi - acute : acute;
  }
  return angles;
}

glm::i16vec2 octahedral_of(const glm::dvec3& n) {
  constexpr double kScale = 256;
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(sum > 0)) return {0, 0};
  double x = n.x / sum, y = n.y / sum;
  if (n.z < 0) {
    const double folded_x = (1 - std::abs(y)) * (x >= 0 ? 1 : -1);
    y = (1 - std::abs(x)) * (y >= 0 ? 1 : -1);
    x = folded_x;
  }
  const auto rounded = [](double v) { return static_cast<int16_t>(v * kScale + (v >= 0 ? 0.5 : -0.5)); };
  return {rounded(x), rounded(y)};
}

}  // namespace

std::vector<glm::i16vec2> normals_by_angle(const QuantizedMesh& mesh, const std::vector<uint8_t>& is_wanted) {
  std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0));
  for (size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const uint32_t* v = &mesh.indices[3 * t];
    if ((is_wanted[v[0]] | is_wanted[v[1]] | is_wanted[v[2]]) == 0) continue;
    const glm::dvec3 from(mesh.positions[v[0]]), a = glm::dvec3(mesh.positions[v[1]]) - from,
                                                 b = glm::dvec3(mesh.positions[v[2]]) - from;
    const glm::dvec3 cross = glm::cross(a, b);
    const double length = std::sqrt(glm::dot(cross, cross));
    if (!(length > 0)) continue;
    const glm::dvec3 normal = cross * (1 / length);
    const double a_b = glm::dot(a, b);
    const std::array<double, 4> angles = angles_of(length, {a_b, glm::dot(a, a) - a_b, glm::dot(b, b) - a_b, 0});
    for (size_t c = 0; c < 3; ++c) sums[v[c]] += normal * angles[c];
  }
  std::vector<glm::i16vec2> codes(sums.size());
  for (size_t i = 0; i < sums.size(); ++i)
    if (is_wanted[i] != 0) codes[i] = octahedral_of(sums[i]);
  return codes;
}

}  // namespace promenade
