#include "cli/study_far.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/trigonometric.hpp>
#include <memory>

#include "cli/console.h"
#include "cli/near_sets.h"
#include "cli/view_options.h"
#include "geometry/parallax.h"
#include "preprocess/far/far_cell.h"
#include "preprocess/far/far_options.h"

namespace promenade {
namespace {

constexpr uint64_t kCacheBytes = uint64_t(1) << 30;

struct Arguments {
  std::filesystem::path model, path_file;
  FarOptions far;
  uint32_t places = 10;
  std::vector<double> flat_cells{1, 0.5, 0.25}, depth_cells{4, 2, 1};
  std::vector<uint32_t> steps{1, 2};
};

/// A way to store a side.
struct Way {
  const char* name;
  FarForetelling how;
  bool alone, shifts;
};
constexpr std::array kWays = {
    Way{"alone", FarForetelling::still, true, false}, Way{"difference", FarForetelling::still, false, false},
    Way{"shifted", FarForetelling::still, false, true}, Way{"warped", FarForetelling::warped, false, false},
    Way{"warped, shifted", FarForetelling::warped, false, true}};

/// What sides took, stored in one way.
struct Sum {
  uint64_t bytes = 0, picture_bytes = 0, faces = 0;
  double encode_s = 0, decode_s = 0;
  double error = 0;  ///< sum of differences of channels from what was drawn, 0 to 255
  uint64_t channels = 0;
};

void add_error(const Image& drawn, const Image& decoded, Sum& sum) {
  for (size_t i = 0; i < drawn.pixels.size(); ++i) {
    if (drawn.pixels[i].a == 0) continue;
    for (int c = 0; c < 3; ++c) sum.error += std::abs(double(drawn.pixels[i][c]) - double(decoded.pixels[i][c]));
    sum.channels += 3;
  }
}

/// Stores a side in one way, and reads it again.
Result<FarFace> store(const FarFace& face, const Way& way, uint32_t side, const FarReference& reference, int quality,
                      Sum& sum) {
  const FarFaceCoding coding{quality, way.shifts};
  const WallClock encoding;
  const Result<std::vector<std::byte>> bytes =
      way.alone ? encode_far_face(face, coding) : encode_far_delta(face, coding, side, reference, way.how);
  if (!bytes) return bytes.error();
  sum.encode_s += encoding.seconds();
  const WallClock decoding;
  Result<FarFace> back = decode_far_face(*bytes, side, &reference);
  if (!back) return back;
  sum.decode_s += decoding.seconds();
  sum.bytes += bytes->size(), sum.picture_bytes += picture_bytes_of_far_face(*bytes), ++sum.faces;
  add_error(face.colors, back->colors, sum);
  return back;
}

using Sides = std::array<std::optional<FarFace>, 6>;

/// What a cell's sides take in each way, told against another's as that was decoded.
Status add_cell(const Sides& sides, const Sides& neighbour, const glm::dvec3& offset, int quality,
                std::array<Sum, kWays.size()>& sums) {
  Sides decoded;
  FarReference reference;
  reference.offset = offset;
  Sum unused;
  for (uint32_t s = 0; s < 6; ++s) {
    if (!neighbour[s]) continue;
    Result<FarFace> face = store(*neighbour[s], kWays[0], s, {}, quality, unused);
    if (!face) return face.error();
    decoded[s] = std::move(*face);
    reference.sides[s] = &*decoded[s];
  }
  for (uint32_t s = 0; s < 6; ++s) {
    if (!sides[s]) continue;
    for (size_t w = 0; w < kWays.size(); ++w)
      if (const Result<FarFace> face = store(*sides[s], kWays[w], s, reference, quality, sums[w]); !face)
        return face.error();
  }
  return Done{};
}

/// Points of the path at even times, and the axis along which it goes there mostly.
struct Place {
  glm::dvec3 at{0};
  int axis = 0;
};
std::vector<Place> places_of(const CameraPath& path, uint32_t count) {
  std::vector<Place> places;
  places.reserve(count);
  constexpr double kSoonS = 1;
  for (uint32_t i = 0; i < count; ++i) {
    const double t = path.keys.front().t_s + path.duration_s() * (i + 0.5) / count;
    const glm::dvec3 eye = pose_at(path, t).eye, way = glm::abs(pose_at(path, t + kSoonS).eye - eye);
    places.push_back({eye, way.x >= way.y ? (way.x >= way.z ? 0 : 2) : (way.y >= way.z ? 1 : 2)});
  }
  return places;
}

class FarStudy {
 public:
  FarStudy(const Arguments& arguments, const ModelReader& reader, const std::vector<Place>& places, JobMonitor& monitor,
           Json& figures)
      : arguments_(arguments), places_(places), monitor_(monitor), figures_(figures), scene_(reader, kCacheBytes) {}

