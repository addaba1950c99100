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
#include "preprocess/far/far_cell.h"
#include "preprocess/far/far_groups.h"
#include "preprocess/survey.h"
#include "preprocess/unit_io.h"
#include "preprocess/visibility/view_volume.h"

namespace promenade {
namespace {

constexpr uint64_t kVoxels = 8 << 20;  // as for the cells of visibility
constexpr uint32_t kVersion = 3;       // of the units' content: a change makes them begin anew
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

/// The places, and those of the outer shells around them; ascending.
std::vector<uint64_t> with_outer(const FarTables& tables, std::set<uint64_t> places) {
  std::set<uint64_t> shell = places;
  while (!shell.empty()) {
    std::set<uint64_t> next;
    for (const uint64_t place : shell)
      if (const std::optional<uint64_t> around = place_around(tables, place)) next.insert(*around);
    places.insert(next.begin(), next.end());
    shell = std::move(next);
  }
  return {places.begin(), places.end()};
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
    return with_outer(tables, places);
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
  std::set<uint64_t> places;
  for (uint64_t place = 0; place < count; ++place) {
    const DBox box = box_of_place(tables, place);
    if (volume->is_open({glm::vec3(box.min), glm::vec3(box.max)})) places.insert(places.end(), place);
  }
  return with_outer(tables, places);
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
        cells_(places.size()),
        groups_(far_groups(tables, places)),
        scene_(reader, memory_bytes / kCachePart) {
    for (const FarShell& shell : shells_of(tables)) figures.shells.push_back({shell.box_m, shell.cell_m, 0, 0, 0});
  }

  Status run() {
    const size_t units = groups_.size();
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
    const std::span<const uint64_t> places = groups_[unit].places;
    const uint64_t hash = hashes[unit] = checksum(std::as_bytes(places), hash_);
    if (const auto payload = folder_.load(name_of_unit(unit), hash))
      if (const std::optional<std::vector<StoredFarCell>> cells = read_payload(*payload)) return count(*cells, 0, true);
    const auto begin = std::chrono::steady_clock::now();
    Result<std::vector<StoredFarCell>> made = make_group(places);
    if (!made) return fail(made.error());
    const std::vector<StoredFarCell>& cells = *made;
    if (cells.size() < places.size()) return;
    const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
    if (const Status status = folder_.store(name_of_unit(unit), hash, payload_of(cells)); !status)
      return fail(status.error());
    count(cells, taken.count(), false);
  }

  /// The key first, as it will be decoded. Fewer cells than places: stopped.
  Result<std::vector<StoredFarCell>> make_group(std::span<const uint64_t> places) {
    std::vector<StoredFarCell> cells;
    cells.reserve(places.size());
    std::array<std::optional<FarFace>, 6> key;
    for (const uint64_t place : places) {
      if (stopped()) break;
      const Result<ShapedFar> drawn = draw_far_cell(scene_, tables_, place);
      if (!drawn) return drawn.error();
      Result<StoredFarCell> cell = store_cell(*drawn, place, places.front(), key);
      if (!cell) return cell.error();
      cells.push_back(std::move(*cell));
    }
    return cells;
  }

  /// Codes a cell's sides. key: those of the key, decoded; put there when this is it and others follow.
  Result<StoredFarCell> store_cell(const ShapedFar& drawn, uint64_t place, uint64_t key_place,
                                   std::array<std::optional<FarFace>, 6>& key) const {
    StoredFarCell cell;
    cell.place = place, cell.parallax_rad = static_cast<float>(drawn.parallax_rad);
    FarReference reference;
    const glm::ivec3 from(coordinates_of(tables_, place)), to(coordinates_of(tables_, key_place));
    for (int i = 0; i < 3; ++i) reference.places[static_cast<size_t>(i)] = static_cast<int8_t>(to[i] - from[i]);
    const FarShell shell = grid_place_of(tables_, place).grid;
    reference.offset = offset_from_reference(reference.places, shell.cell_m, shell.box_m);
    for (size_t s = 0; s < 6; ++s)
      if (key[s]) reference.sides[s] = &*key[s];
    for (uint32_t s = 0; s < 6; ++s) {
      if (!drawn.faces[s]) continue;
      Result<std::vector<std::byte>> bytes = store_side(*drawn.faces[s], s, place == key_place ? nullptr : &reference);
      if (!bytes) return bytes.error();
      if (place == key_place) {
        Result<FarFace> decoded = decode_far_face(*bytes);
        if (!decoded) return decoded.error();
        key[s] = std::move(*decoded);
      }
      cell.faces.push_back({s, far_triangles(*drawn.faces[s]), std::move(*bytes)});
    }
    return cell;
  }

  /// In the shortest way. reference: null for a key.
  Result<std::vector<std::byte>> store_side(const FarFace& face, uint32_t side, const FarReference* reference) const {
    const FarFaceCoding coding{options_.jpeg_quality};
    Result<std::vector<std::byte>> shortest = encode_far_face(face, coding);
    if (!shortest || reference == nullptr || !options_.deltas || options_.jpeg_quality == 0) return shortest;
    // Shifts do for flat pictures, whose cells are small; warping pays across larger ones (`study far`).
    const FarForetelling how = tables_.has_depth ? FarForetelling::warped : FarForetelling::still;
    Result<std::vector<std::byte>> told = encode_far_delta(face, coding, side, *reference, how);
    if (!told) return told;
    return told->size() < shortest->size() ? std::move(told) : std::move(shortest);
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
      FarShellFigures& shell = figures.shells[grid_place_of(tables_, cell.place).shell];
      ++shell.cells, shell.faces += cell.faces.size();
      for (const StoredFarCell::Face& face : cell.faces) shell.bytes += face.bytes.size();
      figures.parallax_max_rad = std::max(figures.parallax_max_rad, double(cell.parallax_rad));
      for (const StoredFarCell::Face& face : cell.faces) {
        faces_bytes += face.bytes.size(), triangles += face.triangles;
        figures.faces_told += reference_of_far_face(face.bytes) ? 1U : 0U;
      }
    }
    monitor_.progress("far pictures", figures.cells, cells_);
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
  size_t cells_;
  std::vector<FarGroup> groups_;
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
