#include "runtime/viewer_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace promenade {
namespace {

constexpr float kLabelLetters = 8.5F;  // beside sliders, in heights of letters
constexpr double kPyramidM = 60;       // length of a view pyramid, shown
constexpr ImU32 kCellColor = IM_COL32(255, 230, 40, 255), kNeighbourColor = IM_COL32(255, 230, 40, 110),
                kPyramidColor = IM_COL32(255, 60, 200, 255);
constexpr ImU32 kTargetColor = IM_COL32(240, 160, 60, 200);
constexpr ImU32 kFarCellColor = IM_COL32(60, 240, 240, 255), kFarBoxColor = IM_COL32(60, 140, 255, 255);

ImU32 packed(const glm::u8vec4& c, int opacity) { return IM_COL32(c.r, c.g, c.b, opacity); }

/// From 0 to 1: how deep, how large, how coarse; resident nodes: how deep.
double share_of(const NodeRecord& node, BoxColors colors, const NodeRecord& most) {
  switch (colors) {
    case BoxColors::triangles:
      return double(node.triangles) / most.triangles;
    case BoxColors::error:
      return node.error_m <= 0 ? 0 : (std::log10(double(node.error_m)) + 3) / 4;  // 1 mm to 10 m
    case BoxColors::level:
    case BoxColors::resident:
    case BoxColors::none:
      break;
  }
  return double(node.level) / most.level;
}

}  // namespace

void FramePlots::push(Plot& plot, double value) {
  std::rotate(plot.begin(), plot.begin() + 1, plot.end());
  plot.back() = static_cast<float>(value);
}

void FramePlots::add(const FrameRow& row) {
  push(frame_ms_, row.frame_ms);
  push(resident_mib_, double(row.resident_bytes) / 1048576);
  push(read_kib_, double(row.bytes_read) / 1024);
  last_ = row;
  drawn_ = std::chrono::steady_clock::now();
}

double FramePlots::shown() {
  if (!drawn_) return 0;
  const std::chrono::duration<double, std::milli> showing = std::chrono::steady_clock::now() - *drawn_;
  drawn_.reset();
  response_ms_ = last_.response_ms + showing.count();
  return response_ms_;
}

void FramePlots::draw_plots(double target_ms, uint64_t memory_bytes) const {
  const float line = ImGui::GetTextLineHeight();
  const auto plot = [line](const char* id, const Plot& values, const std::string& title, double most, float lines) {
    ImGui::PlotLines(id, values.data(), static_cast<int>(values.size()), 0, title.c_str(), 0, static_cast<float>(most),
                     {ImGui::GetContentRegionAvail().x, lines * line});
  };
  constexpr double kTargets = 3;  // of them are the plot's height
  plot("##frames", frame_ms_, fmt::format("{:.1f} ms a frame, {:.1f} foretold", last_.frame_ms, last_.estimated_ms),
       kTargets * target_ms, 4);
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const float target_y = high.y + (low.y - high.y) / static_cast<float>(kTargets);
  ImGui::GetWindowDrawList()->AddLine({low.x, target_y}, {high.x, target_y}, kTargetColor);
  const double bound_mib = double(memory_bytes) / 1048576;
  plot("##memory", resident_mib_,
       fmt::format("{:.0f} of {:.0f} MiB in memory", double(last_.resident_bytes) / 1048576, bound_mib), bound_mib,
       2.5F);
  plot("##read", read_kib_, fmt::format("{:.0f} KiB read", double(last_.bytes_read) / 1024),
       std::max(64.0, double(*std::max_element(read_kib_.begin(), read_kib_.end()))), 2.5F);
}

void FramePlots::draw_figures(const Session& session) const {
  const FigureTable table("##figures");
  table.row("choose, load, draw",
            fmt::format("{:.2f}, {:.2f}, {:.1f} ms", last_.select_ms, last_.upload_ms, last_.draw_ms));
  const std::string ahead = session.frames_ahead() > 0 ? fmt::format("; {} ahead", session.frames_ahead()) : "";
  table.row("response",
            fmt::format("{:.1f} ms, {:.1f} of it to show{}", response_ms_, response_ms_ - last_.response_ms, ahead));
  table.row("triangles", fmt::format("{:.1f} k", double(last_.triangles_drawn) / 1e3));
  table.row("nodes", fmt::format("{}, {} missing", last_.nodes_drawn, last_.nodes_missing));
  if (last_.coarsening > 1) table.row("coarser for memory", fmt::format("{:.2f} times", last_.coarsening));
  std::string levels;
  for (const uint32_t count : last_.nodes_by_level) levels += fmt::format("{} ", count);
  table.row("by level", levels);
  const LoaderCounts counts = session.loader_counts();
  table.row("read", fmt::format("{:.1f} MB in {} runs", double(counts.bytes_read) / 1e6, counts.reads));
  table.row("nodes in, out", fmt::format("{}, {}", counts.nodes_loaded, counts.nodes_evicted));
}

