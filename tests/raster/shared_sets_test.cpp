// The visibility buffer against Embree on the shared data sets. A dozen small views of a part of each; with
// PROMENADE_RASTER_VIEWS=1000 so many views of all of each (minutes), and prints the counts.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "embree_rays.h"

namespace promenade {
namespace {

using namespace test_scenes;  // NOLINT(google-build-using-namespace)
using nlohmann::json;

/// As much of binary glTF as these sets use: triangles, node transforms, no compression.
class Glb {
 public:
  explicit Glb(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(in), {});
    uint32_t length = 0;
    std::memcpy(&length, &bytes_[12], 4);
    doc_ = json::parse(bytes_.begin() + 20, bytes_.begin() + 20 + length);
    blob_ = &bytes_[20 + size_t(length) + 8];
  }

  /// Meshes of the scene's nodes, placed, z up, until there are so many triangles.
  std::vector<Mesh> meshes(size_t most_triangles) {
    left_ = most_triangles;
    glm::dmat4 z_up(0.0);
    z_up[0][0] = 1, z_up[1][2] = 1, z_up[2][1] = -1, z_up[3][3] = 1;
    for (const json& root : doc_["scenes"][0]["nodes"]) visit(root.get<size_t>(), z_up);
    return std::move(out_);
  }

  bool two_sided() const {
    for (const json& m : doc_.value("materials", json::array()))
      if (m.value("doubleSided", false)) return true;
    return false;
  }

 private:
  static glm::dmat4 local(const json& node) {
    glm::dmat4 m(1.0);
    if (node.contains("matrix")) {
      for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node["matrix"][size_t(i)].get<double>();
      return m;
    }
    const json t = node.value("translation", json{0, 0, 0}), r = node.value("rotation", json{0, 0, 0, 1}),
               s = node.value("scale", json{1, 1, 1});
    const glm::dmat4 turned =
        glm::mat4_cast(glm::dquat(r[3].get<double>(), r[0].get<double>(), r[1].get<double>(), r[2].get<double>()));
    for (int i = 0; i < 3; ++i) m[i] = turned[i] * s[size_t(i)].get<double>(), m[3][i] = t[size_t(i)].get<double>();
    return m;
  }

  const char* view(const json& accessor, size_t& stride, size_t element) const {
    const json& v = doc_["bufferViews"][accessor["bufferView"].get<size_t>()];
    stride = v.value("byteStride", element);
    return blob_ + v.value("byteOffset", size_t(0)) + accessor.value("byteOffset", size_t(0));
  }

  Mesh primitive(const json& p) const {
    Mesh mesh;
    size_t stride = 0;
    const json& positions = doc_["accessors"][p["attributes"]["POSITION"].get<size_t>()];
    const char* from = view(positions, stride, 12);
    mesh.positions.resize(positions["count"].get<size_t>());
    for (size_t i = 0; i < mesh.positions.size(); ++i) std::memcpy(&mesh.positions[i], from + i * stride, 12);
    const json& indices = doc_["accessors"][p["indices"].get<size_t>()];
    const size_t size = indices["componentType"].get<int>() == 5125 ? 4 : 2;
    from = view(indices, stride, size);
    mesh.indices.resize(indices["count"].get<size_t>());
    for (size_t i = 0; i < mesh.indices.size(); ++i) std::memcpy(&mesh.indices[i], from + i * size, size);
    return mesh;
  }

  void visit(size_t index, const glm::dmat4& parent) {
    const json& node = doc_["nodes"][index];
    const glm::dmat4 placed = parent * local(node);
    if (node.contains("mesh")) {
      for (const json& p : doc_["meshes"][node["mesh"].get<size_t>()]["primitives"]) {
        if (left_ == 0 || !p.contains("indices")) continue;
        Mesh mesh = transformed(primitive(p), placed);
        left_ -= std::min(left_, mesh.triangle_count());
        if (find_defect(mesh).empty()) out_.push_back(std::move(mesh));
      }
    }
    if (node.contains("children"))
      for (const json& child : node["children"]) visit(child.get<size_t>(), placed);
  }

  std::vector<char> bytes_;
  json doc_;
  const char* blob_ = nullptr;
  size_t left_ = 0;
  std::vector<Mesh> out_;
};

/// The faces of a Wavefront file, all in one mesh; positions and polygons only.
std::vector<Mesh> obj_meshes(const std::filesystem::path& path, size_t most_triangles) {
  std::ifstream in(path);
  Mesh mesh;
  for (std::string line; std::getline(in, line) && mesh.triangle_count() < most_triangles;) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      glm::vec3 p(0);
      words >> p.x >> p.y >> p.z;
      mesh.positions.emplace_back(p.x, -p.z, p.y);
    } else if (word == "f") {
      std::vector<uint32_t> polygon;
      while (words >> word) {
        const long number = std::strtol(word.c_str(), nullptr, 10);
        polygon.push_back(static_cast<uint32_t>(number > 0 ? number - 1 : long(mesh.positions.size()) + number));
      }
      for (size_t i = 2; i < polygon.size(); ++i)
        mesh.indices.insert(mesh.indices.end(), {polygon[0], polygon[i - 1], polygon[i]});
    }
  }
  return {mesh};
}

