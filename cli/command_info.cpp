#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <span>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/view_options.h"
#include "layout/model_io.h"
#include "runtime/front.h"

namespace promenade {
namespace {

struct LevelSummary {
  uint64_t nodes = 0, triangles = 0, stored_bytes = 0;
  double error_m_sum = 0;
  float error_m_max = 0;
};

std::vector<LevelSummary> summarize_levels(const ModelTables& tables) {
  std::vector<LevelSummary> levels;
  for (const NodeRecord& node : tables.nodes) {
    if (levels.size() <= node.level) levels.resize(size_t(node.level) + 1);
    LevelSummary& level = levels[node.level];
    ++level.nodes;
    level.triangles += node.triangles;
    level.stored_bytes += tables.segments[node.segment].stored_bytes;
    level.error_m_sum += double(node.error_m);
    level.error_m_max = std::max(level.error_m_max, node.error_m);
  }
  return levels;
}

Json json_of_levels(const std::vector<LevelSummary>& levels) {
  Json rows = Json::array();
  for (size_t i = 0; i < levels.size(); ++i)
    rows.push_back({{"level", i},
                    {"nodes", levels[i].nodes},
                    {"triangles", levels[i].triangles},
                    {"stored_bytes", levels[i].stored_bytes},
                    {"error_m_mean", levels[i].error_m_sum / double(levels[i].nodes)},
                    {"error_m_max", levels[i].error_m_max}});
  return rows;
}

struct ClassSummary {
  double area_m2 = 0;
  uint64_t leaves = 0;
};

/// By name, what the source's classes come to.
std::map<std::string, ClassSummary> summarize_classes(const ModelObjects& objects) {
  std::map<std::string, ClassSummary> classes;
  for (const ClassShare& share : objects.class_shares) {
    ClassSummary& sum = classes[objects.classes[share.class_index]];
    sum.area_m2 += double(share.area_m2);
    ++sum.leaves;
  }
  return classes;
}

Json json_of_classes(const ModelObjects& objects) {
  Json rows = Json::array();
  for (const auto& [name, sum] : summarize_classes(objects))
    rows.push_back({{"name", name}, {"area_m2", sum.area_m2}, {"leaves", sum.leaves}});
  return rows;
}

Json json_of_model(const Model& model) {
  const ModelManifest& manifest = model.manifest;
  Json files = Json::object();
  for (const ModelManifest::File& file : manifest.files) files[file.name] = file.bytes;
  const DBox& box = manifest.world_box;
  const auto leaf = [](const NodeRecord& node) { return node.child_count == 0; };
  return {{"format_version", ModelManifest::kVersion},
          {"tool_version", manifest.tool_version},
          {"sources", manifest.sources},
          {"settings", manifest.settings},
          {"source_triangles", manifest.source_triangles},
          {"nodes", model.tables.nodes.size()},
          {"leaves", std::count_if(model.tables.nodes.begin(), model.tables.nodes.end(), leaf)},
          {"materials", model.tables.materials.size()},
          {"textures", model.tables.textures.size()},
          {"origin", {manifest.origin.x, manifest.origin.y, manifest.origin.z}},
          {"world_box", {{"min", {box.min.x, box.min.y, box.min.z}}, {"max", {box.max.x, box.max.y, box.max.z}}}},
          {"bytes_by_file", files},
          {"moving_objects", model.objects.moving.size()},
          {"moving_nodes", model.objects.moving_nodes.size()},
          {"footprints", model.objects.footprints.all.size()},
          {"classes", json_of_classes(model.objects)},
          {"levels", json_of_levels(summarize_levels(model.tables))},
          {"import_counts", manifest.import_counts},
          {"notes", manifest.notes}};
}

void print_model(const std::filesystem::path& path, const Model& model) {
  const ModelManifest& manifest = model.manifest;
  uint64_t bytes = 0;
  for (const ModelManifest::File& file : manifest.files) bytes += file.bytes;
  fmt::print("{}: built by promenade {} from", path.string(), manifest.tool_version);
  for (size_t i = 0; i < manifest.sources.size() && i < 4; ++i) fmt::print(" {}", manifest.sources[i]);
  if (manifest.sources.size() > 4) fmt::print(" and {} more", manifest.sources.size() - 4);
  const glm::dvec3 size = manifest.world_box.size();
  const double triangles = std::max(1.0, double(manifest.source_triangles));
  fmt::print("\n  {} source triangles, {:.1f} x {:.1f} x {:.1f} m\n", human_count(manifest.source_triangles), size.x,
             size.y, size.z);
  fmt::print("  {} nodes, {} materials, {} textures, {}, {:.1f} bits a source triangle\n", model.tables.nodes.size(),
             model.tables.materials.size(), model.tables.textures.size(), human_bytes(bytes),
             8.0 * double(bytes) / triangles);
  for (const ModelManifest::File& file : manifest.files)
    fmt::print("    {:<16} {:>12}\n", file.name, human_bytes(file.bytes));
  fmt::print("  level    nodes    triangles   error m (mean, max)\n");
  const std::vector<LevelSummary> levels = summarize_levels(model.tables);
  for (size_t i = 0; i < levels.size(); ++i)
    fmt::print("  {:>5} {:>8} {:>12}   {:.4f} {:.4f}\n", i, levels[i].nodes, levels[i].triangles,
               levels[i].error_m_sum / double(levels[i].nodes), levels[i].error_m_max);
  if (!model.objects.moving.empty())
    fmt::print("  {} objects that move, {} nodes\n", model.objects.moving.size(), model.objects.moving_nodes.size());
  for (const auto& [name, sum] : summarize_classes(model.objects))
    fmt::print("  class {}: {:.0f} m2 in {} leaves\n", name.empty() ? "(none)" : name, sum.area_m2, sum.leaves);
  for (const auto& [name, value] : manifest.settings) fmt::print("  --{} {}\n", name, value);
  for (const auto& [name, count] : manifest.import_counts) fmt::print("  {}: {}\n", name, count);
  for (const std::string& note : manifest.notes) fmt::print("  note: {}\n", note);
}

struct InfoArguments {
  std::filesystem::path model;
  std::filesystem::path front_from;  ///< a path whose eyes see the fronts; empty: none
  uint32_t eyes = 20;
  std::optional<glm::dvec3> cell_at;  ///< world; which cell to describe
  double pixel_error = 1;
  ErrorKind error_kind = ErrorKind::bound;
  ViewOptions view;
};

/// The fronts that a path's eyes ask for, evenly spread over its time.
Status measure_fronts(const InfoArguments& arguments, const Model& model, Json& figures) {
  const Result<CameraPath> path = read_path(arguments.front_from);
  if (!path) return path.error();
  FrontCount sum;
  uint64_t largest = 0, largest_in_view = 0;
  for (uint32_t i = 0; i < arguments.eyes; ++i) {
    const double t_s = path->keys.front().t_s + path->duration_s() * (i + 0.5) / arguments.eyes;
    const FrontCount at =
        count_front(model, camera_of(arguments.view, pose_at(*path, t_s)), arguments.pixel_error, arguments.error_kind);
    const auto add = [](FrontSize& to, const FrontSize& from) {
      to.nodes += from.nodes, to.triangles += from.triangles;
    };
    add(sum.front, at.front), add(sum.front_in_view, at.front_in_view);
    add(sum.leaves, at.leaves), add(sum.leaves_in_view, at.leaves_in_view);
    largest = std::max(largest, at.front.triangles);
    largest_in_view = std::max(largest_in_view, at.front_in_view.triangles);
  }
  const auto mean = [&](uint64_t total) { return double(total) / arguments.eyes; };
  const auto share = [](const FrontSize& part, const FrontSize& whole) {
    return whole.triangles > 0 ? double(part.triangles) / double(whole.triangles) : 0.0;
  };
  figures["front"] = {{"eyes", arguments.eyes},
                      {"pixel_error", arguments.pixel_error},
                      {"error_kind", arguments.error_kind == ErrorKind::bound ? "bound" : "p99"},
                      {"triangles_mean", mean(sum.front.triangles)},
                      {"triangles_max", largest},
                      {"nodes_mean", mean(sum.front.nodes)},
                      {"full_triangles_mean", mean(sum.leaves.triangles)},
                      {"share_of_full", share(sum.front, sum.leaves)},
                      {"in_view_triangles_mean", mean(sum.front_in_view.triangles)},
                      {"in_view_triangles_max", largest_in_view},
                      {"in_view_nodes_mean", mean(sum.front_in_view.nodes)},
                      {"in_view_full_triangles_mean", mean(sum.leaves_in_view.triangles)},
                      {"in_view_share_of_full", share(sum.front_in_view, sum.leaves_in_view)}};
  const auto print = [&](const char* where, const FrontSize& front, const FrontSize& full) {
    fmt::print("  front {}: {:.0f} triangles in {:.1f} nodes of {:.0f} triangles ({:.1f} %)\n", where,
               mean(front.triangles), mean(front.nodes), mean(full.triangles), 100 * share(front, full));
  };
  print("in all directions", sum.front, sum.leaves), print("in view", sum.front_in_view, sum.leaves_in_view);
  return Done{};
}

Json json_of(const DBox& box) {
  return {{"min", {box.min.x, box.min.y, box.min.z}}, {"max", {box.max.x, box.max.y, box.max.z}}};
}

Json json_of(std::span<const NodeId> nodes) {
  Json ids = Json::array();
  for (const NodeId id : nodes) ids.push_back(index_of(id));
  return ids;
}

/// The view cells altogether.
Json json_of_cells(const CellsReader& cells) {
  uint64_t nodes = 0, bytes = 0;
  const auto cell_count = static_cast<uint32_t>(cells.tables().cells.size());
  for (uint32_t i = 0; i < cell_count; ++i) nodes += cells.vlod_nodes(CellId{i});
  for (const VlodBlock& block : cells.blocks()) bytes += block.stored_bytes;
  const double count = std::max(1.0, double(cell_count));
  const FrontBound& bound = cells.tables().bound;
  return {{"cells", cells.tables().cells.size()},     {"faces", cells.tables().faces.size()},
          {"portals", cells.tables().portals.size()}, {"pixel_error", bound.pixel_error},
          {"focal_px", bound.scale.focal_px},         {"tan_corner", bound.scale.tan_corner},
          {"vlod_nodes_mean", double(nodes) / count}, {"vlod_bytes_mean", double(bytes) / count},
          {"vlod_blocks", cells.blocks().size()}};
}

/// One cell and what is seen from it. eye: world.
Status describe_cell(const ModelReader& reader, const glm::dvec3& eye, Json& figures) {
  if (reader.cells() == nullptr) return Error{"the model has no view cells; build it with --cells auto"};
  const CellTables& tables = reader.cells()->tables();
  const glm::dvec3& origin = reader.model().manifest.origin;
  const std::optional<CellId> id = cell_at(tables, eye - origin);
  if (!id) return Error{fmt::format("no view cell holds {},{},{}: the tree alone serves there", eye.x, eye.y, eye.z)};
  const Box& box = tables.cells[index_of(*id)].box;
  const DBox world{glm::dvec3(box.min) + origin, glm::dvec3(box.max) + origin};
  const Result<Vlod> vlod = reader.cells()->read_vlod(*id);
  if (!vlod) return vlod.error();
  const std::vector<NodeId> front = cell_front(reader.model(), box, tables.bound);
  Json neighbours = Json::array();
  for (const uint32_t face : tables.faces_of(*id)) neighbours.push_back(index_of(tables.faces[face].other(*id)));
  figures["cell"] = {{"id", index_of(*id)}, {"box", json_of(world)}};
  figures["neighbours"] = neighbours;
  figures["front"] = json_of(front);
  figures["vlod"] = json_of(vlod->nodes);
  fmt::print(
      "  cell {}: {:.2f},{:.2f},{:.2f} to {:.2f},{:.2f},{:.2f}, {} neighbours, {} of the {} nodes of its front "
      "may be seen\n",
      index_of(*id), world.min.x, world.min.y, world.min.z, world.max.x, world.max.y, world.max.z, neighbours.size(),
      vlod->nodes.size(), front.size());
  return Done{};
}

Result<glm::dvec3> parse_point(const std::string& text) {
  const Result<Pose> pose = parse_pose(text + ",0,0");
  if (!pose || std::count(text.begin(), text.end(), ',') != 2)
    return Error{fmt::format("\"{}\" is no point: x,y,z in metres", text)};
  return pose->eye;
}

}  // namespace

Command add_info(CLI::App& program) {
  auto arguments = std::make_shared<InfoArguments>();
  CLI::App* app = program.add_subcommand("info", "What is inside a model: counts, sizes by part, settings, provenance");
  app->add_option("MODEL", arguments->model, "A directory that build made")->required();
  app->add_option_function<std::string>(
         "--cell",
         [arguments](const std::string& text) {
           const Result<glm::dvec3> point = parse_point(text);
           if (!point) throw CLI::ValidationError("--cell", point.error().message);
           arguments->cell_at = *point;
         },
         "The view cell that holds this point, and what is seen from it (with --json: its nodes)")
      ->type_name("x,y,z");
  CLI::Option_group* front = app->add_option_group("fronts", "How many triangles views ask for, beside full detail");
  front->add_option("--front-from", arguments->front_from, "A camera path whose eyes see the fronts")
      ->type_name("FILE");
  front->add_option("--eyes", arguments->eyes, "How many eyes, evenly along the path")
      ->check(CLI::Range(1U, 100000U))
      ->capture_default_str();
  add_error_options(*front, arguments->pixel_error, arguments->error_kind);
  add_frame_options(*front, arguments->view);
  return {app, {}, [arguments](JobMonitor&, Json& figures) -> Status {
            const Result<ModelReader> reader = ModelReader::open(arguments->model);
            if (!reader) return reader.error();
            print_model(arguments->model, reader->model());
            figures = json_of_model(reader->model());
            if (reader->cells() != nullptr) figures["view_cells"] = json_of_cells(*reader->cells());
            if (arguments->cell_at) PROMENADE_TRY(describe_cell(*reader, *arguments->cell_at, figures));
            if (arguments->front_from.empty()) return Done{};
            return measure_fronts(*arguments, reader->model(), figures);
          }};
}

}  // namespace promenade
