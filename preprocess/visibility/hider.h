#pragma once
// A hider proves that nodes cannot be seen from anywhere in a view cell. Hiders make a chain, from cheap to dear: sets
// that conservative hiders remove add up to a set that may be removed, so any chain of them is conservative.

#include <cstdint>
#include <span>
#include <string_view>

#include "geometry/box.h"
#include "geometry/node_id.h"
#include "geometry/result.h"

namespace promenade {

/// A cell and the nodes that it might see.
struct HiderQuestion {
  Box cell;  ///< metres, model space; closed: its faces belong to it
  /// The cell's front: what is drawn when nothing is hidden. By id.
  std::span<const NodeId> front;
};

/// Prepared for one model once; then asked from any thread, several cells at once.
class Hider {
 public:
  Hider() = default;
  Hider(const Hider&) = delete;
  Hider& operator=(const Hider&) = delete;
  virtual ~Hider() = default;

  virtual std::string_view name() const = 0;
  /// False: may hide what can be seen (the sampled hider); the model then says so.
  virtual bool is_conservative() const { return true; }
  /// Sets hidden[i] to 1 for each front[i] of which nothing can be seen from any point of the cell, when the front is
  /// drawn. What is set already (by hiders before it) is left alone, and may still occlude. Errors: reading the model.
  virtual Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const = 0;
};

}  // namespace promenade
