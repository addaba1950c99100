// glTF 2.0 and GLB: the node hierarchy and its instances. The container is gltf_document.h, meshes gltf_meshes.h,
// materials gltf_materials.h.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>

#include "preprocess/gltf_animation.h"
#include "preprocess/gltf_document.h"
#include "preprocess/gltf_materials.h"
#include "preprocess/gltf_meshes.h"
#include "preprocess/import_readers.h"

namespace promenade {

namespace {

// EXT_mesh_gpu_instancing costs the file nothing when its accessors have no data: bounds what a node can place.
constexpr uint64_t kMaxInstancesPerByte = 1;
constexpr uint64_t kFreeInstances = 1U << 20;

glm::dmat4 placed(const std::array<double, 3>& translation, const std::array<double, 4>& rotation,
                  const std::array<double, 3>& scale) {
  glm::dquat q(rotation[3], rotation[0], rotation[1], rotation[2]);
  const double length = glm::length(q);
  q = length > 0 ? q / length : glm::dquat(1, 0, 0, 0);
  glm::dmat4 m = glm::mat4_cast(q);
  for (int axis = 0; axis < 3; ++axis) m[axis] *= scale[static_cast<size_t>(axis)];
  m[3] = glm::dvec4(translation[0], translation[1], translation[2], 1);
  return m;
}

glm::dmat4 local_transform(const Json& node) {
  std::array<double, 16> matrix{};
  if (numbers(member(node, "matrix"), matrix)) {
    glm::dmat4 m(1);
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row)
        m[column][row] = matrix[static_cast<size_t>(column) * 4 + static_cast<size_t>(row)];
    return m;
  }
  std::array<double, 3> translation{0, 0, 0};
  std::array<double, 4> rotation{0, 0, 0, 1};
  std::array<double, 3> scale{1, 1, 1};
  numbers(member(node, "translation"), translation);
  numbers(member(node, "rotation"), rotation);
  numbers(member(node, "scale"), scale);
  return placed(translation, rotation, scale);
}

/// A node on the way: where it is and what it inherits.
struct Visit {
  uint64_t node;
  glm::dmat4 world_from_parent;
  std::string class_name;
  uint32_t joint = kNoJoint;          ///< the nearest thing above that moves
  glm::dmat4 joint_from_parent{1.0};  ///< no such thing: from the world
};

class Placer {
 public:
  Placer(GltfDocument& document, const std::vector<uint32_t>& mesh_of, const GltfTracks& tracks, Scene& scene)
      : document_(document),
        nodes_(member(document.json(), "nodes")),
        mesh_of_(mesh_of),
        tracks_(tracks),
        scene_(scene) {}

  Status place() {
    if (!nodes_.is_array()) return Done{};
    visited_.assign(nodes_.size(), false);
    std::vector<Visit> stack = roots();
    while (!stack.empty()) {
      const Visit visit = std::move(stack.back());
      stack.pop_back();
      if (visit.node >= nodes_.size() || visited_[visit.node]) {
        ++scene_.report.counts["nodes_skipped"];  // a cycle, a second parent, or a node that is not there
        continue;
      }
      visited_[visit.node] = true;
      PROMENADE_TRY(place_node(visit, stack));
    }
    return Done{};
  }

 private:
  /// Roots of the scene that the file shows; last first, so that the stack pops them in the file's order.
  std::vector<Visit> roots() const {
    const Json& scenes = member(document_.json(), "scenes");
    const Json& shown = element(scenes, whole(member(document_.json(), "scene")).value_or(0));
    std::vector<Visit> out;
    if (shown.is_object()) {
      push_children(member(shown, "nodes"), {0, glm::dmat4(1), ""}, out);
      return out;
    }
    std::vector<bool> is_child(nodes_.size(), false);
    for (const Json& node : nodes_)
      if (const Json& children = member(node, "children"); children.is_array())
        for (const Json& child : children)
          if (const auto index = whole(child); index && *index < is_child.size()) is_child[*index] = true;
    for (size_t i = nodes_.size(); i-- > 0;)
      if (!is_child[i]) out.push_back({i, glm::dmat4(1), ""});
    return out;
  }

  /// from: what every child inherits.
  static void push_children(const Json& children, const Visit& from, std::vector<Visit>& stack) {
    if (!children.is_array()) return;
    for (size_t i = children.size(); i-- > 0;) {
      stack.push_back(from);
      stack.back().node = whole(children[i]).value_or(~uint64_t(0));
    }
  }

  /// What moves by itself becomes a joint; what does not goes on from the one above.
  void hang(const Visit& visit, const Json& node, Visit& below) {
    const auto tracks = tracks_.find(visit.node);
    if (tracks == tracks_.end()) {
      below.joint_from_parent = visit.joint_from_parent * local_transform(node);
      return;
    }
    AnimationJoint joint;
    joint.parent = visit.joint;
    joint.parent_from_rest = visit.joint_from_parent;
    numbers(member(node, "translation"), joint.translation);
    numbers(member(node, "rotation"), joint.rotation);
    numbers(member(node, "scale"), joint.scale);
    joint.tracks = tracks->second;
    below.joint = static_cast<uint32_t>(scene_.animation.joints.size());
    below.joint_from_parent = glm::dmat4(1);
    scene_.animation.joints.push_back(joint);
  }

