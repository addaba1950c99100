#pragma once
// One parametric generator, many parameter sets.

#include <functional>
#include <vector>

#include "geometry/mesh.h"

namespace promenade {

/// Details smaller than a thumb (screws, pins, single keys) are there from this quality on.
constexpr double kFineDetail = 0.5;

/// A builder for each set of parameters.
template <class Parameters>
std::vector<std::function<Mesh(double)>> each(Mesh (*build)(const Parameters&, double),
                                              std::vector<Parameters> variants) {
  std::vector<std::function<Mesh(double)>> builders;
  builders.reserve(variants.size());
  for (const Parameters& p : variants) builders.emplace_back([build, p](double quality) { return build(p, quality); });
  return builders;
}

}  // namespace promenade
