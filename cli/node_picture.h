#pragma once
// Pictures that show which node is where: what checks and studies of visibility are explained with.

#include <filesystem>
#include <functional>

#include "preprocess/visibility/node_meshes.h"

namespace promenade {

/// Draws the nodes through the view, each in its colour, darker where the surface is farther away, and writes a PNG.
/// color_of: by index into nodes. marked: a box drawn as its outline (in plan views: the cell); may be empty.
Status write_node_picture(const NodeMeshes& meshes, std::span<const NodeId> nodes, const RasterView& view,
                          const std::function<glm::u8vec3(size_t)>& color_of, const Box& marked,
                          const std::filesystem::path& path);

/// Straight from above, the whole box in the picture, side_px on its longer side.
RasterView plan_view(const Box& box, uint32_t side_px);

}  // namespace promenade
