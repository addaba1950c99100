#pragma once
// Which class the triangles of a mesh are of, told by runs: objects follow each other.

#include <cstdint>
#include <vector>

namespace promenade {

/// The next so many triangles are of a class.
struct ClassRun {
  uint32_t class_index = 0;  ///< into Survey::classes
  uint32_t triangles = 0;
};

inline void add_run(std::vector<ClassRun>& runs, uint32_t class_index, uint64_t triangles) {
  if (!runs.empty() && runs.back().class_index == class_index)
    runs.back().triangles += static_cast<uint32_t>(triangles);
  else
    runs.push_back({class_index, static_cast<uint32_t>(triangles)});
}

/// How much of a leaf is of a class.
struct ClassArea {
  uint32_t class_index = 0;
  float area_m2 = 0;
};

}  // namespace promenade
