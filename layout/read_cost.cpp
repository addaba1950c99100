#include "layout/read_cost.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace promenade {
namespace {

constexpr std::array<StorageProfile, 3> kProfiles = {{
    // Half a turn and a mean seek of 8.5 ms; outer tracks.
    {"disk", 0.0127, 160e6, 4096},
    {"ssd", 0.0001, 500e6, 4096},
    // First byte of a ranged GET; one connection.
    {"network", 0.030, 80e6, 1},
}};

uint64_t aligned_down(uint64_t offset, uint64_t block) { return offset / block * block; }
uint64_t aligned_up(uint64_t offset, uint64_t block) { return (offset + block - 1) / block * block; }

}  // namespace

std::span<const StorageProfile> storage_profiles() { return kProfiles; }

const StorageProfile* find_storage_profile(std::string_view name) {
  const auto* found =
      std::find_if(kProfiles.begin(), kProfiles.end(), [name](const StorageProfile& p) { return p.name == name; });
  return found == kProfiles.end() ? nullptr : found;
}

void ReadPlan::add(const ReadPlan& other) {
  reads += other.reads, bytes += other.bytes, useful_bytes += other.useful_bytes;
  seconds += other.seconds;
}

std::vector<Extent> merge_reads(std::span<const Extent> extents, const StorageProfile& profile, double least_useful) {
  std::vector<Extent> blocks;
  blocks.reserve(extents.size());
  uint64_t wanted = 0, read = 0;
  for (const Extent& extent : extents) {
    if (extent.bytes == 0) continue;
    wanted += extent.bytes;
    const uint64_t from = aligned_down(extent.offset, profile.block_bytes);
    const uint64_t to = aligned_up(extent.offset + extent.bytes, profile.block_bytes);
    if (blocks.empty() || from > blocks.back().end())
      blocks.push_back({from, to - from});
    else
      blocks.back().bytes = std::max(to, blocks.back().end()) - blocks.back().offset;
  }
  for (const Extent& block : blocks) read += block.bytes;
  // Gaps by length, then by place; the place is that of the block behind.
  std::vector<std::pair<uint64_t, size_t>> gaps;
  gaps.reserve(blocks.size());
  const auto worth = static_cast<uint64_t>(profile.seek_s * profile.bytes_per_s);  // bytes that a seek could have read
  for (size_t i = 1; i < blocks.size(); ++i)
    if (const uint64_t gap = blocks[i].offset - blocks[i - 1].end(); gap <= worth) gaps.emplace_back(gap, i);
  std::sort(gaps.begin(), gaps.end());
  std::vector<uint8_t> joined(blocks.size());
  for (const auto& [gap, place] : gaps) {
    if (static_cast<double>(wanted) < least_useful * static_cast<double>(read + gap)) break;
    read += gap;
    joined[place] = 1;
  }
  std::vector<Extent> reads;
  for (size_t i = 0; i < blocks.size(); ++i) {
    if (joined[i] == 0)
      reads.push_back(blocks[i]);
    else
      reads.back().bytes = blocks[i].end() - reads.back().offset;
  }
  return reads;
}

ReadPlan plan_reads(std::span<const Extent> extents, const StorageProfile& profile, double least_useful) {
  ReadPlan plan;
  for (const Extent& extent : extents) plan.useful_bytes += extent.bytes;
  for (const Extent& read : merge_reads(extents, profile, least_useful)) ++plan.reads, plan.bytes += read.bytes;
  plan.seconds =
      static_cast<double>(plan.reads) * profile.seek_s + static_cast<double>(plan.bytes) / profile.bytes_per_s;
  return plan;
}

NodeLayout::NodeLayout(std::span<const uint32_t> node_bytes) {
  ends_.reserve(node_bytes.size() + 1);
  for (const uint32_t bytes : node_bytes) ends_.push_back(ends_.back() + bytes);
}

std::vector<Extent> NodeLayout::extents(std::span<const uint32_t> places) const {
  std::vector<Extent> extents;
  for (const uint32_t place : places) {
    if (!extents.empty() && extents.back().end() == ends_[place])
      extents.back().bytes += bytes_of(place);
    else
      extents.push_back({ends_[place], bytes_of(place)});
  }
  return extents;
}

ReadPlan NodeLayout::plan(std::span<const uint32_t> places, const StorageProfile& profile, double least_useful) const {
  return plan_reads(extents(places), profile, least_useful);
}

NodeLayout::Places NodeLayout::whole_in(const Extent& read) const {
  const auto first = std::lower_bound(ends_.begin(), ends_.end(), read.offset);
  const auto last = std::upper_bound(first, ends_.end(), read.end());
  const auto from = static_cast<uint32_t>(first - ends_.begin()), to = static_cast<uint32_t>(last - ends_.begin());
  return {from, std::max(from, std::max(to, 1U) - 1)};
}

std::vector<uint8_t> choose_copies(std::span<const ReadPlan> cost, std::span<const ReadPlan> copied,
                                   uint64_t more_bytes) {
  std::vector<uint32_t> order(cost.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto worth = [&](uint32_t i) {
    const double saved = cost[i].seconds - copied[i].seconds;
    return saved / std::max(1.0, static_cast<double>(copied[i].bytes));
  };
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return worth(a) > worth(b); });
  std::vector<uint8_t> chosen(cost.size());
  for (const uint32_t i : order) {
    if (worth(i) <= 0) break;
    if (copied[i].bytes > more_bytes) continue;
    more_bytes -= copied[i].bytes;
    chosen[i] = 1;
  }
  return chosen;
}

}  // namespace promenade
