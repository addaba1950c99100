#include "cli/picture.h"

#include <fmt/format.h>

#include <algorithm>

#include "codec/image_codec.h"
#include "layout/file_io.h"

namespace promenade {
namespace {

std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

bool is_jpeg(const std::string& ending) { return ending == ".jpg" || ending == ".jpeg"; }

}  // namespace

Result<Aov> parse_aov(const std::string& text) {
  if (text == "color") return Aov::color;
  if (text == "depth") return Aov::depth;
  if (text == "node") return Aov::node;
  return Error{fmt::format("\"{}\" is nothing a picture can show: color, depth or node", text)};
}

Result<Frame> read_frame(Renderer& renderer, uint32_t width_px, uint32_t height_px, Aov aov, bool with_depth) {
  Frame frame{width_px, height_px, {}, {}, {}};
  if (aov == Aov::color) {
    Result<Image> color = renderer.read_color();
    if (!color) return color.error();
    frame.color = std::move(*color);
  }
  if (aov == Aov::depth || with_depth) {
    Result<std::vector<float>> depth = renderer.read_depth();
    if (!depth) return depth.error();
    frame.depth_m = std::move(*depth);
  }
  if (aov == Aov::node) {
    Result<std::vector<uint32_t>> nodes = renderer.read_nodes();
    if (!nodes) return nodes.error();
    frame.nodes = std::move(*nodes);
  }
  return frame;
}

Status check_picture_name(Aov aov, const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  if (aov == Aov::color) {
    if (ending == ".png" || is_jpeg(ending)) return Done{};
    return Error{fmt::format("{}: a colour picture ends in .png or .jpg", path.string())};
  }
  if (ending == ".exr" || ending == ".tif" || ending == ".tiff") return Done{};
  return Error{
      fmt::format("{}: a picture of {} ends in .exr or .tif", path.string(), aov == Aov::depth ? "depth" : "node ids")};
}

Status write_frame(const Frame& frame, Aov aov, const std::filesystem::path& path) {
  PROMENADE_TRY(check_picture_name(aov, path));
  const std::string ending = ending_of(path);
  const auto encode = [&] {
    switch (aov) {
      case Aov::depth:
        return encode_float_image(frame.depth_m, frame.width_px, frame.height_px, ending);
      case Aov::node:
        return encode_id_image(frame.nodes, frame.width_px, frame.height_px, ending);
      case Aov::color:
        break;
    }
    return encode_image(frame.color, is_jpeg(ending) ? ImageFormat::jpeg : ImageFormat::png);
  };
  const Result<std::vector<std::byte>> bytes = encode();
  if (!bytes) return Error{fmt::format("{}: {}", path.string(), bytes.error().message)};
  return write_file(path, std::span<const std::byte>(*bytes));
}

Status make_folder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return Error{fmt::format("{}: cannot make the folder: {}", path.string(), error.message())};
  return Done{};
}

std::filesystem::path numbered(const std::filesystem::path& path, uint32_t index, uint32_t count) {
  const size_t digits = std::max<size_t>(4, fmt::format("{}", count > 0 ? count - 1 : 0).size());
  return path.parent_path() /
         fmt::format("{}_{:0{}}{}", path.stem().string(), index, digits, path.extension().string());
}

}  // namespace promenade
