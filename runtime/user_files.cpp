#include "runtime/user_files.h"

#include <cstdlib>

namespace promenade {

std::filesystem::path user_file(const char* variable, const char* fallback, const std::string& name) {
  const auto absolute = [](const char* of) {
    const char* value = std::getenv(of);
    const std::filesystem::path path = value == nullptr ? "" : value;
    return path.is_absolute() ? path : std::filesystem::path();  // relative ones are to be ignored
  };
  std::filesystem::path folder = absolute(variable);
  if (folder.empty() && !absolute("HOME").empty()) folder = absolute("HOME") / fallback;
  return folder.empty() ? folder : folder / "promenade" / name;
}

}  // namespace promenade
