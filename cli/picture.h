#pragma once
// Pictures that commands write: what of a frame, and in which file.

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "runtime/renderer.h"

namespace promenade {

enum class Aov : uint8_t { color, depth, node };
Result<Aov> parse_aov(const std::string& text);

/// A frame as it left the renderer; only the planes that were asked for are there.
struct Frame {
  uint32_t width_px = 0, height_px = 0;
  Image color;
  std::vector<float> depth_m;   ///< along the view axis; +infinity: nothing
  std::vector<uint32_t> nodes;  ///< 0xffffffff: nothing
};

/// Reads the renderer's last frame: its colour, depth or node ids (depth always when with_depth).
Result<Frame> read_frame(Renderer& renderer, uint32_t width_px, uint32_t height_px, Aov aov, bool with_depth = false);

/// Writes one plane, atomically. colour: .png, .jpg; depth, node: .exr, .tif. Another ending is an error that says so.
Status write_frame(const Frame& frame, Aov aov, const std::filesystem::path& path);

/// Whether write_frame would take the ending, before anything is drawn.
Status check_picture_name(Aov aov, const std::filesystem::path& path);

/// A folder and those above it, made where they are not there.
Status make_folder(const std::filesystem::path& path);

/// "walk.png" and 7 of 1800 to "walk_0007.png".
std::filesystem::path numbered(const std::filesystem::path& path, uint32_t index, uint32_t count);

}  // namespace promenade
