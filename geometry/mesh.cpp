#include "geometry/mesh.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace promenade {

Box bounds(const Mesh& mesh) {
  Box box;
  for (const glm::vec3& p : mesh.positions) box.add(p);
  return box;
}

uint64_t byte_size(const Mesh& mesh) {
  return mesh.positions.size() * sizeof(glm::vec3) + mesh.normals.size() * sizeof(glm::vec3) +
         mesh.texcoords.size() * sizeof(glm::vec2) + mesh.colors.size() * sizeof(glm::u8vec4) +
         (mesh.indices.size() + mesh.materials.size()) * sizeof(uint32_t);
}

namespace {

template <class V>
bool finite(const V& v) {
  for (int i = 0; i < V::length(); ++i)
    if (!std::isfinite(v[i])) return false;
  return true;
}

template <class V>
std::string find_non_finite(const std::vector<V>& values, const char* what) {
  for (size_t i = 0; i < values.size(); ++i)
    if (!finite(values[i])) return fmt::format("{} {} is not finite", what, i);
  return {};
}

template <class V>
void append_attribute(std::vector<V>& a, size_t a_count, const std::vector<V>& b, size_t b_count, const V& fill) {
  if (a.empty() && b.empty()) return;
  a.resize(a_count, fill);
  if (b.empty())
    a.resize(a_count + b_count, fill);
  else
    a.insert(a.end(), b.begin(), b.end());
}

}  // namespace

std::string find_defect(const Mesh& mesh) {
  const size_t v = mesh.positions.size();
  if (!mesh.normals.empty() && mesh.normals.size() != v)
    return fmt::format("{} normals for {} vertices", mesh.normals.size(), v);
  if (!mesh.texcoords.empty() && mesh.texcoords.size() != v)
    return fmt::format("{} texture coordinates for {} vertices", mesh.texcoords.size(), v);
  if (!mesh.colors.empty() && mesh.colors.size() != v)
    return fmt::format("{} colours for {} vertices", mesh.colors.size(), v);
  if (mesh.indices.size() % 3 != 0)
    return fmt::format("{} indices are no whole number of triangles", mesh.indices.size());
  if (!mesh.materials.empty() && mesh.materials.size() != mesh.triangle_count())
    return fmt::format("{} materials for {} triangles", mesh.materials.size(), mesh.triangle_count());
  for (size_t i = 0; i < mesh.indices.size(); ++i)
    if (mesh.indices[i] >= v) return fmt::format("index {} is {}, but there are {} vertices", i, mesh.indices[i], v);
  for (std::string defect : {find_non_finite(mesh.positions, "position"), find_non_finite(mesh.normals, "normal"),
                             find_non_finite(mesh.texcoords, "texture coordinate")})
    if (!defect.empty()) return defect;
  return {};
}

void append(Mesh& a, const Mesh& b) {
  if (b.positions.empty()) return;
  if (a.positions.empty()) {
    a = b;
    return;
  }
  const size_t a_vertices = a.vertex_count();
  const size_t a_triangles = a.triangle_count();
  const auto base = static_cast<uint32_t>(a_vertices);
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  append_attribute(a.normals, a_vertices, b.normals, b.vertex_count(), glm::vec3(0));
  append_attribute(a.texcoords, a_vertices, b.texcoords, b.vertex_count(), glm::vec2(0));
  append_attribute(a.colors, a_vertices, b.colors, b.vertex_count(), glm::u8vec4(255));
  append_attribute(a.materials, a_triangles, b.materials, b.triangle_count(), 0U);
  const size_t first = a.indices.size();
  a.indices.insert(a.indices.end(), b.indices.begin(), b.indices.end());
  for (size_t i = first; i < a.indices.size(); ++i) a.indices[i] += base;
}

