#include "preprocess/far/far_units.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <set>

#include "codec/far_mesh.h"
#include "codec/frame.h"
#include "preprocess/far/far_scene.h"
#include "preprocess/far/far_shape.h"
#include "preprocess/survey.h"
#include "preprocess/unit_io.h"
#include "preprocess/visibility/view_volume.h"

namespace promenade {
namespace {

constexpr size_t kUnitCells = 4;       // about a second of work, so that little is lost and little is published
constexpr uint64_t kVoxels = 8 << 20;  // as for the cells of visibility
constexpr uint32_t kVersion = 1;       // of the units' content: a change makes them begin anew
constexpr uint64_t kCachePart = 2;     // of the memory: the rest is for pictures under way

std::string name_of_unit(size_t unit) { return fmt::format("far-{:06}", unit); }

std::vector<std::byte> payload_of(const std::vector<StoredFarCell>& cells) {
  UnitWriter writer;
  writer.value(static_cast<uint64_t>(cells.size()));
  for (const StoredFarCell& cell : cells) {
    writer.value(cell.place), writer.value(cell.parallax_rad), writer.value(static_cast<uint64_t>(cell.faces.size()));
    for (const StoredFarCell::Face& face : cell.faces)
      writer.value(face.side), writer.value(face.triangles), writer.array(face.bytes);
  }
  return std::move(writer.bytes());
}

std::optional<std::vector<StoredFarCell>> read_payload(std::span<const std::byte> payload) {
  UnitReader reader(payload);
  std::vector<StoredFarCell> cells;
  const auto count = reader.value<uint64_t>();
  for (uint64_t i = 0; i < count && reader.ok(); ++i) {
    StoredFarCell& cell = cells.emplace_back();
    cell.place = reader.value<uint64_t>(), cell.parallax_rad = reader.value<float>();
    const auto faces = reader.value<uint64_t>();
    for (uint64_t k = 0; k < faces && reader.ok(); ++k) {
      StoredFarCell::Face& face = cell.faces.emplace_back();
      face.side = reader.value<uint32_t>(), face.triangles = reader.value<uint32_t>();
      face.bytes = reader.array<std::byte>();
    }
  }
  if (!reader.ok() || reader.left() != 0) return std::nullopt;
  return cells;
}

/// Where the eye may be: along the given places, or wherever there is open space.
Result<std::vector<uint64_t>> choose_places(const ModelReader& reader, const FarTables& tables,
                                            const FarOptions& options, JobMonitor& monitor) {
  if (!options.along.empty()) {
    std::set<uint64_t> places;
    for (const glm::dvec3& point : options.along)
      if (const std::optional<uint64_t> place = far_place_at(tables, point - reader.model().manifest.origin))
        places.insert(*place);
    if (places.empty()) return Error{"--far-path: none of its places lies in the model's viewing space"};
    return std::vector<uint64_t>(places.begin(), places.end());
  }
  const uint64_t count = uint64_t(tables.counts.x) * tables.counts.y * tables.counts.z;
  constexpr uint64_t kMostLooked = uint64_t(1) << 26;  // a survey's cubes are eight million
  if (count > kMostLooked)
    return Error{
        fmt::format("far pictures: {} places for view cells of {:.2f} m are too many; take a larger --far-bound, "
                    "--far-box or --far-cell, or --far-path",
                    count, tables.cell_m)};
  const Box space{glm::vec3(tables.origin), glm::vec3(tables.origin + glm::dvec3(tables.counts) * tables.cell_m)};
  Result<ViewVolume> volume = survey_volume(reader, space, kVoxels, monitor);
  if (!volume) return volume.error();
  if (options.height_m) volume->keep_walkable(static_cast<float>(*options.height_m));
  std::vector<uint64_t> places;
  for (uint64_t place = 0; place < count; ++place) {
    const DBox box = box_of_place(tables, place);
    if (volume->is_open({glm::vec3(box.min), glm::vec3(box.max)})) places.push_back(place);
  }
  return places;
}

/// All units: what the threads share.
class FarBatch {
 public:
  FarBatch(const ModelReader& reader, const FarTables& tables, const FarOptions& options, uint64_t hash,
           uint64_t memory_bytes, const WorkFolder& folder, JobMonitor& monitor, std::span<const uint64_t> places)
      : tables_(tables),
        options_(options),
        hash_(hash),
        folder_(folder),
        monitor_(monitor),
        places_(places),
        scene_(reader, memory_bytes / kCachePart) {}

  Status run() {
    const size_t units = (places_.size() + kUnitCells - 1) / kUnitCells;
    hashes.resize(units);
    tbb::parallel_for(
        size_t(0), units,
        [&](size_t unit) {
          if (!stopped()) work(unit);
        },
        tbb::simple_partitioner());
    const std::lock_guard lock(mutex_);
    if (failure_) return *failure_;
    if (monitor_.cancelled()) return Error{kInterrupted};
    return Done{};
  }

  std::vector<uint64_t> hashes;
  FarFigures figures;  ///< sums; guarded by mutex_ while units run
  uint64_t faces_bytes = 0, triangles = 0;
  double busy_ms = 0;

 private:
  bool stopped() const { return failed_ || monitor_.cancelled(); }

