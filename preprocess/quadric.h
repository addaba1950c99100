#pragma once
// The sum of squared distances to planes, as a function of position. Source: Garland and Heckbert, "Surface
// simplification using quadric error metrics", 1997.

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

namespace promenade {

/// Weighted squared distances to a set of planes, and the weights' sum.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  double x = 0, y = 0, z = 0;
  double constant = 0;
  double weight = 0;

  /// The plane through `p` with unit normal n.
  void add_plane(const glm::dvec3& n, const glm::dvec3& p, double w) {
    const double d = -(n.x * p.x + n.y * p.y + n.z * p.z);
    xx += w * n.x * n.x, xy += w * n.x * n.y, xz += w * n.x * n.z;
    yy += w * n.y * n.y, yz += w * n.y * n.z, zz += w * n.z * n.z;
    x += w * n.x * d, y += w * n.y * d, z += w * n.z * d;
    constant += w * d * d;
    weight += w;
  }

  void add(const Quadric& q) {
    xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
    x += q.x, y += q.y, z += q.z, constant += q.constant, weight += q.weight;
  }

  /// Weighted sum of squared distances at p.
  double at(const glm::dvec3& p) const {
    const double value = p.x * (xx * p.x + 2 * (xy * p.y + xz * p.z + x)) + p.y * (yy * p.y + 2 * (yz * p.z + y)) +
                         p.z * (zz * p.z + 2 * z) + constant;
    return std::max(value, 0.0);
  }
};

}  // namespace promenade
