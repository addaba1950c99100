#pragma once
// The finest front that fits into memory. [lakhia2004] section 4.3 fills memory from the top of the priority list, and
// [funkhouser1993] caps what is read ahead at the levels that can be asked for: both go on asking for what will not
// come where what is wanted is larger than memory, and show ancestors here and there instead. Here the bound in pixels
// is what gives way, everywhere alike: it is made coarser by the one factor at which all that is wanted, and all that
// is foreseen, fits.

#include <array>
#include <cstdint>
#include <vector>

#include "layout/model.h"

namespace promenade {

/// What nodes take in memory, and how much of it there is for them.
struct MemoryBudget {
  uint64_t bytes = 0;
  std::vector<uint32_t> node_bytes;     ///< by node, shared pictures aside
  std::vector<uint32_t> texture_bytes;  ///< by texture
  uint64_t byte_size() const { return (node_bytes.capacity() + texture_bytes.capacity()) * sizeof(uint32_t); }
};

/// Who asks for a node.
enum class AskedBy : uint8_t {
  view,  ///< what is to be drawn now, and what must be there for that
  cell,  ///< what the eye's cell (or, outside the cells, the tree) shows after a turn of the head, or a little later
  elsewhere,  ///< only other cells
};

/// A node that is wanted now or may be soon.
struct AheadNode {
  NodeId node = kNoNode;
  float until = 0;  ///< it is asked for as long as the bound is coarser by less than this factor; > 1
  AskedBy by = AskedBy::view;
};

/// How much of memory is asked for, by the factor on the bound.
class BytesByFactor {
 public:
  /// until: as AheadNode's.
  void add(double until, uint64_t bytes) { bytes_[bin_of(until)] += bytes; }
  void operator+=(const BytesByFactor& other) {
    for (size_t i = 0; i < kBins; ++i) bytes_[i] += other.bytes_[i];
  }
  /// Bytes still asked for at this factor, or the next smaller one that is told apart.
  uint64_t at(double factor) const;
  /// The least factor, no less than `least`, at which no more than this is asked for; kCoarsest where none is.
  double fitting(uint64_t bytes, double least = 1) const;
  static constexpr double kCoarsest = 4096;

 private:
  static constexpr int kBinsAnOctave = 16;
  static constexpr size_t kBins = 12 * kBinsAnOctave + 1;
  static size_t bin_of(double factor);
  std::array<uint64_t, kBins> bytes_{};
};

/// How much of memory each of them asks for.
struct BytesAsked {
  BytesByFactor view, cell, elsewhere;
};

/// Factors on the bound in pixels, from frame to frame. A factor grows at once, since what does not fit does not come,
/// and falls slowly, so that what it asks for can be read meanwhile. What is drawn gives way to what is foreseen in the
/// same cell by half at most; what is foreseen takes what is left.
struct MemoryFit {
  double asked = 1;      ///< for what the view asks for
  double cell = 1;       ///< for what else the eye's cell does; >= asked
  double elsewhere = 1;  ///< for what only other cells ask for; >= cell
  double drawn = 1;      ///< for what is drawn: follows `asked`, some frames later where that falls

  double of(AskedBy by) const { return by == AskedBy::view ? asked : by == AskedBy::cell ? cell : elsewhere; }
  /// crossed: the eye's cell is another than in the frame before: what was elsewhere is here. jumped: nothing of the
  /// frame before holds.
  void follow(const BytesAsked& bytes, uint64_t budget_bytes, bool crossed, bool jumped);
};

/// What these nodes take; a picture that several need counts once, for the longest. of_textures: scratch.
BytesAsked bytes_asked(const Model& model, const MemoryBudget& budget, const std::vector<AheadNode>& nodes,
                       std::vector<AheadNode>& of_textures);

}  // namespace promenade
