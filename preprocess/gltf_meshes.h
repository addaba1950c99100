#pragma once
// Meshes of glTF: each becomes one Mesh of all its triangle primitives.

#include <cstdint>
#include <vector>

#include "geometry/job_monitor.h"

#include "preprocess/gltf_document.h"
#include "preprocess/gltf_materials.h"
#include "preprocess/scene.h"

namespace promenade {

/// Reads mesh after mesh into the scene. Two glTF meshes with the same primitives are read once: mesh_of[i] is the
/// scene's mesh for glTF mesh i. Adds a material for primitives that have none. Counts what it leaves out
/// (primitives_skipped: points and lines; faces_dropped: indices out of range).
Status read_gltf_meshes(GltfDocument& document, const std::vector<GltfTexcoords>& texcoords, Scene& scene,
                        std::vector<uint32_t>& mesh_of, JobMonitor& monitor);

}  // namespace promenade
