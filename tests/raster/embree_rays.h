#pragma once
// Embree's primary rays beside the visibility buffer, pixel by pixel.

#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "raster/visibility.h"
#include "scenes.h"

namespace promenade::test_scenes {

/// All items in one Embree scene; geometry i is item i. One-sided meshes drop hits from behind.
class Rays {
 public:
  explicit Rays(const Scene& scene) : scene_(scene), device_(rtcNewDevice("threads=1")), rtc_(rtcNewScene(device_)) {
    rtcSetSceneFlags(rtc_, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    for (uint32_t i = 0; i < scene.meshes.size(); ++i) {
      const Mesh& m = scene.meshes[i];
      RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      void* v = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, m.positions.size());
      std::memcpy(v, m.positions.data(), m.positions.size() * 12);
      void* t = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, m.triangle_count());
      std::memcpy(t, m.indices.data(), m.indices.size() * 4);
      rtcCommitGeometry(g);
      rtcAttachGeometryByID(rtc_, g, i);
      rtcReleaseGeometry(g);
    }
    rtcCommitScene(rtc_);
  }
  ~Rays() { rtcReleaseScene(rtc_), rtcReleaseDevice(device_); }
  Rays(const Rays&) = delete;
  Rays& operator=(const Rays&) = delete;

  struct Hit {
    uint32_t node, triangle;
    float depth_m;
  };

  Hit shoot(const RasterView& view, double x_px, double y_px) const {
    const glm::dvec3 o = ray_origin(view, x_px, y_px), d = ray_direction(view, x_px, y_px);
    RTCRayHit r = {};
    r.ray.org_x = float(o.x), r.ray.org_y = float(o.y), r.ray.org_z = float(o.z);
    r.ray.dir_x = float(d.x), r.ray.dir_y = float(d.y), r.ray.dir_z = float(d.z);
    r.ray.tnear = float(view.near_m), r.ray.tfar = std::numeric_limits<float>::infinity();
    r.ray.mask = 0xffffffffU;
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    Context context;
    context.two_sided = scene_.materials[0].two_sided;
    rtcIntersect1(rtc_, &context.rtc, &r);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID)
      return {kNoTriangle, kNoTriangle, std::numeric_limits<float>::infinity()};
    return {r.hit.geomID, r.hit.primID, r.ray.tfar};
  }

 private:
  struct Context {
    RTCIntersectContext rtc;
    bool two_sided = true;
    Context() : rtc() {
      rtcInitIntersectContext(&rtc);
      rtc.filter = [](const RTCFilterFunctionNArguments* a) {
        if (reinterpret_cast<const Context*>(a->context)->two_sided) return;
        const auto* ray = reinterpret_cast<const RTCRay*>(a->ray);
        const auto* hit = reinterpret_cast<const RTCHit*>(a->hit);
        if (ray->dir_x * hit->Ng_x + ray->dir_y * hit->Ng_y + ray->dir_z * hit->Ng_z >= 0) a->valid[0] = 0;
      };
    }
  };

  const Scene& scene_;
  RTCDevice device_;
  RTCScene rtc_;
};

/// The same ray against every triangle, in double: who is right where the two disagree. Embree's single precision loses
/// triangles whose corners lie thousands of times farther away than what is seen of them.
inline Rays::Hit shoot_exactly(const Scene& scene, const RasterView& view, double x_px, double y_px) {
  const glm::dvec3 o = ray_origin(view, x_px, y_px), d = ray_direction(view, x_px, y_px);
  Rays::Hit best = {kNoTriangle, kNoTriangle, std::numeric_limits<float>::infinity()};
  double nearest = std::numeric_limits<double>::infinity();
  for (uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      const glm::dvec3 a = glm::dvec3(mesh.positions[mesh.indices[3 * t]]) - o;
      const glm::dvec3 b = glm::dvec3(mesh.positions[mesh.indices[3 * t + 1]]) - o;
      const glm::dvec3 c = glm::dvec3(mesh.positions[mesh.indices[3 * t + 2]]) - o;
      const double u = glm::dot(glm::cross(a, b), d), v = glm::dot(glm::cross(b, c), d),
                   w = glm::dot(glm::cross(c, a), d);
      const double sum = u + v + w;
      const bool front = u >= 0 && v >= 0 && w >= 0, back = u <= 0 && v <= 0 && w <= 0;
      if (sum == 0 || !(front || back) || (!scene.materials[0].two_sided && sum > 0)) continue;
      const double depth = glm::dot(view.forward, (a * v + b * w + c * u) / sum);
      if (depth >= view.near_m && depth < nearest) nearest = depth, best = {m, t, float(depth)};
    }
  }
  return best;
}

