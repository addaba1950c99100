#include "cli/hider_study.h"

#include <algorithm>
#include <array>

#include "cli/console.h"
#include "cli/node_picture.h"
#include "geometry/camera.h"
#include "preprocess/visibility/hider_trial.h"
#include "preprocess/visibility/hiders/sampled.h"

namespace promenade {
namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

}  // namespace

void Drawn::add(const Model& model, std::span<const NodeId> front, std::span<const uint8_t> hidden) {
  uint64_t n = 0, t = 0;
  for (size_t i = 0; i < front.size(); ++i)
    if (hidden[i] == 0) ++n, t += model.tables.nodes[index_of(front[i])].triangles;
  ++count, nodes += n, triangles += t;
  most_nodes = std::max(most_nodes, n), most_triangles = std::max(most_triangles, t);
}

Result<std::vector<ChainRow>> make_chains(std::vector<std::string> lists, const ModelReader& reader,
                                          JobMonitor& monitor) {
  const Result<std::vector<std::string>> usual = chain_for_model({std::string(kAutoHiders)}, reader, monitor);
  if (!usual) return usual.error();
  if (lists.empty()) {
    lists.push_back("none");
    lists.insert(lists.end(), usual->begin(), usual->end());
    if (usual->size() > 1) lists.push_back(joined(*usual));
  }
  std::vector<ChainRow> rows;
  rows.reserve(lists.size());
  for (const std::string& list : lists) {
    Result<std::vector<std::string>> names = parse_hiders(list);
    if (!names) return names.error();
    if (list == kAutoHiders) names = *usual;
    const WallClock clock;
    Result<std::vector<std::unique_ptr<Hider>>> hiders = HiderMaker(reader, HiderBuildOptions(), monitor).make(*names);
    if (!hiders) return hiders.error();
    ChainRow row;
    row.name = list, row.hiders = std::move(*hiders), row.is_default = *names == *usual;
    row.prepare_s = clock.seconds();
    for (const auto& hider : row.hiders) row.conservative &= hider->is_conservative();
    rows.push_back(std::move(row));
  }
  return rows;
}

HiderStudy::HiderStudy(const HiderStudyOptions& options, const NodeMeshes& meshes, std::vector<ChainRow>& rows)
    : options_(options),
      meshes_(meshes),
      rows_(rows),
      reference_(make_sampled_hider(meshes)),
      bound_{options.pixel_error, pixel_scale(1280, 720, 60)} {}

Status HiderStudy::add(const Box& cell) {
  const std::vector<NodeId> front = cell_front(meshes_.model().model(), cell, bound_);
  LookOptions around = options_.looks;
  around.aimed_views = 0;
  Result<Looks> looks = look_from_cell(meshes_, cell, front, {}, around);
  if (!looks) return looks.error();
  if (looks->eyes == 0) return Done{};
  // By chain, for each node: 0, or 1 + the place in the chain of the hider that hid it.
  std::vector<std::vector<uint8_t>> hidden_by(rows_.size(), std::vector<uint8_t>(front.size(), 0));
  for (size_t i = 0; i < rows_.size(); ++i) PROMENADE_TRY(ask(rows_[i], cell, front, hidden_by[i]));
  PROMENADE_TRY(aim(cell, front, hidden_by.back(), *looks));
  ++cells;
  eyes += looks->eyes, pixels += looks->pixels;
  front_nodes += front.size();
  seen_nodes += static_cast<uint64_t>(std::count_if(looks->pixels_of.begin(), looks->pixels_of.end(),
                                                    [](uint64_t pixels_of_node) { return pixels_of_node > 0; }));
  std::vector<uint8_t> none(front.size(), 0);
  const ThreadClock clock;
  PROMENADE_TRY(reference_->hide({cell, front}, none));
  reference_ms += clock.seconds() * 1e3;
  for (size_t i = 0; i < rows_.size(); ++i) PROMENADE_TRY(judge_chain(rows_[i], cell, front, hidden_by[i], *looks));
  return Done{};
}

Status HiderStudy::ask(ChainRow& row, const Box& cell, std::span<const NodeId> front, std::span<uint8_t> hidden_by) {
  std::vector<uint8_t> hidden(front.size(), 0);
  for (size_t h = 0; h < row.hiders.size(); ++h) {
    const ThreadClock clock;
    PROMENADE_TRY(row.hiders[h]->hide({cell, front}, hidden));
    row.ms += clock.seconds() * 1e3;
    for (size_t i = 0; i < front.size(); ++i)
      if (hidden[i] != 0 && hidden_by[i] == 0) hidden_by[i] = static_cast<uint8_t>(h + 1);
  }
  return Done{};
}

