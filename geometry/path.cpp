#include "geometry/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace promenade {

uint32_t CameraPath::frame_count() const {
  return keys.empty() ? 0 : static_cast<uint32_t>(std::floor(duration_s() * fps + 1e-6)) + 1;
}

Pose pose_at(const CameraPath& path, double t_s) {
  if (path.keys.empty()) return {};
  const auto after = std::upper_bound(path.keys.begin(), path.keys.end(), t_s,
                                      [](double t, const CameraPath::Key& key) { return t < key.t_s; });
  if (after == path.keys.begin()) return path.keys.front().pose;
  if (after == path.keys.end()) return path.keys.back().pose;
  const CameraPath::Key& a = *(after - 1);
  const CameraPath::Key& b = *after;
  const double u = (t_s - a.t_s) / (b.t_s - a.t_s);
  const auto mix = [u](auto x, auto y) { return x + (y - x) * u; };
  return {mix(a.pose.eye, b.pose.eye), mix(a.pose.yaw_deg, b.pose.yaw_deg), mix(a.pose.pitch_deg, b.pose.pitch_deg),
          mix(a.pose.roll_deg, b.pose.roll_deg)};
}

CameraPath stops_along(const CameraPath& path, double stay_s, double seconds) {
  CameraPath stops;
  stops.fps = path.fps;
  if (path.keys.empty()) return stops;
  const double frame_s = 1 / path.fps, whole_s = seconds > 0 ? seconds : path.duration_s();
  const double stay = std::max(std::round(stay_s * path.fps), 1.0) * frame_s;
  const auto count = static_cast<size_t>(std::clamp(std::floor(whole_s / stay + 1e-9), 1.0, 1e6));
  stops.keys.reserve(2 * count);
  for (size_t i = 0; i < count; ++i) {
    const double at = count > 1 ? double(i) / double(count - 1) * path.duration_s() : 0;
    const Pose pose = pose_at(path, path.keys.front().t_s + at);
    const double from = double(i) * stay;
    stops.keys.push_back({from, pose});
    if (stay > 1.5 * frame_s) stops.keys.push_back({from + stay - frame_s, pose});
  }
  return stops;
}

Pose pose_of_frame(const CameraPath& path, uint32_t frame) {
  return path.keys.empty() ? Pose{} : pose_at(path, path.keys.front().t_s + double(frame) / path.fps);
}

namespace {

Result<double> number(const nlohmann::json& object, const char* name, double missing, const std::string& where) {
  const auto it = object.find(name);
  if (it == object.end()) return missing;
  if (!it->is_number() || !std::isfinite(it->get<double>()))
    return Error{fmt::format("{}: \"{}\" is no finite number", where, name)};
  return it->get<double>();
}

Result<CameraPath::Key> parse_key(const nlohmann::json& json, const std::string& where) {
  if (!json.is_object() || !json.contains("t") || !json.contains("eye"))
    return Error{where + ": a key needs \"t\" and \"eye\": [x, y, z]"};
  const nlohmann::json& eye = json["eye"];
  if (!eye.is_array() || eye.size() != 3) return Error{where + ": \"eye\" must be [x, y, z] in metres"};
  CameraPath::Key key;
  for (int i = 0; i < 3; ++i) {
    const nlohmann::json& c = eye[static_cast<size_t>(i)];
    if (!c.is_number() || !std::isfinite(c.get<double>()))
      return Error{where + ": \"eye\" holds something that is no finite number"};
    key.pose.eye[i] = c.get<double>();
  }
  const std::pair<const char*, double*> fields[] = {{"t", &key.t_s},
                                                    {"yaw_deg", &key.pose.yaw_deg},
                                                    {"pitch_deg", &key.pose.pitch_deg},
                                                    {"roll_deg", &key.pose.roll_deg}};
  for (const auto& [name, target] : fields) {
    const Result<double> value = number(json, name, 0.0, where);
    if (!value) return value.error();
    *target = *value;
  }
  return key;
}

}  // namespace

Result<CameraPath> parse_path(std::string_view text, const std::string& name) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object())
    return Error{name + ": not a JSON object; a camera path is {\"fps\": 30, \"keys\": [...]}"};
  CameraPath path;
  const Result<double> fps = number(json, "fps", 30.0, name);
  if (!fps) return fps.error();
  if (*fps <= 0 || *fps > 1000)
    return Error{fmt::format("{}: \"fps\" is {}, must be above 0 and at most 1000", name, *fps)};
  path.fps = *fps;
  const auto keys = json.find("keys");
  if (keys == json.end() || !keys->is_array() || keys->empty())
    return Error{name + ": no \"keys\": a camera path needs at least one"};
  for (size_t i = 0; i < keys->size(); ++i) {
    const Result<CameraPath::Key> key = parse_key((*keys)[i], fmt::format("{}: key {}", name, i));
    if (!key) return key.error();
    if (i > 0 && key->t_s <= path.keys.back().t_s)
      return Error{fmt::format("{}: key {}: t {} does not come after {}", name, i, key->t_s, path.keys.back().t_s)};
    path.keys.push_back(*key);
  }
  if (path.duration_s() * path.fps > 1e7) return Error{name + ": more than ten million frames"};
  return path;
}

std::string to_json(const CameraPath& path) {
  nlohmann::ordered_json json;
  json["fps"] = path.fps;
  json["keys"] = nlohmann::ordered_json::array();
  for (const CameraPath::Key& key : path.keys) {
    nlohmann::ordered_json k = {{"t", key.t_s},
                                {"eye", {key.pose.eye.x, key.pose.eye.y, key.pose.eye.z}},
                                {"yaw_deg", key.pose.yaw_deg},
                                {"pitch_deg", key.pose.pitch_deg}};
    if (key.pose.roll_deg != 0) k["roll_deg"] = key.pose.roll_deg;
    json["keys"].push_back(k);
  }
  return json.dump(1) + "\n";
}

}  // namespace promenade