/// Huge triangles about a set and through it; needles, lines and points among its vertices.
Mesh hostile_triangles(const Box& box, const Mesh& some, Random& random) {
  Mesh mesh;
  const double size = box.diagonal();
  const auto vertex = [&] { return some.positions[random.below(uint32_t(some.positions.size()))]; };
  for (uint32_t i = 0; i < 12; ++i)
    add_triangle(mesh, i % 3 == 0 ? vertex() : box.center() + random.point(300 * size),
                 box.center() + random.point(300 * size), box.center() + random.point(300 * size));
  for (uint32_t i = 0; i < 200; ++i) {
    const glm::vec3 a = vertex(), b = a + random.point(size);
    const uint32_t kind = i % 4;
    add_triangle(mesh, a, kind == 0 ? a : b,
                 kind < 2    ? a
                 : kind == 2 ? a + (b - a) * 0.5F
                             : b + random.point(1e-6 * size));
  }
  return mesh;
}

/// From among the geometry, from within it, from a vertex, and with all of the set behind the eye.
Camera hostile_camera(const Scene& scene, const Box& box, Random& random, uint32_t i) {
  Camera camera = random_camera(random, 1, 96, 64);
  const Mesh& some = scene.meshes[random.below(uint32_t(scene.meshes.size() - 1))];
  const glm::vec3 at = some.positions[random.below(uint32_t(some.positions.size()))];
  glm::vec3 eye = i % 2 == 0 ? box.center() + (random.point(0.6) * box.size()) : at + random.point(0.5);
  if (i % 10 == 4) eye = at + random.point(1e-3);
  camera.pose.eye = glm::dvec3(eye);
  if (i % 10 == 9) {
    camera.vertical_fov_deg = 60;
    camera.pose.eye = glm::dvec3(box.center()) - basis_of(camera.pose).forward * -1.5 * double(box.diagonal());
  }
  return camera;
}

class SharedSet : public testing::TestWithParam<const char*> {};

TEST_P(SharedSet, ids_equal_embrees_from_random_eyes_and_from_within_the_geometry) {
  const std::filesystem::path path = std::filesystem::path(PROMENADE_SOURCE_DIR) / "../shared/datasets" / GetParam();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const char* wanted = std::getenv("PROMENADE_RASTER_VIEWS");
  const uint32_t views = wanted == nullptr ? 12 : static_cast<uint32_t>(std::atoi(wanted));
  const size_t most_triangles = wanted == nullptr ? 60000 : 5000000;
  Scene scene;
  if (path.extension() == ".obj") {
    scene.materials[0].two_sided = true;
    scene.meshes = obj_meshes(path, most_triangles);
  } else {
    Glb glb(path);
    scene.materials[0].two_sided = glb.two_sided();
    scene.meshes = glb.meshes(most_triangles);
  }
  Box box;
  for (const Mesh& m : scene.meshes) box.add(bounds(m));
  Random random(81);
  scene.meshes.push_back(hostile_triangles(box, scene.meshes.front(), random));
  scene.finish();
  const Rays rays(scene);
  Comparison c;
  const auto count = [](uint64_t n) { return static_cast<unsigned long long>(n); };
  for (uint32_t i = 0; i < views; ++i)
    compare(scene, rays, perspective_view(hostile_camera(scene, box, random, i), glm::dvec3(0)), 1, c);
  if (wanted != nullptr)
    std::printf(
        "%s: %u views, %llu pixels, %llu covered; not Embree's triangle: %llu within 1/256 pixel of an edge, %llu in "
        "one place, %llu where exact arithmetic agrees, %llu wrong\n",
        GetParam(), views, count(c.pixels), count(c.covered), count(c.at_edges), count(c.ties), count(c.embree_wrong),
        count(c.wrong));
  report(c);
}

INSTANTIATE_TEST_SUITE_P(AgainstEmbree, SharedSet,
                         testing::Values("citysim/citysim.glb", "cms_detector/cms_detector.glb",
                                         "conference_room/conference.obj", "datsville_a/datsville_a.glb",
                                         "datsville_a/datsville_a_2blocks.glb", "small_house/small_house.glb",
                                         "sports_car/sports_car.glb"),
                         [](const auto& set) {
                           std::string name = set.param;
                           name = name.substr(name.find('/') + 1);
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace promenade
