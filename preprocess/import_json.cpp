#include "preprocess/import_json.h"

#include <fmt/format.h>

#include <cmath>
#include <new>

namespace promenade {

namespace {

constexpr int kMaxDepth = 200;  // bounds recursion and memory on hostile input; real files stay below 20

/// Byte at which nesting gets too deep, or npos.
size_t find_too_deep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxDepth) return i;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return std::string_view::npos;
}

const Json& null_value() {
  static const Json value;
  return value;
}

}  // namespace

Result<Json> parse_json(std::string_view text, const std::string& name) {
  if (const size_t at = find_too_deep(text); at != std::string_view::npos)
    return Error{
        fmt::format("{}: JSON byte {}: nested deeper than {} levels; the file is broken", name, at, kMaxDepth)};
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& error) {
    return Error{fmt::format("{}: JSON byte {}: not valid JSON; the file is cut off or broken", name, error.byte)};
  } catch (const Json::exception&) {
    return Error{fmt::format("{}: JSON holds a number that is out of range; the file is broken", name)};
  } catch (const std::bad_alloc&) {
    return Error{fmt::format("{}: JSON of {} bytes does not fit into memory", name, text.size())};
  }
}

const Json& member(const Json& object, const char* key) {
  if (!object.is_object()) return null_value();
  const auto found = object.find(key);
  return found == object.end() ? null_value() : *found;
}

const Json& element(const Json& array, uint64_t index) {
  return array.is_array() && index < array.size() ? array[index] : null_value();
}

std::optional<uint64_t> whole(const Json& value) {
  if (value.is_number_unsigned()) return value.get<uint64_t>();
  if (!value.is_number_float()) return std::nullopt;
  const double v = value.get<double>();  // some exporters write 3.0
  if (!(v >= 0 && v <= 9007199254740992.0) || v != std::floor(v)) return std::nullopt;
  return static_cast<uint64_t>(v);
}

double number(const Json& value, double fallback) { return value.is_number() ? value.get<double>() : fallback; }

std::string text(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }

bool truth(const Json& value) { return value.is_boolean() && value.get<bool>(); }

bool numbers(const Json& array, std::span<double> into) {
  if (!array.is_array() || array.size() < into.size()) return false;
  for (size_t i = 0; i < into.size(); ++i)
    if (!array[i].is_number()) return false;
  for (size_t i = 0; i < into.size(); ++i) into[i] = array[i].get<double>();
  return true;
}

}  // namespace promenade
