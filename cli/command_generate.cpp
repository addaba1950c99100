#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/console.h"
#include "datasets/building.h"
#include "datasets/city.h"

namespace promenade {
namespace {

struct GenerateArguments {
  CityOptions city;
  BuildingOptions building;
  std::filesystem::path output;
  std::string style = "grid";
  bool make_building = false;
};

Json json_of(const DBox& box) {
  return {{"min", {box.min.x, box.min.y, box.min.z}}, {"max", {box.max.x, box.max.y, box.max.z}}};
}

double per_second(uint64_t count, double seconds) { return seconds > 0 ? double(count) / seconds : 0; }

Status run_city(const GenerateArguments& arguments, JobMonitor& monitor, Json& figures) {
  const WallClock clock;
  const Result<CityFigures> made = generate_city(arguments.city, arguments.output, monitor);
  if (!made) return made.error();
  const double seconds = clock.seconds();
  figures = {{"triangles", made->triangles},
             {"unique_triangles", made->unique_triangles},
             {"objects", made->objects},
             {"buildings", made->buildings},
             {"files", made->files},
             {"bytes", made->bytes},
             {"texture_megapixels", made->texture_megapixels},
             {"box", json_of(made->box)},
             {"generate_wall_s", seconds},
             {"triangles_per_s", per_second(made->triangles, seconds)}};
  fmt::print("{}: {} triangles, {} buildings, {} objects, {:.0f} x {:.0f} m, {} in {} file(s)\n",
             arguments.output.string(), human_count(made->triangles), made->buildings, human_count(made->objects),
             made->box.size().x, made->box.size().y, human_bytes(made->bytes), made->files);
  return Done{};
}

Status run_building(const GenerateArguments& arguments, JobMonitor& monitor, Json& figures) {
  const WallClock clock;
  const Result<BuildingFigures> made = generate_building(arguments.building, arguments.output, monitor);
  if (!made) return made.error();
  const double seconds = clock.seconds();
  figures = {{"triangles", made->triangles},
             {"unique_triangles", made->unique_triangles},
             {"structure_triangles", made->structure_triangles},
             {"objects", made->objects},
             {"unique_objects", made->unique_objects},
             {"classes", made->classes},
             {"rooms", made->rooms},
             {"files", made->files},
             {"bytes", made->bytes},
             {"box", json_of(made->box)},
             {"generate_wall_s", seconds},
             {"triangles_per_s", per_second(made->triangles, seconds)}};
  fmt::print("{}: {} triangles, {} objects ({} unique) of {} classes in {} rooms, {}\n", arguments.output.string(),
             human_count(made->triangles), made->objects, made->unique_objects, made->classes, made->rooms,
             human_bytes(made->bytes));
  return Done{};
}

void add_city_options(CLI::App& app, GenerateArguments& arguments) {
  CityOptions& city = arguments.city;
  app.add_option("--style", arguments.style, "Street plan: grid, or organic (curved, unaligned)")
      ->check(CLI::IsMember({"grid", "organic"}))
      ->capture_default_str();
  app.add_option("--blocks-x", city.blocks_x, "Blocks along x (0: as --triangles asks)")->capture_default_str();
  app.add_option("--blocks-y", city.blocks_y, "Blocks along y (0: as --triangles asks)")->capture_default_str();
  app.add_option("--block-length", city.block_length_m, "Length of a block, m")->capture_default_str();
  app.add_option("--block-width", city.block_width_m, "Width of a block, m")->capture_default_str();
  app.add_option("--rows", city.max_rows, "Most rows of buildings on a block")->capture_default_str();
  app.add_option("--columns", city.max_columns, "Most columns of buildings in a row")->capture_default_str();
  app.add_option("--max-height", city.max_height_m, "Highest building, m")->capture_default_str();
  app.add_option("--street-width", city.street_width_m, "Width of a street, m")->capture_default_str();
  app.add_option("--street-height", city.street_height_m, "Height of the streets' surface, m")->capture_default_str();
  app.add_option("--curb-width", city.curb_width_m, "Width of the pavement, m")->capture_default_str();
  app.add_option("--curb-height", city.curb_height_m, "Height of the pavement above the street, m")
      ->capture_default_str();
  app.add_option("--tree-distance", city.tree_distance_m, "Distance between street trees, m (0: none)")
      ->capture_default_str();
  app.add_option("--moving", city.moving, "Cars that drive around blocks: animated objects, besides --triangles")
      ->capture_default_str();
  app.add_flag("--plain", city.plain,
               "Buildings without windows, streets with trees alone: a few hundred triangles a building");
  app.add_flag("--interiors", city.interiors, "Furnished rooms behind the windows");
  app.add_option("--texture-megapixels", city.texture_megapixels,
                 "Unique facade textures, all together (0: colours only)")
      ->capture_default_str();
  app.add_option("--tile-triangles", city.tile_triangles, "A larger city becomes a folder of tiles of about this size")
      ->capture_default_str();
}

}  // namespace

Command add_generate(CLI::App& program) {
  auto arguments = std::make_shared<GenerateArguments>();
  CLI::App* app =
      program.add_subcommand("generate", "Generate a city or a furnished building, with camera paths beside it");
  app->add_option_function<std::string>(
         "KIND", [arguments](const std::string& kind) { arguments->make_building = kind == "building"; },
         "city or building")
      ->required()
      ->check(CLI::IsMember({"city", "building"}));
  app->add_option("-o,--output", arguments->output,
                  "FILE.glb, or a folder for tiles; of a city also FILE.city.jsonl: CityJSON, "
                  "its buildings plain closed solids")
      ->required();
  app->add_option_function<uint64_t>(
         "--seed", [arguments](uint64_t seed) { arguments->city.seed = arguments->building.seed = seed; },
         "Another seed, another city")
      ->default_str("1");
  app->add_option_function<uint64_t>(
         "--triangles",
         [arguments](uint64_t count) { arguments->city.triangles = arguments->building.triangles = count; },
         "Triangles to aim at, instances counted each")
      ->default_str("city 1000000, building 1400000");
  app->add_option_function<uint32_t>(
         "--jobs", [arguments](uint32_t jobs) { arguments->city.jobs = arguments->building.jobs = jobs; },
         "Threads (0: as many as cores); the bytes are the same")
      ->default_str("0");
  CLI::Option_group* city = app->add_option_group("city", "Only for a city");
  add_city_options(*city, *arguments);
  CLI::Option_group* building = app->add_option_group("building", "Only for a building");
  building->add_option("--floors", arguments->building.floors, "Floors")->capture_default_str();
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) {
            arguments->city.style = arguments->style == "organic" ? StreetStyle::organic : StreetStyle::grid;
            return arguments->make_building ? run_building(*arguments, monitor, figures)
                                            : run_city(*arguments, monitor, figures);
          }};
}

}  // namespace promenade
