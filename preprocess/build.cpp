#include "preprocess/build.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <system_error>

#include "codec/frame.h"
#include "geometry/process_memory.h"
#include "preprocess/assemble.h"
#include "preprocess/object_units.h"
#include "preprocess/partition.h"
#include "preprocess/unit_io.h"
#include "preprocess/visibility/find_openings.h"
#include "preprocess/visibility/hider_trial.h"

namespace promenade {

namespace {

constexpr uint64_t kHidersPart = 2;  // of the memory: nothing else of a build is in it by then

constexpr uint32_t kUnitsVersion = 19;  // of the work units' content: a change makes builds begin anew

/// Measures the stages of a build.
class StageClock {
 public:
  explicit StageClock(BuildFigures& figures) : figures_(figures) {}
  void end(const std::string& stage) {
    const auto now = std::chrono::steady_clock::now();
    figures_.stage_wall_s[stage] += std::chrono::duration<double>(now - start_).count();
    start_ = now;
    figures_.stage_peak_rss_bytes[stage] = peak_rss_bytes();
    return_freed_memory();  // each stage has its budget to itself
  }

 private:
  BuildFigures& figures_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::filesystem::path beside(const std::filesystem::path& model, const char* ending) {
  std::filesystem::path path = model.has_filename() ? model : model.parent_path();
  return path += ending;
}

Status check_options(const BuildOptions& o) {
  const auto check = [](const char* name, uint64_t value, uint64_t least, uint64_t most) -> Status {
    if (value >= least && value <= most) return Done{};
    return Error{fmt::format("--{} {}: must be between {} and {}", name, value, least, most)};
  };
  PROMENADE_TRY(check("node-triangles", o.node_triangles, 100, 60000));
  for (const uint32_t factor : o.level_factors.list()) PROMENADE_TRY(check("level-factor", factor, 2, 16));
  if (o.chunk_triangles != 0) PROMENADE_TRY(check("chunk-triangles", o.chunk_triangles, 1000, 1U << 24));
  PROMENADE_TRY(check("max-texture", o.max_texture_px, 64, 16384));
  PROMENADE_TRY(check("jpeg-quality", o.jpeg_quality < 0 ? 0U : static_cast<uint32_t>(o.jpeg_quality), 1, 100));
  PROMENADE_TRY(check_options(o.far));
  return check_options(o.visibility);
}

uint64_t tool_hash() {
  UnitWriter writer;
  writer.text(PROMENADE_VERSION), writer.value(kUnitsVersion);
  return checksum(writer.bytes());
}

/// Everything that the units of partition and tree depend on.
uint64_t hash_of(const BuildOptions& o, const MemoryBudget& budget, const Survey& survey) {
  UnitWriter writer;
  writer.value(tool_hash()), writer.value(survey.hash);
  writer.value(o.node_triangles), writer.array(o.level_factors.list()), writer.value(o.geometry_codec);
  writer.value(o.max_texture_px), writer.value(o.jpeg_quality);
  writer.value(budget.chunk_triangles), writer.value(budget.samples);
  return checksum(writer.bytes());
}

/// The grid of all leaves: far below their own detail, at most two millimetres (rounding by half of that shows as a
/// pixel from nearer than a metre), no finer than single precision.
float leaf_step_m(const Survey& survey, uint32_t node_triangles) {
  constexpr double kStepsAcross = 16384;  // of a leaf of average size
  constexpr double kCoarsestM = 1.0 / 512;
  const double leaves = std::max(1.0, double(survey.triangles) / node_triangles);
  const double leaf_m = survey.world_box.diagonal() / std::sqrt(leaves);
  const glm::dvec3 far =
      glm::max(glm::abs(survey.world_box.min - survey.origin), glm::abs(survey.world_box.max - survey.origin));
  const double precision_m = std::max({far.x, far.y, far.z}) * std::exp2(-24);
  const double step_m = std::max({std::min(leaf_m / kStepsAcross, kCoarsestM), precision_m, 1e-30});
  return static_cast<float>(std::exp2(std::floor(std::log2(step_m))));
}

/// Without a folder for what is too much.
HiderBuildOptions hider_options(const BuildOptions& o) {
  HiderBuildOptions options;
  options.memory_bytes = o.memory_bytes / kHidersPart;
  return options;
}

/// Everything that the model depends on.
uint64_t hash_of(const BuildOptions& o, uint64_t tree_hash) {
  if (o.visibility.cells == CellStyle::none && !o.far.pictures) return tree_hash;
  UnitWriter writer;
  writer.value(tree_hash), writer.value(hash_of(o.visibility)), writer.value(hash_of(hider_options(o)));
  if (o.far.pictures) writer.value(hash_of(o.far));
  writer.text(o.order.name), writer.text(o.order.file.string());
  return checksum(writer.bytes());
}

std::map<std::string, std::string> settings_of(const BuildOptions& o, const MemoryBudget& budget) {
  std::map<std::string, std::string> settings{
      {"node-triangles", fmt::format("{}", o.node_triangles)},
      {"level-factor", o.level_factors.name()},
      {"geometry-codec", std::string(name_of(o.geometry_codec))},
      {"max-texture", fmt::format("{}", o.max_texture_px)},
      {"jpeg-quality", fmt::format("{}", o.jpeg_quality)},
      {"repair", o.import.repair ? "on" : "off"},
      {"chunk-triangles", fmt::format("{}", budget.chunk_triangles)},
  };
  settings.merge(settings_of(o.visibility));
  settings.merge(settings_of(o.far));
  if (o.visibility.cells != CellStyle::none) settings["order"] = o.order.name;
  if (o.import.unit_m) settings["unit"] = fmt::format("{}", *o.import.unit_m);
  if (o.import.up) settings["up"] = *o.import.up == UpAxis::y ? "y" : "z";
  return settings;
}

ModelManifest manifest_of(const BuildOptions& o, const MemoryBudget& budget, const Survey& survey, uint64_t hash) {
  ModelManifest manifest;
  manifest.tool_version = PROMENADE_VERSION;
  manifest.input_hash = hash;
  manifest.origin = survey.origin;
  manifest.world_box = survey.world_box;
  manifest.source_triangles = survey.triangles;
  manifest.geometry_codec = o.geometry_codec;
  manifest.settings = settings_of(o, budget);
  for (const SurveyedPart& part : survey.parts) manifest.sources.push_back(part.part.name);
  manifest.import_counts = survey.report.counts;
  manifest.notes = survey.report.warnings;
  return manifest;
}

void count_nodes(const ModelTables& tables, BuildFigures& figures) {
  figures.nodes = tables.nodes.size();
  for (const NodeRecord& node : tables.nodes) {
    figures.leaves += node.child_count == 0 ? 1U : 0U;
    figures.levels = std::max<uint64_t>(figures.levels, node.level + 1);
    figures.triangles_stored += node.triangles;
  }
}

/// What the model takes on disk.
std::map<std::string, uint64_t> bytes_by_part(const std::filesystem::path& model) {
  std::map<std::string, uint64_t> bytes;
  for (const auto& [part, file] :
       {std::pair("geometry", "geometry.bin"), std::pair("textures", "textures.bin"), std::pair("tables", "tables.bin"),
        std::pair("cells", "cells.bin"), std::pair("openings", "openings.bin"), std::pair("far", "far.bin"),
        std::pair("objects", "objects.bin"), std::pair("manifest", "manifest.json")}) {
    std::error_code code;
    const uintmax_t size = std::filesystem::file_size(model / file, code);
    bytes[part] = code ? 0 : size;
  }
  return bytes;
}

/// One build with its lock and its work folder; the stages share what stands here.
class Build {
 public:
  Build(const BuildOptions& options, const MemoryBudget& budget, const WorkFolder& folder, FileSystem& files,
        JobMonitor& monitor)
      : options_(options), budget_(budget), folder_(folder), files_(files), monitor_(monitor), clock_(figures_) {}

