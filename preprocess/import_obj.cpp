// Wavefront OBJ and MTL. tinyobjloader reads the materials; it does not read the geometry, because Debian's is compiled
// for floats (UTM coordinates would lose their decimetres), cuts polygons at 255 corners and gives up on a whole
// file for one bad index.
//
// MTL's colours are taken as sRGB, as the programs that write them show them. Objects: a mesh for each `o` or `g`.

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "preprocess/import_builder.h"
#include "preprocess/import_index_table.h"
#include "preprocess/import_readers.h"
#include "preprocess/import_text.h"
#include "preprocess/import_uri.h"

namespace promenade {

namespace fs = std::filesystem;

namespace {

constexpr uint64_t kMaxMtlBytes = uint64_t(64) << 20;
constexpr uint64_t kMaxImageBytes = uint64_t(1) << 30;
constexpr uint32_t kAbsent = 0xffffffffU;
constexpr uint64_t kLinesPerProgress = 1U << 16;

/// A face's corner: places in the file's lists, kAbsent where the file gives none.
struct Corner {
  uint32_t position, texcoord, normal;
  bool operator==(const Corner&) const = default;
};

uint8_t unit_byte(double value) {
  return static_cast<uint8_t>(std::lround(std::clamp(std::isnan(value) ? 1.0 : value, 0.0, 1.0) * 255.0));
}

class ObjReader {
 public:
  ObjReader(LineReader lines, fs::path folder, std::string name, JobMonitor& monitor)
      : lines_(std::move(lines)), folder_(std::move(folder)), name_(std::move(name)), monitor_(monitor) {}

  Result<ReadScene> read() {
    std::string_view line;
    while (lines_.next(line)) {
      if (lines_.line_number() % kLinesPerProgress == 0) {
        if (monitor_.cancelled()) return Error{"interrupted"};
        monitor_.progress("import", lines_.byte_after(), lines_.file_bytes());
      }
      if (line.empty() || line.back() != '\\') {
        read_line(line);
        continue;
      }
      std::string joined;  // a backslash at the end goes on
      while (!line.empty() && line.back() == '\\') {
        joined += line.substr(0, line.size() - 1);
        joined += ' ';
        line = {};
        if (!lines_.next(line)) break;
      }
      joined += line;
      read_line(joined);
    }
    if (!lines_.status().ok()) return lines_.status().error();
    finish_object();
    if (!saw_keyword_)
      return Error{fmt::format("{}: no line of it is OBJ; the file is of another format or broken", name_)};
    out_.up = UpAxis::y;
    out_.sides_unknown = true;
    return std::move(out_);
  }

 private:
  void read_line(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (keyword.empty() || keyword[0] == '#') return;
    if (keyword == "v")
      read_vertex(line);
    else if (keyword == "vt")
      texcoords_.push_back(read_texcoord(line));
    else if (keyword == "vn")
      normals_.emplace_back(read_numbers(line));
    else if (keyword == "f")
      read_face(line);
    else if (keyword == "o" || keyword == "g")
      start_object(line);
    else if (keyword == "usemtl")
      material_ = material_named(std::string(trimmed(line)));
    else if (keyword == "mtllib")
      read_libraries(trimmed(line));
    else if (keyword == "l" || keyword == "p" || keyword == "curv" || keyword == "surf")
      ++counts()["primitives_skipped"];
    else
      return;
    saw_keyword_ = true;
  }

  Counts& counts() { return out_.scene.report.counts; }

  /// Three numbers; what cannot be read is not a number, so that it is found and counted.
  static glm::dvec3 read_numbers(std::string_view& line) {
    glm::dvec3 out(0);
    for (int i = 0; i < 3; ++i)
      if (!parse_number(take_word(line), out[i])) out[i] = std::nan("");
    return out;
  }

  void read_vertex(std::string_view line) {
    positions_.push_back(read_numbers(line));
    glm::dvec3 color(0);
    int given = 0;
    while (given < 3 && parse_number(take_word(line), color[given])) ++given;
    if (given < 3 && colors_.empty()) return;  // none, or a weight
    colors_.resize(positions_.size(), glm::u8vec4(255));
    if (given == 3) colors_.back() = {unit_byte(color.x), unit_byte(color.y), unit_byte(color.z), 255};
  }

  static glm::vec2 read_texcoord(std::string_view& line) {
    double u = 0;
    double v = 0;
    parse_number(take_word(line), u);
    parse_number(take_word(line), v);
    return {static_cast<float>(u), static_cast<float>(1.0 - v)};  // OBJ's origin is at the bottom
  }

  /// "12", "12/3", "12//5", "12/3/5" or with negative (relative) numbers; false: no vertex that is there.
  bool read_corner(std::string_view word, Corner& corner) const {
    std::array<uint32_t, 3> places{kAbsent, kAbsent, kAbsent};
    const std::array<size_t, 3> sizes{positions_.size(), texcoords_.size(), normals_.size()};
    for (size_t i = 0; i < 3 && !word.empty(); ++i) {
      const size_t end = std::min(word.find('/'), word.size());
      int64_t value = 0;
      if (parse_number(word.substr(0, end), value)) {
        const auto size = static_cast<int64_t>(sizes[i]);
        const int64_t place = value < 0 ? size + value : value - 1;
        if (place >= 0 && place < size) places[i] = static_cast<uint32_t>(place);
      }
      word.remove_prefix(std::min(end + 1, word.size()));
    }
    corner = {places[0], places[1], places[2]};
    return corner.position != kAbsent;
  }

