#pragma once
// What the fuzz targets of import share: the bytes become a file, the file is imported, and what comes must be sound.

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "preprocess/import.h"

namespace promenade {

/// Imports the bytes as a file with this extension; aborts on an unsound scene or an error of several lines.
inline int fuzz_import(const char* extension, const uint8_t* data, size_t size) {
  static const std::filesystem::path path =
      std::filesystem::path("/dev/shm") / ("fuzz_import_" + std::to_string(getpid()) + extension);
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  JobMonitor monitor;
  const Result<Scene> scene = import_part({path, path.filename().string(), size}, {}, monitor);
  if (!scene.ok()) {
    if (scene.error().message.find('\n') != std::string::npos) std::abort();
    return 0;
  }
  for (const Mesh& mesh : scene->meshes)
    if (!find_defect(mesh).empty()) std::abort();
  for (const SceneInstance& instance : scene->instances)
    if (instance.mesh >= scene->meshes.size()) std::abort();
  return 0;
}

}  // namespace promenade
