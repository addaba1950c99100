#include "cli/source_renderer.h"

#include <fmt/format.h>

#include <glm/ext/matrix_transform.hpp>

#include "cli/console.h"
#include "codec/image_codec.h"
#include "runtime/brute_force.h"

namespace promenade {
namespace {

std::vector<Image> decode_textures(const Scene& scene) {
  std::vector<Image> images(scene.textures.size());
  for (size_t i = 0; i < images.size(); ++i) {
    if (scene.textures[i].encoded.empty()) continue;
    Result<Image> image = decode_image(scene.textures[i].encoded, scene.textures[i].name);
    if (image) images[i] = std::move(*image);  // else import has named it; drawn in the plain colour
  }
  return images;
}

/// Adds a scene to what the renderer holds. Instances are numbered on from first_instance.
Status add_scene(const Scene& scene, const glm::dvec3& origin, double time_s, uint32_t first_instance,
                 BruteForceScene& portion) {
  const std::vector<glm::dmat4> poses = poses_at(scene.animation, time_s);
  const glm::dmat4 model_from_world = glm::translate(glm::dmat4(1.0), -origin);
  std::vector<PlacedMesh> placed;
  placed.reserve(scene.instances.size());
  for (const SceneInstance& instance : scene.instances) {
    const glm::dmat4 world_from_mesh =
        instance.joint == kNoJoint ? instance.world_from_mesh : poses[instance.joint] * instance.joint_from_mesh;
    placed.push_back({instance.mesh, NodeId{first_instance + static_cast<uint32_t>(placed.size())},
                      glm::mat4(model_from_world * world_from_mesh)});
  }
  return portion.add(scene.meshes, scene.materials, decode_textures(scene), placed);
}

/// Takes over the pixels of `nearer` that lie in front.
void put_together(Frame& frame, const Frame& nearer) {
  for (size_t i = 0; i < frame.depth_m.size(); ++i) {
    if (nearer.depth_m[i] >= frame.depth_m[i]) continue;
    frame.depth_m[i] = nearer.depth_m[i];
    if (!frame.color.pixels.empty()) frame.color.pixels[i] = nearer.color.pixels[i];
    if (!frame.nodes.empty()) frame.nodes[i] = nearer.nodes[i];
  }
}

/// The views of what the portion holds, added to the frames.
Status draw_portion(const SourceRenderOptions& options, BruteForceScene& portion, const glm::dvec3& origin,
                    Renderer& renderer, std::vector<Frame>& frames, double& draw_s) {
  FrameView view = options.look;
  view.model_origin = origin;
  const bool first = frames.empty();
  for (size_t i = 0; i < options.cameras.size(); ++i) {
    view.camera = options.cameras[i];
    const WallClock clock;
    PROMENADE_TRY(portion.draw(view));
    draw_s += clock.seconds();
    Result<Frame> frame = read_frame(renderer, view.camera.width_px, view.camera.height_px, options.aov, true);
    if (!frame) return frame.error();
    if (first)
      frames.push_back(std::move(*frame));
    else
      put_together(frames[i], *frame);
  }
  return Done{};
}

/// The corner of the first object, rounded: single precision is enough from there, wherever on Earth the source lies.
glm::dvec3 origin_of(const Scene& scene) {
  constexpr double kFarFromZeroM = 50'000;
  if (scene.instances.empty()) return glm::dvec3(0);
  const SceneInstance& instance = scene.instances.front();
  const glm::dvec3 at(instance.world_from_mesh *
                      glm::dvec4(glm::dvec3(bounds(scene.meshes[instance.mesh]).center()), 1.0));
  return glm::length(at) > kFarFromZeroM ? glm::round(at) : glm::dvec3(0);
}

uint64_t triangles_of(const Scene& scene) {
  uint64_t sum = 0;
  for (const SceneInstance& instance : scene.instances) sum += scene.meshes[instance.mesh].triangle_count();
  return sum;
}

}  // namespace

Result<std::vector<Frame>> render_source(const SourceRenderOptions& options, Renderer& renderer,
                                         SourceRenderFigures& figures, JobMonitor& monitor) {
  const Result<std::vector<SourcePart>> parts = list_source(options.sources);
  if (!parts) return parts.error();
  std::vector<Frame> frames;
  BruteForceScene portion(renderer);
  std::optional<glm::dvec3> origin;
  uint32_t instances_seen = 0;
  double draw_s = 0;
  for (size_t i = 0; i < parts->size(); ++i) {
    monitor.progress("draw the source", i, parts->size());
    if (monitor.cancelled()) return Error{"interrupted"};
    const Result<Scene> scene = import_part((*parts)[i], options.import, monitor);
    if (!scene) return scene.error();
    for (const std::string& warning : scene->report.warnings) monitor.warning(warning);
    if (!origin && !scene->instances.empty()) origin = origin_of(*scene);
    figures.triangles += triangles_of(*scene);
    PROMENADE_TRY(add_scene(*scene, origin.value_or(glm::dvec3(0)), options.time_s, instances_seen, portion));
    instances_seen += static_cast<uint32_t>(scene->instances.size());
    if (renderer.bytes() < options.memory_bytes && i + 1 < parts->size()) continue;
    PROMENADE_TRY(draw_portion(options, portion, origin.value_or(glm::dvec3(0)), renderer, frames, draw_s));
    portion = BruteForceScene(renderer);
  }
  if (figures.triangles == 0) return Error{fmt::format("{}: no triangles to draw", options.sources.front().string())};
  monitor.progress("draw the source", parts->size(), parts->size());
  figures.draw_ms_mean = options.cameras.empty() ? 0 : draw_s * 1e3 / double(options.cameras.size());
  return frames;
}

}  // namespace promenade
