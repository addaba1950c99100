#include "runtime/panel_look.h"

#include <fontconfig/fontconfig.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "layout/file_io.h"

namespace promenade {
namespace {

constexpr float kFontPx = 14;

struct FontFile {
  std::filesystem::path path;
  int number = 0;  ///< within a collection
};

/// The system's plain font without serifs.
std::optional<FontFile> system_font() {
  const std::unique_ptr<FcConfig, decltype(&FcConfigDestroy)> config(FcInitLoadConfigAndFonts(), FcConfigDestroy);
  if (!config) return std::nullopt;
  const std::unique_ptr<FcPattern, decltype(&FcPatternDestroy)> wanted(
      FcNameParse(reinterpret_cast<const FcChar8*>("sans:weight=medium:slant=roman:fontformat=TrueType")),
      FcPatternDestroy);
  FcConfigSubstitute(config.get(), wanted.get(), FcMatchPattern);
  FcDefaultSubstitute(wanted.get());
  FcResult result = FcResultNoMatch;
  const std::unique_ptr<FcPattern, decltype(&FcPatternDestroy)> found(FcFontMatch(config.get(), wanted.get(), &result),
                                                                      FcPatternDestroy);
  FcChar8 *path = nullptr, *format = nullptr;
  if (!found || FcPatternGetString(found.get(), FC_FILE, 0, &path) != FcResultMatch) return std::nullopt;
  if (FcPatternGetString(found.get(), FC_FONTFORMAT, 0, &format) != FcResultMatch ||
      std::string(reinterpret_cast<const char*>(format)) != "TrueType")
    return std::nullopt;
  FontFile font{reinterpret_cast<const char*>(path)};
  FcPatternGetInteger(found.get(), FC_INDEX, 0, &font.number);
  return font;
}

void add_font(float size_px) {
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  if (const std::optional<FontFile> file = system_font())
    if (const Result<std::vector<std::byte>> bytes = read_file(file->path)) {
      void* data = IM_ALLOC(bytes->size());  // the atlas frees it
      std::copy(bytes->begin(), bytes->end(), static_cast<std::byte*>(data));
      ImFontConfig config;
      config.FontNo = file->number & 0xffff;  // the rest names a variation
      if (fonts.AddFontFromMemoryTTF(data, static_cast<int>(bytes->size()), size_px, &config) != nullptr) return;
    }
  ImFontConfig config;
  config.SizePixels = size_px;
  fonts.AddFontDefault(&config);
}

}  // namespace

void set_panel_look(float scale) {
  add_font(kFontPx * scale);
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 6, style.FrameRounding = 4, style.GrabRounding = 4, style.PopupRounding = 4;
  style.ScrollbarRounding = 4;
  style.WindowBorderSize = 0;
  style.WindowPadding = {10, 10}, style.FramePadding = {8, 3}, style.ItemSpacing = {8, 5}, style.CellPadding = {4, 1};
  style.WindowTitleAlign = {0, 0.5F};
  style.ScaleAllSizes(scale);
  const ImVec4 ground(0.09F, 0.10F, 0.12F, 0.90F), field(0.18F, 0.20F, 0.23F, 1), field_lit(0.24F, 0.27F, 0.31F, 1);
  const ImVec4 accent(0.36F, 0.62F, 0.84F, 1), accent_lit(0.50F, 0.74F, 0.94F, 1);
  const auto set = [&style](ImGuiCol which, const ImVec4& color) { style.Colors[which] = color; };
  set(ImGuiCol_Text, {0.90F, 0.91F, 0.92F, 1});
  set(ImGuiCol_TextDisabled, {0.60F, 0.63F, 0.66F, 1});
  for (const ImGuiCol which : {ImGuiCol_WindowBg, ImGuiCol_PopupBg}) set(which, ground);
  for (const ImGuiCol which : {ImGuiCol_TitleBg, ImGuiCol_TitleBgActive, ImGuiCol_TitleBgCollapsed})
    set(which, {0.06F, 0.07F, 0.08F, 0.95F});
  for (const ImGuiCol which : {ImGuiCol_FrameBg, ImGuiCol_Button, ImGuiCol_Header}) set(which, field);
  for (const ImGuiCol which : {ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive, ImGuiCol_ButtonHovered,
                               ImGuiCol_ButtonActive, ImGuiCol_HeaderHovered, ImGuiCol_HeaderActive})
    set(which, field_lit);
  for (const ImGuiCol which : {ImGuiCol_SliderGrab, ImGuiCol_CheckMark, ImGuiCol_PlotLines}) set(which, accent);
  for (const ImGuiCol which : {ImGuiCol_SliderGrabActive, ImGuiCol_PlotLinesHovered}) set(which, accent_lit);
}

}  // namespace promenade
