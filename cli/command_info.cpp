#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cli/command.h"
#include "cli/console.h"
#include "layout/model_io.h"

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
  for (const auto& [name, value] : manifest.settings) fmt::print("  --{} {}\n", name, value);
  for (const auto& [name, count] : manifest.import_counts) fmt::print("  {}: {}\n", name, count);
  for (const std::string& note : manifest.notes) fmt::print("  note: {}\n", note);
}

}  // namespace

Command add_info(CLI::App& program) {
  auto path = std::make_shared<std::filesystem::path>();
  CLI::App* app = program.add_subcommand("info", "What is inside a model: counts, sizes by part, settings, provenance");
  app->add_option("MODEL", *path, "A directory that build made")->required();
  return {app, {}, [path](JobMonitor&, Json& figures) -> Status {
            const Result<ModelReader> reader = ModelReader::open(*path);
            if (!reader) return reader.error();
            print_model(*path, reader->model());
            figures = json_of_model(reader->model());
            return Done{};
          }};
}

}  // namespace promenade
