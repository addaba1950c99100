#pragma once
// Columns that are equal as one: they stand together in every good order.

#include <vector>

#include "layout/incidence.h"

namespace promenade {

struct DistinctColumns {
  std::vector<uint32_t> first;    ///< the lowest column of each kind, ascending
  std::vector<uint32_t> kind_of;  ///< by column
};
DistinctColumns distinct_columns(const Incidence& matrix);

/// The order of all columns from that of the kinds. Those of a kind by number.
ColumnOrder spread(const DistinctColumns& distinct, const std::vector<uint32_t>& kinds);

}  // namespace promenade
