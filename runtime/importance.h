#pragma once
// How much nodes matter by the classes of what is in them. Source: [funkhouser1993] section 4.2.3, semantics.

#include <map>
#include <string>
#include <vector>

#include "layout/model.h"

namespace promenade {

/// In [0, 1], by class name; 1 for what is not named.
using ClassWeights = std::map<std::string, double>;

/// By node: the mean of its leaves' weights, each by the area of its classes; 1 where the source names no class. Empty
/// when nothing is weighted: all matter alike. Pure; any thread.
std::vector<float> importance_of(const Model& model, const ClassWeights& weights);

}  // namespace promenade
