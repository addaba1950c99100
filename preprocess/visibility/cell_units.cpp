#include "preprocess/visibility/cell_units.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>

#include "codec/frame.h"
#include "codec/id_set.h"
#include "preprocess/survey.h"
#include "preprocess/unit_io.h"

namespace promenade {

namespace {

constexpr size_t kUnitCells = 32;  // some tenths of a second of work, so that little is lost and little is published

CodedVlod coded(const CellVlod& vlod) {
  std::vector<uint32_t> ids;
  ids.reserve(vlod.nodes.size());
  for (const NodeId id : vlod.nodes) ids.push_back(index_of(id));
  return {encode_ids(ids), static_cast<uint32_t>(ids.size()), vlod.triangles, vlod.front_nodes, vlod.front_triangles};
}

std::vector<std::byte> payload_of(std::span<const CodedVlod> vlods) {
  UnitWriter writer;
  for (const CodedVlod& v : vlods) {
    writer.array(v.ids), writer.value(v.nodes), writer.value(v.triangles);
    writer.value(v.front_nodes), writer.value(v.front_triangles);
  }
  return std::move(writer.bytes());
}

bool read_payload(std::span<const std::byte> payload, std::span<CodedVlod> vlods) {
  UnitReader reader(payload);
  for (CodedVlod& v : vlods) {
    v.ids = reader.array<std::byte>(), v.nodes = reader.value<uint32_t>(), v.triangles = reader.value<uint64_t>();
    v.front_nodes = reader.value<uint32_t>(), v.front_triangles = reader.value<uint64_t>();
  }
  return reader.ok() && reader.left() == 0;
}

uint64_t hash_of(std::span<const Box> cells, uint64_t hash) { return checksum(std::as_bytes(cells), hash); }

/// One call of run(): what its threads share.
class Batch {
 public:
  Batch(const Model& model, HiderChain hiders, const FrontBound& bound, uint64_t hash, const WorkFolder& folder,
        JobMonitor& monitor, const std::vector<Box>& cells, uint64_t asked_before)
      : vlods(cells.size()),
        model_(model),
        hiders_(hiders),
        bound_(bound),
        hash_(hash),
        folder_(folder),
        monitor_(monitor),
        cells_(cells),
        asked_(asked_before + cells.size()),
        done_(asked_before) {}

  void work(const std::string& name, size_t first, size_t count) {
    const auto out = std::span(vlods).subspan(first, count);
    const auto boxes = std::span(cells_).subspan(first, count);
    const uint64_t hash = hash_of(boxes, hash_);
    if (const auto payload = folder_.load(name, hash); payload && read_payload(*payload, out)) {
      ++resumed;
      return progress(count);
    }
    const auto begin = std::chrono::steady_clock::now();
    for (size_t i = 0; i < count; ++i) {
      if (stopped()) return;
      const Result<CellVlod> vlod = cell_vlod(model_, hiders_, boxes[i], bound_);
      if (!vlod.ok()) return fail(vlod.error());
      out[i] = coded(*vlod);
      progress(1);
    }
    const auto taken = std::chrono::steady_clock::now() - begin;
    busy_us += static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(taken).count());
    computed += count;
    if (const Status status = folder_.store(name, hash, payload_of(out)); !status.ok()) fail(status.error());
  }

  bool stopped() const { return failed_ || monitor_.cancelled(); }
  Status status() {
    const std::lock_guard lock(mutex_);
    if (failure_) return *failure_;
    if (monitor_.cancelled()) return Error{kInterrupted};
    return Done{};
  }

  std::vector<CodedVlod> vlods;  ///< each written by the thread that has its unit
  std::atomic<uint64_t> resumed = 0, computed = 0, busy_us = 0;

 private:
  void progress(size_t count) { monitor_.progress("visibility", done_ += count, asked_); }
  void fail(const Error& error) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = error;
    failed_ = true;
  }

  const Model& model_;
  HiderChain hiders_;
  const FrontBound& bound_;
  uint64_t hash_;
  const WorkFolder& folder_;
  JobMonitor& monitor_;
  const std::vector<Box>& cells_;
  uint64_t asked_;              ///< cells, of this batch and those before
  std::atomic<uint64_t> done_;  ///< of these
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::optional<Error> failure_;  ///< guarded by mutex_
};

}  // namespace

Result<std::vector<NodeId>> decoded(const CodedVlod& vlod, uint32_t nodes) {
  const Result<std::vector<uint32_t>> ids = decode_ids(vlod.ids, nodes);
  if (!ids.ok()) return ids.error();
  std::vector<NodeId> result;
  result.reserve(ids->size());
  for (const uint32_t id : *ids) result.push_back(NodeId{id});
  return result;
}

Result<std::vector<CodedVlod>> CellUnits::run(const std::string& name, const std::vector<Box>& cells) {
  Batch batch(model_, hiders_, bound_, hash_, folder_, monitor_, cells, asked_);
  asked_ += cells.size();
  const size_t units = (cells.size() + kUnitCells - 1) / kUnitCells;
  tbb::parallel_for(
      size_t(0), units,
      [&](size_t unit) {
        if (batch.stopped()) return;
        const size_t first = unit * kUnitCells;
        batch.work(fmt::format("cells-{}-{:06}", name, unit), first, std::min(kUnitCells, cells.size() - first));
      },
      tbb::simple_partitioner());
  PROMENADE_TRY(batch.status());
  counts_.total += units;
  counts_.resumed += batch.resumed;
  counts_.cells += batch.computed;
  counts_.busy_ms += double(batch.busy_us) / 1e3;
  return std::move(batch.vlods);
}

}  // namespace promenade
