#include "datasets/building.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "datasets/building_furnish.h"
#include "datasets/building_structure.h"
#include "datasets/building_walk.h"
#include "datasets/furniture.h"
#include "datasets/glb_writer.h"
#include "layout/file_io.h"

namespace promenade {

namespace {

constexpr uint32_t kMaxFloors = 400;   // 1.5 km high; keeps float positions within a tenth of a millimetre
constexpr double kLeastQuality = 0.1;  // below it nothing gets simpler
constexpr double kMostQuality = 4;     // beyond it a chair's edges are finer than a millimetre
constexpr double kTolerance = 0.1;     // of BuildingOptions::triangles
constexpr int kBisections = 14;

struct Design {
  BuildingPlan plan;
  Structure structure;
  std::vector<Placement> placements;
  std::vector<uint32_t> uses;  ///< instances of each catalogue item
  double quality = 1;
  uint64_t structure_triangles = 0;
  std::vector<Mesh> meshes;  ///< of the catalogue's items; empty where unused
};

class Architect {
 public:
  Architect(const BuildingOptions& options, JobMonitor& monitor)
      : options_(options),
        monitor_(monitor),
        arena_(options.jobs == 0 ? tbb::task_arena::automatic : static_cast<int>(options.jobs)) {}

  /// Finds floors, density and quality that come closest to the triangles asked for.
  Result<Design> design();
  const FurnitureCatalogue& catalogue() const { return catalogue_; }

 private:
  void raise(uint32_t floors);
  void furnish(double density);
  /// All triangles at that quality; the meshes are kept.
  uint64_t build(double quality);
  Status thin_out();
  void refine();

