#pragma once
// Situations that say who sees whom, and how a chain of hiders is asked about them.

#include <gtest/gtest.h>

#include "preprocess/visibility/audit.h"
#include "preprocess/visibility/hider_chain.h"
#include "tests/preprocess/situations.h"

namespace promenade {

inline std::vector<uint8_t> hidden_by(const SituationModel& model, const std::vector<std::string>& names,
                                      const Box& cell) {
  JobMonitor monitor;
  const Result<std::vector<std::unique_ptr<Hider>>> hiders = HiderMaker(model.reader(), {}, monitor).make(names);
  EXPECT_TRUE(hiders.ok());
  const std::vector<NodeId> front = model.front();
  std::vector<uint8_t> hidden(front.size(), 0);
  for (const auto& hider : *hiders) EXPECT_TRUE(hider->hide({cell, front}, hidden).ok());
  return hidden;
}

/// Nodes that are hidden and that pictures from the cell show all the same.
inline uint64_t misses(const SituationModel& model, const Box& cell, std::span<const uint8_t> hidden) {
  const Result<std::unique_ptr<NodeMeshes>> meshes = NodeMeshes::make(model.reader(), 1U << 28U);
  EXPECT_TRUE(meshes.ok());
  LookOptions options;
  options.views = 240;
  const std::vector<NodeId> front = model.front();
  const Result<Looks> looks = look_from_cell(**meshes, cell, front, hidden, options);
  EXPECT_TRUE(looks.ok());
  return judge(model.reader().model(), front, hidden, *looks).false_hidden_nodes;
}

struct Situation {
  std::string name;
  Objects objects;
  Box cell;
  std::vector<std::string> hidden, kept;  ///< by the chain under test
};
// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest looks for this name
inline void PrintTo(const Situation& s, std::ostream* out) { *out << s.name; }

/// A cube of a metre.
inline Mesh thing_at(float x, float y, float z = 0) {
  return block({x - 0.5F, y - 0.5F, z}, {x + 0.5F, y + 0.5F, z + 1});
}

/// Asks the chain: what the situation says must be hidden is, what it says must be seen is not, and pictures show
/// nothing that is hidden.
inline void expect_as_said(const Situation& situation, const std::vector<std::string>& chain) {
  const SituationModel model(situation.objects);
  const std::vector<uint8_t> hidden = hidden_by(model, chain, situation.cell);
  for (const std::string& name : situation.hidden) EXPECT_EQ(hidden[model.number_of(name)], 1) << name;
  for (const std::string& name : situation.kept) EXPECT_EQ(hidden[model.number_of(name)], 0) << name;
  EXPECT_EQ(misses(model, situation.cell, hidden), 0U);
}

}  // namespace promenade
