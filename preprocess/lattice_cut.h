#pragma once
// Cutting large triangles along a lattice of planes, so that every piece can go to one node whole.

#include "geometry/mesh.h"

namespace promenade {

/// Cuts triangles along the planes that lie at whole multiples of step_m on each axis. Only edges longer than step_m
/// are cut, and where depends on their two ends alone: triangles that share an edge still share its pieces, whatever
/// meshes, chunks and nodes they are in, so that nothing opens between them. Edges of more than 64 steps are cut by
/// every second plane, every fourth and so on, which bounds the number of pieces.
///
/// step_m: a power of two; 0: nothing is cut. Attributes are interpolated, winding and materials are kept. A cut
/// triangle's first piece keeps its index; others are added at the end. Deterministic. Pure; any thread.
/// Source: [lakhia2004] section 3.2.
void cut_along_lattice(Mesh& mesh, float step_m);

}  // namespace promenade
