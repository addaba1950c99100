#pragma once
// The last stage: all work units into one model.

#include "layout/model_io.h"
#include "preprocess/survey.h"
#include "preprocess/texture_store.h"
#include "preprocess/tree_units.h"

namespace promenade {

struct AssembledModel {
  ModelTables tables;
  ModelObjects objects;
};

/// Appends shared textures, then nodes, each after its parent and beside its siblings: first a node's children, then
/// the children of the first of them, so that going into detail reads on where it is. Fills in all tables. Objects that
/// move come last, their nodes' boxes as swept.
/// materials: what nodes' meshes index (MaterialBase::materials). Errors: the disk, cancellation.
Result<AssembledModel> assemble_model(const TreeUnits& units, const Survey& survey, const TextureStore& textures,
                                      const std::vector<Material>& materials, GeometryCodec codec,
                                      const WorkFolder& folder, ModelWriter& writer, JobMonitor& monitor);

}  // namespace promenade
