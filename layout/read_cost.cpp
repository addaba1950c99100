#include "layout/read_cost.h"

#include <algorithm>
#include <array>
#include <numeric>

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

ReadPlan plan_reads(std::span<const Extent> extents, const StorageProfile& profile) {
  ReadPlan plan;
  const auto worth = static_cast<uint64_t>(profile.seek_s * profile.bytes_per_s);  // bytes that a seek could have read
  uint64_t end = 0;
  for (const Extent& extent : extents) {
    if (extent.bytes == 0) continue;
    plan.useful_bytes += extent.bytes;
    const uint64_t from = aligned_down(extent.offset, profile.block_bytes);
    const uint64_t to = aligned_up(extent.offset + extent.bytes, profile.block_bytes);
    if (plan.reads > 0 && from <= end + worth) {
      plan.bytes += to > end ? to - end : 0;
    } else {
      ++plan.reads;
      plan.bytes += to - from;
    }
    end = std::max(end, to);
  }
  plan.seconds =
      static_cast<double>(plan.reads) * profile.seek_s + static_cast<double>(plan.bytes) / profile.bytes_per_s;
  return plan;
}

NodeLayout::NodeLayout(std::span<const uint32_t> node_bytes) {
  for (const uint32_t bytes : node_bytes) ends_.push_back(ends_.back() + bytes);
}

ReadPlan NodeLayout::plan(std::span<const uint32_t> places, const StorageProfile& profile) const {
  std::vector<Extent> extents;
  for (const uint32_t place : places) {
    const uint64_t begin = ends_[place], bytes = ends_[place + 1] - begin;
    if (!extents.empty() && extents.back().offset + extents.back().bytes == begin)
      extents.back().bytes += bytes;
    else
      extents.push_back({begin, bytes});
  }
  return plan_reads(extents, profile);
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
