// The visibility buffer against Embree's primary rays: the same node and triangle at every pixel, but where the pixel's
// centre lies within 1/256 pixel of an edge, or two surfaces are as far away as rounding can tell.

#include "embree_rays.h"

namespace promenade {
namespace {

using namespace test_scenes;  // NOLINT(google-build-using-namespace)

TEST(AgainstEmbree, ids_are_equal_in_perspective) {
  Random random(31);
  for (const bool two_sided : {false, true}) {
    const Scene scene = mixed_scene(32 + two_sided, two_sided);
    const Rays rays(scene);
    Comparison c;
    for (uint32_t i = 0; i < 12; ++i)
      compare(scene, rays, perspective_view(random_camera(random, 10, 240, 160), glm::dvec3(0)), 1, c);
    report(c);
  }
}

TEST(AgainstEmbree, ids_are_equal_among_huge_degenerate_and_enclosing_triangles) {
  Random random(41);
  for (uint64_t seed = 0; seed < 3; ++seed) {
    const Scene scene = hostile_scene(42 + seed);
    const Rays rays(scene);
    Comparison c;
    for (uint32_t i = 0; i < 6; ++i)
      compare(scene, rays, perspective_view(random_camera(random, i % 2 == 0 ? 0.3 : 5, 120, 80), glm::dvec3(0)), 1, c);
    report(c);
  }
}

TEST(AgainstEmbree, ids_are_equal_in_parallel_views_and_cube_faces) {
  Random random(51);
  const Scene scene = mixed_scene(52, false);
  const Rays rays(scene);
  Comparison c;
  for (uint32_t i = 0; i < 6; ++i) {
    compare(scene, rays, cube_face_view(random.point(9), int(i), 128, 0.05), 1, c);
    const Pose pose = random_camera(random, 12, 1, 1).pose;
    compare(scene, rays, orthographic_view(pose, glm::dvec3(0), 200, 150, random.within(5, 30), 0.1), 1, c);
  }
  report(c);
}

TEST(AgainstEmbree, ids_are_equal_in_a_picture_16384_pixels_wide) {
  const Scene scene = mixed_scene(61, false);
  const Rays rays(scene);
  Comparison c;
  Random random(62);
  for (uint32_t i = 0; i < 2; ++i) {
    Camera camera = random_camera(random, 9, kMaxPictureSide, 512);
    camera.vertical_fov_deg = 3.6;  // about 90 degrees across
    compare(scene, rays, perspective_view(camera, glm::dvec3(0)), 5, c);
  }
  report(c);
}

TEST(AgainstEmbree, ids_are_equal_far_from_the_origin) {
  Scene scene = mixed_scene(71, false);
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    for (glm::vec3& p : scene.meshes[i].positions) p = glm::vec3(p.x + 4096.0F, p.y - 2048.0F, p.z);
    scene.prepared[i] = *prepare(scene.meshes[i], scene.materials);
  }
  const Rays rays(scene);
  Comparison c;
  Random random(72);
  for (uint32_t i = 0; i < 6; ++i) {
    Camera camera = random_camera(random, 9, 240, 160);
    camera.pose.eye = glm::dvec3(glm::vec3(camera.pose.eye + glm::dvec3(4096, -2048, 0)));  // as the rays have it
    compare(scene, rays, perspective_view(camera, glm::dvec3(0)), 1, c);
  }
  report(c);
}

}  // namespace
}  // namespace promenade
