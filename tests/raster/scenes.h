#pragma once
// Scenes for the rasteriser's tests, named by their situation; deterministic.

#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <string>
#include <vector>

#include "raster/visibility.h"

namespace promenade::test_scenes {

/// A small generator of our own: the same numbers on every machine.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15ULL + 1) {}
  uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15ULL;
    uint64_t z = (state_ ^ (state_ >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  double unit() { return double(bits() >> 11) * 0x1p-53; }
  double within(double low, double high) { return low + (high - low) * unit(); }
  uint32_t below(uint32_t n) { return static_cast<uint32_t>(bits() % n); }
  glm::vec3 point(double half) {
    return {float(within(-half, half)), float(within(-half, half)), float(within(-half, half))};
  }

 private:
  uint64_t state_;
};

/// Meshes with what must outlive a picture of them.
struct Scene {
  std::vector<Material> materials = std::vector<Material>(1);
  std::vector<Mesh> meshes;
  std::vector<PreparedMesh> prepared;
  std::vector<MipTexture> textures;
  std::unique_ptr<SurfaceTable> surfaces;
  std::vector<RasterItem> items;

  void finish() {
    std::vector<const MipTexture*> pointers;
    for (const MipTexture& t : textures) pointers.push_back(&t);
    surfaces = std::make_unique<SurfaceTable>(materials, pointers);
    for (const Mesh& m : meshes) prepared.push_back(*prepare(m, materials));
    for (uint32_t i = 0; i < prepared.size(); ++i) items.push_back({&prepared[i], i, surfaces.get(), {}});
  }
};

inline void add_triangle(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2});
}

inline void add_box(Mesh& mesh, const glm::vec3& low, const glm::vec3& high) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (uint32_t k = 0; k < 8; ++k)
    mesh.positions.emplace_back(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
  for (const uint32_t i : {0U, 2U, 3U, 0U, 3U, 1U, 4U, 5U, 7U, 4U, 7U, 6U, 0U, 1U, 5U, 0U, 5U, 4U,
                           2U, 6U, 7U, 2U, 7U, 3U, 0U, 4U, 6U, 0U, 6U, 2U, 1U, 3U, 7U, 1U, 7U, 5U})
    mesh.indices.push_back(first + i);
}

/// A bumpy sphere: closed, smooth, thousands of small triangles.
inline Mesh bumpy_sphere(const glm::vec3& center, float radius, uint32_t rings, uint64_t seed) {
  Mesh mesh;
  Random random(seed);
  const uint32_t columns = rings * 2;
  for (uint32_t r = 0; r <= rings; ++r) {
    for (uint32_t c = 0; c < columns; ++c) {
      const double a = M_PI * r / rings, b = 2 * M_PI * c / columns;
      const double d = r == 0 || r == rings ? 1 : random.within(0.97, 1.03);
      const glm::dvec3 n(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
      mesh.positions.push_back(center + glm::vec3(n * d) * radius);
      mesh.texcoords.emplace_back(float(c) / float(columns) * 4, float(r) / float(rings) * 2);
      mesh.normals.push_back(glm::vec3(n));
    }
  }
  for (uint32_t r = 0; r < rings; ++r)
    for (uint32_t c = 0; c < columns; ++c) {
      const uint32_t p = r * columns + c, q = r * columns + (c + 1) % columns;
      for (const uint32_t i : {p, p + columns, q + columns, p, q + columns, q}) mesh.indices.push_back(i);
    }
  return mesh;
}

/// Unconnected triangles of all sizes about the origin; about one in ten is needle-thin, one in twenty a point or a
/// line.
inline Mesh triangle_soup(uint32_t count, double half, uint64_t seed) {
  Mesh mesh;
  Random random(seed);
  for (uint32_t i = 0; i < count; ++i) {
    const glm::vec3 a = random.point(half);
    const double size = half * std::pow(10.0, random.within(-3, 0.3));
    glm::vec3 b = a + random.point(size), c = a + random.point(size);
    const uint32_t kind = random.below(20);
    if (kind < 2) c = b + random.point(size * 1e-4);
    if (kind == 2) c = random.below(2) == 0 ? b : a + (b - a) * 0.5F;
    add_triangle(mesh, a, b, c);
  }
  return mesh;
}

/// Soups, spheres and boxes mixed: ordinary and two-sided.
inline Scene mixed_scene(uint64_t seed, bool two_sided) {
  Scene scene;
  scene.materials[0].two_sided = two_sided;
  Random random(seed);
  for (uint32_t i = 0; i < 6; ++i)
    scene.meshes.push_back(
        bumpy_sphere(random.point(8), float(random.within(0.3, 2)), 6 + random.below(40), random.bits()));
  for (uint32_t i = 0; i < 4; ++i) scene.meshes.push_back(triangle_soup(200, 6, random.bits()));
  Mesh boxes;
  for (uint32_t i = 0; i < 60; ++i) {
    const glm::vec3 low = random.point(9);
    add_box(boxes, low, low + glm::vec3(0.1F) + glm::abs(random.point(1.5)));
  }
  scene.meshes.push_back(boxes);
  scene.finish();
  return scene;
}

/// Triangles far larger than the picture, through the eye, behind it, and specks.
inline Scene hostile_scene(uint64_t seed) {
  Scene scene;
  scene.materials[0].two_sided = true;
  Random random(seed);
  Mesh huge;
  for (uint32_t i = 0; i < 40; ++i)
    add_triangle(huge, random.point(random.below(4) == 0 ? 1e7 : 300), random.point(300),
                 random.point(i % 3 == 0 ? 5 : 3000));
  scene.meshes.push_back(huge);
  Mesh specks;
  for (uint32_t i = 0; i < 400; ++i) {
    const glm::vec3 a = random.point(20);
    add_triangle(specks, a, a + random.point(1e-5), a + random.point(1e-5));
  }
  scene.meshes.push_back(specks);
  Mesh around_the_eye;
  for (uint32_t i = 0; i < 100; ++i)
    add_triangle(around_the_eye, random.point(0.3), random.point(0.3), random.point(2));
  scene.meshes.push_back(around_the_eye);
  scene.meshes.push_back(triangle_soup(300, 20, random.bits()));
  scene.finish();
  return scene;
}

/// Looks along +y from the origin; a square of side 4 at y = 4 fills the picture.
inline Camera along_y(uint32_t side_px) {
  Camera camera;
  camera.pose.yaw_deg = 90;
  camera.width_px = camera.height_px = side_px;
  camera.vertical_fov_deg = 2 * std::atan(0.5) * 180 / M_PI;
  return camera;
}

inline Camera random_camera(Random& random, double half, uint32_t width, uint32_t height) {
  Camera camera;
  camera.pose.eye = random.point(half);
  camera.pose.yaw_deg = random.within(-180, 180);
  camera.pose.pitch_deg = random.within(-80, 80);
  camera.pose.roll_deg = random.within(-30, 30);
  camera.width_px = width, camera.height_px = height;
  camera.vertical_fov_deg = random.within(20, 100);
  camera.near_m = 0.05;
  return camera;
}

/// A scene with holes: a quad of a chequered, half transparent texture before a wall.
inline Image chequers(uint32_t side, uint32_t squares) {
  Image image;
  image.width = image.height = side;
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) {
      const bool solid = ((x * squares / side) + (y * squares / side)) % 2 == 0;
      image.pixels.emplace_back(solid ? glm::u8vec4(250, 30, 30, 255) : glm::u8vec4(10, 200, 10, 0));
    }
  return image;
}

}  // namespace promenade::test_scenes
