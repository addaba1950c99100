#include "datasets/furniture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace promenade {

FurnitureCatalogue::FurnitureCatalogue() {
  add_seating(*this);
  add_tables(*this);
  add_storage(*this);
  add_lamps(*this);
  add_plants(*this);
  add_devices(*this);
  add_small_things(*this);
  add_fittings(*this);
  add_outdoors(*this);
}

void FurnitureCatalogue::add(std::string_view kind, std::string_view class_name,
                             std::vector<std::function<Mesh(double)>> builders) {
  kinds_.push_back({std::string(kind), static_cast<uint32_t>(items_.size()), static_cast<uint32_t>(builders.size())});
  for (size_t i = 0; i < builders.size(); ++i)
    items_.push_back({fmt::format("{}_{}", kind, i), std::string(class_name), std::move(builders[i])});
}

uint32_t FurnitureCatalogue::find(std::string_view kind, uint32_t variant) const {
  const auto it = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& k) { return k.name == kind; });
  assert(it != kinds_.end());
  return it->first + variant % it->count;
}

uint32_t FurnitureCatalogue::variants(std::string_view kind) const {
  const auto it = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& k) { return k.name == kind; });
  assert(it != kinds_.end());
  return it->count;
}

}  // namespace promenade
