#include <fmt/format.h>

#include <ctime>
#include <memory>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/far_command.h"
#include "layout/file_io.h"
#include "preprocess/build.h"
#include "preprocess/visibility/hider_chain.h"

namespace promenade {
namespace {

void print_summary(const BuildOptions& options, const BuildFigures& made, double seconds) {
  uint64_t bytes = 0;
  for (const auto& [part, size] : made.bytes_by_part) bytes += size;
  fmt::print("{}: {} triangles in {} nodes on {} levels, {} ({:.1f} bits a source triangle), {:.1f} s\n",
             options.model.string(), human_count(made.triangles_in), human_count(made.nodes), made.levels,
             human_bytes(bytes), made.triangles_in > 0 ? 8.0 * double(bytes) / double(made.triangles_in) : 0.0,
             seconds);
  const VisibilityFigures& seen = made.visibility;
  if (seen.cells > 0)
    fmt::print(
        "  {} view cells ({}), {:.0f} of {:.0f} triangles of a cell's front may be seen ({}), {:.1f} ms a cell\n",
        seen.cells, name_of(seen.style), seen.vlod_triangles_mean, seen.front_triangles_mean,
        made.hiders.empty() ? "nothing is hidden" : fmt::format("{}", fmt::join(made.hiders, ", ")), seen.ms_per_cell);
  if (made.far.cells > 0) print_far(made.far);
  for (const auto& [name, count] : made.import_counts)
    if (count > 0 &&
        (name.starts_with("faces_") || name.starts_with("vertices_") || name.starts_with("textures_missing")))
      fmt::print("  {}: {}\n", name, count);
}

Status run_build(const BuildOptions& options, JobMonitor& monitor, Json& figures) {
  const WallClock clock;
  const Result<BuildFigures> made = build_model(options, monitor);
  if (!made) return made.error();
  const double seconds = clock.seconds();
  figures = {{"triangles_in", made->triangles_in},
             {"nodes", made->nodes},
             {"leaves", made->leaves},
             {"levels", made->levels},
             {"triangles_stored", made->triangles_stored},
             {"bytes_by_part", made->bytes_by_part},
             {"stage_wall_s", made->stage_wall_s},
             {"stage_peak_rss_bytes", made->stage_peak_rss_bytes},
             {"node_cpu_s", made->node_cpu_s},
             {"cpu_s", double(std::clock()) / CLOCKS_PER_SEC},
             {"spill_bytes_peak", made->spill_bytes_peak},
             {"units_total", made->units_total},
             {"units_resumed", made->units_resumed},
             {"cells", made->visibility.cells},
             {"cells_style", name_of(made->visibility.style)},
             {"hiders", made->hiders},
             {"roofed_share", made->visibility.roofed_share},
             {"vlod_nodes_mean", made->visibility.vlod_nodes_mean},
             {"vlod_triangles_mean", made->visibility.vlod_triangles_mean},
             {"front_nodes_mean", made->visibility.front_nodes_mean},
             {"front_triangles_mean", made->visibility.front_triangles_mean},
             {"delta_bytes_mean", made->delta_bytes_mean},
             {"delta_ids_mean", made->delta_ids_mean},
             {"visibility_ms_per_cell", made->visibility.ms_per_cell},
             {"visibility_cells_computed", made->visibility.units.cells},
             {"far", json_of(made->far)},
             {"import_counts", made->import_counts},
             {"warnings", made->warnings},
             {"build_wall_s", seconds},
             {"triangles_per_s", seconds > 0 ? double(made->triangles_in) / seconds : 0.0}};
  uint64_t bytes = 0;
  for (const auto& [part, size] : made->bytes_by_part) bytes += size;
  figures["bits_per_source_triangle"] = made->triangles_in > 0 ? 8.0 * double(bytes) / double(made->triangles_in) : 0.0;
  print_summary(options, *made, seconds);
  return Done{};
}

Result<GeometryCodec> parse_codec(const std::string& text) {
  if (const std::optional<GeometryCodec> codec = geometry_codec_named(text)) return *codec;
  return Error{fmt::format("\"{}\" is no geometry codec: grown, meshopt, draco or raw", text)};
}

Result<LevelFactors> parse_level_factors(const std::string& text) {
  if (const std::optional<LevelFactors> factors = LevelFactors::named(text)) return *factors;
  return Error{fmt::format("\"{}\" are no numbers with commas between, such as 3,2,4", text)};
}

Result<CellStyle> parse_cells(const std::string& text) {
  if (const std::optional<CellStyle> style = cell_style_named(text)) return *style;
  return Error{fmt::format("\"{}\" is no division of viewing space: auto, octree, kd or none", text)};
}

Result<ErrorAt> parse_error_at(const std::string& text) {
  if (text == "center") return ErrorAt::center;
  if (text == "corner") return ErrorAt::corner;
  return Error{fmt::format("\"{}\" is no place in a picture: center or corner", text)};
}

constexpr uint64_t kLargestBoxes = uint64_t(64) << 20;

Result<glm::dvec3> corner_of(const Json& box, const char* name) {
  const auto found = box.is_object() ? box.find(name) : box.end();
  if (!box.is_object() || found == box.end() || !found->is_array() || found->size() != 3)
    return Error{fmt::format("\"{}\" is not three numbers", name)};
  glm::dvec3 corner(0);
  for (size_t i = 0; i < 3; ++i) {
    if (!(*found)[i].is_number()) return Error{fmt::format("\"{}\" is not three numbers", name)};
    corner[static_cast<int>(i)] = (*found)[i].get<double>();
  }
  return corner;
}

/// Boxes in the world, metres, from their file.
Result<std::vector<DBox>> read_boxes(const std::filesystem::path& file) {
  const Result<std::string> text = read_text_file(file, kLargestBoxes);
  if (!text) return text.error();
  const Json json = Json::parse(*text, nullptr, false);
  const auto list = json.is_object() ? json.find("boxes") : json.end();
  if (json.is_discarded() || !json.is_object() || list == json.end() || !list->is_array() || list->empty())
    return Error{fmt::format("{}: no \"boxes\" in it", file.string())};
  std::vector<DBox> boxes;
  for (const Json& entry : *list) {
    const Result<glm::dvec3> min = corner_of(entry, "min"), max = corner_of(entry, "max");
    if (!min || !max)
      return Error{fmt::format("{}: box {}: {}", file.string(), boxes.size(), (!min ? min : max).error().message)};
    boxes.push_back({*min, *max});
    if (boxes.back().empty())
      return Error{fmt::format("{}: box {}: min is above max", file.string(), boxes.size() - 1)};
  }
  return boxes;
}

/// What can be seen from where.
void add_cell_options(CLI::App& app, CellOptions& o) {
  CLI::Option_group* group = app.add_option_group("view cells", "What can be seen from where, computed once");
  o.cells = CellStyle::automatic;
  o.hiders = {std::string(kAutoHiders)};
  group
      ->add_option_function<std::string>(
          "--hiders",
          [&o](const std::string& text) {
            const Result<std::vector<std::string>> names = parse_hiders(text);
            if (!names) throw CLI::ValidationError("--hiders", names.error().message);
            o.hiders = *names;
          },
          fmt::format(
              "What proves that nodes are hidden, in order: none, some of {}, or auto: {} in an octree's cells, {} "
              "in those along walls, less what hides next to nothing in this model",
              hider_names(), fmt::join(hiders_for(CellStyle::octree), ","), fmt::join(hiders_for(CellStyle::kd), ",")))
      ->default_str(std::string(kAutoHiders));
  add_parsed<CellStyle>(*group, "--cells", o.cells, parse_cells,
                        "How viewing space is divided: octree, kd (along walls), none, or auto: kd indoors, where "
                        "walls hide a tenth, else octree")
      ->default_str("auto");
  group->add_option("--pixel-error", o.pixel_error, "Projected error that is allowed from anywhere in a cell, pixels")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  group
      ->add_option_function<std::string>(
          "--size",
          [&o](const std::string& text) {
            const Result<PixelSize> size = parse_size(text);
            if (!size) throw CLI::ValidationError("--size", size.error().message);
            o.width_px = size->width, o.height_px = size->height;
          },
          "Picture that it is meant for, pixels")
      ->default_str("1280x720");
  group->add_option("--fov", o.vertical_fov_deg, "Vertical field of view that it is meant for, degrees")
      ->check(CLI::Range(1.0, 170.0))
      ->capture_default_str();
  add_parsed<ErrorAt>(*group, "--error-at", o.error_at, parse_error_at,
                      "Where in the picture the error is counted: center, or corner, where perspective stretches most")
      ->default_str("center");
  group->add_option("--cell-triangles", o.cell_triangles, "Most triangles seen from a cell that is not divided further")
      ->capture_default_str();
  group
      ->add_option("--cell-gain", o.cell_gain,
                   "A cell is divided when it sees more than this many times what its smallest parts see")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  group->add_option("--smallest-cell", o.smallest_cell_m, "No cell is divided into parts shorter than this, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  group
      ->add_option("--least-room", o.least_room_m,
                   "No cells between walls nearer to each other than this, where nobody passes, m (with cells "
                   "along walls; at most a 32nd of the model's length; 0: cells there, too)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  group->add_option("--max-cells", o.max_cells, "Most cells, about (0: one a node, 256 to 4096)")
      ->capture_default_str();
  group
      ->add_option_function<double>(
          "--walk-height", [&o](double height_m) { o.walk_height_m = height_m; },
          "Cells only this high above what one may stand on, m (default: up to the sky)")
      ->check(CLI::PositiveNumber);
  group->add_flag("--openings", o.openings,
                  "Store what is open in the walls between view cells, for fly, view and render --eye-culling");
  group
      ->add_option_function<std::string>(
          "--cells-in",
          [&o](const std::string& file) {
            Result<std::vector<DBox>> boxes = read_boxes(file);
            if (!boxes) throw CLI::ValidationError("--cells-in", boxes.error().message);
            o.inside = std::move(*boxes);
          },
          "Cells only in the boxes of FILE: {\"boxes\": [{\"min\": [x,y,z], \"max\": [x,y,z]}, ...]}, m")
      ->type_name("FILE");
}

Result<UpAxis> parse_up(const std::string& text) {
  if (text == "y") return UpAxis::y;
  if (text == "z") return UpAxis::z;
  return Error{fmt::format("\"{}\" is no up axis: y or z", text)};
}

}  // namespace

void add_import_options(CLI::App& app, ImportOptions& import) {
  app.add_option_function<double>(
         "--unit", [&import](double metres) { import.unit_m = metres; },
         "Metres a unit of the source (default: what the format says)")
      ->check(CLI::PositiveNumber);
  app.add_option_function<std::string>(
      "--up",
      [&import](const std::string& text) {
        const Result<UpAxis> up = parse_up(text);
        if (!up) throw CLI::ValidationError("--up", up.error().message);
        import.up = *up;
      },
      "The source's up axis, y or z (default: what the format says)");
  app.add_flag("!--no-repair", import.repair,
               "Take faces as they are: degenerate, duplicate, inconsistently oriented ones too");
}

Command add_build(CLI::App& program) {
  auto options = std::make_shared<BuildOptions>();
  CLI::App* app = program.add_subcommand(
      "build", "Build a model from source files: read, repair, simplify into an HLOD tree, write");
  app->add_option("SOURCE", options->sources, "Files or folders: glTF, OBJ, PLY, CityJSON and what assimp reads")
      ->required();
  app->add_option("-o,--output", options->model, "MODEL: the directory to publish")->required();
  add_parsed<uint64_t>(*app, "--memory", options->memory_bytes, parse_bytes, "Bound on resident memory")
      ->default_str("4GiB");
  app->add_option("--jobs", options->jobs, "Threads (0: as many as cores); the bytes are the same")
      ->capture_default_str();
  app->add_option("--node-triangles", options->node_triangles,
                  "Most triangles of a node; more: fewer draws, coarser culling")
      ->capture_default_str();
  add_parsed<LevelFactors>(*app, "--level-factor", options->level_factors, parse_level_factors,
                           "About how many children nodes have, from just above the leaves up; the last for all levels "
                           "above it. Smaller: finer levels, a larger model")
      ->default_str(options->level_factors.name());
  add_parsed<GeometryCodec>(*app, "--geometry-codec", options->geometry_codec, parse_codec,
                            "grown, meshopt, draco or raw")
      ->default_str("grown");
  app->add_option("--max-texture", options->max_texture_px, "Longest side of a stored texture, pixels")
      ->capture_default_str();
  app->add_option("--jpeg-quality", options->jpeg_quality, "Of textures that are coded anew, 1 to 100")
      ->capture_default_str();
  add_cell_options(*app, options->visibility);
  CLI::Option_group* far = app->add_option_group(
      "far pictures",
      "What lies beyond a box around the eye as pictures, for the policies stratified, vlod-stratified");
  far->add_flag("--far-pictures", options->far.pictures, "Make them");
  add_far_options(*far, options->far);
  add_parsed<NodeOrderOptions>(*app, "--order", options->order, parse_node_order,
                               "Order of meshes on disk in a model with cells: tour, bisection, hilbert, morton, input "
                               "or file:FILE (a node's number a line)")
      ->default_str("tour");
  add_import_options(*app, options->import);
  return {app, {}, [options](JobMonitor& monitor, Json& figures) { return run_build(*options, monitor, figures); }};
}

}  // namespace promenade
