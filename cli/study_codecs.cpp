#include "cli/study_codecs.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "cli/console.h"
#include "cli/plot.h"
#include "cli/report_page.h"
#include "cli/study_sets.h"
#include "codec/id_set.h"
#include "codec/id_set_block.h"
#include "codec/id_set_codec.h"
#include "codec/id_set_rivals.h"
#include "layout/file_io.h"
#include "layout/model_io.h"

namespace promenade {
namespace {

constexpr size_t kFrameSets = 40;  // deltas in a zstd frame

struct CodecRow {
  std::string name, what;
  uint64_t bytes = 0, ids = 0;  ///< ids: of deltas; of vLODs for blocks
  double encode_s = 0, decode_s = 0;
  bool is_default = false;
  std::optional<uint64_t> bytes_p99;  ///< of a delta; none where several are coded together and no path is walked
};

uint64_t count_ids(const IdSets& sets) {
  uint64_t ids = 0;
  for (const std::vector<uint32_t>& set : sets) ids += set.size();
  return ids;
}

/// Of one of several repetitions, the fastest: others may use the machine.
double fastest(const std::function<Status()>& work, Status& status) {
  constexpr double kEnough = 0.2, kMostRepetitions = 50;
  double least = 1e30, total = 0;
  for (int i = 0; status.ok() && i < kMostRepetitions && total < kEnough; ++i) {
    const WallClock clock;
    status = work();
    const double seconds = clock.seconds();
    least = std::min(least, seconds), total += seconds;
  }
  return std::max(least, 1e-9);
}

Result<CodecRow> measure_codec(const IdSetCodec& codec, const IdSets& deltas, uint32_t nodes) {
  CodecRow row{std::string(codec.name), std::string(codec.what), 0, count_ids(deltas), 0, 0, false, {}};
  std::vector<std::vector<std::byte>> coded(deltas.size());
  size_t longest = 0;
  const WallClock clock;
  for (size_t i = 0; i < deltas.size(); ++i) codec.encode(deltas[i], nodes, coded[i]);
  row.encode_s = std::max(clock.seconds(), 1e-9);
  std::vector<uint64_t> sizes;
  sizes.reserve(deltas.size());
  for (size_t i = 0; i < deltas.size(); ++i) {
    row.bytes += coded[i].size(), longest = std::max(longest, deltas[i].size());
    sizes.push_back(coded[i].size());
  }
  row.bytes_p99 = size_figures(std::move(sizes)).p99;
  std::vector<uint32_t> into(longest);
  Status status = Done{};
  row.decode_s = fastest(
      [&]() -> Status {
        for (size_t i = 0; i < coded.size(); ++i)
          if (const Result<size_t> count = codec.decode(coded[i], nodes, into); !count || *count != deltas[i].size())
            return Error{fmt::format("{}: delta {} does not come back", codec.name, i)};
        return Done{};
      },
      status);
  if (!status) return status.error();
  return row;
}

/// Groups of sets, coded and decoded together.
template <class Encode, class Decode>
Result<CodecRow> measure_groups(CodecRow row, size_t groups, const Encode& encode, const Decode& decode) {
  std::vector<std::vector<std::byte>> coded(groups);
  const WallClock clock;
  for (size_t i = 0; i < groups; ++i) coded[i] = encode(i);
  row.encode_s = std::max(clock.seconds(), 1e-9);
  for (const std::vector<std::byte>& bytes : coded) row.bytes += bytes.size();
  Status status = Done{};
  row.decode_s = fastest(
      [&]() -> Status {
        for (size_t i = 0; i < groups; ++i) PROMENADE_TRY(decode(i, coded[i]));
        return Done{};
      },
      status);
  if (!status) return status.error();
  return row;
}

Result<CodecRow> measure_frames(const IdSets& deltas, uint32_t nodes) {
  const size_t groups = (deltas.size() + kFrameSets - 1) / kFrameSets;
  const auto group = [&](size_t i) {
    return std::span(deltas).subspan(i * kFrameSets, std::min(kFrameSets, deltas.size() - i * kFrameSets));
  };
  std::vector<uint32_t> ids(count_ids(deltas) + 1), ends(kFrameSets);
  return measure_groups(
      {"zstd-frames",
       fmt::format("zstd level 19 over varint, {} deltas a frame", kFrameSets),
       0,
       count_ids(deltas),
       0,
       0,
       false,
       {}},
      groups, [&](size_t i) { return encode_zstd_frame(group(i)); },
      [&](size_t i, std::span<const std::byte> bytes) {
        return decode_zstd_frame(bytes, nodes, ids, std::span(ends).first(group(i).size()));
      });
}

/// As the model stores them: every vLOD, so that every delta is known.
Result<CodecRow> measure_blocks(const ModelReader& reader, const IdSets& vlods) {
  const Result<NodeForest> forest = node_forest(reader.model().tables);
  if (!forest) return forest.error();
  const std::vector<uint32_t> ranks = rank_of_node(*forest);
  std::vector<IdSetBlock> blocks;
  size_t cell = 0, most_ids = 0;
  for (const VlodBlock& stored : reader.cells()->blocks()) {
    IdSetBlock& block = blocks.emplace_back();
    for (const size_t end = cell + stored.cells; cell < end; ++cell) {
      const size_t begin = block.ids.size();
      for (const uint32_t id : vlods[cell]) block.ids.push_back(ranks[id]);
      std::sort(block.ids.begin() + static_cast<std::ptrdiff_t>(begin), block.ids.end());
      block.ends.push_back(static_cast<uint32_t>(block.ids.size()));
    }
    most_ids = std::max(most_ids, block.ids.size());
  }
  std::vector<uint32_t> ids(most_ids), ends(kMaxSetsInBlock);
  CodecRow row{"blocks", "vLODs of neighbouring cells together, along the tree", 0, count_ids(vlods), 0, 0, true, {}};
  return measure_groups(
      row, blocks.size(), [&](size_t i) { return encode_block(forest->by_rank, blocks[i]); },
      [&](size_t i, std::span<const std::byte> bytes) {
        return decode_block(forest->by_rank, bytes, std::span(ids).first(blocks[i].ids.size()),
                            std::span(ends).first(blocks[i].ends.size()));
      });
}

/// What the path reads of the blocks, by a viewer that has read none yet and keeps the last ones.
Status count_along_path(const std::filesystem::path& model, const std::vector<uint32_t>& walk, CodecRow& blocks) {
  const Result<ModelReader> fresh = ModelReader::open(model);
  if (!fresh) return fresh.error();
  std::vector<uint64_t> sizes;
  sizes.reserve(walk.size());
  blocks.bytes = 0;
  for (size_t i = 0; i < walk.size(); ++i) {
    const Result<Vlod> vlod = fresh->cells()->read_vlod(CellId{walk[i]});
    if (!vlod) return vlod.error();
    blocks.bytes += vlod->bytes_read;
    if (i > 0) sizes.push_back(vlod->bytes_read);
  }
  blocks.bytes_p99 = size_figures(std::move(sizes)).p99;
  return Done{};
}

/// Across every face once, or as the path takes the steps.
IdSets deltas_to_study(const StudySets& sets) {
  if (sets.walk.empty()) return sets.deltas;
  IdSets deltas;
  deltas.reserve(sets.walk.size());
  for (size_t i = 1; i < sets.walk.size(); ++i)
    deltas.push_back(symmetric_difference(sets.vlods[sets.walk[i - 1]], sets.vlods[sets.walk[i]]));
  return deltas;
}

Result<std::vector<CodecRow>> measure_all(const StudyArguments& arguments, const StudyInput& input,
                                          const IdSets& deltas, JobMonitor& monitor) {
  const auto nodes = static_cast<uint32_t>(input.reader.model().tables.nodes.size());
  std::vector<CodecRow> rows;
  for (const IdSetCodec& codec : id_set_codecs()) {
    if (monitor.cancelled()) return Error{"interrupted"};
    Result<CodecRow> row = measure_codec(codec, deltas, nodes);
    if (!row) return row.error();
    rows.push_back(std::move(*row));
    monitor.progress("codecs", rows.size(), id_set_codecs().size() + 2);
  }
  for (Result<CodecRow> row : {measure_frames(deltas, nodes), measure_blocks(input.reader, input.sets.vlods)}) {
    if (!row) return row.error();
    rows.push_back(std::move(*row));
  }
  if (!input.sets.walk.empty()) PROMENADE_TRY(count_along_path(arguments.model, input.sets.walk, rows.back()));
  return rows;
}

/// Per cent of steps by the size of their delta, in parts of the vLOD's, the last part: all from the whole on
/// ([chhugani2003] figure 10). A face counts by both of its cells.
std::vector<double> frequencies(const ModelReader& reader, const StudySets& sets, size_t parts) {
  std::vector<double> bins(parts + 1);
  const auto count = [&](size_t delta, uint32_t cell, double weight) {
    const double share = double(delta) / std::max<double>(1, double(sets.vlods[cell].size()));
    bins[std::min(parts, static_cast<size_t>(share * double(parts)))] += 100 * weight;
  };
  const std::vector<CellFace>& faces = reader.cells()->tables().faces;
  for (size_t i = 0; sets.walk.empty() && i < faces.size(); ++i)
    for (const CellId cell : {faces[i].below, faces[i].above})
      count(sets.deltas[i].size(), index_of(cell), 0.5 / double(faces.size()));
  const IdSets along = sets.walk.empty() ? IdSets() : deltas_to_study(sets);
  for (size_t i = 0; i < along.size(); ++i) count(along[i].size(), sets.walk[i + 1], 1 / double(along.size()));
  return bins;
}

void put_figures(const StudyInput& input, const IdSets& deltas, const std::vector<CodecRow>& rows, Json& figures) {
  const auto sizes_of = [](const IdSets& sets) {
    std::vector<uint64_t> sizes;
    sizes.reserve(sets.size());
    for (const std::vector<uint32_t>& set : sets) sizes.push_back(set.size());
    return size_figures(std::move(sizes));
  };
  const double count = std::max<double>(1, double(deltas.size()));
  const SizeFigures ids = sizes_of(deltas);
  constexpr size_t kTenths = 10;
  figures["cells"] = input.sets.vlods.size();
  figures["deltas"] = deltas.size();
  figures["delta_ids_mean"] = ids.mean;
  figures["delta_ids_p99"] = ids.p99;
  figures["vlod_nodes_mean"] = sizes_of(input.sets.vlods).mean;
  figures["delta_to_vlod_percent_by_tenth"] = frequencies(input.reader, input.sets, kTenths);
  Json list = Json::array();
  for (const CodecRow& row : rows)
    list.push_back({{"name", row.name},
                    {"what", row.what},
                    {"bytes_per_delta_mean", double(row.bytes) / count},
                    {"bytes_per_delta_p99", row.bytes_p99 ? Json(*row.bytes_p99) : Json()},
                    {"bytes_total", row.bytes},
                    {"ids_total", row.ids},
                    {"encode_ids_per_s", double(row.ids) / row.encode_s},
                    {"decode_ids_per_s", double(row.ids) / row.decode_s},
                    {"default", row.is_default}});
  figures["codecs"] = list;
}

constexpr std::string_view kNote =
    "blocks hold all vLODs, so their bytes serve every delta; their speed counts the ids of vLODs, that of the others "
    "the ids of deltas. On a path their bytes are what a viewer reads, the first cell's included";

std::string headline(const Json& figures) {
  return fmt::format("{} cells, {} deltas: {:.1f} ids on average, 99 of 100 have at most {}; a vLOD has {:.1f} nodes",
                     uint64_t(figures["cells"]), uint64_t(figures["deltas"]), double(figures["delta_ids_mean"]),
                     uint64_t(figures["delta_ids_p99"]), double(figures["vlod_nodes_mean"]));
}

/// A row a codec, the head first.
std::vector<std::vector<std::string>> table_of(const std::vector<CodecRow>& rows, double deltas) {
  std::vector<std::vector<std::string>> table = {
      {"codec", "bytes", "bytes a delta", "99 of 100", "encode M ids/s", "decode M ids/s"}};
  for (const CodecRow& row : rows)
    table.push_back({row.name + (row.is_default ? " (default)" : ""), fmt::format("{}", row.bytes),
                     fmt::format("{:.2f}", double(row.bytes) / std::max(1.0, deltas)),
                     row.bytes_p99 ? fmt::format("{}", *row.bytes_p99) : "-",
                     fmt::format("{:.1f}", double(row.ids) / row.encode_s / 1e6),
                     fmt::format("{:.1f}", double(row.ids) / row.decode_s / 1e6)});
  return table;
}

void print_results(const std::vector<std::vector<std::string>>& table, const Json& figures) {
  fmt::print("{}\na delta's size in tenths of a vLOD's, per cent of steps:", headline(figures));
  for (const double percent : figures["delta_to_vlod_percent_by_tenth"]) fmt::print(" {:.1f}", percent);
  fmt::print("\n\n");
  for (const std::vector<std::string>& row : table) {
    fmt::print("{:18}", row[0]);
    for (size_t i = 1; i < row.size(); ++i) fmt::print(" {:>14}", row[i]);
    fmt::print("\n");
  }
  fmt::print("\n{}\n", kNote);
}

std::string page_of(const StudyArguments& arguments, const StudyInput& input, const std::vector<CodecRow>& rows,
                    const std::vector<std::vector<std::string>>& table, const Json& figures) {
  constexpr size_t kPercents = 100;
  std::vector<PlotBar> bytes, speed;
  for (const CodecRow& row : rows) {
    bytes.push_back({row.name, double(row.bytes) / std::max<double>(1, double(figures["deltas"]))});
    speed.push_back({row.name, double(row.ids) / row.decode_s / 1e6});
  }
  const PlotOptions frequency = {.title = "Steps by the size of their delta (figure 10 of Chhugani 2003)",
                                 .y_label = "% of steps",
                                 .x_label = "delta, % of the vLOD's nodes (100: as many or more)",
                                 .lines = {}};
  std::string body = fmt::format("<p>{}</p>\n", escaped(headline(figures))) + html_table(table, true);
  body += fmt::format("<p>{}.</p>\n", escaped(std::string(kNote)));
  body += line_plot({{"steps", frequencies(input.reader, input.sets, kPercents)}}, frequency);
  body += bar_plot(bytes, "Size", "bytes a delta") + bar_plot(speed, "Decoding", "million ids a second");
  const std::string steps = arguments.path_file.empty() ? "across every face once" : arguments.path_file.string();
  return html_page("How to store what changes between the cells of " + arguments.model.string(), escaped(steps), body);
}

Status run(const StudyArguments& arguments, JobMonitor& monitor, Json& figures) {
  const Result<StudyInput> input = open_study(arguments, monitor);
  if (!input) return input.error();
  const IdSets deltas = deltas_to_study(input->sets);
  const Result<std::vector<CodecRow>> rows = measure_all(arguments, *input, deltas, monitor);
  if (!rows) return rows.error();
  put_figures(*input, deltas, *rows, figures);
  const std::vector<std::vector<std::string>> table = table_of(*rows, double(deltas.size()));
  print_results(table, figures);
  if (arguments.report_file.empty()) return Done{};
  return write_file(arguments.report_file, std::string_view(page_of(arguments, *input, *rows, table, figures)));
}

}  // namespace

Command add_study_codecs(CLI::App& study) {
  CLI::App* app = study.add_subcommand("codecs", "Bytes and speed of every way to store what changes between cells");
  auto arguments = std::make_shared<StudyArguments>();
  add_study_arguments(*app, *arguments);
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run(*arguments, monitor, figures); }};
}

}  // namespace promenade
