#pragma once
// Layouts of nodes on disk, and what the steps between a model's cells cost to read from each: the rows of `study
// orders`.

#include <algorithm>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "cli/study_sets.h"
#include "layout/order.h"
#include "layout/read_cost.h"

namespace promenade {

/// What steps cost on average.
struct StepCost {
  double reads = 0, bytes = 0, useful_bytes = 0, ms = 0;
  double useful_share() const { return bytes > 0 ? useful_bytes / bytes : 1.0; }
};

/// A walk with nodes staying in memory, a step on average.
struct WalkFigures {
  StepCost step;
  double useful_share = 0;   ///< see WalkCost
  uint64_t start_bytes = 0;  ///< read for the first cell
};

/// A way to lay nodes out, and what it costs on each kind of storage.
struct LayoutRow {
  std::string name;
  double runs_per_step = 0, wall_s = 0;
  double stored_share = 1;  ///< bytes on disk, of all nodes' once
  bool is_default = false;
  std::vector<StepCost> costs;     ///< by profile: each step by itself, with what its cell saw in memory
  std::vector<WalkFigures> walks;  ///< by profile; empty without a path
};

/// How rows differ besides the order.
struct Reading {
  std::string suffix;       ///< to the order's name
  double least_useful = 0;  ///< see merge_reads
  double copies = 0;        ///< bytes of copies of steps, as a share of all nodes'
};

class OrderStudy {
 public:
  /// input must outlive it. memory_bytes: along the walk; 0: one and a half times the largest vLOD's.
  OrderStudy(const StudyInput& input, std::vector<StorageProfile> profiles, uint64_t memory_bytes);

  OrderQuestion question() const { return {&matrix_, points_}; }
  const Incidence& matrix() const { return matrix_; }  ///< a row a step across a face, a column a node
  const std::vector<StorageProfile>& profiles() const { return profiles_; }
  uint64_t memory_bytes() const { return memory_bytes_; }
  double row_count() const { return std::max<double>(1, matrix_.rows); }

  LayoutRow row_of(const MadeOrder& made, const Reading& reading) const;
  /// Every step's nodes in one piece of their own: geometry stored by cell, the other extreme.
  LayoutRow row_by_step() const;
  /// The steps' matrix of so many nodes that lie near each other.
  Incidence part_of_matrix(uint32_t columns) const;

 private:
  /// From one cell to another.
  struct Step {
    double weight = 1;             ///< how often it is taken
    std::vector<uint32_t> enters;  ///< node ids, ascending
  };
  std::vector<Step> all_steps(const std::vector<CellFace>& faces) const;
  std::vector<Step> walked_steps() const;
  StepCost mean_of(const std::vector<ReadPlan>& plans) const;
  uint32_t bytes_of(uint32_t id) const { return tables_.segments[tables_.nodes[id].segment].stored_bytes; }
  uint64_t bytes_of(const std::vector<uint32_t>& ids) const;
  uint64_t largest_vlod_bytes() const;
  std::vector<WalkFigures> walks(const NodeLayout& layout, const std::vector<uint32_t>& place,
                                 double least_useful) const;
  std::vector<ReadPlan> copied(const StorageProfile& profile) const;
  void use_copies(const StorageProfile& profile, double share, uint64_t all, std::vector<ReadPlan>& plans,
                  LayoutRow& row) const;

  const ModelTables& tables_;
  const StudySets& sets_;
  std::vector<StorageProfile> profiles_;
  std::vector<Step> steps_;
  Incidence matrix_;
  std::vector<glm::vec3> points_;
  uint64_t memory_bytes_ = 0;
};

}  // namespace promenade
