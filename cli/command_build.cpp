#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/console.h"
#include "preprocess/build.h"

namespace promenade {
namespace {

void print_summary(const BuildOptions& options, const BuildFigures& made, double seconds) {
  uint64_t bytes = 0;
  for (const auto& [part, size] : made.bytes_by_part) bytes += size;
  fmt::print("{}: {} triangles in {} nodes on {} levels, {} ({:.1f} bits a source triangle), {:.1f} s\n",
             options.model.string(), human_count(made.triangles_in), human_count(made.nodes), made.levels,
             human_bytes(bytes), made.triangles_in > 0 ? 8.0 * double(bytes) / double(made.triangles_in) : 0.0,
             seconds);
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
             {"spill_bytes_peak", made->spill_bytes_peak},
             {"units_total", made->units_total},
             {"units_resumed", made->units_resumed},
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
  return Error{fmt::format("\"{}\" is no geometry codec: draco, meshopt or raw", text)};
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
  app->add_option("--level-factor", options->level_factor, "Children a node and ratio of triangles between levels")
      ->capture_default_str();
  add_parsed<GeometryCodec>(*app, "--geometry-codec", options->geometry_codec, parse_codec, "draco, meshopt or raw")
      ->default_str("meshopt");
  app->add_option("--max-texture", options->max_texture_px, "Longest side of a stored texture, pixels")
      ->capture_default_str();
  app->add_option("--jpeg-quality", options->jpeg_quality, "Of textures that are coded anew, 1 to 100")
      ->capture_default_str();
  add_import_options(*app, options->import);
  return {app, {}, [options](JobMonitor& monitor, Json& figures) { return run_build(*options, monitor, figures); }};
}

}  // namespace promenade
