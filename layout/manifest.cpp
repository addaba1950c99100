#include "layout/manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "codec/frame.h"
#include "layout/model_folder.h"

namespace promenade {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "promenade model";
constexpr std::string_view kChecksumField = "\n \"checksum\": \"";

Json json_of(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }

Result<uint64_t> parse_hex(std::string_view text, const char* field) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.size() != 16 || error != std::errc() || end != text.data() + text.size())
    return Error{fmt::format("\"{}\" is not 16 hexadecimal digits", field)};
  return value;
}

/// Reads fields of one object; remembers the first that is missing or of another type.
class FieldReader {
 public:
  FieldReader(const Json& object, std::string where) : object_(object), where_(std::move(where)) {}

  template <class T>
  void read(const char* name, T& into) {
    if (!error_.empty()) return;
    const auto it = object_.find(name);
    if (it == object_.end()) {
      error_ = fmt::format("{}\"{}\" is missing", where_, name);
    } else if (!convert(*it, into)) {
      error_ = fmt::format("{}\"{}\" is {}, which it must not be", where_, name, it->type_name());
    }
  }

  const std::string& error() const { return error_; }

 private:
  static bool convert(const Json& json, std::string& into) {
    if (json.is_string()) into = json.get<std::string>();
    return json.is_string();
  }
  static bool convert(const Json& json, uint64_t& into) {
    if (json.is_number_unsigned()) into = json.get<uint64_t>();
    return json.is_number_unsigned();
  }
  static bool convert(const Json& json, glm::dvec3& into) {
    if (!json.is_array() || json.size() != 3) return false;
    for (size_t i = 0; i < 3; ++i) {
      if (!json[i].is_number() || !std::isfinite(json[i].get<double>())) return false;
      into[static_cast<int>(i)] = json[i].get<double>();
    }
    return true;
  }
  template <class T>
  static bool convert(const Json& json, std::vector<T>& into) {
    if (!json.is_array()) return false;
    for (const Json& element : json)
      if (!convert(element, into.emplace_back())) return false;
    return true;
  }
  template <class T>
  static bool convert(const Json& json, std::map<std::string, T>& into) {
    if (!json.is_object()) return false;
    for (const auto& [key, element] : json.items())
      if (!convert(element, into[key])) return false;
    return true;
  }
  static bool convert(const Json& json, ModelManifest::File& into) {
    FieldReader reader(json, "");
    if (!json.is_object()) return false;
    reader.read("name", into.name);
    reader.read("bytes", into.bytes);
    return reader.error().empty();
  }

  const Json& object_;
  std::string where_;
  std::string error_;
};

/// The text up to the checksum, if it is what the checksum says.
Status check_text(std::string_view text) {
  const size_t at = text.rfind(kChecksumField);
  if (at == std::string_view::npos || text.size() < at + kChecksumField.size() + 16)
    return Error{"\"checksum\" is missing at the end; the file is truncated"};
  const Result<uint64_t> stored = parse_hex(text.substr(at + kChecksumField.size(), 16), "checksum");
  if (!stored) return stored.error();
  if (text.substr(at + kChecksumField.size() + 16) != "\"\n}\n") return Error{"something follows \"checksum\""};
  if (const uint64_t found = checksum(std::as_bytes(std::span(text.substr(0, at)))); found != *stored)
    return Error{fmt::format("checksum {:016x} != {:016x}; the file was changed after the build", found, *stored)};
  return Done{};
}

Result<StoredManifest> read_fields(const Json& json) {
  StoredManifest stored;
  ModelManifest& m = stored.manifest;
  std::string input_hash, tables_checksum, codec;
  FieldReader reader(json, "");
  reader.read("tool_version", m.tool_version);
  reader.read("input_hash", input_hash);
  reader.read("origin_m", m.origin);
  reader.read("world_min_m", m.world_box.min);
  reader.read("world_max_m", m.world_box.max);
  reader.read("source_triangles", m.source_triangles);
  reader.read("geometry_codec", codec);
  reader.read("files", m.files);
  reader.read("tables_checksum", tables_checksum);
  reader.read("settings", m.settings);
  reader.read("sources", m.sources);
  reader.read("import_counts", m.import_counts);
  reader.read("notes", m.notes);
  if (!reader.error().empty()) return Error{reader.error()};
  const Result<uint64_t> hash = parse_hex(input_hash, "input_hash"),
                         tables = parse_hex(tables_checksum, "tables_checksum");
  if (!hash) return hash.error();
  if (!tables) return tables.error();
  const std::optional<GeometryCodec> named = geometry_codec_named(codec);
  if (!named) return Error{fmt::format("\"geometry_codec\" is \"{}\", which this program does not know", codec)};
  m.input_hash = *hash;
  stored.tables_checksum = *tables;
  m.geometry_codec = *named;
  return stored;
}

}  // namespace

std::string manifest_text(const StoredManifest& stored) {
  const ModelManifest& m = stored.manifest;
  Json json;
  json["format"] = kFormat;
  const bool objects =
      std::any_of(m.files.begin(), m.files.end(), [](const auto& f) { return f.name == kObjectsName; });
  json["version"] = objects ? ModelManifest::kVersion : ModelManifest::kVersionPlain;
  json["tool_version"] = m.tool_version;
  json["input_hash"] = fmt::format("{:016x}", m.input_hash);
  json["origin_m"] = json_of(m.origin);
  json["world_min_m"] = json_of(m.world_box.min);
  json["world_max_m"] = json_of(m.world_box.max);
  json["source_triangles"] = m.source_triangles;
  json["geometry_codec"] = name_of(m.geometry_codec);
  json["files"] = Json::array();
  for (const ModelManifest::File& file : m.files) json["files"].push_back({{"name", file.name}, {"bytes", file.bytes}});
  json["tables_checksum"] = fmt::format("{:016x}", stored.tables_checksum);
  json["settings"] = m.settings;
  json["sources"] = m.sources;
  json["import_counts"] = m.import_counts;
  json["notes"] = m.notes;
  // Names of files are any bytes, JSON is UTF-8: what is not becomes a replacement character.
  std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace);
  text.resize(text.size() - 2);  // the closing brace and the line before it
  text += ",";
  const uint64_t sum = checksum(std::as_bytes(std::span(text)));
  return text + std::string(kChecksumField) + fmt::format("{:016x}\"\n}}\n", sum);
}

Result<StoredManifest> parse_manifest(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) return Error{"no JSON object; the file is damaged or truncated"};
  const auto format = json.find("format");
  if (format == json.end() || *format != kFormat) return Error{fmt::format("\"format\" is not \"{}\"", kFormat)};
  const auto version = json.find("version");
  if (version == json.end() || !version->is_number_unsigned()) return Error{"\"version\" is missing"};
  if (version->get<uint64_t>() < ModelManifest::kVersionPlain || version->get<uint64_t>() > ModelManifest::kVersion)
    return Error{
        fmt::format("version {} of the model's format, this program reads {}; use the program that wrote it, "
                    "or build again",
                    version->get<uint64_t>(), ModelManifest::kVersion)};
  PROMENADE_TRY(check_text(text));
  return read_fields(json);
}

}  // namespace promenade
