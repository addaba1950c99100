#include "preprocess/object_units.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <glm/gtc/matrix_transform.hpp>
#include <mutex>
#include <optional>

#include "preprocess/weld.h"

namespace promenade {

namespace {

/// Whatever hangs on the object's joint, in the object's space, materials by the survey's table.
ObjectMesh mesh_of(const SurveyedObject& object, const SurveyedPart& part, const Survey& survey, const Scene& scene) {
  ObjectMesh out;
  const glm::dmat4 object_from_joint = glm::inverse(object.joint_from_object);
  for (const uint32_t i : object.instances) {
    const SceneInstance& instance = scene.instances[i];
    Mesh mesh = transformed(scene.meshes[instance.mesh], object_from_joint * instance.joint_from_mesh);
    if (mesh.materials.empty()) mesh.materials.assign(mesh.triangle_count(), 0);
    for (uint32_t& material : mesh.materials) material = part.material_of[material];
    add_run(out.classes, survey.class_of(instance.class_name), mesh.triangle_count());
    append(out.mesh, mesh);
  }
  return out;
}

}  // namespace

Result<std::vector<NodeUnit>> build_objects(const Survey& survey, const ImportOptions& import,
                                            const NodeBuilder& builder, const TreeOptions& options,
                                            const WorkFolder& folder, JobMonitor& monitor) {
  std::vector<NodeUnit> units(survey.objects.size());
  std::mutex mutex;
  std::optional<std::pair<size_t, Error>> failed;  // the first by object
  for (size_t first = 0, last = 0; first < units.size(); first = last) {
    const uint32_t part = survey.objects[first].part;
    std::vector<size_t> due;
    for (last = first; last < units.size() && survey.objects[last].part == part; ++last) {
      std::optional<NodeUnit> known = load_node_unit(folder, fmt::format("object-{:06}", last), options.hash);
      if (known)
        units[last] = std::move(*known);
      else
        due.push_back(last);
    }
    if (due.empty()) continue;
    const Result<std::shared_ptr<const Scene>> scene = scene_of(survey.parts[part], import, monitor);
    if (!scene.ok()) return scene.error();
    tbb::parallel_for(size_t(0), due.size(), [&](size_t k) {
      if (monitor.cancelled()) return;
      const size_t i = due[k];
      Result<NodeUnit> unit = build_object(mesh_of(survey.objects[i], survey.parts[part], survey, **scene), builder,
                                           options, folder, fmt::format("object-{:06}", i), monitor);
      const std::lock_guard lock(mutex);
      if (unit.ok())
        units[i] = std::move(*unit);
      else if (!failed || i < failed->first)
        failed = {i, unit.error()};
    });
    if (monitor.cancelled()) return Error{kInterrupted};
    if (failed) return failed->second;
  }
  return units;
}

}  // namespace promenade
