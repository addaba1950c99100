#include "codec/adaptive_huffman.h"

#include <algorithm>
#include <utility>

namespace promenade {

AdaptiveHuffman::AdaptiveHuffman() {
  // A complete tree: the node at place i has its children at 2 i + 1 and 2 i + 2.
  for (uint32_t i = kNodes; i-- > 0;) {
    Place& place = places_[i];
    place.parent = i == kRoot ? kRoot : (i - 1) / 2;
    if (i >= kSymbols - 1) {
      place.weight = 1;
      place.symbol = i - (kSymbols - 1);
      place_of_[place.symbol] = i;
    } else {
      place.children = 2 * i + 1;
      place.weight = places_[place.children].weight + places_[place.children + 1].weight;
    }
  }
  // Leaves of the level that is not full are lighter than nodes behind them: put each level in order.
  for (uint32_t first = 1; first < kNodes; first = 2 * first + 1) {
    const uint32_t last = std::min(2 * first + 1, kNodes);
    for (uint32_t i = first; i < last; ++i)
      for (uint32_t k = i + 1; k < last; ++k)
        if (places_[k].weight > places_[i].weight) exchange(i, k);
  }
}

void AdaptiveHuffman::exchange(uint32_t a, uint32_t b) {
  std::swap(places_[a].weight, places_[b].weight);
  std::swap(places_[a].children, places_[b].children);
  std::swap(places_[a].symbol, places_[b].symbol);
  for (const uint32_t i : {a, b}) {
    const Place& place = places_[i];
    if (place.children == 0)
      place_of_[place.symbol] = i;
    else
      places_[place.children].parent = places_[place.children + 1].parent = i;
  }
}

void AdaptiveHuffman::count(uint32_t symbol) {
  uint32_t at = place_of_[symbol];
  while (at != kRoot) {
    // The first of those that weigh as much takes the increment, so that the order stays.
    uint32_t first = at;
    while (first > 1 && places_[first - 1].weight == places_[at].weight) --first;
    if (first != at) {
      exchange(first, at);
      at = first;
    }
    ++places_[at].weight;
    at = places_[at].parent;
  }
  ++places_[kRoot].weight;
}

void AdaptiveHuffman::put(BitWriter& writer, uint32_t symbol) {
  std::array<uint8_t, kNodes> bits{};
  uint32_t length = 0;
  for (uint32_t at = place_of_[symbol]; at != kRoot; at = places_[at].parent)
    bits[length++] = at == places_[places_[at].parent].children ? 0 : 1;
  while (length > 0) writer.put(bits[--length], 1);
  count(symbol);
}

uint32_t AdaptiveHuffman::get(BitReader& reader) {
  uint32_t at = kRoot;
  while (places_[at].children != 0) at = places_[at].children + reader.get(1);
  const uint32_t symbol = places_[at].symbol;
  count(symbol);
  return symbol;
}

}  // namespace promenade
