#pragma once
// Adaptive Huffman coding of a small alphabet: encoder and decoder keep the same tree and change it after each symbol.
// Source: D. E. Knuth, Dynamic Huffman coding, Journal of Algorithms 6, 1985 (the algorithm of Faller and Gallager).

#include <array>
#include <cstdint>

#include "codec/bit_io.h"

namespace promenade {

/// Symbols 0 to kSymbols - 1, all of weight one at first.
class AdaptiveHuffman {
 public:
  static constexpr uint32_t kSymbols = 34;
  AdaptiveHuffman();
  /// symbol: below kSymbols.
  void put(BitWriter& writer, uint32_t symbol);
  uint32_t get(BitReader& reader);

 private:
  static constexpr uint32_t kNodes = 2 * kSymbols - 1, kRoot = 0;
  /// Nodes stand in order of falling weight, siblings beside each other (Gallager's sibling property): place 0 is the
  /// root, places 2 i + 1 and 2 i + 2 are the children of one node.
  struct Place {
    uint32_t weight = 0;
    uint32_t children = 0;  ///< the first of two places; 0: a leaf
    uint32_t symbol = 0;
    uint32_t parent = 0;
  };
  void exchange(uint32_t a, uint32_t b);
  void count(uint32_t symbol);

  std::array<Place, kNodes> places_;
  std::array<uint32_t, kSymbols> place_of_;
};

}  // namespace promenade
