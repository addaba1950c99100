#pragma once
// What is around a walker, at full detail: read beside the frames, so that collision waits for no disk.

#include <memory>

#include "geometry/closest_point.h"
#include "runtime/model_source.h"

namespace promenade {

/// A thread of its own reads the leaves around the eye. Everything else: one thread.
class Surroundings {
 public:
  /// bytes: what the surfaces held may take, the one being made included. The source must outlive it.
  Surroundings(const ModelSource& source, uint64_t bytes);
  ~Surroundings();
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;

  /// The eye, model space. Asks for other leaves when it has gone far enough; never waits.
  void move_to(const glm::dvec3& eye);
  /// What was read last; null: nothing yet. Leaves that cannot be read are left out.
  std::shared_ptr<const ClosestPointTree> surface() const;
  /// Whether what surface() has was read for where the eye is now.
  bool up_to_date() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace promenade