Mesh transformed(const Mesh& mesh, const glm::dmat4& to_from_mesh) {
  Mesh out = mesh;
  const glm::dmat3 linear(to_from_mesh);
  const double determinant = glm::determinant(linear);
  for (glm::vec3& p : out.positions) p = glm::vec3(glm::dvec3(to_from_mesh * glm::dvec4(glm::dvec3(p), 1.0)));
  if (!out.normals.empty()) {
    // The cofactor matrix is det * inverse transpose and exists for singular transforms too.
    const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                              glm::cross(linear[0], linear[1]));
    const double sign = determinant < 0 ? -1.0 : 1.0;
    for (glm::vec3& n : out.normals) {
      const glm::dvec3 turned = sign * (cofactor * glm::dvec3(n));
      const double length = glm::length(turned);
      n = length > 0 ? glm::vec3(turned / length) : glm::vec3(0);
    }
  }
  if (determinant < 0)
    for (size_t i = 0; i + 2 < out.indices.size(); i += 3) std::swap(out.indices[i + 1], out.indices[i + 2]);
  return out;
}

Mesh submesh(const Mesh& mesh, const std::vector<uint32_t>& triangles) {
  constexpr uint32_t kUnused = 0xffffffffU;
  std::vector<uint32_t> renamed(mesh.vertex_count(), kUnused);
  Mesh out;
  out.indices.reserve(triangles.size() * 3);
  for (const uint32_t t : triangles) {
    for (size_t corner = 0; corner < 3; ++corner) {
      const uint32_t v = mesh.indices[size_t(t) * 3 + corner];
      if (renamed[v] == kUnused) {
        renamed[v] = static_cast<uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[v]);
        if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[v]);
        if (!mesh.texcoords.empty()) out.texcoords.push_back(mesh.texcoords[v]);
        if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[v]);
      }
      out.indices.push_back(renamed[v]);
    }
    if (!mesh.materials.empty()) out.materials.push_back(mesh.materials[t]);
  }
  return out;
}

glm::vec3 triangle_cross(const Mesh& mesh, size_t triangle) {
  const glm::vec3& a = mesh.positions[mesh.indices[3 * triangle]];
  const glm::vec3& b = mesh.positions[mesh.indices[3 * triangle + 1]];
  const glm::vec3& c = mesh.positions[mesh.indices[3 * triangle + 2]];
  return glm::cross(b - a, c - a);
}

double surface_area_m2(const Mesh& mesh) {
  double area = 0;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) area += 0.5 * double(glm::length(triangle_cross(mesh, t)));
  return area;
}

float srgb_to_linear(uint8_t value) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (size_t i = 0; i < t.size(); ++i) {
      const double s = double(i) / 255.0;
      t[i] = static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return table[value];
}

namespace {

/// Bytes of linear light by thresholds: the first float that has each, as the powers tell, which are far slower.
class SrgbBytes {
 public:
  SrgbBytes() {
    uint32_t from = 0;  // bits of floats that are not negative sort as they do
    for (uint32_t byte = 1; byte <= 255; ++byte) {
      uint32_t until = std::bit_cast<uint32_t>(1.0F);
      while (from < until) {
        const uint32_t middle = from + (until - from) / 2;
        if (by_powers(std::bit_cast<float>(middle)) >= byte)
          until = middle;
        else
          from = middle + 1;
      }
      first_light_[byte] = std::bit_cast<float>(from);
    }
    uint32_t byte = 0;
    for (uint32_t i = 0; i < kSlots; ++i) {
      while (byte < 255 && first_light_[byte + 1] <= float(i) / float(kSlots)) ++byte;
      at_slot_[i] = static_cast<uint8_t>(byte);
    }
  }

  uint8_t of(float value) const {
    const float light = value > 0 ? std::min(value, 1.0F) : 0.0F;  // not a number: 0
    uint32_t byte = at_slot_[std::min(static_cast<uint32_t>(light * float(kSlots)), kSlots - 1)];
    while (byte < 255 && light >= first_light_[byte + 1]) ++byte;
    return static_cast<uint8_t>(byte);
  }

 private:
  static uint32_t by_powers(float light) {
    const auto v = double(light);
    const double s = v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
    return static_cast<uint32_t>(std::lround(s * 255.0));
  }

  static constexpr uint32_t kSlots = 4096;  // the steepest part has a byte every 1.2 slots
  std::array<float, 256> first_light_{};
  std::array<uint8_t, kSlots> at_slot_{};
};

}  // namespace

uint8_t linear_to_srgb(float value) {
  static const SrgbBytes bytes;
  return bytes.of(value);
}

}  // namespace promenade
