#include "runtime/vlod_store.h"

#include <algorithm>

namespace promenade {
namespace {

constexpr uint64_t kMostSets = 32;  // a cell, its neighbours, and where the eye came from
constexpr uint64_t kComfortableBytes = 4 << 20;
constexpr size_t kMostFailures = 8;
/// What reading one takes at most, in sets: its difference, its base and the result, and growing vectors.
constexpr uint64_t kReadingSets = 6;

}  // namespace

VlodStore::VlodStore(const ModelSource& source) : source_(source) {
  uint64_t largest = 0;
  const CellTables* tables = source.cells();
  for (uint32_t i = 0; tables != nullptr && i < tables->cells.size(); ++i)
    largest = std::max(largest, bytes_of(CellId{i}));
  capacity_bytes_ = std::max(2 * largest, std::min(kMostSets * largest, kComfortableBytes));
  bound_bytes_ = capacity_bytes_ + kReadingSets * largest;
}

void VlodStore::want(std::span<const CellId> cells) {
  const std::lock_guard lock(mutex_);
  wanted_.assign(cells.begin(), cells.end());
}

std::shared_ptr<const Vlod> VlodStore::find(CellId cell) const {
  const std::lock_guard lock(mutex_);
  const auto found = loaded_.find(cell);
  return found == loaded_.end() ? nullptr : found->second;
}

/// Drops what nobody wants, then what is wanted less than the cell at that place of the list.
bool VlodStore::make_room(uint64_t bytes, size_t importance) {
  const auto place = [this](CellId cell) {
    return static_cast<size_t>(std::find(wanted_.begin(), wanted_.end(), cell) - wanted_.begin());
  };
  while (used_bytes_ + bytes > capacity_bytes_) {
    auto worst = loaded_.end();
    size_t worst_place = importance;
    for (auto it = loaded_.begin(); it != loaded_.end(); ++it)
      if (it->second != nullptr && place(it->first) > worst_place) worst = it, worst_place = place(it->first);
    if (worst == loaded_.end()) return false;
    used_bytes_ -= bytes_of(worst->first);
    loaded_.erase(worst);
  }
  return true;
}

VlodStore::Step VlodStore::load_next() {
  CellId cell = kNoCell;
  {
    const std::lock_guard lock(mutex_);
    for (size_t i = 0; i < wanted_.size() && cell == kNoCell; ++i) {
      if (loaded_.contains(wanted_[i])) continue;
      if (!make_room(bytes_of(wanted_[i]), i)) return {};
      cell = wanted_[i];
    }
    if (cell == kNoCell) return {};
    used_bytes_ += bytes_of(cell);
  }
  Result<Vlod> vlod = source_.read_vlod(cell);
  const std::lock_guard lock(mutex_);
  if (!vlod) {
    used_bytes_ -= bytes_of(cell);
    loaded_.emplace(cell, nullptr);
    if (failures_.size() < kMostFailures) failures_.push_back(vlod.error().message);
    return {true, 0};
  }
  const uint64_t bytes = vlod->bytes_read;
  ++loaded_count_;
  bytes_read_ += bytes;
  loaded_.emplace(cell, std::make_shared<const Vlod>(std::move(*vlod)));
  return {true, bytes};
}

uint64_t VlodStore::loaded() const {
  const std::lock_guard lock(mutex_);
  return loaded_count_;
}

uint64_t VlodStore::bytes_read() const {
  const std::lock_guard lock(mutex_);
  return bytes_read_;
}

std::vector<std::string> VlodStore::failures() const {
  const std::lock_guard lock(mutex_);
  return failures_;
}

}  // namespace promenade
