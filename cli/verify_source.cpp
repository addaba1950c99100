#include "cli/verify_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "cli/picture.h"
#include "cli/source_renderer.h"
#include "cli/view_options.h"
#include "preprocess/visibility/eyes.h"
#include "preprocess/visibility/node_meshes.h"
#include "preprocess/visibility/study_cells.h"
#include "raster/picture_error.h"
#include "runtime/cpu_renderer.h"
#include "runtime/far_stage.h"
#include "runtime/session.h"

namespace promenade {
namespace {

constexpr uint64_t kMemoryBytes = uint64_t(4) << 30;
constexpr uint32_t kEyeCells = 16;  // in a model without cells

/// Where somebody may stand: the model's cells, or places on the ground and in the air.
Result<std::vector<Box>> places_of(const ModelReader& reader, const NodeMeshes& meshes, uint64_t seed) {
  std::vector<Box> boxes;
  if (reader.cells() != nullptr) {
    boxes.reserve(reader.cells()->tables().cells.size());
    for (const CellRecord& cell : reader.cells()->tables().cells) boxes.push_back(cell.box);
    return boxes;
  }
  StudyCellOptions study;
  study.seed = seed, study.cells = kEyeCells;
  for (const StudyPlace place : {StudyPlace::street, StudyPlace::roof}) {
    study.place = place;
    const Result<std::vector<Box>> made = study_cells(meshes, study);
    if (!made) return made.error();
    boxes.insert(boxes.end(), made->begin(), made->end());
  }
  return boxes;
}

Result<std::vector<Camera>> random_cameras(const VerifySourceOptions& options, const ModelReader& reader) {
  const Result<std::unique_ptr<NodeMeshes>> meshes = NodeMeshes::make(reader, uint64_t(1) << 30);
  if (!meshes) return meshes.error();
  const Result<std::vector<Box>> places = places_of(reader, **meshes, options.seed);
  if (!places) return places.error();
  if (places->empty()) return Error{"there is no place in this model where anybody could stand"};
  const Model& model = reader.model();
  const FrontBound bound{options.pixel_error,
                         pixel_scale(options.size.width, options.size.height, options.vertical_fov_deg)};
  Random random(options.seed);
  std::vector<Camera> cameras;
  cameras.reserve(options.views);
  const uint64_t most_tries = uint64_t(options.views) * 20 + 100;
  for (uint64_t i = 0; i < most_tries && cameras.size() < options.views; ++i) {
    const Box& place = (*places)[random.below(static_cast<uint32_t>(places->size()))];
    const Result<HeldNodes> held = hold_nodes(**meshes, cell_front(model, place, bound));
    if (!held) return held.error();
    EyeFinder finder(place, held->items, !model.objects.footprints.empty(), random.fork(i));
    const Result<std::optional<glm::dvec3>> eye = finder.next();
    if (!eye) return eye.error();
    if (!*eye) continue;
    Camera camera;
    camera.pose.eye = **eye + model.manifest.origin;
    camera.pose.yaw_deg = random.range(0.0, 360.0), camera.pose.pitch_deg = random.range(-40.0, 20.0);
    camera.width_px = options.size.width, camera.height_px = options.size.height;
    camera.vertical_fov_deg = options.vertical_fov_deg;
    camera.near_m = EyeFinder::kNearM;
    cameras.push_back(camera);
  }
  if (cameras.empty()) return Error{"no place was found in this model where anybody could stand"};
  return cameras;
}

/// Evenly along a recorded path.
Result<std::vector<Camera>> path_cameras(const VerifySourceOptions& options) {
  const Result<CameraPath> path = read_path(options.path);
  if (!path) return path.error();
  Camera camera;
  camera.width_px = options.size.width, camera.height_px = options.size.height;
  camera.vertical_fov_deg = options.vertical_fov_deg;
  std::vector<Camera> cameras;
  cameras.reserve(options.views);
  for (uint32_t i = 0; i < options.views; ++i) {
    const double share = (i + 0.5) / options.views;
    camera.pose = pose_at(*path, path->keys.front().t_s + share * path->duration_s());
    cameras.push_back(camera);
  }
  return cameras;
}

/// The sides of the far pictures around an eye's cell. Metres, model space.
Status add_far_surface(const ModelSource& source, const glm::dvec3& eye, std::vector<glm::vec3>& positions,
                       std::vector<uint32_t>& indices) {
  const FarTables& tables = *source.far();
  const std::optional<FarCellId> innermost = far_cell_at(tables, eye);
  if (!innermost) return Done{};
  FarKey key;
  for (const FarCellId cell : chain_of(tables, *innermost)) {
    const FarCellRecord& record = tables.cells[index_of(cell)];
    for (uint32_t face = record.first_face; face < record.first_face + record.face_count; ++face) {
      const Result<FarFace> side = read_far_side(source, cell, face, key);
      if (!side) return side.error();
      const Mesh mesh = far_mesh(*side, place_of_far_side(tables, cell, face));
      const auto first = static_cast<uint32_t>(positions.size());
      positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
      indices.reserve(indices.size() + mesh.indices.size());
      for (const uint32_t i : mesh.indices) indices.push_back(first + i);
    }
  }
  return Done{};
}

/// What a front's nodes are made of, and the far picture around `far_eye` if there is one, in one mesh.
Result<ClosestPointTree> surface_of(const ModelReader& reader, std::span<const NodeId> front, const ModelSource& source,
                                    const std::optional<glm::dvec3>& far_eye) {
  std::vector<glm::vec3> positions;
  std::vector<uint32_t> indices;
  const Model& model = reader.model();
  const std::vector<glm::dmat4> moving = model_from_objects(model, 0);
  for (const NodeId id : front) {
    Result<Mesh> mesh = reader.read_mesh(id);
    if (!mesh) return mesh.error();
    if (model.is_moving(id))
      mesh = transformed(*mesh, moving[model.objects.moving_nodes[index_of(id) - model.first_moving_node()].object]);
    const auto first = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), mesh->positions.begin(), mesh->positions.end());
    indices.reserve(indices.size() + mesh->indices.size());
    for (const uint32_t i : mesh->indices) indices.push_back(first + i);
  }
  if (far_eye) PROMENADE_TRY(add_far_surface(source, *far_eye, positions, indices));
  return ClosestPointTree(positions, indices);
}

