#include "runtime/notices.h"

#include <imgui.h>

#include <algorithm>
#include <utility>

namespace promenade {
namespace {

constexpr double kShownS = 5;
constexpr ImGuiWindowFlags kBare = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                   ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing |
                                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoMove;
constexpr ImU32 kStateColor = IM_COL32(240, 80, 70, 255);

}  // namespace

void Notices::say(std::string text) {
  text_ = std::move(text);
  said_ = Clock::now();
}

void Notices::draw(const std::string& state) const {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float edge = ImGui::GetFontSize();
  if (!text_.empty() && std::chrono::duration<double>(Clock::now() - said_).count() < kShownS) {
    ImGui::SetNextWindowPos({size.x / 2, size.y - edge}, ImGuiCond_Always, {0.5F, 1});
    ImGui::Begin("##notice", nullptr, kBare);
    ImGui::PushTextWrapPos(std::max(size.x * 0.7F, 20 * edge));
    ImGui::TextUnformatted(text_.c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
  }
  if (state.empty()) return;
  ImGui::SetNextWindowPos({size.x - edge, edge}, ImGuiCond_Always, {1, 0});
  ImGui::Begin("##state", nullptr, kBare);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::GetWindowDrawList()->AddCircleFilled({at.x + edge / 2, at.y + edge / 2}, edge * 0.4F, kStateColor);
  ImGui::Dummy({edge, edge});
  ImGui::SameLine();
  ImGui::TextUnformatted(state.c_str());
  ImGui::End();
}

}  // namespace promenade
