#include "cli/study_orders.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <string>

#include "cli/console.h"
#include "cli/study_sets.h"
#include "cli/view_options.h"
#include "layout/file_io.h"
#include "layout/order.h"
#include "layout/read_cost.h"
#include "preprocess/node_order.h"
#include "runtime/cursor.h"

namespace promenade {
namespace {

constexpr uint64_t kMostOrderBytes = uint64_t(1) << 34;  // of an order as text: a billion lines

struct Arguments {
  std::filesystem::path model, path_file, export_folder;
  std::string order_file;
  double copies = 0.3;
};

/// From one cell to another.
struct Step {
  uint32_t from = 0, to = 0;
  double weight = 1;             ///< how often it is taken
  std::vector<uint32_t> enters;  ///< node ids, ascending
};

std::vector<uint32_t> entering(const StudySets& sets, uint32_t from, uint32_t to) {
  std::vector<uint32_t> ids;
  const std::vector<uint32_t>&a = sets.vlods[from], &b = sets.vlods[to];
  std::set_difference(b.begin(), b.end(), a.begin(), a.end(), std::back_inserter(ids));
  return ids;
}

/// Across every face in both directions.
std::vector<Step> all_steps(const ModelReader& reader, const StudySets& sets) {
  std::vector<Step> steps;
  for (const CellFace& face : reader.cells()->tables().faces)
    for (const bool up : {true, false}) {
      const uint32_t from = index_of(up ? face.below : face.above), to = index_of(up ? face.above : face.below);
      steps.push_back({from, to, 1, entering(sets, from, to)});
    }
  return steps;
}

/// Weighs the steps by how often a path takes them; jumps between cells that are no neighbours are added.
Status weigh_by_path(const std::filesystem::path& file, const ModelReader& reader, const StudySets& sets,
                     std::vector<Step>& steps) {
  const Result<CameraPath> path = read_path(file);
  if (!path) return path.error();
  std::map<std::pair<uint32_t, uint32_t>, size_t> number;
  for (size_t i = 0; i < steps.size(); ++i) steps[i].weight = 0, number[{steps[i].from, steps[i].to}] = i;
  Cursor cursor(&reader.cells()->tables());
  std::optional<CellId> last;
  for (uint32_t frame = 0; frame < path->frame_count(); ++frame) {
    cursor.move_to(pose_of_frame(*path, frame).eye - reader.model().manifest.origin);
    const std::optional<CellId> cell = cursor.cell();
    if (cell && last && *cell != *last) {
      const std::pair<uint32_t, uint32_t> key{index_of(*last), index_of(*cell)};
      if (!number.contains(key)) {
        number[key] = steps.size();
        steps.push_back({key.first, key.second, 0, entering(sets, key.first, key.second)});
      }
      steps[number[key]].weight += 1;
    }
    if (cell) last = cell;
  }
  return Done{};
}

/// What steps cost on average.
struct StepCost {
  double reads = 0, bytes = 0, useful_bytes = 0, ms = 0;
};

StepCost mean_of(const std::vector<Step>& steps, const std::vector<ReadPlan>& plans) {
  StepCost cost;
  double weight = 0;
  for (size_t i = 0; i < steps.size(); ++i) {
    const double w = steps[i].weight;
    weight += w;
    cost.reads += w * static_cast<double>(plans[i].reads), cost.bytes += w * static_cast<double>(plans[i].bytes);
    cost.useful_bytes += w * static_cast<double>(plans[i].useful_bytes), cost.ms += w * plans[i].seconds * 1e3;
  }
  weight = std::max(weight, 1e-9);
  return {cost.reads / weight, cost.bytes / weight, cost.useful_bytes / weight, cost.ms / weight};
}

/// A way to lay nodes out, and what it costs on each kind of storage.
struct LayoutRow {
  std::string name;
  double runs_per_delta = 0, wall_s = 0, stored_share = 1;
  bool is_default = false;
  std::vector<StepCost> costs;  ///< by storage_profiles()
};

class OrderStudy {
 public:
  OrderStudy(const ModelReader& reader, const StudySets& sets, std::vector<Step> steps)
      : tables_(reader.model().tables), sets_(sets), steps_(std::move(steps)) {
    matrix_ = incidence_of(sets.deltas, static_cast<uint32_t>(tables_.nodes.size()));
    for (const NodeRecord& node : tables_.nodes) points_.push_back(node.box.center());
  }

  OrderQuestion question() const { return {&matrix_, points_}; }
  const Incidence& matrix() const { return matrix_; }