  const BuildingOptions& options_;
  JobMonitor& monitor_;
  tbb::task_arena arena_;
  FurnitureCatalogue catalogue_;
  Design design_;
};

void Architect::raise(uint32_t floors) {
  design_.plan = plan_building(options_.seed, floors);
  design_.structure = build_structure(design_.plan, options_.seed);
  design_.structure_triangles = 0;
  for (const StructurePart& part : design_.structure.parts)
    design_.structure_triangles += design_.structure.meshes[part.mesh].triangle_count();
}

void Architect::furnish(double density) {
  design_.placements = furnish_building(design_.plan, catalogue_, options_.seed, density);
  design_.uses.assign(catalogue_.items().size(), 0);
  for (const Placement& placement : design_.placements) ++design_.uses[placement.item];
}

uint64_t Architect::build(double quality) {
  design_.quality = quality;
  design_.meshes.assign(catalogue_.items().size(), {});
  arena_.execute([&] {
    tbb::parallel_for(size_t{0}, design_.meshes.size(), [&](size_t i) {
      if (design_.uses[i] > 0) design_.meshes[i] = catalogue_.items()[i].build(quality);
    });
  });
  uint64_t triangles = design_.structure_triangles;
  for (size_t i = 0; i < design_.meshes.size(); ++i) triangles += design_.uses[i] * design_.meshes[i].triangle_count();
  return triangles;
}

/// Too many triangles even at the least quality: fewer loose things.
Status Architect::thin_out() {
  double low = 0, high = 1;
  for (int i = 0; i < kBisections; ++i) {
    const double density = (low + high) / 2;
    furnish(density);
    (build(kLeastQuality) > options_.triangles ? high : low) = density;
  }
  furnish(low);
  const uint64_t least = build(kLeastQuality);
  if (static_cast<double>(least) <= static_cast<double>(options_.triangles) * (1 + kTolerance)) return Done{};
  return Error{fmt::format(
      "building: {} triangles are too few for {} floors, which need {}; ask for more triangles or fewer floors",
      options_.triangles, design_.plan.floors, least)};
}

void Architect::refine() {
  double low = kLeastQuality, high = kMostQuality;
  uint64_t best_error = ~uint64_t{0};
  double best = low;
  for (int i = 0; i < kBisections; ++i) {
    const double quality = std::sqrt(low * high);
    const uint64_t triangles = build(quality);
    const uint64_t error =
        triangles > options_.triangles ? triangles - options_.triangles : options_.triangles - triangles;
    if (error < best_error) best_error = error, best = quality;
    if (error * 100 < options_.triangles) return;
    (triangles > options_.triangles ? high : low) = quality;
    monitor_.progress("design", static_cast<uint64_t>(i) + 1, kBisections);
  }
  build(best);
}

Result<Design> Architect::design() {
  raise(options_.floors);
  furnish(1);
  if (build(kLeastQuality) > options_.triangles) {
    PROMENADE_TRY(thin_out());
    return std::move(design_);
  }
  for (uint64_t most = build(kMostQuality); most < options_.triangles; most = build(kMostQuality)) {
    const double wanted =
        std::ceil(design_.plan.floors * 1.02 * static_cast<double>(options_.triangles) / static_cast<double>(most));
    if (wanted > kMaxFloors) {
      return Error{fmt::format("building: {} triangles would need {} floors, {} are the most; ask for fewer triangles",
                               options_.triangles, wanted, kMaxFloors)};
    }
    raise(std::max(design_.plan.floors + 1, static_cast<uint32_t>(wanted)));
    furnish(1);
  }
  refine();
  return std::move(design_);
}

Status check(const BuildingOptions& options, const std::filesystem::path& output) {
  if (options.floors == 0 || options.floors > kMaxFloors) {
    return Error{fmt::format("building: {} floors; ask for 1 to {}", options.floors, kMaxFloors)};
  }
  if (options.triangles == 0) return Error{"building: 0 triangles; ask for some hundred thousand or more"};
  if (output.extension() != ".glb") {
    return Error{fmt::format("{}: a building is written as one binary glTF file; give a name that ends in .glb",
                             output.string())};
  }
  return Done{};
}

/// Writes the meshes that are used, then a node an object.
Status write_objects(const Design& design, const FurnitureCatalogue& catalogue, GlbWriter& writer,
                     JobMonitor& monitor) {
  writer.add_material("paint", Material{});
  std::vector<uint32_t> structure_mesh, item_mesh(design.meshes.size());
  const uint64_t total = design.structure.meshes.size() + design.meshes.size();
  for (size_t i = 0; i < design.structure.meshes.size(); ++i) {
    if (monitor.cancelled()) return Error{"interrupted"};
    monitor.progress("write", i, total);
    Result<uint32_t> mesh = writer.add_mesh(fmt::format("structure_{}", i), design.structure.meshes[i]);
    if (!mesh) return mesh.error();
    structure_mesh.push_back(*mesh);
  }
  for (size_t i = 0; i < design.meshes.size(); ++i) {
    if (design.uses[i] == 0) continue;
    if (monitor.cancelled()) return Error{"interrupted"};
    monitor.progress("write", design.structure.meshes.size() + i, total);
    Result<uint32_t> mesh = writer.add_mesh(catalogue.items()[i].name, design.meshes[i]);
    if (!mesh) return mesh.error();
    item_mesh[i] = *mesh;
  }
  for (const StructurePart& part : design.structure.parts)
    writer.add_node(part.name, part.class_name, structure_mesh[part.mesh], part.world_from_part);
  for (const Placement& placement : design.placements)
    writer.add_node(placement.name, catalogue.items()[placement.item].class_name, item_mesh[placement.item],
                    placement.world_from_item);
  monitor.progress("write", total, total);
  return Done{};
}

DBox placed_bounds(const Mesh& mesh, const glm::dmat4& world_from_mesh) {
  DBox box;
  for (const glm::vec3& p : mesh.positions) box.add(glm::dvec3(world_from_mesh * glm::dvec4(p, 1)));
  return box;
}

BuildingFigures measure(const Design& design, const FurnitureCatalogue& catalogue) {
  BuildingFigures figures;
  std::set<std::string_view> classes;
  figures.structure_triangles = figures.triangles = design.structure_triangles;
  for (const Mesh& mesh : design.structure.meshes) figures.unique_triangles += mesh.triangle_count();
  for (const StructurePart& part : design.structure.parts) {
    classes.insert(part.class_name);
    figures.box.add(placed_bounds(design.structure.meshes[part.mesh], part.world_from_part));
  }
  for (size_t i = 0; i < design.meshes.size(); ++i) {
    if (design.uses[i] == 0) continue;
    ++figures.unique_objects;
    figures.unique_triangles += design.meshes[i].triangle_count();
    figures.triangles += design.uses[i] * design.meshes[i].triangle_count();
    classes.insert(catalogue.items()[i].class_name);
  }
  std::vector<Box> boxes;
  for (const Mesh& mesh : design.meshes) boxes.push_back(bounds(mesh));
  for (const Placement& placement : design.placements) {
    const Box& box = boxes[placement.item];
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p((corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                         (corner & 4) != 0 ? box.max.z : box.min.z);
      figures.box.add(glm::dvec3(placement.world_from_item * glm::dvec4(p, 1)));
    }
  }
  figures.unique_objects += design.structure.meshes.size();
  figures.objects = design.structure.parts.size() + design.placements.size();
  figures.classes = classes.size();
  figures.rooms =
      static_cast<uint64_t>(std::count_if(design.plan.rooms.begin(), design.plan.rooms.end(), [](const Room& room) {
        return room.kind != RoomKind::corridor && room.has_floor;
      }));
  return figures;
}

}  // namespace

Result<BuildingFigures> generate_building(const BuildingOptions& options, const std::filesystem::path& output,
                                          JobMonitor& monitor) {
  PROMENADE_TRY(check(options, output));
  Architect architect(options, monitor);
  const Result<Design> design = architect.design();
  if (!design) return design.error();
  if (monitor.cancelled()) return Error{"interrupted"};

  Result<GlbWriter> writer = GlbWriter::create(output, "promenade building");
  if (!writer) return writer.error();
  PROMENADE_TRY(write_objects(*design, architect.catalogue(), *writer, monitor));

  std::filesystem::path walk_path = output;
  walk_path.replace_filename(output.stem().string() + "_walk.json");
  const std::string walk = to_json(walk_building(design->plan));
  // Both files are written whole before either takes its name.
  Result<AtomicFile> walk_file = AtomicFile::create(walk_path);
  if (!walk_file) return walk_file.error();
  PROMENADE_TRY(walk_file->write(std::as_bytes(std::span(walk))));
  PROMENADE_TRY(writer->finish());
  PROMENADE_TRY(walk_file->commit());

  BuildingFigures figures = measure(*design, architect.catalogue());
  std::error_code ignored;
  const uint64_t glb_bytes = std::filesystem::file_size(output, ignored);
  figures.files = 2;
  figures.bytes = (ignored ? 0 : glb_bytes) + walk.size();
  return figures;
}

}  // namespace promenade
