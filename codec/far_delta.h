#pragma once
// Colours of a far picture's side as their difference from what was foretold, block by block. Not for others than
// far_face.cpp.

#include <array>
#include <cstdint>
#include <vector>

#include "codec/far_coding.h"
#include "geometry/mesh.h"

namespace promenade::far_coding {

/// Blocks have so many pixels a side, as JPEG's with halved chroma: none of its blocks lies in two of ours.
constexpr uint32_t kBlockPx = 16;
/// How far what was foretold may be taken from aside, pixels.
constexpr int32_t kMostShiftPx = 12;

/// What a block's colours are told against.
struct Block {
  bool foretold = true;          ///< false: against one colour
  int32_t dx = 0, dy = 0;        ///< where the foretold is taken from, less where it is put
  std::array<uint8_t, 3> color;  ///< the one colour, in steps of 4
  Block() : color{0, 0, 0} {}
};

inline uint32_t blocks_across(uint32_t side) { return (side + kBlockPx - 1) / kBlockPx; }

/// The cheapest way for each block, row by row. colors: to be told; opacity 0: of no matter.
std::vector<Block> choose_blocks(const Image& colors, const Image& foretold, bool shifts);

/// What differences are taken from. blocks: as many as the picture has.
Image base_of(const std::vector<Block>& blocks, const Image& foretold);

/// Blocks that show nothing, even to filters, in the colour of the one before: coders find nothing in them to tell.
/// there: opacities.
void flatten_empty_blocks(const Image& there, Image& colors);

/// Differences plus 128, where something is, and what is near it; 128 elsewhere.
Image differences(const Image& colors, const Image& base);
/// Their sum. Opacities are the differences'.
void add_differences(const Image& differences, Image& base);

struct BlockModels {
  std::array<BitModel, 4> foretold;
  Models numbers;
};

template <class Coder>
void code_blocks(Coder& code, uint32_t across, std::vector<Block>& blocks) {
  // One set of contexts for each kind of number: shifts along the axes and shares of the colours.
  enum : size_t { shift_x, shift_y, red, green, blue };
  BlockModels models;
  Block last;
  for (size_t i = 0; i < blocks.size(); ++i) {
    Block& b = blocks[i];
    const uint32_t left = i % across > 0 && blocks[i - 1].foretold ? 1U : 0U;
    const uint32_t above = i >= across && blocks[i - across].foretold ? 1U : 0U;
    b.foretold = code(models.foretold[left | above << 1], b.foretold ? 1U : 0U) != 0;
    const auto near = [&](size_t kind, int32_t guess, int32_t value) {
      return guess + code_difference(code, models.numbers, kind, value - guess);
    };
    if (b.foretold) {
      b.dx = std::clamp(near(shift_x, last.dx, b.dx), -kMostShiftPx, kMostShiftPx);
      b.dy = std::clamp(near(shift_y, last.dy, b.dy), -kMostShiftPx, kMostShiftPx);
      last.dx = b.dx, last.dy = b.dy;
    } else {
      for (size_t c = 0; c < 3; ++c)
        last.color[c] = b.color[c] = static_cast<uint8_t>(std::clamp(near(red + c, last.color[c], b.color[c]), 0, 63));
    }
  }
}

}  // namespace promenade::far_coding
