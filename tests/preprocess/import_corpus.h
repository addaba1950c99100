#pragma once
// One small sound file of each format and feature: where mutations start.

#include <random>
#include <string>
#include <vector>

namespace promenade {

struct CorpusFile {
  std::string name;
  std::string bytes;
  bool cheap = true;  ///< read in this process; otherwise a process starts each time
};

inline void PrintTo(const CorpusFile& file, std::ostream* out) { *out << file.name; }  // NOLINT: gtest's name

std::vector<CorpusFile> import_corpus();

/// A few bytes changed, runs copied, digits grown; never the same length necessarily.
std::string mutated(std::string bytes, std::mt19937& random);

}  // namespace promenade
