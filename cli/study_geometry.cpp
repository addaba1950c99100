#include "cli/study_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "cli/console.h"
#include "layout/model_io.h"

namespace promenade {
namespace {

struct StudyGeometryOptions {
  std::filesystem::path model;
  uint32_t nodes = 1000;  ///< how many nodes are coded, evenly spread over the model's; more: slower, steadier figures
};

/// One node as it is stored.
struct Sample {
  Mesh mesh;
  float step_m = 0;       ///< of its grid; 0: floats
  float fine_step_m = 0;  ///< of the finer one that some of it lies on; 0: none
  float error_m = 0;
  uint64_t stored_bytes = 0;
};

/// One way of coding: a codec and the grid's width, as a multiple of the stored one.
struct Way {
  std::string name;
  GeometryCodec codec = GeometryCodec::grown;
  float steps = 1;
};

struct WayFigures {
  uint64_t bytes = 0, triangles = 0, decoded_triangles = 0;
  double encode_s = 0, decode_s = 0;
  double error_ratio_sum = 0;
};

std::vector<Way> all_ways() {
  std::vector<Way> ways = {{"raw", GeometryCodec::raw, 1}};
  for (const GeometryCodec codec : {GeometryCodec::grown, GeometryCodec::meshopt, GeometryCodec::draco})
    for (const float steps : {0.25F, 0.5F, 1.0F, 2.0F, 4.0F}) {
      const std::string name(name_of(codec));
      ways.push_back({steps == 1 ? name : fmt::format("{}, {} x step", name, steps), codec, steps});
    }
  return ways;
}

GeometryEncodeOptions options_of(const Way& way, const Sample& sample) {
  GeometryEncodeOptions options;
  options.codec = sample.step_m > 0 ? way.codec : GeometryCodec::raw;
  if (options.codec != GeometryCodec::raw) options.position_step_m = sample.step_m * way.steps;
  options.fine_step_m = sample.fine_step_m;
  return options;
}

Result<std::vector<Sample>> read_samples(const ModelReader& reader, uint32_t wanted) {
  const ModelTables& tables = reader.model().tables;
  const size_t count = std::min<size_t>(wanted, tables.nodes.size());
  std::vector<Sample> samples;
  for (size_t i = 0; i < count; ++i) {
    const size_t node = tables.nodes.size() * i / count;
    const Result<std::vector<std::byte>> bytes = reader.read_segment(tables.nodes[node].segment);
    if (!bytes) return bytes.error();
    Result<Mesh> mesh = decode_mesh(*bytes);
    if (!mesh) return mesh.error();
    samples.push_back(
        {std::move(*mesh), position_step_m(*bytes), fine_step_m(*bytes), tables.nodes[node].error_m, bytes->size()});
  }
  return samples;
}

/// Half the diagonal of a grid's cell: the farthest that rounding moves a point.
double rounding_m(double step_m) { return step_m * std::sqrt(3.0) / 2; }

Result<WayFigures> measure(const Way& way, const std::vector<Sample>& samples) {
  WayFigures made;
  std::vector<std::vector<std::byte>> coded;
  const WallClock encoding;
  for (const Sample& sample : samples) {
    GeometryEncodeOptions options = options_of(way, sample);
    Result<EncodedMesh> encoded = encode_mesh(sample.mesh, options);
    if (!encoded && options.position_step_m) {  // too many steps across: on the stored grid, as a build would
      options.position_step_m = sample.step_m;
      encoded = encode_mesh(sample.mesh, options);
    }
    if (!encoded) return encoded.error();
    made.bytes += encoded->bytes.size();
    made.triangles += sample.mesh.triangle_count();
    if (sample.error_m > 0)
      made.error_ratio_sum += rounding_m(options.position_step_m.value_or(0)) / double(sample.error_m);
    coded.push_back(std::move(encoded->bytes));
  }
  made.encode_s = encoding.seconds();
  const WallClock decoding;
  for (const std::vector<std::byte>& bytes : coded) {
    const Result<Mesh> mesh = decode_mesh(bytes);
    if (!mesh) return mesh.error();
    made.decoded_triangles += mesh->triangle_count();
  }
  made.decode_s = decoding.seconds();
  return made;
}

double per_second(uint64_t count, double seconds) { return seconds > 0 ? double(count) / seconds : 0.0; }
double bits_each(uint64_t bytes, uint64_t count) { return count > 0 ? 8.0 * double(bytes) / double(count) : 0.0; }

Json json_of(const Way& way, const WayFigures& made, size_t nodes, bool is_default) {
  return {{"name", way.name},
          {"step_of_stored", way.codec == GeometryCodec::raw ? 0.0 : double(way.steps)},
          {"bits_per_triangle", bits_each(made.bytes, made.triangles)},
          {"encode_triangles_per_s", per_second(made.triangles, made.encode_s)},
          {"decode_triangles_per_s", per_second(made.decoded_triangles, made.decode_s)},
          {"error_ratio", made.error_ratio_sum / double(std::max<size_t>(nodes, 1))},
          {"default", is_default}};
}

/// What each kind of data adds to the coded size, in bits a triangle, one after another.
Result<Json> measure_parts(const Way& way, std::vector<Sample> samples) {
  Json parts = Json::object();
  double before = 0;
  const auto add = [&](const char* name, const auto& strip) -> Status {
    std::vector<Sample> stripped = samples;
    for (Sample& sample : stripped) strip(sample.mesh);
    const Result<WayFigures> made = measure(way, stripped);
    if (!made) return made.error();
    const double bits = bits_each(made->bytes, made->triangles);
    parts[name] = bits - before;
    before = bits;
    return Done{};
  };
  const auto bare = [](Mesh& m) { m.normals.clear(), m.texcoords.clear(), m.colors.clear(), m.materials.clear(); };
  PROMENADE_TRY(add("positions_and_triangles", bare));
  PROMENADE_TRY(add("normals", [](Mesh& m) { m.texcoords.clear(), m.colors.clear(), m.materials.clear(); }));
  PROMENADE_TRY(add("texture_coordinates", [](Mesh& m) { m.colors.clear(), m.materials.clear(); }));
  PROMENADE_TRY(add("colors", [](Mesh& m) { m.materials.clear(); }));
  PROMENADE_TRY(add("materials", [](Mesh&) {}));
  return parts;
}

/// Codes nodes anew with every codec and, around the grid that each node is stored on, finer and coarser grids; prints
/// a table and fills `figures`: `codecs` (a row for each, the model's own marked default), `parts` (what the model's
/// own way spends on positions and triangles, normals, texture coordinates, colours and materials).
Status study_geometry(const ModelReader& reader, const StudyGeometryOptions& options, JobMonitor& monitor,
                      Json& figures) {
  const Result<std::vector<Sample>> samples = read_samples(reader, options.nodes);
  if (!samples) return samples.error();
  uint64_t stored = 0, triangles = 0, vertices = 0;
  for (const Sample& sample : *samples) {
    stored += sample.stored_bytes;
    triangles += sample.mesh.triangle_count();
    vertices += sample.mesh.vertex_count();
  }
  figures["nodes"] = samples->size();
  figures["triangles"] = triangles;
  figures["vertices_per_triangle"] = triangles > 0 ? double(vertices) / double(triangles) : 0.0;
  figures["stored_bits_per_triangle"] = bits_each(stored, triangles);
  figures["codecs"] = Json::array();
  fmt::print("{:<20} {:>13} {:>12} {:>12} {:>18}\n", "codec", "bits/triangle", "encode M/s", "decode M/s",
             "rounding / error");
  const std::vector<Way> ways = all_ways();
  const GeometryCodec own = reader.model().manifest.geometry_codec;
  for (size_t i = 0; i < ways.size(); ++i) {
    monitor.progress("study", i, ways.size());
    if (monitor.cancelled()) return Error{"interrupted"};
    const Result<WayFigures> made = measure(ways[i], *samples);
    if (!made) return made.error();
    const bool is_default = ways[i].codec == own && ways[i].steps == 1;
    const Json row = json_of(ways[i], *made, samples->size(), is_default);
    fmt::print("{:<20} {:>13.2f} {:>12.2f} {:>12.2f} {:>18.3f}{}\n", ways[i].name,
               row["bits_per_triangle"].get<double>(), row["encode_triangles_per_s"].get<double>() / 1e6,
               row["decode_triangles_per_s"].get<double>() / 1e6, row["error_ratio"].get<double>(),
               is_default ? "  (the model's)" : "");
    figures["codecs"].push_back(row);
  }
  Result<Json> parts = measure_parts({std::string(name_of(own)), own, 1}, *samples);
  if (!parts) return parts.error();
  for (const auto& [part, bits] : parts->items()) fmt::print("  {:<26} {:>8.2f} bits\n", part, bits.get<double>());
  figures["parts"] = std::move(*parts);
  return Done{};
}

}  // namespace

Command add_study_geometry(CLI::App& study) {
  auto options = std::make_shared<StudyGeometryOptions>();
  CLI::App* app = study.add_subcommand("geometry", "Codecs and grids of the nodes' meshes: bits, speed, rounding");
  app->add_option("MODEL", options->model, "A directory that build made")->required();
  app->add_option("--nodes", options->nodes, "How many nodes to code, evenly spread")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  return {app, {}, [options](JobMonitor& monitor, Json& figures) -> Status {
            const Result<ModelReader> reader = ModelReader::open(options->model);
            if (!reader) return reader.error();
            return study_geometry(*reader, *options, monitor, figures);
          }};
}

}  // namespace promenade