  Status place_node(const Visit& visit, std::vector<Visit>& stack) {
    const Json& node = nodes_[visit.node];
    const glm::dmat4 world_from_node = visit.world_from_parent * local_transform(node);
    std::string class_name = text(member(member(node, "extras"), "class"));
    if (class_name.empty()) class_name = visit.class_name;
    Visit below{visit.node, world_from_node, class_name, visit.joint, glm::dmat4(1)};
    hang(visit, node, below);
    push_children(member(node, "children"), below, stack);

    const std::optional<uint64_t> mesh = whole(member(node, "mesh"));
    if (!mesh || *mesh >= mesh_of_.size()) return Done{};
    const Json& declared = document_.json()["meshes"][*mesh];
    SceneInstance instance{mesh_of_[*mesh], world_from_node, text(member(node, "name")),
                           class_name,      below.joint,     glm::dmat4(1)};
    if (below.joint != kNoJoint) instance.joint_from_mesh = below.joint_from_parent;
    if (instance.name.empty()) instance.name = text(member(declared, "name"));
    if (instance.class_name.empty()) instance.class_name = text(member(member(declared, "extras"), "class"));
    const Json& many = member(member(member(node, "extensions"), "EXT_mesh_gpu_instancing"), "attributes");
    if (many.is_object()) return place_many(many, instance, visit.node);
    scene_.instances.push_back(std::move(instance));
    return Done{};
  }

  Status place_many(const Json& attributes, const SceneInstance& instance, uint64_t node) {
    const std::array<const char*, 3> names{"TRANSLATION", "ROTATION", "SCALE"};
    const std::array<uint32_t, 3> components{3, 4, 3};
    std::array<std::vector<float>, 3> values;
    std::optional<uint64_t> count;
    for (size_t i = 0; i < names.size(); ++i) {
      const std::optional<uint64_t> index = whole(member(attributes, names[i]));
      if (!index) continue;
      const Result<GltfAccessor> accessor = document_.accessor(*index);
      if (!accessor.ok()) return accessor.error();
      if (accessor->components != components[i] || (count && *count != accessor->count))
        return Error{
            fmt::format("{}: node {}: instances' {} do not fit; the file is broken", document_.name(), node, names[i])};
      count = accessor->count;
      const uint64_t limit = kFreeInstances + kMaxInstancesPerByte * document_.source_bytes();
      if (*count > limit || (placed_ += *count) > limit)
        return Error{fmt::format("{}: node {}: {} instances are more than the file can mean; it is broken",
                                 document_.name(), node, *count)};
      values[i].resize(static_cast<size_t>(*count) * components[i]);
      PROMENADE_TRY(document_.read_floats(*index, 0, values[i]));
    }
    for (size_t k = 0; k < count.value_or(0); ++k) {
      std::array<double, 3> translation{0, 0, 0};
      std::array<double, 4> rotation{0, 0, 0, 1};
      std::array<double, 3> scale{1, 1, 1};
      const auto take = [k](const std::vector<float>& from, auto& into) {
        if (!from.empty())
          std::copy_n(from.begin() + static_cast<ptrdiff_t>(k * into.size()), into.size(), into.begin());
      };
      take(values[0], translation), take(values[1], rotation), take(values[2], scale);
      SceneInstance one = instance;
      const glm::dmat4 own = placed(translation, rotation, scale);
      one.world_from_mesh = instance.world_from_mesh * own;
      one.joint_from_mesh = instance.joint_from_mesh * own;
      scene_.instances.push_back(std::move(one));
    }
    return Done{};
  }

  GltfDocument& document_;
  const Json& nodes_;
  const std::vector<uint32_t>& mesh_of_;
  const GltfTracks& tracks_;
  Scene& scene_;
  std::vector<bool> visited_;
  uint64_t placed_ = 0;
};

/// Extensions that change the shape and that we do not know: refused when required.
Status check_extensions(const GltfDocument& document) {
  constexpr std::array<std::string_view, 6> kShapeExtensions{"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                                             "KHR_mesh_quantization",      "EXT_mesh_gpu_instancing",
                                                             "KHR_texture_transform",      "KHR_texture_basisu"};
  const Json& required = member(document.json(), "extensionsRequired");
  if (!required.is_array()) return Done{};
  for (const Json& value : required) {
    const std::string extension = text(value);
    const bool looks_only = extension.rfind("KHR_materials_", 0) == 0 || extension.rfind("EXT_texture_", 0) == 0 ||
                            extension.rfind("MSFT_texture_", 0) == 0 || extension.rfind("KHR_lights", 0) == 0;
    if (!looks_only && std::find(kShapeExtensions.begin(), kShapeExtensions.end(), extension) == kShapeExtensions.end())
      return Error{fmt::format("{}: needs the extension {}, which cannot be read; export without it", document.name(),
                               extension.substr(0, 80))};
  }
  return Done{};
}

}  // namespace

Result<ReadScene> read_gltf(const std::filesystem::path& path, const std::string& name, JobMonitor& monitor) {
  Result<GltfDocument> document = GltfDocument::open(path, name);
  if (!document.ok()) return document.error();
  PROMENADE_TRY(check_extensions(*document));
  ReadScene out;
  out.up = UpAxis::y;
  std::vector<GltfTexcoords> texcoords;
  std::vector<uint32_t> mesh_of;
  PROMENADE_TRY(read_gltf_materials(*document, out.scene, texcoords));
  PROMENADE_TRY(read_gltf_meshes(*document, texcoords, out.scene, mesh_of, monitor));
  const GltfTracks tracks = read_gltf_animations(*document, out.scene);
  PROMENADE_TRY(Placer(*document, mesh_of, tracks, out.scene).place());
  return out;
}

}  // namespace promenade
