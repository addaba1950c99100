// Source: [xiong1996] appendix A, the random city model generator; [chhugani2003] section 6 for the detail;
// [lakhia2004] chapter 1 for textures that no two buildings share.

#include "datasets/city.h"

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include "codec/image_codec.h"
#include "datasets/city_budget.h"
#include "datasets/city_path.h"
#include "datasets/city_solids.h"
#include "datasets/city_texture.h"
#include "datasets/city_tile.h"
#include "layout/file_io.h"

namespace promenade {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kFewestTriangles = 1000, kMostTriangles = 4'000'000'000;
constexpr uint64_t kMostBlocks = 4'000'000;
constexpr double kBytesPerUniqueTriangle = 24;  // measured: 22 to 30
constexpr uint32_t kLargestTexturePx = 8192;
constexpr int kJpegQuality = 85;
constexpr int kTrafficLevel = 2;  // of detail: about 9 thousand triangles a car, so that it has levels of its own
constexpr uint32_t kMostMoving = 100'000;

struct Limit {
  const char* name;
  double value, low, high;
};

Status check(const CityOptions& o) {
  const std::array<Limit, 12> limits = {
      Limit{"block length", o.block_length_m, 20, 2000},
      {"block width", o.block_width_m, 20, 2000},
      {"greatest height", o.max_height_m, 4, 1000},
      {"street width", o.street_width_m, 3, 200},
      {"street height", o.street_height_m, -1000, 10'000},
      {"kerb width", o.curb_width_m, 0.5, 20},
      {"kerb height", o.curb_height_m, 0, 2},
      {"distance between trees", o.tree_distance_m, 0, 1000},
      {"texture size in megapixels", o.texture_megapixels, 0, 1e6},
      {"rows of buildings", static_cast<double>(o.max_rows), 1, 100},
      {"columns of buildings", static_cast<double>(o.max_columns), 1, 100},
      {"threads", static_cast<double>(o.jobs), 0, 1024},
  };
  for (const Limit& limit : limits)
    if (!(limit.value >= limit.low && limit.value <= limit.high))
      return Error{fmt::format("city: {} is {}, but must lie between {} and {}", limit.name, limit.value, limit.low,
                               limit.high)};
  if (o.tree_distance_m > 0 && o.tree_distance_m < 2)
    return Error{fmt::format("city: trees {} m apart: at least 2 m, or 0 for none", o.tree_distance_m)};
  if (o.triangles < kFewestTriangles || o.triangles > kMostTriangles)
    return Error{fmt::format("city: {} triangles asked for, but must lie between {} and {}", o.triangles,
                             kFewestTriangles, kMostTriangles)};
  if (o.tile_triangles < kFewestTriangles)
    return Error{
        fmt::format("city: tiles of {} triangles are too small: at least {}", o.tile_triangles, kFewestTriangles)};
  if (o.moving > kMostMoving)
    return Error{fmt::format("city: {} moving cars are too many: at most {}", o.moving, kMostMoving)};
  if (o.plain && (o.interiors || o.texture_megapixels > 0))
    return Error{"city: plain buildings have neither interiors nor textures"};
  if (o.solids && (o.interiors || o.texture_megapixels > 0 || o.moving > 0))
    return Error{"city: CityJSON holds neither interiors nor textures here, and nothing that moves"};
  if (o.blocks_x > kMostBlocks || o.blocks_y > kMostBlocks || uint64_t(o.blocks_x) * o.blocks_y > kMostBlocks)
    return Error{fmt::format("city: {} x {} blocks are too many: at most {}", o.blocks_x, o.blocks_y, kMostBlocks)};
  const double narrow = std::min(o.block_length_m, o.block_width_m);
  if (2 * o.curb_width_m + 4 > narrow * (o.style == StreetStyle::organic ? 0.5 : 1))
    return Error{fmt::format("city: blocks {} m wide leave no room between kerbs of {} m", narrow, o.curb_width_m)};
  if (o.style == StreetStyle::organic && o.street_width_m > narrow * 0.4)
    return Error{fmt::format("city: streets {} m wide are too wide for organic blocks of {} m: at most {} m",
                             o.street_width_m, narrow, narrow * 0.4)};
  return Done{};
}

/// Which blocks go into which file.
struct Tiling {
  uint32_t blocks_x = 1, blocks_y = 1;  ///< of the city
  uint32_t tile_x = 1, tile_y = 1;      ///< blocks of a tile

  uint32_t tiles_x() const { return (blocks_x + tile_x - 1) / tile_x; }
  uint32_t tiles_y() const { return (blocks_y + tile_y - 1) / tile_y; }
};

struct Work {
  uint32_t x = 0, y = 0, tile = 0;
  bool last_of_tile = false;
  CityBlock block;
  std::vector<EncodedFacade> facades;
  std::optional<Error> error;
};

Tiling tiling_of(const CityBudget& budget, bool one_file) {
  Tiling tiling{budget.options.blocks_x, budget.options.blocks_y, budget.options.blocks_x, budget.options.blocks_y};
  if (one_file) return tiling;
  const double per_block = budget.triangles / (static_cast<double>(tiling.blocks_x) * tiling.blocks_y);
  const double blocks = std::max(1.0, static_cast<double>(budget.options.tile_triangles) / per_block);
  const double length = budget.options.block_length_m, width = budget.options.block_width_m;
  const auto parts = [](uint32_t all, double size) {
    return static_cast<uint32_t>(std::clamp(std::round(size), 1.0, static_cast<double>(all)));
  };
  tiling.tile_y = parts(tiling.blocks_y, std::sqrt(blocks * length / width));
  tiling.tile_x = parts(tiling.blocks_x, blocks / tiling.tile_y);
  return tiling;
}

class CityWriter {
 public:
  CityWriter(const CityBudget& budget, PropLibrary& props, fs::path target, bool one_file, JobMonitor& monitor)
      : budget_(budget),
        plan_(budget.options),
        props_(props),
        target_(std::move(target)),
        one_file_(one_file),
        monitor_(monitor),
        tiling_(tiling_of(budget, one_file)) {}

  Result<CityFigures> write(int jobs);

 private:
  std::shared_ptr<Work> next();
  void make(Work& work) const;
  Status paint(const UniqueObject& object, EncodedFacade& facade) const;
  Status take(Work& work);
  fs::path file_of(uint32_t tile) const;

  const CityBudget& budget_;
  CityPlan plan_;
  PropLibrary& props_;
  fs::path target_;
  bool one_file_;
  JobMonitor& monitor_;
  Tiling tiling_;
  uint32_t tile_ = 0, in_tile_ = 0;  ///< of the next work
  uint64_t done_ = 0;
  std::unique_ptr<CityFile> open_tile_;
  CityFigures figures_;
  std::optional<Error> error_;
  std::atomic<bool> stop_ = false;
};

/// The next block, tile by tile; null at the end.
std::shared_ptr<Work> CityWriter::next() {
  if (stop_ || tile_ >= tiling_.tiles_x() * tiling_.tiles_y()) return nullptr;
  const uint32_t x0 = tile_ % tiling_.tiles_x() * tiling_.tile_x, y0 = tile_ / tiling_.tiles_x() * tiling_.tile_y;
  const uint32_t wide = std::min(tiling_.tile_x, tiling_.blocks_x - x0);
  const uint32_t high = std::min(tiling_.tile_y, tiling_.blocks_y - y0);
  auto work = std::make_shared<Work>();
  work->x = x0 + in_tile_ % wide, work->y = y0 + in_tile_ / wide, work->tile = tile_;
  work->last_of_tile = ++in_tile_ == wide * high;
  if (work->last_of_tile) ++tile_, in_tile_ = 0;
  return work;
}

Status CityWriter::paint(const UniqueObject& object, EncodedFacade& facade) const {
  const FacadeSketch& sketch = *object.facade;
  const double density = std::sqrt(budget_.options.texture_megapixels * 1e6 / std::max(budget_.facade_m2, 1.0));
  const auto side = [&](double meters) {
    return static_cast<uint32_t>(std::clamp(std::round(meters * density), 8.0, static_cast<double>(kLargestTexturePx)));
  };
  const Image image = paint_facade(sketch, side(sketch.around_m), side(sketch.height_m), sketch.seed);
  Result<std::vector<std::byte>> jpeg = encode_image(image, ImageFormat::jpeg, kJpegQuality);
  if (!jpeg) return jpeg.error();
  facade = {std::move(*jpeg), uint64_t(image.width) * image.height};
  return Done{};
}

void CityWriter::make(Work& work) const {
  if (stop_) return;
  work.block = make_block(plan_, work.x, work.y, {budget_.detail, false}, props_);
  work.facades.resize(work.block.objects.size());
  for (size_t i = 0; i < work.block.objects.size(); ++i)
    if (work.block.objects[i].facade)
      if (const Status painted = paint(work.block.objects[i], work.facades[i]); !painted) work.error = painted.error();
}

fs::path CityWriter::file_of(uint32_t tile) const {
  if (one_file_) return target_;
  return target_ / fmt::format("tile_{:03}_{:03}.glb", tile % tiling_.tiles_x(), tile / tiling_.tiles_x());
}

Status CityWriter::take(Work& work) {
  if (work.error) return *work.error;
  if (monitor_.cancelled()) return Error{"interrupted"};
  if (!open_tile_) {
    const fs::path file = file_of(work.tile);
    Result<std::unique_ptr<CityFile>> tile = budget_.options.solids ? CitySolids::create(file) : CityTile::create(file);
    if (!tile) return tile.error();
    open_tile_ = std::move(*tile);
  }
  PROMENADE_TRY(open_tile_->add(work.block, work.x, work.y, work.facades, props_, figures_));
  monitor_.progress("city", ++done_, uint64_t(tiling_.blocks_x) * tiling_.blocks_y);
  if (!work.last_of_tile) return Done{};
  // All traffic is in the last file: cars leave their tiles.
  if (budget_.options.moving > 0 && work.tile + 1 == tiling_.tiles_x() * tiling_.tiles_y())
    PROMENADE_TRY(open_tile_->add_traffic(traffic_of(plan_, budget_.options.moving, kTrafficLevel), props_, figures_));
  PROMENADE_TRY(open_tile_->finish());
  open_tile_.reset();
  std::error_code failed;
  figures_.bytes += fs::file_size(file_of(work.tile), failed);
  ++figures_.files;
  return Done{};
}

Result<CityFigures> CityWriter::write(int jobs) {
  const auto source = [this](tbb::flow_control& flow) {
    std::shared_ptr<Work> work = next();
    if (!work) flow.stop();
    return work;
  };
  const auto making = [this](std::shared_ptr<Work> work) {
    make(*work);
    return work;
  };
  const auto sink = [this](const std::shared_ptr<Work>& work) {
    if (stop_) return;
    if (const Status taken = take(*work); !taken) error_ = taken.error(), stop_ = true;
  };
  using tbb::filter_mode;
  // Each of these tokens holds a block: memory is bounded by the threads, not by the city.
  tbb::parallel_pipeline(
      static_cast<size_t>(jobs) * 2,
      tbb::make_filter<void, std::shared_ptr<Work>>(filter_mode::serial_in_order, source) &
          tbb::make_filter<std::shared_ptr<Work>, std::shared_ptr<Work>>(filter_mode::parallel, making) &
          tbb::make_filter<std::shared_ptr<Work>, void>(filter_mode::serial_in_order, sink));
  open_tile_.reset();
  if (error_) return *error_;
  return figures_;
}

/// Files and folders that go again unless everything went well.
class Undo {
 public:
  Undo() = default;
  Undo(const Undo&) = delete;
  Undo& operator=(const Undo&) = delete;
  ~Undo() {
    std::error_code ignored;
    for (const fs::path& path : paths_) fs::remove_all(path, ignored);
  }
  void add(fs::path path) { paths_.push_back(std::move(path)); }
  void forget() { paths_.clear(); }

 private:
  std::vector<fs::path> paths_;
};

fs::path beside(const fs::path& output, const char* ending) {
  std::string name = output.filename().string();
  for (const char* extension : {".glb", ".jsonl", ".city"})
    if (name.ends_with(extension)) name.resize(name.size() - std::string_view(extension).size());
  return output.parent_path() / (name + ending);
}

Status write_paths(const CityPlan& plan, const fs::path& output, Undo& undo) {
  const std::array<std::pair<const char*, CameraPath>, 3> paths = {
      std::pair("_walk.json", walk_through(plan)), {"_drive.json", drive_through(plan)}, {"_fly.json", fly_over(plan)}};
  for (const auto& [ending, path] : paths) {
    const fs::path file = beside(output, ending);
    PROMENADE_TRY(write_file(file, to_json(path)));
    undo.add(file);
  }
  return Done{};
}

/// Where the city is written before it gets its name: a single file sees to that itself.
Result<fs::path> make_target(const fs::path& output, bool one_file) {
  if (one_file) return output;
  std::error_code failed;
  if (fs::exists(output, failed))
    return Error{fmt::format("{}: exists already; remove it or choose another name", output.string())};
  const fs::path partial = output.parent_path() / ("." + output.filename().string() + ".partial");
  fs::remove_all(partial, failed);
  fs::create_directory(partial, failed);
  if (failed) return Error{fmt::format("{}: cannot make the folder: {}", output.string(), failed.message())};
  return partial;
}

Result<CityFigures> generate(const CityOptions& options, const fs::path& output, JobMonitor& monitor, int jobs) {
  PropLibrary props;
  monitor.progress("plan", 0, 0);
  const CityBudget budget = plan_budget(options, props);
  const auto wish = static_cast<double>(options.triangles);
  if (std::abs(budget.triangles - wish) > 0.1 * wish)
    monitor.warning(
        fmt::format("city: {} x {} blocks hold about {:.0f} triangles at this detail, not the {} asked for; "
                    "other numbers of blocks would",
                    budget.options.blocks_x, budget.options.blocks_y, budget.triangles, options.triangles));
  const bool one_file = output.extension() == ".glb" || options.solids;
  if (one_file && !options.solids && budget.unique_triangles * kBytesPerUniqueTriangle > 4.2e9)
    return Error{fmt::format("{}: {} triangles do not fit into one .glb file (4 GiB): name a folder instead",
                             output.string(), options.triangles)};
  const Result<fs::path> target = make_target(output, one_file);
  if (!target) return target.error();
  Undo undo;
  if (!one_file) undo.add(*target);
  Result<CityFigures> figures = CityWriter(budget, props, *target, one_file, monitor).write(jobs);
  if (!figures) return figures;
  if (one_file) undo.add(output);
  PROMENADE_TRY(write_paths(CityPlan(budget.options), output, undo));
  if (!one_file) {
    std::error_code failed;
    fs::rename(*target, output, failed);
    if (failed) return Error{fmt::format("{}: cannot name the finished folder: {}", output.string(), failed.message())};
  }
  undo.forget();
  return figures;
}

}  // namespace

Result<CityFigures> generate_city(const CityOptions& wanted, const fs::path& output, JobMonitor& monitor) {
  CityOptions options = wanted;
  options.solids = is_city_solids(output);
  PROMENADE_TRY(check(options));
  if (!output.has_filename()) return Error{"city: no name given for the output: a .glb file or a folder"};
  const int jobs = options.jobs > 0 ? static_cast<int>(options.jobs) : tbb::this_task_arena::max_concurrency();
  tbb::task_arena arena(jobs);
  return arena.execute([&] { return generate(options, output, monitor, jobs); });
}

}  // namespace promenade
