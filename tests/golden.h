#pragma once
// Files under tests/golden: bytes of each version of a format, and sizes, so that a change is a reviewed difference.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace promenade {

inline std::filesystem::path golden_path(const std::string& name) {
  return std::filesystem::path(PROMENADE_SOURCE_DIR) / "tests" / "golden" / name;
}

inline std::string golden_text(const std::string& name) {
  std::ifstream in(golden_path(name), std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline std::vector<std::byte> golden_bytes(const std::string& name) {
  const std::string text = golden_text(name);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// Compares with the file. With PROMENADE_UPDATE_GOLDEN set, writes it instead: look at the difference, then commit.
inline void expect_golden(const std::string& name, std::string_view actual) {
  if (std::getenv("PROMENADE_UPDATE_GOLDEN") != nullptr) {
    std::ofstream(golden_path(name), std::ios::binary) << actual;
    return;
  }
  EXPECT_TRUE(golden_text(name) == actual)
      << "tests/golden/" << name << " differs; set PROMENADE_UPDATE_GOLDEN=1 to write it anew";
}

inline void expect_golden(const std::string& name, std::span<const std::byte> actual) {
  expect_golden(name, std::string_view(reinterpret_cast<const char*>(actual.data()), actual.size()));
}

}  // namespace promenade
