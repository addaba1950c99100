#include "cli/study_orders.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "cli/console.h"
#include "cli/order_layouts.h"
#include "cli/order_table.h"
#include "cli/plot.h"
#include "cli/report_page.h"
#include "layout/file_io.h"
#include "layout/order.h"
#include "layout/read_cost.h"
#include "layout/storage_probe.h"
#include "preprocess/node_order.h"

namespace promenade {
namespace {

constexpr uint64_t kMostOrderBytes = uint64_t(1) << 34;  // of an order as text: a billion lines

struct Arguments {
  StudyArguments study;
  std::string order_file;
  double copies = 0.3, useful = 0.8;
  std::vector<std::string> disks = {"disk", "ssd", "network"};
  uint64_t memory_bytes = 0;
  uint32_t table_columns = 0;
};

constexpr std::string_view kMeasured = "measured";

/// The kinds of storage that are asked for; a measured one is that of the model's folder.
Result<std::vector<StorageProfile>> storage_to_study(const Arguments& arguments, JobMonitor& monitor) {
  std::vector<StorageProfile> profiles;
  for (const std::string& name : arguments.disks) {
    if (const StorageProfile* known = find_storage_profile(name); known != nullptr) {
      profiles.push_back(*known);
      continue;
    }
    const std::filesystem::path folder = arguments.study.model / "..";
    const Result<StorageProfile> measured = measure_storage(folder, ProbeOptions(), monitor);
    if (!measured) return measured.error();
    profiles.push_back(*measured);
  }
  return profiles;
}

Json json_of(const StepCost& cost, double useful_share) {
  return {{"reads_per_step_mean", cost.reads},
          {"bytes_per_step_mean", cost.bytes},
          {"useful_share", useful_share},
          {"read_ms_per_step_mean", cost.ms}};
}

/// The profile whose figures stand beside an order's name: an SSD, or the first there is.
size_t shown_profile(const std::vector<StorageProfile>& profiles) {
  for (size_t i = 0; i < profiles.size(); ++i)
    if (profiles[i].name == "ssd") return i;
  return 0;
}

Json json_of(const LayoutRow& row, const std::vector<StorageProfile>& profiles) {
  const StepCost& shown = row.costs[shown_profile(profiles)];
  Json json = {{"name", row.name}, {"runs_per_delta_mean", row.runs_per_step}};
  json.update(json_of(shown, shown.useful_share()));
  json["stored_share"] = row.stored_share;
  json["wall_s"] = row.wall_s;
  json["default"] = row.is_default;
  for (size_t i = 0; i < row.costs.size(); ++i)
    json["profiles"][std::string(profiles[i].name)] = json_of(row.costs[i], row.costs[i].useful_share());
  for (size_t i = 0; i < row.walks.size(); ++i) {
    Json walk = json_of(row.walks[i].step, row.walks[i].useful_share);
    walk["start_bytes"] = row.walks[i].start_bytes;
    json["walk"][std::string(profiles[i].name)] = walk;
  }
  return json;
}

using Table = std::vector<std::vector<std::string>>;

void add_cost(std::vector<std::string>& cells, const StepCost& cost, double useful_share) {
  cells.push_back(fmt::format("{:.1f}", cost.ms));
  cells.push_back(fmt::format("{:.2f}", cost.reads));
  cells.push_back(human_bytes(static_cast<uint64_t>(cost.bytes)));
  cells.push_back(fmt::format("{:.2f}", useful_share));
}

/// A row an order, the head first: each step by itself, or, along a path, with nodes staying in memory.
Table table_of(const std::vector<LayoutRow>& rows, const std::vector<StorageProfile>& profiles, bool of_walk) {
  Table table = {{"order", "runs", "stored"}};
  for (const StorageProfile& profile : profiles)
    for (const char* name : {" ms", " reads", " bytes", " useful"})
      table[0].push_back(name[1] == 'm' ? std::string(profile.name) + name : name + 1);
  for (const LayoutRow& row : rows) {
    if (of_walk && row.walks.empty()) continue;
    std::vector<std::string> cells = {row.name + (row.is_default ? " (default)" : ""),
                                      fmt::format("{:.2f}", row.runs_per_step),
                                      fmt::format("{:.2f}x", row.stored_share)};
    for (size_t i = 0; i < profiles.size(); ++i)
      of_walk ? add_cost(cells, row.walks[i].step, row.walks[i].useful_share)
              : add_cost(cells, row.costs[i], row.costs[i].useful_share());
    table.push_back(std::move(cells));
  }
  return table;
}

void print_table(const Table& table) {
  for (const std::vector<std::string>& row : table) {
    fmt::print("{:18}", row[0]);
    for (size_t i = 1; i < row.size(); ++i) fmt::print(" {:>{}}", row[i], i < 3 ? 7 : (i % 4 == 1 ? 10 : 9));
    fmt::print("\n");
  }
}

std::string line_of(const StorageProfile& profile) {
  return fmt::format("{}: {:.3f} ms before a read, {:.0f} MB/s, blocks of {}", profile.name, profile.seek_s * 1e3,
                     profile.bytes_per_s / 1e6, human_bytes(profile.block_bytes));
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

std::vector<LayoutRow> rows_of(const OrderStudy& study, const std::vector<MadeOrder>& orders,
                               const Arguments& arguments) {
  std::vector<LayoutRow> rows;
  for (const MadeOrder& made : orders) {
    rows.push_back(study.row_of(made, {}));
    rows.back().is_default = made.name == NodeOrderOptions().name;
  }
  const MadeOrder& chosen = *std::find_if(orders.begin(), orders.end(),
                                          [](const MadeOrder& made) { return made.name == NodeOrderOptions().name; });
  rows.push_back(study.row_of(chosen, {"+useful", arguments.useful, 0}));
  rows.push_back(study.row_of(chosen, {"+copies", 0, arguments.copies}));
  rows.push_back(study.row_by_step());
  return rows;
}

struct Results {
  std::string headline, walk_line;
  Table steps, walk;
  std::vector<OrderTableRow> table_1;
};

std::string page_of(const Arguments& arguments, const OrderStudy& study, const std::vector<LayoutRow>& rows,
                    const Results& results) {
  std::string body = fmt::format("<p>{}</p>\n", escaped(results.headline));
  for (const StorageProfile& profile : study.profiles()) body += fmt::format("<p>{}</p>\n", escaped(line_of(profile)));
  body += "<div style=\"overflow-x: auto\">" + html_table(results.steps, true) + "</div>\n";
  if (!results.walk_line.empty())
    body += fmt::format("<p>{}</p>\n<div style=\"overflow-x: auto\">{}</div>\n", escaped(results.walk_line),
                        html_table(results.walk, true));
  std::vector<PlotBar> runs;
  runs.reserve(rows.size());
  for (const LayoutRow& row : rows) runs.push_back({row.name, row.runs_per_step});
  body += bar_plot(runs, "Runs", "a step");
  for (size_t i = 0; i < study.profiles().size(); ++i) {
    std::vector<PlotBar> ms, useful;
    for (const LayoutRow& row : rows) {
      ms.push_back({row.name, row.costs[i].ms});
      useful.push_back({row.name, 100 * row.costs[i].useful_share()});
    }
    body += bar_plot(ms, fmt::format("Reading, {}", study.profiles()[i].name), "ms a step");
    body += bar_plot(useful, fmt::format("Of what is read, wanted, {}", study.profiles()[i].name), "%");
  }
  const std::string& path = arguments.study.path_file.string();
  return html_page("What steps through " + arguments.study.model.string() + " cost to read",
                   escaped(path.empty() ? "across every face in both directions" : path), body);
}

void print_results(const OrderStudy& study, const Results& results) {
  fmt::print("{}\n", results.headline);
  for (const StorageProfile& profile : study.profiles()) fmt::print("{}\n", line_of(profile));
  fmt::print("\n");
  print_table(results.steps);
  if (!results.walk_line.empty()) {
    fmt::print("\n{}\n\n", results.walk_line);
    print_table(results.walk);
  }
  if (!results.table_1.empty()) fmt::print("\n{}", markdown_of(results.table_1));
}

Status run(const Arguments& arguments, JobMonitor& monitor, Json& figures) {
  const Result<StudyInput> input = open_study(arguments.study, monitor);
  if (!input) return input.error();
  Result<std::vector<StorageProfile>> profiles = storage_to_study(arguments, monitor);
  if (!profiles) return profiles.error();
  const OrderStudy study(*input, std::move(*profiles), arguments.memory_bytes);
  const Result<std::vector<MadeOrder>> orders = make_orders(study, arguments.order_file, monitor);
  if (!orders) return orders.error();
  const std::vector<LayoutRow> rows = rows_of(study, *orders, arguments);
  Results results;
  const double bound = double(lower_bound_of_runs(study.matrix())) / study.row_count();
  results.headline = fmt::format("{} nodes, {} steps across {} faces; no order has fewer than {:.2f} runs a step{}",
                                 study.matrix().columns(), study.matrix().rows, input->sets.deltas.size(), bound,
                                 bound > 0 ? "" : " (too many columns to tell)");
  results.steps = table_of(rows, study.profiles(), false);
  if (!input->sets.walk.empty()) {
    results.walk_line = fmt::format(
        "the path's {} steps one after the other, with {} for nodes to stay in memory; useful: of all that "
        "is read, the start too, what is wanted before it leaves",
        input->sets.walk.size() - 1, human_bytes(study.memory_bytes()));
    results.walk = table_of(rows, study.profiles(), true);
  }
  if (arguments.table_columns > 0)
    results.table_1 = order_table(
        arguments.table_columns, study.matrix().columns(),
        [&study](uint32_t columns) { return study.part_of_matrix(columns); }, monitor);
  figures["nodes"] = study.matrix().columns();
  figures["deltas"] = input->sets.deltas.size();
  figures["runs_lower_bound_per_delta"] = bound;
  figures["memory_bytes"] = study.memory_bytes();
  for (const StorageProfile& p : study.profiles())
    figures["storage"].push_back({{"name", p.name},
                                  {"seek_ms", p.seek_s * 1e3},
                                  {"bytes_per_s", p.bytes_per_s},
                                  {"block_bytes", p.block_bytes}});
  for (const LayoutRow& row : rows) figures["orders"].push_back(json_of(row, study.profiles()));
  if (!results.table_1.empty()) figures["table"] = json_of(results.table_1);
  print_results(study, results);
  if (arguments.study.report_file.empty()) return Done{};
  return write_file(arguments.study.report_file, std::string_view(page_of(arguments, study, rows, results)));
}

}  // namespace

Command add_study_orders(CLI::App& study) {
  CLI::App* app = study.add_subcommand("orders", "What steps between cells cost to read, nodes laid out in any order");
  auto arguments = std::make_shared<Arguments>();
  add_study_arguments(*app, arguments->study);
  app->add_option_function<std::string>(
      "--order",
      [arguments](const std::string& text) {
        constexpr std::string_view kPrefix = "file:";
        if (!text.starts_with(kPrefix)) throw CLI::ValidationError("--order", "\"" + text + "\" is no file:FILE");
        arguments->order_file = text.substr(kPrefix.size());
      },
      "An order of one's own as well: file:FILE, a node's number a line");
  app->add_option("--useful", arguments->useful,
                  "Row +useful: reads are joined only while this share of what is read is wanted")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app->add_option("--copies", arguments->copies, "Row +copies: bytes of copies of steps, as a share of all nodes'")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  app->add_option("--disk", arguments->disks,
                  "Kinds of storage: disk, ssd, network, or measured: that of the model's folder, by a file of 256 MiB "
                  "that is read past the system's cache and removed")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>{"disk", "ssd", "network", std::string(kMeasured)}))
      ->default_str("disk,ssd,network");
  add_parsed<uint64_t>(*app, "--memory", arguments->memory_bytes, parse_bytes,
                       "Along a path: for nodes to stay in memory, in stored bytes (default: one and a half times the "
                       "largest vLOD)");
  app->add_option(
      "--table", arguments->table_columns,
      "Also what the tour takes and gains on matrices of 500 to so many columns, as Markdown: of the model, "
      "beyond its nodes of a generated landscape");
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run(*arguments, monitor, figures); }};
}

}  // namespace promenade
