#include "preprocess/node_order.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "codec/frame.h"
#include "codec/id_set.h"
#include "layout/file_io.h"
#include "layout/step_sets.h"
#include "preprocess/survey.h"
#include "preprocess/unit_io.h"

namespace promenade {
namespace {

constexpr std::string_view kFilePrefix = "file:";
constexpr uint64_t kMostFileBytes = uint64_t(1) << 32;

constexpr uint32_t kUnitsVersion = 2;  // of the units' content: a change makes them be done again

/// What the cells see, and what that means for an order.
struct Steps {
  Incidence matrix;           ///< a row a step, a column a node
  double delta_ids_mean = 0;  ///< what leaves and what enters
};

Result<Steps> steps_of(const Model& model, const Visibility& visibility) {
  const auto nodes = static_cast<uint32_t>(model.tables.nodes.size());
  std::vector<std::vector<uint32_t>> sets;
  sets.reserve(visibility.vlods.size());
  for (const CodedVlod& vlod : visibility.vlods) {
    Result<std::vector<uint32_t>> ids = decode_ids(vlod.ids, nodes);
    if (!ids.ok()) return ids.error();
    sets.push_back(std::move(*ids));
  }
  const std::vector<CellFace>& faces = visibility.cells.faces;
  Steps steps{incidence_of(step_rows(sets, faces), nodes), 0};
  // Both rows of a face together are its delta.
  steps.delta_ids_mean = double(steps.matrix.ones.size()) / std::max<double>(1, double(faces.size()));
  return steps;
}

uint64_t hash_of(const Incidence& matrix) {
  UnitWriter writer;
  writer.value(kUnitsVersion), writer.value(matrix.rows);
  writer.value(checksum(std::as_bytes(std::span(matrix.first))));
  writer.value(checksum(std::as_bytes(std::span(matrix.ones))));
  return checksum(writer.bytes());
}

/// The tour's work units.
class TourUnits {
 public:
  TourUnits(const Incidence& matrix, const WorkFolder& folder, JobMonitor& monitor)
      : matrix_(matrix), hash_(hash_of(matrix)), folder_(folder), monitor_(monitor) {}

  Result<ColumnOrder> run() {
    const std::string unit = "order-tour";
    if (const auto payload = folder_.load(unit, hash_)) {
      UnitReader reader(*payload);
      ColumnOrder order = reader.array<uint32_t>();
      if (reader.ok() && is_permutation_of(order, matrix_.columns())) return order;
    }
    Result<ColumnOrder> order =
        tour_order(matrix_, TourOptions(), [this](std::span<const uint32_t> among, const NeighbourOptions& options) {
          return neighbours(among, options);
        });
    if (!order.ok()) return order;
    UnitWriter writer;
    writer.array(*order);
    PROMENADE_TRY(folder_.store(unit, hash_, writer.bytes()));
    return order;
  }

 private:
  Result<NeighbourLists> neighbours(std::span<const uint32_t> among, const NeighbourOptions& options) {
    std::vector<NeighbourLists> parts;
    for (uint32_t round = 0; round < options.rounds; ++round) {
      if (monitor_.cancelled()) return Error{kInterrupted};
      Result<NeighbourLists> part = neighbours_of_round(among, options, round);
      if (!part.ok()) return part;
      parts.push_back(std::move(*part));
      monitor_.progress("order", round + 1, options.rounds);
    }
    return near_columns_of_parts(matrix_, among, options, parts);
  }

  Result<NeighbourLists> neighbours_of_round(std::span<const uint32_t> among, const NeighbourOptions& options,
                                             uint32_t round) {
    const std::string unit = fmt::format("order-near-{:02}", round);
    if (const auto payload = folder_.load(unit, hash_)) {
      UnitReader reader(*payload);
      NeighbourLists lists;
      lists.first = reader.array<uint64_t>(), lists.all = reader.array<Neighbour>();
      if (reader.ok() && is_sound(lists, among.size())) return lists;
    }
    NeighbourLists lists = near_columns_of_round(matrix_, among, options, round);
    UnitWriter writer;
    writer.array(lists.first), writer.array(lists.all);
    PROMENADE_TRY(folder_.store(unit, hash_, writer.bytes()));
    return lists;
  }

  static bool is_sound(const NeighbourLists& lists, size_t columns) {
    return lists.first.size() == columns + 1 && lists.first.front() == 0 && lists.first.back() == lists.all.size() &&
           std::is_sorted(lists.first.begin(), lists.first.end()) &&
           std::all_of(lists.all.begin(), lists.all.end(), [&](const Neighbour& n) { return n.column < columns; });
  }

  const Incidence& matrix_;
  uint64_t hash_;
  const WorkFolder& folder_;
  JobMonitor& monitor_;
};

Result<ColumnOrder> read_order(const std::filesystem::path& file, uint32_t nodes) {
  const Result<std::vector<std::byte>> bytes = read_file(file, kMostFileBytes);
  if (!bytes.ok()) return bytes.error();
  Result<ColumnOrder> order = parse_order({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, nodes);
  if (!order.ok()) return Error{fmt::format("{}: {}", file.string(), order.error().message)};
  return order;
}

}  // namespace

Result<NodeOrderOptions> parse_node_order(const std::string& text) {
  const std::span<const std::string_view> names = order_names();
  if (std::find(names.begin(), names.end(), text) != names.end()) return NodeOrderOptions{text, {}};
  if (text.starts_with(kFilePrefix) && text.size() > kFilePrefix.size())
    return NodeOrderOptions{"file", text.substr(kFilePrefix.size())};
  return Error{fmt::format("\"{}\" is no order of nodes: {} or file:FILE", text, fmt::join(names, ", "))};
}

Result<NodeOrder> node_order(const Model& model, const Visibility& visibility, const NodeOrderOptions& options,
                             const WorkFolder& folder, JobMonitor& monitor) {
  const Result<Steps> steps = steps_of(model, visibility);
  if (!steps.ok()) return steps.error();
  NodeOrder made{{}, steps->delta_ids_mean};
  if (options.name == "file") {
    Result<ColumnOrder> order = read_order(options.file, static_cast<uint32_t>(model.tables.nodes.size()));
    if (!order.ok()) return order.error();
    made.order = std::move(*order);
    return made;
  }
  std::vector<glm::vec3> points;
  points.reserve(model.tables.nodes.size());
  for (const NodeRecord& node : model.tables.nodes) points.push_back(node.box.center());
  const OrderQuestion question{&steps->matrix, points};
  std::vector<MadeOrder> orders;
  orders.push_back(make_order("input", question));
  if (options.name == "tour") {
    Result<ColumnOrder> tour = TourUnits(steps->matrix, folder, monitor).run();
    if (!tour.ok()) return tour.error();
    const uint64_t runs = count_runs(steps->matrix, *tour);
    orders.push_back({"tour", std::move(*tour), runs, 0});
  } else if (options.name != "input") {
    orders.push_back(make_order(options.name, question));
  }
  made.order = best_of(orders).order;
  return made;
}

}  // namespace promenade