  void read_face(std::string_view line) {
    face_.clear();
    bool sound = true;
    for (std::string_view word = take_word(line); !word.empty() && word[0] != '#'; word = take_word(line)) {
      Corner corner{};
      sound = read_corner(word, corner) && sound;
      if (sound) face_.push_back(vertex_of(corner));
    }
    if (!sound || face_.size() < 3) {
      ++counts()["faces_dropped"];
      return;
    }
    const std::array<uint32_t, 1> ring{static_cast<uint32_t>(face_.size())};
    if (!material_) material_ = material_named("");
    builder_.add_polygon(face_, ring, *material_, counts());
  }

  uint32_t vertex_of(const Corner& corner) {
    corners_.push_back(corner);
    const auto hash = [this](uint32_t i) {
      const Corner& c = corners_[i];
      return mixed_bits((uint64_t(c.position) << 32 | c.texcoord) ^ mixed_bits(c.normal));
    };
    const auto equal = [this](uint32_t a, uint32_t b) { return corners_[a] == corners_[b]; };
    const auto index = static_cast<uint32_t>(corners_.size() - 1);
    const uint32_t vertex = known_.find_or_add(index, hash, equal);
    if (vertex != index) {
      corners_.pop_back();
      return vertex;
    }
    SourceVertex source;
    source.position = positions_[corner.position];
    if (corner.texcoord != kAbsent) source.texcoord = texcoords_[corner.texcoord];
    if (corner.normal != kAbsent) source.normal = normals_[corner.normal];
    if (corner.position < colors_.size()) source.color = colors_[corner.position];
    return builder_.add_vertex(source);
  }

  void start_object(std::string_view line) {
    finish_object();
    object_ = std::string(trimmed(line));
  }

  void finish_object() {
    add_object(out_.scene, builder_, object_, "");
    builder_ = {};
    corners_.clear();
    known_ = IndexTable(0);
  }

  /// Index of a material; one that no library defines is plain.
  uint32_t material_named(const std::string& name) {
    const auto [place, is_new] = materials_.emplace(name, static_cast<uint32_t>(out_.scene.materials.size()));
    if (is_new) out_.scene.materials.emplace_back();
    return place->second;
  }

  void read_libraries(std::string_view line) {
    // One name, which may hold spaces, or several.
    if (read_library(line)) return;
    bool any = false;
    for (std::string_view rest = line, word = take_word(rest); !word.empty(); word = take_word(rest))
      any = (word != line && read_library(word)) || any;
    if (any) return;
    ++counts()["materials_missing"];
    out_.scene.report.warnings.push_back(fmt::format("missing material library {}", line.substr(0, 200)));
  }

  bool read_library(std::string_view name) {
    const Result<fs::path> path = resolve_picture(folder_, name);
    if (!path.ok()) return false;
    const Result<std::string> content = read_text_file(*path, kMaxMtlBytes);
    if (!content.ok()) return false;
    std::map<std::string, int> names;
    std::vector<tinyobj::material_t> materials;
    std::string warning;
    std::string error;
    std::istringstream stream(*content);
    tinyobj::LoadMtl(&names, &materials, &stream, &warning, &error);
    for (const tinyobj::material_t& material : materials)
      out_.scene.materials[material_named(material.name)] = to_material(material);
    return true;
  }

  Material to_material(const tinyobj::material_t& from) {
    Material to;
    to.color = {unit_byte(double(from.diffuse[0])), unit_byte(double(from.diffuse[1])),
                unit_byte(double(from.diffuse[2])), unit_byte(double(from.dissolve))};
    if (to.color.a < 255) to.alpha = AlphaMode::blend;
    if (from.diffuse_texname.empty()) return to;
    to.texture = texture_named(from.diffuse_texname);
    // Exporters leave the colour black where a picture gives it.
    if (glm::u8vec3(to.color) == glm::u8vec3(0)) to.color = {255, 255, 255, to.color.a};
    if (from.diffuse_texopt.clamp) to.wrap_u = to.wrap_v = Wrap::clamp;
    if (!from.alpha_texname.empty() && from.alpha_texname == from.diffuse_texname) to.alpha = AlphaMode::mask;
    return to;
  }

  uint32_t texture_named(const std::string& name) {
    const auto [place, is_new] = textures_.emplace(name, static_cast<uint32_t>(out_.scene.textures.size()));
    if (!is_new) return place->second;
    SourceTexture texture{name.substr(0, 200), {}};
    if (const Result<fs::path> path = resolve_picture(folder_, name); path.ok())
      if (Result<std::vector<std::byte>> bytes = read_file(*path, kMaxImageBytes); bytes.ok())
        texture.encoded = *std::move(bytes);
    out_.scene.textures.push_back(std::move(texture));
    return place->second;
  }

  LineReader lines_;
  fs::path folder_;
  std::string name_;
  JobMonitor& monitor_;
  ReadScene out_;
  bool saw_keyword_ = false;

  std::vector<glm::dvec3> positions_;
  std::vector<glm::u8vec4> colors_;  // as many as positions up to the last that had one
  std::vector<glm::vec2> texcoords_;
  std::vector<glm::vec3> normals_;
  std::map<std::string, uint32_t> materials_, textures_;
  std::optional<uint32_t> material_;

  std::string object_;
  MeshBuilder builder_;
  std::vector<Corner> corners_;  // of the object's vertices
  IndexTable known_{0};
  std::vector<uint32_t> face_;
};

}  // namespace

Result<ReadScene> read_obj(const fs::path& path, const std::string& name, JobMonitor& monitor) {
  Result<LineReader> lines = LineReader::open(path, name);
  if (!lines.ok()) return lines.error();
  return ObjReader(*std::move(lines), path.parent_path(), name, monitor).read();
}

}  // namespace promenade