  /// copies: bytes of copies of steps, as a share of all nodes'; 0: none.
  LayoutRow row_of(const MadeOrder& made, double copies) const {
    LayoutRow row{std::string(made.name), static_cast<double>(made.runs) / delta_count(), made.wall_s, 1, false, {}};
    const NodeLayout layout(bytes_in(made.order));
    std::vector<uint32_t> place(made.order.size());
    for (size_t i = 0; i < place.size(); ++i) place[made.order[i]] = static_cast<uint32_t>(i);
    for (const StorageProfile& profile : storage_profiles()) {
      std::vector<ReadPlan> plans;
      for (const Step& step : steps_) {
        std::vector<uint32_t> places;
        for (const uint32_t id : step.enters) places.push_back(place[id]);
        std::sort(places.begin(), places.end());
        plans.push_back(layout.plan(places, profile));
      }
      if (copies > 0) use_copies(profile, copies, layout.bytes(), plans, row);
      row.costs.push_back(mean_of(steps_, plans));
    }
    if (copies > 0) row.name += "+copies";
    return row;
  }

  /// Every step's nodes in one piece of their own: the other extreme.
  LayoutRow row_by_step() const {
    LayoutRow row{"by-step", 1, 0, 0, false, {}};
    uint64_t bytes = 0, all = 0;
    for (uint32_t id = 0; id < tables_.nodes.size(); ++id) all += bytes_of(id);
    for (const Step& step : steps_) bytes += useful(step);
    row.stored_share = static_cast<double>(bytes) / static_cast<double>(std::max<uint64_t>(1, all));
    for (const StorageProfile& profile : storage_profiles()) row.costs.push_back(mean_of(steps_, copied(profile)));
    return row;
  }

 private:
  double delta_count() const { return std::max<double>(1, static_cast<double>(sets_.deltas.size())); }
  uint32_t bytes_of(uint32_t id) const { return tables_.segments[tables_.nodes[id].segment].stored_bytes; }
  std::vector<uint32_t> bytes_in(const ColumnOrder& order) const {
    std::vector<uint32_t> bytes;
    for (const uint32_t id : order) bytes.push_back(bytes_of(id));
    return bytes;
  }
  uint64_t useful(const Step& step) const {
    uint64_t bytes = 0;
    for (const uint32_t id : step.enters) bytes += bytes_of(id);
    return bytes;
  }
  /// Each step read from a copy of its own.
  std::vector<ReadPlan> copied(const StorageProfile& profile) const {
    std::vector<ReadPlan> plans;
    for (const Step& step : steps_) plans.push_back(plan_reads(std::vector<Extent>{{0, useful(step)}}, profile));
    return plans;
  }
  void use_copies(const StorageProfile& profile, double share, uint64_t all, std::vector<ReadPlan>& plans,
                  LayoutRow& row) const {
    const std::vector<ReadPlan> alone = copied(profile);
    const std::vector<uint8_t> chosen =
        choose_copies(plans, alone, static_cast<uint64_t>(share * static_cast<double>(all)));
    uint64_t bytes = all;
    for (size_t i = 0; i < plans.size(); ++i)
      if (chosen[i] != 0) plans[i] = alone[i], bytes += alone[i].bytes;
    row.stored_share =
        std::max(row.stored_share, static_cast<double>(bytes) / static_cast<double>(std::max<uint64_t>(1, all)));
  }