FigureTable::FigureTable(const char* id) : open_(ImGui::BeginTable(id, 2, ImGuiTableFlags_SizingFixedFit)) {}

FigureTable::~FigureTable() {
  if (open_) ImGui::EndTable();
}

void FigureTable::row(const char* name, const std::string& value) const {
  if (!open_) return;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", name);
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(value.c_str());
}

namespace {

void draw_far_style_setting(Session& session) {
  FarStyle& style = session.far_style();
  if (!ImGui::BeginCombo("near and far (N)", std::string(name_of(style)).c_str())) return;
  for (const FarStyle each : {FarStyle::full, FarStyle::near_only, FarStyle::far_only})
    if (ImGui::Selectable(std::string(name_of(each)).c_str(), each == style)) style = each;
  ImGui::EndCombo();
}

/// The far cell whose picture is shown, and the boxes of its shells.
template <class In>
void draw_far_boxes(const RasterView& view, const FarTables& tables, FarCellId shown, const In& in) {
  for (const FarCellId cell : chain_of(tables, shown)) {
    const DBox box = cell_box(tables, cell);
    draw_box(view, {glm::vec3(box.min), glm::vec3(box.max)}, in(kFarCellColor, 1.5F));
    draw_box(view, near_box(tables, cell), in(kFarBoxColor, 2));
  }
}

}  // namespace

std::string show_next_style(Session& session, const ModelSource& source, std::optional<Policy>& brute_from) {
  Policy& policy = session.select_options().policy;
  FarStyle& style = session.far_style();
  if (source.far() == nullptr) return "no far pictures: build the model with --far-pictures";
  if (policy == Policy::none && brute_from) {
    policy = *brute_from, style = FarStyle::full;
    brute_from.reset();
  } else if (!uses_far(policy)) {
    policy = Policy::stratified, style = FarStyle::full;
  } else if (style == FarStyle::far_only) {
    brute_from = policy, policy = Policy::none, style = FarStyle::full;
    return "brute force";
  } else {
    style = style == FarStyle::full ? FarStyle::near_only : FarStyle::far_only;
  }
  return std::string(style == FarStyle::full        ? "near geometry, far pictures"
                     : style == FarStyle::near_only ? "near geometry alone"
                                                    : "far pictures alone");
}

/// Everything that a policy can be told.
void draw_settings(Session& session) {
  SelectOptions& select = session.select_options();
  ImGui::PushItemWidth(-kLabelLetters * ImGui::GetFontSize());
  if (ImGui::BeginCombo("policy", std::string(name_of(select.policy)).c_str())) {
    for (const Policy policy : all_policies())
      if (ImGui::Selectable(std::string(name_of(policy)).c_str(), policy == select.policy)) select.policy = policy;
    ImGui::EndCombo();
  }
  float pixel_error = static_cast<float>(select.pixel_error), target_ms = static_cast<float>(select.time.target_ms);
  if (ImGui::SliderFloat("pixel error", &pixel_error, 0.25F, 16, "%.2f", ImGuiSliderFlags_Logarithmic))
    select.pixel_error = double(pixel_error);
  if (ImGui::SliderFloat("target ms", &target_ms, 5, 200, "%.0f", ImGuiSliderFlags_Logarithmic))
    select.time.target_ms = double(target_ms);
  const auto slide = [](const char* label, double& value, float least, float most) {
    float shown = static_cast<float>(value);
    if (ImGui::SliderFloat(label, &shown, least, most, "%.2f")) value = double(shown);
  };
  slide("error hysteresis", select.error_hysteresis, 0, 0.5F);
  ImGui::Checkbox("coarser where memory is short", &select.fit_memory);
  if (select.policy == Policy::cost_benefit && ImGui::CollapsingHeader("worth of drawing")) {
    slide("half error px", select.benefit.half_error_px, 0.5F, 32);
    slide("focus", select.benefit.focus_weight, 0, 1);
    slide("motion", select.benefit.motion_weight, 0, 1);
    slide("hysteresis", select.benefit.hysteresis_weight, 0, 1);
  }
  const std::vector<std::string>& classes = session.model_now().objects.classes;
  if (!classes.empty() && ImGui::CollapsingHeader("classes")) {
    for (const std::string& name : classes) {
      const auto found = session.class_weights().find(name);
      const double before = found == session.class_weights().end() ? 1 : found->second;
      double weight = before;
      slide(name.empty() ? "(no class)" : name.c_str(), weight, 0, 1);
      if (weight != before) session.set_class_weight(name, weight);
    }
  }
  if (uses_time(select.policy) && ImGui::CollapsingHeader("time slices")) {
    ImGui::Checkbox("hysteresis", &select.time.hysteresis);
    slide("switch", select.time.hysteresis_switch, 1, 50);
    slide("limit", select.time.hysteresis_limit, 1, 150);
    slide("visibility", select.time.visibility_weight, 0, 4);
    slide("foreshortening", select.time.foreshortening_weight, 0, 1);
    ImGui::Checkbox("refine when all children are there", &select.time.all_children_resident);
    ImGui::Checkbox("share follows time", &select.time.share_feedback);
  }
  if (uses_far(select.policy)) draw_far_style_setting(session);
  if (session.has_openings()) ImGui::Checkbox("leave out what this eye does not see", &select.eye_culling);
  int fade_frames = static_cast<int>(session.fade_frames());
  if (ImGui::SliderInt("fade frames", &fade_frames, 0, 60)) session.fade_frames() = static_cast<uint32_t>(fade_frames);
  ImGui::Checkbox("textures", &session.frame_view().textures);
  ImGui::PopItemWidth();
}