/// Looks closer at what is kept but not seen yet.
Status HiderStudy::aim(const Box& cell, std::span<const NodeId> front, std::span<const uint8_t> hidden_by,
                       Looks& looks) const {
  if (options_.looks.aimed_views == 0) return Done{};
  std::vector<uint8_t> unseen(front.size(), 0);
  for (size_t i = 0; i < front.size(); ++i) unseen[i] = hidden_by[i] == 0 && looks.pixels_of[i] == 0 ? 1 : 0;
  if (std::find(unseen.begin(), unseen.end(), 1) == unseen.end()) return Done{};
  LookOptions closer = options_.looks;
  closer.seed += 1;  // from other eyes
  const Result<Looks> more = look_from_cell(meshes_, cell, front, unseen, closer);
  if (!more) return more.error();
  looks.pixels += more->pixels;
  for (size_t i = 0; i < front.size(); ++i) looks.pixels_of[i] += more->pixels_of[i];
  return Done{};
}

Status HiderStudy::judge_chain(ChainRow& row, const Box& cell, std::span<const NodeId> front,
                               std::span<const uint8_t> hidden_by, const Looks& looks) {
  std::vector<uint8_t> hidden(front.size(), 0);
  for (size_t i = 0; i < front.size(); ++i) hidden[i] = hidden_by[i] != 0 ? 1 : 0;
  const bool last = &row == &rows_.back();
  if (last && cells == 1 && !options_.picture.empty()) PROMENADE_TRY(draw_plan(cell, front, hidden_by, looks));
  if (last && options_.eyes > 0) PROMENADE_TRY(see_from_eyes(row, cell, front, hidden));
  const CellVerdict verdict = judge(meshes_.model().model(), front, hidden, looks);
  if (last) studied.push_back({cell, looks.eyes, verdict});
  row.ratio_sum += double(verdict.kept_triangles) / double(std::max<uint64_t>(verdict.seen_triangles, 1));
  row.hidden_share_sum += 1 - double(verdict.kept_triangles) / double(std::max<uint64_t>(verdict.front_triangles, 1));
  row.false_hidden_nodes += verdict.false_hidden_nodes;
  row.false_hidden_pixels += verdict.false_hidden_pixels;
  row.kept_nodes += verdict.kept_nodes, row.kept_triangles += verdict.kept_triangles;
  return Done{};
}

/// What is drawn when the chain is asked for an eye in the cell, and for what its view pyramid meets.
Status HiderStudy::see_from_eyes(const ChainRow& row, const Box& cell, std::span<const NodeId> front,
                                 std::span<const uint8_t> hidden) {
  const Model& model = meshes_.model().model();
  cell_to_object.add(model, front, hidden);
  const auto unit = [this] { return double(random_() >> 11U) * 0x1p-53; };
  for (uint32_t i = 0; i < options_.eyes; ++i) {
    Camera camera;
    const double x = unit(), y = unit(), z = unit();
    camera.pose.eye = glm::dvec3(cell.min) + glm::dvec3(x, y, z) * glm::dvec3(cell.size());
    camera.pose.yaw_deg = 360 * unit();
    const Frustum frustum = frustum_of(camera, glm::dvec3(0));
    std::vector<uint8_t> unseen(hidden.begin(), hidden.end());
    for (size_t k = 0; k < front.size(); ++k)
      if (classify(frustum, model.tables.nodes[index_of(front[k])].box) == Overlap::outside) unseen[k] = 1;
    in_view.add(model, front, unseen);
    const glm::vec3 eye(camera.pose.eye);
    const ThreadClock clock;
    for (const auto& hider : row.hiders) PROMENADE_TRY(hider->hide({{eye, eye}, front}, unseen));
    eye_ms += clock.seconds() * 1e3;
    eye_to_object.add(model, front, unseen);
  }
  return Done{};
}

/// From above: seen green, kept though not seen orange, hidden grey (by the chain's first hider) and shades of blue.
Status HiderStudy::draw_plan(const Box& cell, std::span<const NodeId> front, std::span<const uint8_t> hidden_by,
                             const Looks& looks) const {
  const std::array<glm::u8vec3, 4> hiders = {
      glm::u8vec3(170, 170, 170), {130, 160, 230}, {90, 110, 200}, {150, 90, 200}};
  const auto color_of = [&](size_t i) {
    if (looks.pixels_of[i] > 0) return hidden_by[i] == 0 ? glm::u8vec3(80, 190, 90) : glm::u8vec3(255, 0, 0);
    return hidden_by[i] == 0 ? glm::u8vec3(250, 160, 40) : hiders[std::min<size_t>(hidden_by[i] - 1U, 3)];
  };
  const Model& model = meshes_.model().model();
  Box box;
  for (const NodeId root : model.tables.roots) box.add(model.tables.nodes[index_of(root)].box);
  return write_node_picture(meshes_, front, plan_view(box, 1200), color_of, cell, options_.picture);
}

}  // namespace promenade
