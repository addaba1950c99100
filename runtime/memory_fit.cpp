#include "runtime/memory_fit.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace promenade {
namespace {

/// Of the budget, for what only other cells ask for, where they ask for something.
constexpr uint64_t kElsewhereDivisor = 8;
/// A factor falls by this part a frame: from 2 to 1 in two seconds at 30 frames a second.
constexpr double kFall = 0.99;
/// It falls only where it may by more than this, and rises by as much more than it must: views change from frame to
/// frame, and each change of the factor switches some level.
constexpr double kSlack = 1.05;
/// What is drawn lags behind what is asked for by this much while that falls: ten frames, in which it can be read.
constexpr double kLead = 1.1;
/// What is drawn gives way by this much at most to what is foreseen.
constexpr double kForForeseen = 1.5;

/// The factor at which what is asked for fits. But where coarser levels take hardly less, as where the pictures of all
/// levels up to the roots are what takes room, a few missing nodes are the lesser evil: for the last eighth of the room
/// no more than the square of how many times too large it is.
double giving_way(const BytesByFactor& asked, uint64_t bytes) {
  constexpr uint64_t kLast = 8;
  const double too_large = double(asked.at(1)) / double(std::max<uint64_t>(bytes, 1));
  const double worth_it = std::max(too_large * too_large, asked.fitting(bytes + bytes / kLast));
  return std::min(asked.fitting(bytes), std::max(1.0, worth_it));
}

void follow_goal(double& factor, double goal) {
  if (goal > factor)
    factor = std::min(goal * kSlack, BytesByFactor::kCoarsest);
  else if (goal <= 1 || goal * kSlack * kSlack < factor)
    factor = std::max(goal <= 1 ? 1 : goal * kSlack, factor * kFall);
}

}  // namespace

size_t BytesByFactor::bin_of(double factor) {
  constexpr double kRounding = 1e-6;  // a bin's own edge lies in it
  const double bin = std::floor(std::log2(std::clamp(factor, 1.0, kCoarsest)) * kBinsAnOctave + kRounding);
  return std::min(static_cast<size_t>(bin), kBins - 1);
}

uint64_t BytesByFactor::at(double factor) const {
  uint64_t sum = 0;
  for (size_t i = bin_of(factor); i < kBins; ++i) sum += bytes_[i];
  return sum;
}

double BytesByFactor::fitting(uint64_t bytes, double least) const {
  uint64_t sum = 0;
  size_t bin = kBins;
  const size_t end = bin_of(least);
  while (bin > end && sum + bytes_[bin - 1] <= bytes) sum += bytes_[--bin];
  if (bin == end) return least;
  return std::min(kCoarsest, std::exp2(double(bin) / kBinsAnOctave));
}

void MemoryFit::follow(const BytesAsked& bytes, uint64_t budget_bytes, bool crossed, bool jumped) {
  const auto left = [budget_bytes](uint64_t taken) { return budget_bytes - std::min(budget_bytes, taken); };
  const bool others_ask = bytes.elsewhere.at(1) > 0;
  const uint64_t here_bytes = others_ask ? left(budget_bytes / kElsewhereDivisor) : budget_bytes;
  BytesByFactor here = bytes.view;
  here += bytes.cell;
  const double least = giving_way(bytes.view, here_bytes);
  const double goal = std::clamp(giving_way(here, here_bytes), least, least * kForForeseen);
  if (crossed) asked = cell = elsewhere;
  follow_goal(asked, goal);
  if (jumped) asked = goal;
  const double cell_goal = bytes.cell.fitting(left(bytes.view.at(asked)), asked);
  follow_goal(cell, cell_goal);
  cell = std::max(jumped ? cell_goal : cell, asked);
  const double elsewhere_goal = bytes.elsewhere.fitting(left(bytes.view.at(asked) + bytes.cell.at(cell)), cell);
  follow_goal(elsewhere, elsewhere_goal);
  elsewhere = std::max(jumped ? elsewhere_goal : elsewhere, cell);
  const bool falling = asked > 1 && goal * kSlack * kSlack < asked;
  const double behind = falling ? asked * kLead : asked;
  if (drawn > behind) drawn = std::max(behind, drawn * kFall);
  if (jumped || drawn < asked) drawn = asked;
}

BytesAsked bytes_asked(const Model& model, const MemoryBudget& budget, const std::vector<AheadNode>& nodes,
                       std::vector<AheadNode>& of_textures) {
  BytesAsked bytes;
  const auto add = [&bytes](const AheadNode& asked, uint64_t size) {
    BytesByFactor& into = asked.by == AskedBy::view   ? bytes.view
                          : asked.by == AskedBy::cell ? bytes.cell
                                                      : bytes.elsewhere;
    into.add(double(asked.until), size);
  };
  of_textures.clear();
  for (const AheadNode& n : nodes) {
    add(n, budget.node_bytes[index_of(n.node)]);
    for (const uint32_t texture : model.textures_of(n.node)) of_textures.push_back({NodeId{texture}, n.until, n.by});
  }
  std::sort(of_textures.begin(), of_textures.end(), [](const AheadNode& a, const AheadNode& b) {
    return std::tuple(index_of(a.node), a.by, -a.until) < std::tuple(index_of(b.node), b.by, -b.until);
  });
  NodeId last = kNoNode;
  for (const AheadNode& t : of_textures) {
    if (t.node != last) add(t, budget.texture_bytes[index_of(t.node)]);
    last = t.node;
  }
  return bytes;
}

}  // namespace promenade