/// Distance in pixels from a point of the picture to the picture of a triangle's edges, cut at the near plane.
inline double edge_distance_px(const RasterView& view, const Mesh& mesh, uint32_t triangle, double x_px, double y_px) {
  std::vector<glm::dvec3> polygon, cut;
  for (size_t c = 0; c < 3; ++c) {
    const glm::dvec3 p = glm::dvec3(mesh.positions[mesh.indices[3 * size_t(triangle) + c]]) - view.eye;
    polygon.emplace_back(glm::dot(p, view.right), glm::dot(p, view.up), glm::dot(p, view.forward));
  }
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % 3];
    if (a.z >= view.near_m) cut.push_back(a);
    if ((a.z >= view.near_m) != (b.z >= view.near_m)) cut.push_back(a + (b - a) * ((view.near_m - a.z) / (b.z - a.z)));
  }
  double least = std::numeric_limits<double>::infinity();
  const auto on_picture = [&](const glm::dvec3& p) {
    const double q = view.orthographic ? 1 : p.z;
    return glm::dvec2(view.width_px / 2.0 + p.x / q * view.scale_px, view.height_px / 2.0 - p.y / q * view.scale_px);
  };
  const glm::dvec2 at(x_px, y_px);
  for (size_t i = 0; i < cut.size(); ++i) {
    const glm::dvec2 a = on_picture(cut[i]), b = on_picture(cut[(i + 1) % cut.size()]);
    const glm::dvec2 d = b - a;
    const double t = glm::dot(d, d) > 0 ? glm::clamp(glm::dot(at - a, d) / glm::dot(d, d), 0.0, 1.0) : 0;
    least = std::min(least, glm::length(a + d * t - at));
  }
  return least;
}

struct Comparison {
  uint64_t pixels = 0, covered = 0, at_edges = 0, ties = 0, embree_wrong = 0, wrong = 0;
};

/// Whether two surfaces lie in one place, as far as single precision can tell.
inline bool same_depth(float a, float b) { return std::abs(a - b) <= 2e-5F * std::max(a, b); }

inline void compare(const Scene& scene, const Rays& rays, const RasterView& view, uint32_t step, Comparison& c) {
  VisibilityBuffer buffer;
  VisibilityOptions options;
  options.threads = 1;
  ASSERT_TRUE(buffer.draw(view, scene.items, options).ok());
  for (uint32_t y = 0; y < view.height_px; y += step) {
    for (uint32_t x = y % step; x < view.width_px; x += step) {
      const double px = x + 0.5, py = y + 0.5;
      const Rays::Hit hit = rays.shoot(view, px, py);
      const uint32_t node = buffer.node(x, y), triangle = buffer.triangle(x, y);
      ++c.pixels, c.covered += node != kNoTriangle;
      if (node == hit.node && triangle == hit.triangle) continue;
      double edge = std::numeric_limits<double>::infinity();
      if (node != kNoTriangle) edge = edge_distance_px(view, scene.meshes[node], triangle, px, py);
      if (hit.node != kNoTriangle)
        edge = std::min(edge, edge_distance_px(view, scene.meshes[hit.node], hit.triangle, px, py));
      if (edge <= 1.0 / 256) {
        ++c.at_edges;
      } else if (node != kNoTriangle && hit.node != kNoTriangle && same_depth(buffer.depth_m(x, y), hit.depth_m)) {
        ++c.ties;
      } else if (const Rays::Hit exact = shoot_exactly(scene, view, px, py);
                 (exact.node == node && exact.triangle == triangle) ||
                 (node != kNoTriangle && exact.node != kNoTriangle &&
                  same_depth(buffer.depth_m(x, y), exact.depth_m))) {  // two in one place, and Embree on neither
        ++c.embree_wrong;
      } else {
        if (++c.wrong <= 3)
          ADD_FAILURE() << "pixel " << x << ", " << y << ": drew " << node << "/" << triangle << " at "
                        << buffer.depth_m(x, y) << " m, Embree hits " << hit.node << "/" << hit.triangle << " at "
                        << hit.depth_m << " m, exactly " << exact.node << "/" << exact.triangle << " at "
                        << exact.depth_m << " m, " << edge << " px from an edge";
      }
    }
  }
}

inline void report(const Comparison& c) {
  EXPECT_EQ(c.wrong, 0U);
  EXPECT_GT(c.covered, c.pixels / 50) << "too little is seen to compare";
  EXPECT_LT(c.at_edges, c.pixels / 200);
  const auto record = [&](const char* name, uint64_t count) {
    testing::Test::RecordProperty(name, std::to_string(count));
  };
  record("pixels", c.pixels), record("covered", c.covered), record("at_edges", c.at_edges), record("ties", c.ties);
  record("embree_wrong", c.embree_wrong), record("wrong", c.wrong);
}

}  // namespace promenade::test_scenes
