#pragma once
// References from a source file to files beside it: a hostile file must not make us read anything else.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/result.h"

namespace promenade {

/// The file that a reference (percent-encoded when `encoded`) names, which must be a regular file in `folder` or below.
/// Errors say why it is refused: absolute, another scheme, outside the folder, absent, no plain file.
Result<std::filesystem::path> resolve_reference(const std::filesystem::path& folder, std::string_view reference,
                                                bool encoded);

/// As resolve_reference, for pictures that exporters name by paths of their own machine: backslashes are slashes, and
/// where the path leads nowhere the bare file name is tried in `folder`.
Result<std::filesystem::path> resolve_picture(const std::filesystem::path& folder, std::string_view reference);

/// Payload of a base64 data: URI; nullopt: not one. Whether it is one: is_data_uri.
bool is_data_uri(std::string_view uri);
std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri);

}  // namespace promenade
