#include "runtime/viewer_settings.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "layout/file_io.h"
#include "runtime/user_files.h"

namespace promenade {
namespace {

using Json = nlohmann::ordered_json;
constexpr uint64_t kLargestFile = uint64_t(1) << 24;

Json read_json(const std::filesystem::path& file) {
  const Result<std::string> text = read_text_file(file, kLargestFile);
  if (!text) return Json::object();
  Json json = Json::parse(*text, nullptr, false);
  return json.is_object() ? json : Json::object();
}

template <class T>
std::optional<T> value_of(const Json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end()) return std::nullopt;
  if constexpr (std::is_same_v<T, bool>) {
    if (!found->is_boolean()) return std::nullopt;
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (!found->is_string()) return std::nullopt;
  } else {
    if (!found->is_number() || !(found->get<double>() > 0) || !std::isfinite(found->get<double>())) return std::nullopt;
  }
  return found->get<T>();
}

std::optional<Pose> pose_of(const Json& json) {
  if (!json.is_array() || json.size() != 6) return std::nullopt;
  double v[6];
  for (size_t i = 0; i < 6; ++i) {
    if (!json[i].is_number() || !std::isfinite(json[i].get<double>())) return std::nullopt;
    v[i] = json[i].get<double>();
  }
  return Pose{{v[0], v[1], v[2]}, v[3], v[4], v[5]};
}

}  // namespace

std::filesystem::path viewer_settings_file() { return user_file("XDG_CONFIG_HOME", ".config", "viewer.json"); }

ViewerSettings read_viewer_settings(const std::filesystem::path& file, const std::string& model) {
  const Json json = file.empty() ? Json::object() : read_json(file);
  ViewerSettings s;
  s.speed_m_per_s = value_of<double>(json, "speed_m_per_s");
  s.on_foot = value_of<bool>(json, "on_foot"), s.panel = value_of<bool>(json, "panel");
  s.textures = value_of<bool>(json, "textures");
  s.policy = value_of<std::string>(json, "policy");
  s.pixel_error = value_of<double>(json, "pixel_error"), s.target_ms = value_of<double>(json, "target_ms");
  const auto models = json.find("bookmarks");
  if (models == json.end() || !models->is_object() || !models->contains(model)) return s;
  const Json& own = (*models)[model];
  if (!own.is_object()) return s;
  for (int number = 1; number <= 9; ++number)
    if (const auto found = own.find(std::to_string(number)); found != own.end())
      if (const std::optional<Pose> pose = pose_of(*found)) s.bookmarks[number] = *pose;
  return s;
}

Status write_viewer_settings(const ViewerSettings& s, const std::filesystem::path& file, const std::string& model) {
  Json json = read_json(file);
  const auto put = [&json](const char* name, const auto& value) {
    if (value) json[name] = *value;
  };
  put("speed_m_per_s", s.speed_m_per_s), put("on_foot", s.on_foot), put("panel", s.panel), put("textures", s.textures);
  put("policy", s.policy), put("pixel_error", s.pixel_error), put("target_ms", s.target_ms);
  if (!json["bookmarks"].is_object()) json["bookmarks"] = Json::object();
  Json own = Json::object();
  for (const auto& [number, p] : s.bookmarks)
    own[std::to_string(number)] = {p.eye.x, p.eye.y, p.eye.z, p.yaw_deg, p.pitch_deg, p.roll_deg};
  if (own.empty())
    json["bookmarks"].erase(model);
  else
    json["bookmarks"][model] = own;
  std::error_code ignored;  // write_file says what is wrong
  std::filesystem::create_directories(file.parent_path(), ignored);
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  return write_file(file, std::string_view(text));
}

}  // namespace promenade