/// The source's picture, the model's, and black where they differ, side by side.
Status write_difference(const Frame& source, const Frame& model, const std::filesystem::path& path) {
  const uint32_t w = source.width_px, h = source.height_px;
  Frame sheet{w * 3, h, {w * 3, h, {}}, {}, {}};
  sheet.color.pixels.assign(size_t(w) * 3 * h, glm::u8vec4(255));
  for (uint32_t y = 0; y < h; ++y)
    for (uint32_t x = 0; x < w; ++x) {
      const glm::u8vec4 a = source.color.at(x, y), b = model.color.at(x, y);
      sheet.color.at(x, y) = a, sheet.color.at(w + x, y) = b;
      int difference = 0;
      for (int c = 0; c < 3; ++c) difference = std::max(difference, std::abs(int(a[c]) - int(b[c])));
      const auto gray = static_cast<uint8_t>(255 - std::min(255, difference * 4));
      sheet.color.at(2 * w + x, y) = {gray, gray, gray, 255};
    }
  return write_frame(sheet, Aov::color, path);
}

}  // namespace

Status verify_source(const VerifySourceOptions& options, const ModelReader& reader, JobMonitor& monitor,
                     Json& figures) {
  if (!options.picture.empty()) PROMENADE_TRY(check_picture_name(Aov::color, options.picture));
  const Result<std::vector<Camera>> cameras =
      options.path.empty() ? random_cameras(options, reader) : path_cameras(options);
  if (!cameras) return cameras.error();
  const std::unique_ptr<Renderer> renderer = create_cpu_renderer({.close_gaps = true});
  SourceRenderOptions reference;
  reference.sources = options.sources, reference.import = options.import, reference.cameras = *cameras;
  reference.memory_bytes = kMemoryBytes;
  SourceRenderFigures drawn;
  const Result<std::vector<Frame>> sources = render_source(reference, *renderer, drawn, monitor);
  if (!sources) return sources.error();
  const uint64_t expected = reader.model().manifest.source_triangles;
  if (drawn.triangles != expected)
    return Error{fmt::format("{} has {} triangles, this model's source had {}: not the same, or read otherwise",
                             options.sources.front().string(), drawn.triangles, expected)};

  const std::unique_ptr<ModelSource> model = source_of(reader);
  SessionOptions session_options;
  session_options.loader.memory_bytes = kMemoryBytes;
  session_options.loader_thread = false;
  session_options.fade_frames = 0;  // still pictures
  session_options.select.policy = options.policy, session_options.select.pixel_error = options.pixel_error;
  Result<Session> session = Session::open(*model, *renderer, session_options);
  if (!session) return session.error();
  PictureErrors errors;
  uint64_t most_other = 0;
  for (size_t i = 0; i < cameras->size(); ++i) {
    monitor.progress("compare pictures", i, cameras->size());
    if (monitor.cancelled()) return Error{"interrupted"};
    const Camera& camera = (*cameras)[i];
    const Result<FrameRow> row = session->settle(camera);
    if (!row) return row.error();
    const Result<Frame> frame = read_frame(*renderer, camera.width_px, camera.height_px, Aov::color, true);
    if (!frame) return frame.error();
    std::optional<glm::dvec3> far_eye;
    if (row->far_layers > 0) far_eye = camera.pose.eye - reader.model().manifest.origin;
    const Result<ClosestPointTree> surface = surface_of(reader, session->selection().front, *model, far_eye);
    if (!surface) return surface.error();
    const Frame& source = (*sources)[i];
    const uint64_t other_before = errors.pixels_of_other_color();
    errors.add(perspective_view(camera, reader.model().manifest.origin), {source.depth_m, source.color.pixels},
               {frame->depth_m, frame->color.pixels}, *surface);
    const uint64_t other = errors.pixels_of_other_color() - other_before;
    if (!options.picture.empty() && other > most_other)
      PROMENADE_TRY(write_difference(source, *frame, options.picture));
    most_other = std::max(most_other, other);
  }
  monitor.progress("compare pictures", cameras->size(), cameras->size());
  const double other_share = double(errors.pixels_of_other_color()) / double(errors.pixels());
  figures["source_views"] = cameras->size();
  figures["pixel_error_p99_px"] = errors.quantile_px(0.99);
  figures["pixel_error_max_px"] = errors.largest_px();
  figures["background_pixels"] = errors.background_pixels();
  figures["pixels_of_other_color_share"] = other_share;
  fmt::print("{} views against the source, {} points: pixel error {:.2f} (99 of 100), {:.2f} at most\n",
             cameras->size(), errors.points(), errors.quantile_px(0.99), errors.largest_px());
  fmt::print("  {} pixels show the background through a surface; {:.2f} % have a colour that the source has not near\n",
             errors.background_pixels(), other_share * 100);
  return Done{};
}

}  // namespace promenade
