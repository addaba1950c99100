#pragma once
// JSON of unknown origin: parsed within bounds, and read without exceptions and without trusting any type.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "geometry/result.h"

namespace promenade {

using Json = nlohmann::json;

/// Parses UTF-8 text (a byte order mark is skipped). Errors name the file (`name`) and the byte: syntax, or nesting
/// deeper than any real file's (a bomb).
Result<Json> parse_json(std::string_view text, const std::string& name);

/// The member of an object, or a null when it is absent or `object` is none. The reference lives as long as `object`.
const Json& member(const Json& object, const char* key);
/// The element of an array, or a null.
const Json& element(const Json& array, uint64_t index);

/// A whole number from 0; nullopt: absent, or anything else.
std::optional<uint64_t> whole(const Json& value);
double number(const Json& value, double fallback);
std::string text(const Json& value);
bool truth(const Json& value);

/// Fills `into` from an array of at least as many numbers; false: it is none, and `into` keeps what it had.
bool numbers(const Json& array, std::span<double> into);

}  // namespace promenade
