#include "preprocess/import_uri.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace promenade {

namespace fs = std::filesystem;

namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool escape =
        text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0;
    if (escape) {
      out.push_back(static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2])));
      i += 2;
    } else {
      out.push_back(text[i]);
    }
  }
  return out;
}

bool is_below(const fs::path& path, const fs::path& folder) {
  const auto [folder_end, path_end] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return folder_end == folder.end() && path_end != path.end();
}

}  // namespace

Result<fs::path> resolve_reference(const fs::path& folder, std::string_view reference, bool encoded) {
  const std::string text = encoded ? percent_decoded(reference) : std::string(reference);
  if (text.empty() || text.find('\0') != std::string::npos) return Error{"names no file"};
  const size_t colon = text.find(':');
  if (colon != std::string::npos && colon < text.find('/')) return Error{"is no plain relative path"};
  const fs::path relative = fs::path(text).lexically_normal();
  if (relative.is_absolute() || *relative.begin() == "..") return Error{"leaves the source's folder"};
  std::error_code error;
  const fs::path home = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  if (error) return Error{fmt::format("is in a folder that cannot be read ({})", error.message())};
  const fs::path path = fs::canonical(home / relative, error);
  if (error) return Error{error == std::errc::no_such_file_or_directory ? "is not there" : error.message()};
  if (!is_below(path, home)) return Error{"leads out of the source's folder by a link"};
  if (!fs::is_regular_file(path, error)) return Error{"is no plain file"};
  return path;
}

Result<fs::path> resolve_picture(const fs::path& folder, std::string_view reference) {
  std::string text(reference);
  std::replace(text.begin(), text.end(), '\\', '/');
  Result<fs::path> found = resolve_reference(folder, text, false);
  if (found.ok()) return found;
  const size_t slash = text.rfind('/');
  if (slash == std::string::npos || slash + 1 == text.size()) return found;
  Result<fs::path> beside = resolve_reference(folder, text.substr(slash + 1), false);
  return beside.ok() ? beside : found;
}

bool is_data_uri(std::string_view uri) { return uri.substr(0, 5) == "data:"; }

std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri) {
  constexpr std::string_view kMark = ";base64,";
  const size_t mark = uri.substr(0, 256).find(kMark);  // a media type is short
  if (!is_data_uri(uri) || mark == std::string_view::npos) return std::nullopt;
  std::vector<std::byte> out;
  out.reserve((uri.size() - mark) / 4 * 3);
  uint32_t bits = 0;
  int count = 0;
  for (const char c : uri.substr(mark + kMark.size())) {
    uint32_t value = 0;
    if (c >= 'A' && c <= 'Z')
      value = static_cast<uint32_t>(c - 'A');
    else if (c >= 'a' && c <= 'z')
      value = static_cast<uint32_t>(c - 'a' + 26);
    else if (c >= '0' && c <= '9')
      value = static_cast<uint32_t>(c - '0' + 52);
    else if (c == '+' || c == '-')
      value = 62;
    else if (c == '/' || c == '_')
      value = 63;
    else if (c == '=')
      break;
    else
      return std::nullopt;
    bits = (bits << 6) | value;
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out.push_back(static_cast<std::byte>((bits >> count) & 0xffU));
  }
  return out;
}

}  // namespace promenade