  Result<BuildFigures> run() {
    Result<ModelWriter> writer = make_tree();  // of what it took nothing is left
    if (!writer.ok()) return writer.error();
    clock_.end("write");

    if (options_.visibility.cells != CellStyle::none) PROMENADE_TRY(add_cells(*writer));
    clock_.end("visibility");

    if (options_.far.pictures) PROMENADE_TRY(add_far(*writer));
    clock_.end("far pictures");

    PROMENADE_TRY(writer->publish());
    figures_.bytes_by_part = bytes_by_part(options_.model);
    return std::move(figures_);
  }

 private:
  /// From the source to a staged model without cells.
  Result<ModelWriter> make_tree() {
    const Result<std::vector<SourcePart>> parts = list_source(options_.sources);
    if (!parts.ok()) return parts.error();
    TextureStore textures(folder_, {options_.max_texture_px, options_.jpeg_quality, budget_.textures, tool_hash()});
    Result<Survey> survey = survey_source(*parts, options_.import, budget_, textures, monitor_);
    if (!survey.ok()) return survey.error();
    for (const std::string& warning : survey->report.warnings) monitor_.warning(warning);
    hash_ = hash_of(options_, budget_, *survey);
    clock_.end("survey");

    const MaterialBase base(survey->materials.materials());
    const NodeBuilder builder(base, textures, node_options(*survey));
    const TreeOptions tree_options{options_.node_triangles, options_.level_factors, hash_,
                                   survey->classes.size() > 1 || !survey->classes.contains("")};
    Result<std::vector<NodeUnit>> objects =
        build_objects(*survey, options_.import, builder, tree_options, folder_, monitor_);
    if (!objects.ok()) return objects.error();
    clock_.end("objects");

    // Nothing stands still: no tree.
    ChunkTree tree;
    const uint64_t still = survey->triangles - survey->moving_triangles;
    if (still > 0)
      tree = divide_into_chunks(survey->samples, {still, budget_.chunk_triangles, options_.node_triangles,
                                                  options_.level_factors, survey->origin});
    survey->samples = {};
    const Result<SpillIndex> spill =
        partition_source(*survey, tree, options_.import, budget_, folder_, hash_, monitor_);
    if (!spill.ok()) return spill.error();
    clock_.end("partition");

    Result<TreeUnits> units = build_tree(*spill, tree, builder, tree_options, budget_, folder_, monitor_);
    if (!units.ok()) return units.error();
    units->objects = std::move(*objects);
    figures_.node_cpu_s = builder.profile().seconds();
    clock_.end("simplify");

    count_work(*spill, *units, textures);
    Result<ModelWriter> writer = ModelWriter::create(options_.model, files_);
    if (!writer.ok()) return writer.error();
    PROMENADE_TRY(stage(*survey, *units, base, textures, *writer));
    return writer;
  }

