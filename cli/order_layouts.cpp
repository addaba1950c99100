#include "cli/order_layouts.h"

#include <map>
#include <numeric>
#include <utility>

#include "layout/order_rivals.h"
#include "layout/step_sets.h"
#include "layout/walk_cost.h"

namespace promenade {
namespace {

std::vector<uint32_t> places_of(const std::vector<uint32_t>& ids, const std::vector<uint32_t>& place) {
  std::vector<uint32_t> places;
  places.reserve(ids.size());
  for (const uint32_t id : ids) places.push_back(place[id]);
  std::sort(places.begin(), places.end());
  return places;
}

}  // namespace

OrderStudy::OrderStudy(const StudyInput& input, std::vector<StorageProfile> profiles, uint64_t memory_bytes)
    : tables_(input.reader.model().tables), sets_(input.sets), profiles_(std::move(profiles)) {
  const std::vector<CellFace>& faces = input.reader.cells()->tables().faces;
  matrix_ = incidence_of(step_rows(sets_.vlods, faces), static_cast<uint32_t>(tables_.nodes.size()));
  steps_ = sets_.walk.empty() ? all_steps(faces) : walked_steps();
  points_.reserve(tables_.nodes.size());
  for (const NodeRecord& node : tables_.nodes) points_.push_back(node.box.center());
  memory_bytes_ = memory_bytes != 0 ? memory_bytes : largest_vlod_bytes() * 3 / 2;
}

/// Across every face in both directions.
std::vector<OrderStudy::Step> OrderStudy::all_steps(const std::vector<CellFace>& faces) const {
  std::vector<Step> steps;
  steps.reserve(2 * faces.size());
  for (std::vector<uint32_t>& row : step_rows(sets_.vlods, faces)) steps.push_back({1, std::move(row)});
  return steps;
}

/// As the walk takes them; jumps between cells that are no neighbours are among them.
std::vector<OrderStudy::Step> OrderStudy::walked_steps() const {
  std::map<std::pair<uint32_t, uint32_t>, double> times;
  for (size_t i = 1; i < sets_.walk.size(); ++i) times[{sets_.walk[i - 1], sets_.walk[i]}] += 1;
  std::vector<Step> steps;
  steps.reserve(times.size());
  for (const auto& [cells, weight] : times)
    steps.push_back({weight, entering(sets_.vlods[cells.first], sets_.vlods[cells.second])});
  return steps;
}

StepCost OrderStudy::mean_of(const std::vector<ReadPlan>& plans) const {
  StepCost cost;
  double weight = 0;
  for (size_t i = 0; i < steps_.size(); ++i) {
    const double w = steps_[i].weight;
    weight += w;
    cost.reads += w * static_cast<double>(plans[i].reads), cost.bytes += w * static_cast<double>(plans[i].bytes);
    cost.useful_bytes += w * static_cast<double>(plans[i].useful_bytes), cost.ms += w * plans[i].seconds * 1e3;
  }
  weight = std::max(weight, 1e-9);
  return {cost.reads / weight, cost.bytes / weight, cost.useful_bytes / weight, cost.ms / weight};
}

LayoutRow OrderStudy::row_of(const MadeOrder& made, const Reading& reading) const {
  LayoutRow row;
  row.name = std::string(made.name) + reading.suffix;
  row.runs_per_step = double(made.runs) / row_count(), row.wall_s = made.wall_s;
  std::vector<uint32_t> bytes;
  bytes.reserve(made.order.size());
  for (const uint32_t id : made.order) bytes.push_back(bytes_of(id));
  const NodeLayout layout(bytes);
  std::vector<uint32_t> place(made.order.size());
  for (size_t i = 0; i < place.size(); ++i) place[made.order[i]] = static_cast<uint32_t>(i);
  for (const StorageProfile& profile : profiles_) {
    std::vector<ReadPlan> plans;
    plans.reserve(steps_.size());
    for (const Step& step : steps_)
      plans.push_back(layout.plan(places_of(step.enters, place), profile, reading.least_useful));
    if (reading.copies > 0) use_copies(profile, reading.copies, layout.bytes(), plans, row);
    row.costs.push_back(mean_of(plans));
  }
  if (!sets_.walk.empty() && reading.copies <= 0) row.walks = walks(layout, place, reading.least_useful);
  return row;
}

LayoutRow OrderStudy::row_by_step() const {
  LayoutRow row;
  row.name = "by-step", row.runs_per_step = 1;
  uint64_t bytes = 0, all = 0;
  for (uint32_t id = 0; id < tables_.nodes.size(); ++id) all += bytes_of(id);
  for (uint32_t id = 0; id < matrix_.columns(); ++id) bytes += bytes_of(id) * matrix_.column(id).size();
  row.stored_share = double(bytes) / std::max<double>(1, double(all));
  for (const StorageProfile& profile : profiles_) row.costs.push_back(mean_of(copied(profile)));
  return row;
}

Incidence OrderStudy::part_of_matrix(uint32_t columns) const {
  ColumnOrder near = hilbert_order(points_);
  near.resize(std::min<size_t>(columns, near.size()));
  std::sort(near.begin(), near.end());  // in the order of the input
  Incidence part;
  part.rows = matrix_.rows;
  part.first.reserve(near.size() + 1);
  for (const uint32_t column : near) {
    const std::span<const uint32_t> ones = matrix_.column(column);
    part.ones.insert(part.ones.end(), ones.begin(), ones.end());
    part.first.push_back(part.ones.size());
  }
  return part;
}

uint64_t OrderStudy::bytes_of(const std::vector<uint32_t>& ids) const {
  uint64_t bytes = 0;
  for (const uint32_t id : ids) bytes += bytes_of(id);
  return bytes;
}

uint64_t OrderStudy::largest_vlod_bytes() const {
  uint64_t most = 0;
  for (const std::vector<uint32_t>& vlod : sets_.vlods) most = std::max(most, bytes_of(vlod));
  return most;
}

std::vector<WalkFigures> OrderStudy::walks(const NodeLayout& layout, const std::vector<uint32_t>& place,
                                           double least_useful) const {
  std::vector<std::vector<uint32_t>> wanted;
  wanted.reserve(sets_.walk.size());
  for (const uint32_t cell : sets_.walk) wanted.push_back(places_of(sets_.vlods[cell], place));
  std::vector<WalkFigures> figures;
  for (const StorageProfile& profile : profiles_) {
    const WalkCost cost = walk_cost(layout, wanted, {profile, least_useful, memory_bytes_});
    const double steps = std::max<double>(1, double(cost.taken));
    figures.push_back({{double(cost.steps.reads) / steps, double(cost.steps.bytes) / steps,
                        double(cost.steps.useful_bytes) / steps, cost.steps.seconds * 1e3 / steps},
                       cost.useful_share,
                       cost.start.bytes});
  }
  return figures;
}

/// Each step read from a copy of its own.
std::vector<ReadPlan> OrderStudy::copied(const StorageProfile& profile) const {
  std::vector<ReadPlan> plans;
  plans.reserve(steps_.size());
  for (const Step& step : steps_) plans.push_back(plan_reads(std::vector<Extent>{{0, bytes_of(step.enters)}}, profile));
  return plans;
}

void OrderStudy::use_copies(const StorageProfile& profile, double share, uint64_t all, std::vector<ReadPlan>& plans,
                            LayoutRow& row) const {
  const std::vector<ReadPlan> alone = copied(profile);
  const std::vector<uint8_t> chosen = choose_copies(plans, alone, static_cast<uint64_t>(share * double(all)));
  uint64_t bytes = all;
  for (size_t i = 0; i < plans.size(); ++i)
    if (chosen[i] != 0) plans[i] = alone[i], bytes += alone[i].bytes;
  row.stored_share = std::max(row.stored_share, double(bytes) / std::max<double>(1, double(all)));
}

}  // namespace promenade
