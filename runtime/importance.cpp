#include "runtime/importance.h"

#include <algorithm>

namespace promenade {

std::vector<float> importance_of(const Model& model, const ClassWeights& weights) {
  const ModelObjects& objects = model.objects;
  const auto weighted = [&weights](const std::string& name) { return weights.contains(name); };
  if (std::none_of(objects.classes.begin(), objects.classes.end(), weighted)) return {};
  std::vector<double> weight_of(objects.classes.size(), 1);
  for (size_t i = 0; i < weight_of.size(); ++i)
    if (const auto found = weights.find(objects.classes[i]); found != weights.end())
      weight_of[i] = std::clamp(found->second, 0.0, 1.0);
  struct Sum {
    double area_m2 = 0, weighted_m2 = 0;
  };
  std::vector<Sum> sums(model.tables.nodes.size());
  for (const ClassShare& share : objects.class_shares)
    for (NodeId id = share.leaf; id != kNoNode; id = model.tables.nodes[index_of(id)].parent) {
      sums[index_of(id)].area_m2 += double(share.area_m2);
      sums[index_of(id)].weighted_m2 += double(share.area_m2) * weight_of[share.class_index];
    }
  std::vector<float> importance;
  importance.reserve(sums.size());
  for (const Sum& sum : sums)
    importance.push_back(sum.area_m2 > 0 ? static_cast<float>(sum.weighted_m2 / sum.area_m2) : 1.0F);
  return importance;
}

}  // namespace promenade