  NodeBuilderOptions node_options(const Survey& survey) const {
    NodeBuilderOptions options;
    options.node_triangles = options_.node_triangles;
    options.codec = options_.geometry_codec;
    options.leaf_step_m = leaf_step_m(survey, options_.node_triangles);
    options.jpeg_quality = options_.jpeg_quality;
    return options;
  }

  void count_work(const SpillIndex& spill, const TreeUnits& units, const TextureStore& textures) {
    figures_.spill_bytes_peak = spill.file_bytes + units.top.payload_bytes;
    figures_.units_total = textures.size() + (units.top.nodes.empty() ? 0U : 1U);
    for (const NodeUnit& unit : units.objects) figures_.spill_bytes_peak += unit.payload_bytes;
    figures_.units_total += units.objects.size();
    for (const NodeUnit& unit : units.chunks) {
      figures_.spill_bytes_peak += unit.payload_bytes;
      figures_.units_total += unit.nodes.empty() ? 0U : 1U;
    }
    for (uint32_t i = 0; i < textures.size(); ++i) figures_.spill_bytes_peak += textures[i].bytes;
    figures_.units_resumed = units.resumed + textures.resumed();
  }

  Status stage(const Survey& survey, const TreeUnits& units, const MaterialBase& base, const TextureStore& textures,
               ModelWriter& writer) {
    Result<AssembledModel> model =
        assemble_model(units, survey, textures, base.materials, options_.geometry_codec, folder_, writer, monitor_);
    if (!model.ok()) return model.error();
    count_nodes(model->tables, figures_);
    figures_.triangles_in = survey.triangles;
    figures_.import_counts = survey.report.counts;
    figures_.warnings = survey.report.warnings;
    return writer.stage(std::move(model->tables), manifest_of(options_, budget_, survey, hash_of(options_, hash_)),
                        std::move(model->objects));
  }

