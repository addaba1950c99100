#include "cli/study_codecs.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>

#include "cli/console.h"
#include "cli/study_sets.h"
#include "codec/id_set_block.h"
#include "codec/id_set_codec.h"
#include "codec/id_set_rivals.h"
#include "layout/model_io.h"

namespace promenade {
namespace {

constexpr size_t kFrameSets = 40;  // deltas in a zstd frame

struct Arguments {
  std::filesystem::path model, export_folder;
};

struct CodecRow {
  std::string name, what;
  uint64_t bytes = 0, ids = 0;  ///< ids: of deltas; of vLODs for blocks
  double encode_s = 0, decode_s = 0;
  bool is_default = false;
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
  CodecRow row{std::string(codec.name), std::string(codec.what), 0, count_ids(deltas), 0, 0, false};
  std::vector<std::vector<std::byte>> coded(deltas.size());
  size_t longest = 0;
  const WallClock clock;
  for (size_t i = 0; i < deltas.size(); ++i) codec.encode(deltas[i], nodes, coded[i]);
  row.encode_s = std::max(clock.seconds(), 1e-9);
  for (size_t i = 0; i < deltas.size(); ++i)
    row.bytes += coded[i].size(), longest = std::max(longest, deltas[i].size());
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
      {"zstd-frames", fmt::format("zstd level 19 over varint, {} deltas a frame", kFrameSets), 0, count_ids(deltas), 0,
       0, false},
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
  CodecRow row{"blocks", "vLODs of neighbouring cells together, along the tree", 0, count_ids(vlods), 0, 0, true};
  return measure_groups(
      row, blocks.size(), [&](size_t i) { return encode_block(forest->by_rank, blocks[i]); },
      [&](size_t i, std::span<const std::byte> bytes) {
        return decode_block(forest->by_rank, bytes, std::span(ids).first(blocks[i].ids.size()),
                            std::span(ends).first(blocks[i].ends.size()));
      });
}

Result<std::vector<CodecRow>> measure_all(const ModelReader& reader, const StudySets& sets, JobMonitor& monitor) {
  const auto nodes = static_cast<uint32_t>(reader.model().tables.nodes.size());
  std::vector<CodecRow> rows;
  for (const IdSetCodec& codec : id_set_codecs()) {
    if (monitor.cancelled()) return Error{"interrupted"};
    Result<CodecRow> row = measure_codec(codec, sets.deltas, nodes);
    if (!row) return row.error();
    rows.push_back(std::move(*row));
    monitor.progress("codecs", rows.size(), id_set_codecs().size() + 2);
  }
  for (Result<CodecRow> row : {measure_frames(sets.deltas, nodes), measure_blocks(reader, sets.vlods)}) {
    if (!row) return row.error();
    rows.push_back(std::move(*row));
  }
  return rows;
}

/// Shares of the sizes of deltas to those of vLODs, by tenths; the last: all from 0.9 on ([chhugani2003] figure 10).
std::vector<double> histogram(const ModelReader& reader, const StudySets& sets) {
  constexpr size_t kBins = 10;
  std::vector<double> bins(kBins);
  const std::vector<CellFace>& faces = reader.cells()->tables().faces;
  for (size_t i = 0; i < faces.size(); ++i)
    for (const CellId cell : {faces[i].below, faces[i].above}) {
      const double size = std::max<double>(1, static_cast<double>(sets.vlods[index_of(cell)].size()));
      const double share = static_cast<double>(sets.deltas[i].size()) / size;
      bins[std::min(kBins - 1, static_cast<size_t>(share * kBins))] += 0.5 / static_cast<double>(faces.size());
    }
  return bins;
}

void put_figures(const ModelReader& reader, const StudySets& sets, const std::vector<CodecRow>& rows, Json& figures) {
  const double deltas = std::max<double>(1, static_cast<double>(sets.deltas.size()));
  std::vector<size_t> sizes;
  for (const std::vector<uint32_t>& delta : sets.deltas) sizes.push_back(delta.size());
  std::sort(sizes.begin(), sizes.end());
  figures["cells"] = sets.vlods.size();
  figures["deltas"] = sets.deltas.size();
  figures["delta_ids_mean"] = static_cast<double>(count_ids(sets.deltas)) / deltas;
  figures["delta_ids_p99"] = sizes.empty() ? 0 : sizes[(sizes.size() - 1) * 99 / 100];
  figures["vlod_nodes_mean"] =
      static_cast<double>(count_ids(sets.vlods)) / std::max<double>(1, static_cast<double>(sets.vlods.size()));
  figures["delta_to_vlod_share_by_tenth"] = histogram(reader, sets);
  Json list = Json::array();
  for (const CodecRow& row : rows)
    list.push_back({{"name", row.name},
                    {"what", row.what},
                    {"bytes_per_delta_mean", static_cast<double>(row.bytes) / deltas},
                    {"bytes_total", row.bytes},
                    {"ids_total", row.ids},
                    {"encode_ids_per_s", static_cast<double>(row.ids) / row.encode_s},
                    {"decode_ids_per_s", static_cast<double>(row.ids) / row.decode_s},
                    {"default", row.is_default}});
  figures["codecs"] = list;
}

void print_table(const std::vector<CodecRow>& rows, const Json& figures) {
  const uint64_t deltas = figures["deltas"];
  fmt::print("{} cells, {} deltas: {:.1f} ids on average, 99 of 100 have at most {}; a vLOD has {:.1f} nodes\n",
             uint64_t(figures["cells"]), deltas, double(figures["delta_ids_mean"]), uint64_t(figures["delta_ids_p99"]),
             double(figures["vlod_nodes_mean"]));
  fmt::print("a delta's size in tenths of a vLOD's, per cent of steps:");
  for (const double share : figures["delta_to_vlod_share_by_tenth"]) fmt::print(" {:.1f}", 100 * share);
  fmt::print("\n\n{:18} {:>12} {:>14} {:>14} {:>14}\n", "codec", "bytes", "bytes a delta", "encode M ids/s",
             "decode M ids/s");
  for (const CodecRow& row : rows)
    fmt::print("{:18} {:>12} {:>14.2f} {:>14.1f} {:>14.1f}{}\n", row.name, row.bytes,
               static_cast<double>(row.bytes) / static_cast<double>(std::max<uint64_t>(1, deltas)),
               static_cast<double>(row.ids) / row.encode_s / 1e6, static_cast<double>(row.ids) / row.decode_s / 1e6,
               row.is_default ? "  (default)" : "");
  fmt::print(
      "\nblocks hold all vLODs, so their bytes serve every delta; their speed counts the ids of vLODs, that of the\n"
      "others the ids of deltas\n");
}

Status run(const Arguments& arguments, JobMonitor& monitor, Json& figures) {
  const Result<ModelReader> reader = ModelReader::open(arguments.model);
  if (!reader) return reader.error();
  const Result<StudySets> sets = read_study_sets(*reader, monitor);
  if (!sets) return sets.error();
  if (!arguments.export_folder.empty()) PROMENADE_TRY(export_study_sets(arguments.export_folder, *reader, *sets));
  const Result<std::vector<CodecRow>> rows = measure_all(*reader, *sets, monitor);
  if (!rows) return rows.error();
  put_figures(*reader, *sets, *rows, figures);
  print_table(*rows, figures);
  return Done{};
}

}  // namespace

Command add_study_codecs(CLI::App& study) {
  CLI::App* app = study.add_subcommand("codecs", "Bytes and speed of every way to store what changes between cells");
  auto arguments = std::make_shared<Arguments>();
  app->add_option("model", arguments->model, "Model with view cells")->required();
  app->add_option("--export", arguments->export_folder,
                  "Folder for vlods.txt, deltas.txt and nodes.txt: the same data as plain text");
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run(*arguments, monitor, figures); }};
}

}  // namespace promenade