  void work(size_t unit) {
    const std::span<const uint64_t> places =
        places_.subspan(unit * kUnitCells, std::min(kUnitCells, places_.size() - unit * kUnitCells));
    const uint64_t hash = hashes[unit] = checksum(std::as_bytes(places), hash_);
    if (const auto payload = folder_.load(name_of_unit(unit), hash))
      if (const std::optional<std::vector<StoredFarCell>> cells = read_payload(*payload)) return count(*cells, 0, true);
    const auto begin = std::chrono::steady_clock::now();
    std::vector<StoredFarCell> cells;
    for (const uint64_t place : places) {
      if (stopped()) return;
      Result<StoredFarCell> cell = make_cell(place);
      if (!cell) return fail(cell.error());
      cells.push_back(std::move(*cell));
    }
    const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
    if (const Status status = folder_.store(name_of_unit(unit), hash, payload_of(cells)); !status)
      return fail(status.error());
    count(cells, taken.count(), false);
  }

  Result<StoredFarCell> make_cell(uint64_t place) {
    const glm::dvec3 centre = box_of_place(tables_, place).center();
    Result<FarView> view = FarView::make(scene_, centre, tables_.box_m, tables_.face_levels);
    if (!view) return view.error();
    std::array<std::optional<DrawnSide>, 6> sides;
    for (uint32_t s = 0; s < 6; ++s) {
      DrawnSide drawn;
      const Result<bool> any = view->draw(s, drawn.colors, drawn.depth_m);
      if (!any) return any.error();
      if (*any) sides[s] = std::move(drawn);
    }
    const ShapedFar shaped = shape_far(tables_, std::move(sides));
    StoredFarCell cell;
    cell.place = place, cell.parallax_rad = static_cast<float>(shaped.parallax_rad);
    for (uint32_t s = 0; s < 6; ++s) {
      if (!shaped.faces[s]) continue;
      Result<std::vector<std::byte>> bytes = encode_far_face(*shaped.faces[s], {options_.jpeg_quality});
      if (!bytes) return bytes.error();
      cell.faces.push_back({s, far_triangles(*shaped.faces[s]), std::move(*bytes)});
    }
    return cell;
  }

  void count(const std::vector<StoredFarCell>& cells, double ms, bool resumed) {
    const std::lock_guard lock(mutex_);
    ++figures.units;
    figures.units_resumed += resumed ? 1U : 0U;
    if (!resumed) figures.cells_computed += cells.size(), busy_ms += ms;
    for (const StoredFarCell& cell : cells) {
      ++figures.cells;
      figures.cells_with_pictures += cell.faces.empty() ? 0U : 1U;
      figures.faces += cell.faces.size();
      figures.parallax_max_rad = std::max(figures.parallax_max_rad, double(cell.parallax_rad));
      for (const StoredFarCell::Face& face : cell.faces) faces_bytes += face.bytes.size(), triangles += face.triangles;
    }
    monitor_.progress("far pictures", figures.cells, places_.size());
  }

  void fail(const Error& error) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = error;
    failed_ = true;
  }

  const FarTables& tables_;
  const FarOptions& options_;
  uint64_t hash_;
  const WorkFolder& folder_;
  JobMonitor& monitor_;
  std::span<const uint64_t> places_;
  FarScene scene_;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::optional<Error> failure_;  ///< guarded by mutex_
};

}  // namespace

Result<FarUnits> make_far(const ModelReader& reader, const FarOptions& options, uint64_t hash, uint64_t memory_bytes,
                          const WorkFolder& folder, JobMonitor& monitor) {
  Result<FarTables> tables = far_grid(reader.model(), options);
  if (!tables) return tables.error();
  const Result<std::vector<uint64_t>> places = choose_places(reader, *tables, options, monitor);
  if (!places) return places.error();
  if (places->size() > options.max_cells)
    return Error{
        fmt::format("far pictures: {} view cells of {:.2f} m, more than --far-max-cells {}; allow more, or take a "
                    "larger --far-bound, --far-box or --far-cell, --far-height or --far-path",
                    places->size(), tables->cell_m, options.max_cells)};
  UnitWriter writer;
  writer.value(hash), writer.value(hash_of(options)), writer.value(kVersion);
  FarBatch batch(reader, *tables, options, checksum(writer.bytes()), memory_bytes, folder, monitor, *places);
  PROMENADE_TRY(batch.run());
  FarUnits units{std::move(*tables), batch.figures, std::move(batch.hashes)};
  FarFigures& f = units.figures;
  const double with = std::max(1.0, double(f.cells_with_pictures));
  f.cell_m = units.tables.cell_m, f.box_m = units.tables.box_m;
  f.side_px = (1U << units.tables.face_levels) + 1;
  f.triangles_mean = double(batch.triangles) / with, f.bytes_mean = double(batch.faces_bytes) / with;
  constexpr double kTexelBytes = 3;
  f.texel_bytes_mean = double(f.faces) * f.side_px * f.side_px * kTexelBytes / with;
  f.ms_per_cell = f.cells_computed > 0 ? batch.busy_ms / double(f.cells_computed) : 0;
  return units;
}

FarCellSource cells_of(const FarUnits& units, const WorkFolder& folder) {
  auto next = std::make_shared<size_t>(0);
  return [next, &units, &folder]() -> Result<std::vector<StoredFarCell>> {
    if (*next >= units.unit_hashes.size()) return std::vector<StoredFarCell>{};
    const std::string name = name_of_unit(*next);
    const auto payload = folder.load(name, units.unit_hashes[*next]);
    std::optional<std::vector<StoredFarCell>> cells;
    if (payload) cells = read_payload(*payload);
    if (!cells || cells->empty())
      return Error{fmt::format("{}: a finished work unit is gone or damaged; run the same command again",
                               folder.path_of(name).string())};
    ++*next;
    return std::move(*cells);
  };
}

}  // namespace promenade