  Status add_cells(ModelWriter& writer) {
    const Result<ModelReader> reader = ModelReader::open(writer.staged_folder(), files_);
    if (!reader.ok()) return reader.error();
    HiderBuildOptions hiding = hider_options(options_);
    hiding.folder = folder_.path(), hiding.files = &files_;
    const Result<ViewPlan> plan =
        plan_views(options_.visibility.hiders, *reader, options_.visibility, hiding, monitor_);
    if (!plan.ok()) return plan.error();
    clock_.end("hiders");
    for (const std::unique_ptr<Hider>& hider : plan->hiders)
      if (!hider->is_conservative())
        monitor_.warning(fmt::format("hider {}: may hide what can be seen", hider->name()));
    const Result<Visibility> made = compute_visibility(*reader, plan->space, plan->hiders, options_.visibility,
                                                       hash_of(options_, hash_), folder_, monitor_);
    if (!made.ok()) return made.error();
    figures_.visibility = made->figures;
    for (const std::unique_ptr<Hider>& hider : plan->hiders) figures_.hiders.emplace_back(hider->name());
    figures_.units_total += made->figures.units.total;
    figures_.units_resumed += made->figures.units.resumed;
    const auto nodes = static_cast<uint32_t>(reader->model().tables.nodes.size());
    const Result<NodeOrder> order = node_order(reader->model(), *made, options_.order, folder_, monitor_);
    if (!order.ok()) return order.error();
    PROMENADE_TRY(writer.reorder(order->order));
    PROMENADE_TRY(
        writer.add_cells(made->cells, [&](CellId cell) { return decoded(made->vlods[index_of(cell)], nodes); }));
    figures_.delta_ids_mean = order->delta_ids_mean;
    if (options_.visibility.openings) PROMENADE_TRY(add_openings(*reader, made->cells, writer, monitor_));
    return count_delta_bytes(writer);
  }

  static Status add_openings(const ModelReader& reader, const CellTables& cells, ModelWriter& writer,
                             JobMonitor& monitor) {
    const Result<Openings> openings = find_openings(reader, cells, monitor);
    if (!openings.ok()) return openings.error();
    return writer.add_openings(*openings);
  }

  Status add_far(ModelWriter& writer) {
    const Result<ModelReader> reader = ModelReader::open(writer.staged_folder(), files_);
    if (!reader.ok()) return reader.error();
    const Result<FarUnits> made =
        make_far(*reader, options_.far, hash_, options_.memory_bytes / kHidersPart, folder_, monitor_);
    if (!made.ok()) return made.error();
    figures_.far = made->figures;
    figures_.units_total += made->figures.units;
    figures_.units_resumed += made->figures.units_resumed;
    return writer.add_far(made->tables, cells_of(*made, folder_));
  }

  /// The blocks of vLODs tell every delta: their bytes, shared among the faces.
  Status count_delta_bytes(const ModelWriter& writer) {
    const Result<ModelReader> reader = ModelReader::open(writer.staged_folder(), files_);
    if (!reader.ok()) return reader.error();
    uint64_t bytes = 0;
    for (const VlodBlock& block : reader->cells()->blocks()) bytes += block.stored_bytes;
    figures_.delta_bytes_mean = double(bytes) / std::max<double>(1, double(reader->cells()->tables().faces.size()));
    return Done{};
  }

  const BuildOptions& options_;
  const MemoryBudget& budget_;
  const WorkFolder& folder_;
  FileSystem& files_;
  JobMonitor& monitor_;
  BuildFigures figures_;
  StageClock clock_;
  uint64_t hash_ = 0;
};

}  // namespace

Result<BuildFigures> build_model(const BuildOptions& options, JobMonitor& monitor, FileSystem& files) {
  PROMENADE_TRY(check_options(options));
  const Result<MemoryBudget> budget = plan_memory(
      {options.memory_bytes, options.jobs, options.node_triangles, options.level_factors, options.chunk_triangles});
  if (!budget.ok()) return budget.error();
  const Result<FileLock> lock =
      FileLock::acquire(beside(options.model, ".lock"), fmt::format("model {}", options.model.string()));
  if (!lock.ok()) return lock.error();
  // Says now what would go wrong at the end: a file in the model's place, a folder that cannot be written to.
  if (const Result<ModelWriter> writer = ModelWriter::create(options.model, files); !writer.ok()) return writer.error();
  const Result<WorkFolder> folder = WorkFolder::open(beside(options.model, ".work"), files);
  if (!folder.ok()) return folder.error();

  // More threads than cores are allowed where they are asked for.
  const tbb::global_control threads(
      tbb::global_control::max_allowed_parallelism,
      std::max<size_t>(budget->jobs, tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
  tbb::task_arena arena(static_cast<int>(budget->jobs));
  Result<BuildFigures> figures = arena.execute([&] { return Build(options, *budget, *folder, files, monitor).run(); });
  if (figures.ok()) PROMENADE_TRY(folder->remove());
  return figures;
}

}  // namespace promenade
