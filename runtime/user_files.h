#pragma once
// Where the program keeps what it remembers for a user, as the XDG base directory specification asks.

#include <filesystem>
#include <string>

namespace promenade {

/// $VARIABLE/promenade/NAME, or below ~/FALLBACK; empty where there is neither. VARIABLE: "XDG_CACHE_HOME" with
/// ".cache", "XDG_CONFIG_HOME" with ".config".
std::filesystem::path user_file(const char* variable, const char* fallback, const std::string& name);

}  // namespace promenade