  Status run() {
    fmt::print("{:<6} {:>8} {:>6} {:<16} {:>12} {:>9} {:>10} {:>8} {:>10} {:>10}\n", "kind", "cell m", "steps",
               "stored", "bytes a cell", "of alone", "of colours", "error", "encode ms", "decode ms");
    for (const bool depth : {false, true})
      for (const double part : depth ? arguments_.depth_cells : arguments_.flat_cells)
        PROMENADE_TRY(add_size(depth, part));
    tell_near();
    return Done{};
  }

 private:
  /// part: of the largest flat cell.
  Status add_size(bool depth, double part) {
    FarOptions options = arguments_.far;
    options.depth = false, options.cell_m = 0;
    Result<FarTables> tables = far_grid(scene_.model().model(), options);
    if (!tables) return tables.error();
    options.cell_m = tables->cell_m * part, options.depth = depth;
    tables = far_grid(scene_.model().model(), options);
    if (!tables) return tables.error();
    std::vector<std::array<Sum, kWays.size()>> sums(arguments_.steps.size());
    std::vector<uint64_t> cells(arguments_.steps.size());
    NearSets near;
    for (size_t i = 0; i < places_.size(); ++i) {
      monitor_.progress("cells", i, places_.size());
      if (monitor_.cancelled()) return Error{"interrupted"};
      const glm::dvec3 at = places_[i].at - scene_.model().model().manifest.origin;
      const std::optional<uint64_t> place = far_place_at(*tables, at);
      if (!place) continue;
      const Result<ShapedFar> cell = draw_far_cell(scene_, *tables, *place);
      if (!cell) return cell.error();
      for (size_t k = 0; k < arguments_.steps.size(); ++k) {
        const double step_m = arguments_.steps[k] * tables->cell_m;
        const int axis = places_[i].axis;
        glm::dvec3 beside = box_of_place(*tables, *place).center(), offset(0);
        beside[axis] += step_m;
        const std::optional<uint64_t> neighbour = far_place_at(*tables, beside);
        if (!neighbour) continue;
        if (arguments_.steps[k] == 1)
          near.add(scene_.model().model(), near_box(*tables, *place), near_box(*tables, *neighbour));
        const Result<ShapedFar> other = draw_far_cell(scene_, *tables, *neighbour);
        if (!other) return other.error();
        offset[axis] = -step_m / (tables->box_m / 2);
        PROMENADE_TRY(add_cell(cell->faces, other->faces, offset, options.jpeg_quality, sums[k]));
        ++cells[k];
      }
    }
    for (size_t k = 0; k < arguments_.steps.size(); ++k) tell(*tables, arguments_.steps[k], cells[k], sums[k]);
    if (near.steps > 0) keep(*tables, near);
    return Done{};
  }

  void keep(const FarTables& tables, const NearSets& near) {
    const double n = double(near.steps);
    figures_["near"].push_back({{"has_depth", tables.has_depth},
                                {"cell_m", tables.cell_m},
                                {"box_m", tables.box_m},
                                {"cells", near.steps},
                                {"leaves_mean", double(near.leaves) / n},
                                {"changed_mean", double(near.changed) / n},
                                {"delta_bytes_mean", double(near.delta_bytes) / n},
                                {"find_ms_mean", 1e3 * near.find_s / n}});
  }

  void tell_near() const {
    if (figures_["near"].empty()) return;
    fmt::print("\nNear geometry, from a cell to the one beside it\n{:>8} {:>8} {:>12} {:>12} {:>16} {:>18}\n", "cell m",
               "box m", "leaves", "others", "bytes if stored", "ms to find in tree");
    for (const Json& near : figures_["near"])
      fmt::print("{:>8.2f} {:>8.1f} {:>12.0f} {:>12.1f} {:>16.1f} {:>18.3f}\n", near["cell_m"].get<double>(),
                 near["box_m"].get<double>(), near["leaves_mean"].get<double>(), near["changed_mean"].get<double>(),
                 near["delta_bytes_mean"].get<double>(), near["find_ms_mean"].get<double>());
  }

