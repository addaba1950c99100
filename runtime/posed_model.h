#pragma once
// A model at a moment: the boxes of what moves are where it is then.

#include <glm/mat4x4.hpp>
#include <vector>

#include "layout/model.h"

namespace promenade {

/// Takes a copy of the model's tables if anything in it moves, else nothing. The source must outlive it. One thread.
class PosedModel {
 public:
  explicit PosedModel(const Model& source);
  PosedModel(const PosedModel&) = delete;
  PosedModel& operator=(const PosedModel&) = delete;

  void set_time(double time_s);
  /// Boxes, of what moves, as they are now, no larger than what they sweep; stays the same object.
  const Model& now() const { return moves() ? posed_ : source_; }
  const Model& source() const { return source_; }
  bool moves() const { return !source_.objects.moving.empty(); }
  /// Model space from a node's mesh.
  glm::mat4 matrix_of(NodeId id) const;
  static uint64_t byte_size(const Model& source);

 private:
  const Model& source_;
  Model posed_;
  std::vector<glm::mat4> matrices_;  ///< by moving object
};

}  // namespace promenade