void draw_keys() {
  static constexpr std::array<std::pair<const char*, const char*>, 16> kKeys = {{
      {"drag, wheel", "look, speed"},
      {"WASD, arrows", "move; space, C: up, down"},
      {"double click", "go there"},
      {"G", "walk or fly"},
      {"Q, E, F", "roll, straighten"},
      {"Home", "back to the start"},
      {"1-9", "to a bookmark; with Ctrl: set it"},
      {"B", "bird's eye; wheel: height"},
      {"V", "boxes of nodes"},
      {"N", "near and far, near, far, brute force"},
      {"T", "what moves stops or goes on"},
      {"P", "picture of the view"},
      {"R", "record a path, and stop"},
      {"L", "replay it, and stop"},
      {"H", "hide this panel, show it"},
      {"Esc", "quit"},
  }};
  const FigureTable table("##keys");
  for (const auto& [key, what] : kKeys) table.row(key, what);
}

void draw_box_colors_setting(BoxColors& colors) {
  static constexpr std::array<const char*, 5> kNames = {"no boxes", "drawn nodes by level", "drawn nodes by triangles",
                                                        "drawn nodes by error", "resident nodes by level"};
  int chosen = static_cast<int>(colors);
  ImGui::SetNextItemWidth(-kLabelLetters * ImGui::GetFontSize());
  if (ImGui::Combo("boxes", &chosen, kNames.data(), static_cast<int>(kNames.size())))
    colors = static_cast<BoxColors>(chosen);
}

void draw_overlay(const RasterView& view, const ModelSource& source, const Session& session, BoxColors colors,
                  const Camera* walker, const FrameRow& row) {
  ImDrawList* lines = ImGui::GetBackgroundDrawList();
  const auto in = [lines](ImU32 color, float width) {
    return [lines, color, width](const Line& line) {
      lines->AddLine({line[0].x, line[0].y}, {line[1].x, line[1].y}, color, width);
    };
  };
  const ModelTables& tables = session.model_now().tables;
  if (colors != BoxColors::none) {
    NodeRecord most;  // of every figure, whichever node has it
    most.level = most.triangles = 1;
    for (const NodeRecord& node : tables.nodes) {
      most.level = std::max(most.level, node.level);
      most.triangles = std::max(most.triangles, node.triangles);
    }
    const std::vector<NodeId> nodes =
        colors == BoxColors::resident ? session.resident_nodes() : session.selection().front;
    for (const NodeId id : nodes) {
      const NodeRecord& node = tables.nodes[index_of(id)];
      draw_box(view, node.box, in(packed(false_color(share_of(node, colors, most)), 160), 1));
    }
  }
  if (walker == nullptr) return;
  draw_pyramid(view, *walker, source.model().manifest.origin, kPyramidM, in(kPyramidColor, 2));
  if (source.far() != nullptr && row.far_cell) draw_far_boxes(view, *source.far(), *row.far_cell, in);
  const CellTables* cells = source.cells();
  if (cells == nullptr || !row.cell) return;
  for (const uint32_t face : cells->faces_of(*row.cell))
    draw_box(view, cells->cells[index_of(cells->faces[face].other(*row.cell))].box, in(kNeighbourColor, 1));
  draw_box(view, cells->cells[index_of(*row.cell)].box, in(kCellColor, 2));
}

}  // namespace promenade
