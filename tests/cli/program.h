#pragma once
// Runs build/promenade as a user would.

#include <filesystem>
#include <string>

#include "tests/temporary_folder.h"

namespace promenade {

struct ProgramRun {
  int exit_code = -1;
  std::string out, err;
};

/// Runs the program with shell words, in `folder`; bounded in time. environment: "NAME=value ..." besides the test's.
ProgramRun run_program(const std::string& words, const std::filesystem::path& folder,
                       const std::string& environment = "");

void write_text(const std::filesystem::path& path, const std::string& text);
std::string read_text(const std::filesystem::path& path);

}  // namespace promenade
