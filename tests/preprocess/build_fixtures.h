#pragma once
// Small sources for the tests of the build, and what they check of a model.

#include <filesystem>
#include <map>
#include <string>

#include "layout/model_io.h"
#include "preprocess/build.h"
#include "tests/preprocess/import_fixtures.h"

namespace promenade {

/// A mesh as OBJ text, z up: positions, normals and texture coordinates where it has them. vertices_before: how many
/// the file has already.
std::string obj_text(const Mesh& mesh, const std::string& header = "", size_t vertices_before = 0);

/// Options for tests: nodes of 300 triangles, chunks of 4000, z up, two threads.
BuildOptions small_build(const std::filesystem::path& source, const std::filesystem::path& model);

/// Every file of a folder by name.
std::map<std::string, std::vector<std::byte>> bytes_of(const std::filesystem::path& folder);

/// The node's mesh; fails the test where it cannot be read.
Mesh mesh_of(const ModelReader& reader, uint32_t node);

/// The leaves below a node, itself if it is one.
std::vector<uint32_t> leaves_below(const Model& model, uint32_t node);

}  // namespace promenade
