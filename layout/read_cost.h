#pragma once
// What a step costs to read: which runs of bytes, in how many reads, for how long, on which kind of storage. Source:
// [chhugani2003] section 3.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace promenade {

/// A kind of storage.
struct StorageProfile {
  std::string_view name;
  double seek_s = 0;            ///< before each read: head movement, request, round trip
  double bytes_per_s = 0;       ///< while a read goes on, > 0
  uint32_t block_bytes = 4096;  ///< reads begin and end at multiples of it, >= 1
};

/// "disk" (7,200 turns a minute), "ssd" (SATA), "network" (an object store in the same data centre).
std::span<const StorageProfile> storage_profiles();
const StorageProfile* find_storage_profile(std::string_view name);  ///< null: there is none

/// Bytes that are wanted.
struct Extent {
  uint64_t offset = 0, bytes = 0;
  uint64_t end() const { return offset + bytes; }
};

struct ReadPlan {
  uint64_t reads = 0, bytes = 0, useful_bytes = 0;
  double seconds = 0;
  void add(const ReadPlan& other);
};

/// Aligned reads that cover all extents, by offset. Two become one when reading what lies between takes no longer than
/// a seek, the nearest two first, and as long as at least this share of what is read is wanted; reads in one block
/// always do. least_useful: 0 to 1; 0: as fast as can be. extents: by offset, without overlap. Pure.
std::vector<Extent> merge_reads(std::span<const Extent> extents, const StorageProfile& profile,
                                double least_useful = 0);

/// What these reads are, and take.
ReadPlan plan_reads(std::span<const Extent> extents, const StorageProfile& profile, double least_useful = 0);

/// A step's nodes on a disk whose nodes lie one behind the other: node_bytes by place in the order. places: ascending.
class NodeLayout {
 public:
  explicit NodeLayout(std::span<const uint32_t> node_bytes);
  uint32_t nodes() const { return static_cast<uint32_t>(ends_.size() - 1); }
  uint64_t bytes() const { return ends_.back(); }
  uint64_t bytes_of(uint32_t place) const { return ends_[place + 1] - ends_[place]; }
  std::vector<Extent> extents(std::span<const uint32_t> places) const;
  ReadPlan plan(std::span<const uint32_t> places, const StorageProfile& profile, double least_useful = 0) const;
  /// The places whose nodes a read brings whole: from first to before last.
  struct Places {
    uint32_t first = 0, last = 0;
  };
  Places whole_in(const Extent& read) const;

 private:
  std::vector<uint64_t> ends_ = {0};  ///< by place: where the nodes before it end
};

/// Which steps get a copy of their own, in one piece: those that save most time a byte, until the copies take
/// more_bytes. cost: by step, as it is; copied: as it would be, with a copy. Ties by number. Returns by step: 1,
/// copied.
std::vector<uint8_t> choose_copies(std::span<const ReadPlan> cost, std::span<const ReadPlan> copied,
                                   uint64_t more_bytes);

}  // namespace promenade
