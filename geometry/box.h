#pragma once
// Axis-aligned boxes.

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace promenade {

/// A closed axis-aligned box; empty (min > max) until something is added.
template <class T>
struct BasicBox {
  using Vec = glm::vec<3, T>;
  Vec min{std::numeric_limits<T>::max()};
  Vec max{std::numeric_limits<T>::lowest()};

  bool empty() const { return min.x > max.x || min.y > max.y || min.z > max.z; }
  void add(const Vec& p) { min = glm::min(min, p), max = glm::max(max, p); }
  void add(const BasicBox& b) { min = glm::min(min, b.min), max = glm::max(max, b.max); }
  Vec center() const { return (min + max) * T(0.5); }
  Vec size() const { return max - min; }
  T diagonal() const { return empty() ? T(0) : glm::length(max - min); }
  bool contains(const Vec& p) const {
    return glm::all(glm::lessThanEqual(min, p)) && glm::all(glm::lessThanEqual(p, max));
  }
  bool contains(const BasicBox& b) const { return contains(b.min) && contains(b.max); }
  bool overlaps(const BasicBox& b) const {
    return glm::all(glm::lessThanEqual(min, b.max)) && glm::all(glm::lessThanEqual(b.min, max));
  }
  /// Smallest distance from p to the box; 0 inside.
  T distance(const Vec& p) const { return glm::length(glm::max(glm::max(min - p, p - max), Vec(0))); }
  BasicBox grown(T by) const { return {min - Vec(by), max + Vec(by)}; }
  /// 0, 1 or 2: the axis along which the box is longest.
  int longest_axis() const {
    const Vec s = size();
    return s.x >= s.y && s.x >= s.z ? 0 : s.y >= s.z ? 1 : 2;
  }
  bool operator==(const BasicBox&) const = default;
};

using Box = BasicBox<float>;
using DBox = BasicBox<double>;

}  // namespace promenade