  const ModelTables& tables_;
  const StudySets& sets_;
  std::vector<Step> steps_;
  Incidence matrix_;
  std::vector<glm::vec3> points_;
};

Json json_of(const StepCost& cost) {
  return {{"reads_per_step_mean", cost.reads},
          {"bytes_per_step_mean", cost.bytes},
          {"useful_share", cost.bytes > 0 ? cost.useful_bytes / cost.bytes : 1.0},
          {"read_ms_per_step_mean", cost.ms}};
}

Json json_of(const LayoutRow& row) {
  constexpr size_t kShown = 1;  // of the profiles: the figures beside the name are those of an SSD
  Json json = {{"name", row.name}, {"runs_per_delta_mean", row.runs_per_delta}};
  json.update(json_of(row.costs[kShown]));
  json["stored_share"] = row.stored_share;
  json["wall_s"] = row.wall_s;
  json["default"] = row.is_default;
  for (size_t i = 0; i < row.costs.size(); ++i)
    json["profiles"][std::string(storage_profiles()[i].name)] = json_of(row.costs[i]);
  return json;
}

void print_table(const std::vector<LayoutRow>& rows) {
  fmt::print("{:18} {:>10} {:>7}", "order", "runs/delta", "stored");
  for (const StorageProfile& profile : storage_profiles())
    fmt::print(" | {:>8} {:>6} {:>9} {:>6}", profile.name, "reads", "bytes", "useful");
  fmt::print("\n");
  for (const LayoutRow& row : rows) {
    fmt::print("{:18} {:>10.2f} {:>6.2f}x", row.name, row.runs_per_delta, row.stored_share);
    for (const StepCost& c : row.costs)
      fmt::print(" | {:>5.1f} ms {:>6.2f} {:>9} {:>6.2f}", c.ms, c.reads, human_bytes(static_cast<uint64_t>(c.bytes)),
                 c.bytes > 0 ? c.useful_bytes / c.bytes : 1.0);
    fmt::print("{}\n", row.is_default ? "  (default)" : "");
  }
}

Result<std::vector<MadeOrder>> make_orders(const OrderStudy& study, const std::string& file, JobMonitor& monitor) {
  std::vector<MadeOrder> orders;
  for (const std::string_view name : order_names()) {
    if (monitor.cancelled()) return Error{"interrupted"};
    orders.push_back(make_order(name, study.question()));
    monitor.progress("orders", orders.size(), order_names().size());
  }
  if (file.empty()) return orders;
  const Result<std::vector<std::byte>> bytes = read_file(file, kMostOrderBytes);
  if (!bytes) return bytes.error();
  Result<ColumnOrder> order =
      parse_order({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, study.matrix().columns());
  if (!order) return Error{fmt::format("{}: {}", file, order.error().message)};
  const uint64_t runs = count_runs(study.matrix(), *order);
  orders.push_back({"file", std::move(*order), runs, 0});
  return orders;
}

Status run(const Arguments& arguments, JobMonitor& monitor, Json& figures) {
  const Result<ModelReader> reader = ModelReader::open(arguments.model);
  if (!reader) return reader.error();
  const Result<StudySets> sets = read_study_sets(*reader, monitor);
  if (!sets) return sets.error();
  if (!arguments.export_folder.empty()) PROMENADE_TRY(export_study_sets(arguments.export_folder, *reader, *sets));
  std::vector<Step> steps = all_steps(*reader, *sets);
  if (!arguments.path_file.empty()) PROMENADE_TRY(weigh_by_path(arguments.path_file, *reader, *sets, steps));
  const OrderStudy study(*reader, *sets, std::move(steps));
  const Result<std::vector<MadeOrder>> orders = make_orders(study, arguments.order_file, monitor);
  if (!orders) return orders.error();
  std::vector<LayoutRow> rows;
  for (const MadeOrder& made : *orders) {
    rows.push_back(study.row_of(made, 0));
    rows.back().is_default = made.name == NodeOrderOptions().name;
  }
  rows.push_back(study.row_of(best_of(*orders), arguments.copies));
  rows.push_back(study.row_by_step());
  figures["nodes"] = study.matrix().columns();
  figures["deltas"] = sets->deltas.size();
  figures["runs_lower_bound_per_delta"] = static_cast<double>(lower_bound_of_runs(study.matrix())) /
                                          std::max<double>(1, static_cast<double>(sets->deltas.size()));
  for (const LayoutRow& row : rows) figures["orders"].push_back(json_of(row));
  fmt::print("{} nodes, {} deltas; no order has fewer than {:.2f} runs a delta (0: too many columns to tell)\n\n",
             study.matrix().columns(), sets->deltas.size(), double(figures["runs_lower_bound_per_delta"]));
  print_table(rows);
  return Done{};
}

}  // namespace

Command add_study_orders(CLI::App& study) {
  CLI::App* app = study.add_subcommand("orders", "What steps between cells cost to read, nodes laid out in any order");
  auto arguments = std::make_shared<Arguments>();
  app->add_option("model", arguments->model, "Model with view cells")->required();
  app->add_option("--path", arguments->path_file, "Steps as this camera path takes them (default: across every face)");
  app->add_option_function<std::string>(
      "--order",
      [arguments](const std::string& text) {
        constexpr std::string_view kPrefix = "file:";
        if (!text.starts_with(kPrefix)) throw CLI::ValidationError("--order", "\"" + text + "\" is no file:FILE");
        arguments->order_file = text.substr(kPrefix.size());
      },
      "An order of one's own as well: file:FILE, a node's number a line");
  app->add_option("--copies", arguments->copies, "Bytes of copies of steps, as a share of all nodes'")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  app->add_option("--export", arguments->export_folder,
                  "Folder for vlods.txt, deltas.txt and nodes.txt: the same data as plain text");
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run(*arguments, monitor, figures); }};
}

}  // namespace promenade