  void tell(const FarTables& tables, uint32_t steps, uint64_t cells, const std::array<Sum, kWays.size()>& sums) {
    if (sums[0].faces == 0) return;
    for (size_t w = 0; w < kWays.size(); ++w) {
      const Sum& sum = sums[w];
      const double n = double(sum.faces), of_alone = double(sum.bytes) / double(sums[0].bytes);
      const double error = sum.error / double(std::max<uint64_t>(sum.channels, 1));
      fmt::print("{:<6} {:>8.2f} {:>6} {:<16} {:>12.0f} {:>8.0f}% {:>9.0f}% {:>8.2f} {:>10.1f} {:>10.1f}\n",
                 tables.has_depth ? "depth" : "flat", tables.cell_m, steps, kWays[w].name,
                 double(sum.bytes) / double(cells), 100 * of_alone,
                 100 * double(sum.picture_bytes) / double(sums[0].picture_bytes), error, 1e3 * sum.encode_s / n,
                 1e3 * sum.decode_s / n);
      figures_["far"].push_back({{"has_depth", tables.has_depth},
                                 {"cell_m", tables.cell_m},
                                 {"box_m", tables.box_m},
                                 {"side_px", (1U << tables.face_levels) + 1},
                                 {"steps", steps},
                                 {"name", kWays[w].name},
                                 {"cells", cells},
                                 {"faces", sum.faces},
                                 {"bytes_per_cell_mean", double(sum.bytes) / double(cells)},
                                 {"share_of_alone", of_alone},
                                 {"picture_bytes_per_cell_mean", double(sum.picture_bytes) / double(cells)},
                                 {"color_error_mean", error},
                                 {"encode_ms_per_face", 1e3 * sum.encode_s / n},
                                 {"decode_ms_per_face", 1e3 * sum.decode_s / n}});
    }
  }

  const Arguments& arguments_;
  const std::vector<Place>& places_;
  JobMonitor& monitor_;
  Json& figures_;
  FarScene scene_;
};

Status run_study(Arguments& arguments, JobMonitor& monitor, Json& figures) {
  const Result<ModelReader> reader = ModelReader::open(arguments.model);
  if (!reader) return reader.error();
  const Result<CameraPath> path = read_path(arguments.path_file);
  if (!path) return path.error();
  arguments.far.pictures = true;
  figures["far"] = Json::array(), figures["near"] = Json::array();
  const std::vector<Place> places = places_of(*path, arguments.places);
  for (const Place& place : places) arguments.far.along.push_back(place.at);
  return FarStudy(arguments, *reader, places, monitor, figures).run();
}

}  // namespace

Command add_study_far(CLI::App& study) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* app = study.add_subcommand("far",
                                       "What far pictures take, each alone or told by its differences from a "
                                       "neighbour's; how much near geometry changes");
  app->add_option("MODEL", arguments->model, "A built model, with far pictures or without")->required();
  app->add_option("--path", arguments->path_file, "Cells where this recorded path goes")->required()->type_name("FILE");
  app->add_option("--places", arguments->places, "How many places of the path")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app->add_option("--far-bound", arguments->far.bound_deg, "Largest parallax, degrees")->capture_default_str();
  app->add_option("--far-box", arguments->far.box_m, "Length of the box, m (0: a sixth of the model)")
      ->capture_default_str();
  app->add_option("--far-side", arguments->far.side_px, "Pixels of a picture's side, 2^n + 1 (0: by the bound)")
      ->capture_default_str();
  app->add_option("--far-quality", arguments->far.jpeg_quality, "JPEG quality")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  const auto add_list = [app](const char* name, auto& list, const char* help) {
    app->add_option(name, list, help)->delimiter(',')->check(CLI::PositiveNumber)->capture_default_str();
  };
  add_list("--flat-cells", arguments->flat_cells, "Lengths of view cells, of the largest that flat pictures allow");
  add_list("--depth-cells", arguments->depth_cells, "The same for pictures with depth");
  add_list("--steps", arguments->steps, "How many cells away the neighbour is");
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run_study(*arguments, monitor, figures); }};
}

}  // namespace promenade
