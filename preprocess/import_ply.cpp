// PLY, ascii and binary of either byte order. Own reader: the libraries at hand drop vertex colours, texture pictures
// or double precision. Elements that are not known are skipped, as the format intends.
//
// Read: vertices (x y z, nx ny nz, red green blue alpha, s t or u v), faces (vertex_indices, colours of faces, texcoord
// and texnumber of MeshLab), tristrips, `comment TextureFile`.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "preprocess/import_builder.h"
#include "preprocess/import_readers.h"
#include "preprocess/import_text.h"
#include "preprocess/import_uri.h"

namespace promenade {

namespace fs = std::filesystem;

namespace {

constexpr size_t kPieceBytes = size_t(1) << 20;
constexpr uint64_t kMaxImageBytes = uint64_t(1) << 30;
constexpr uint64_t kElementsPerProgress = 1U << 18;
constexpr size_t kMaxHeaderLines = 10'000;  // bounds hostile headers

enum class Type : uint8_t { none, int8, uint8, int16, uint16, int32, uint32, float32, float64 };

Type type_named(std::string_view name) {
  struct Name {
    std::string_view name;
    Type type;
  };
  constexpr std::array<Name, 16> kNames{{{"char", Type::int8},
                                         {"int8", Type::int8},
                                         {"uchar", Type::uint8},
                                         {"uint8", Type::uint8},
                                         {"short", Type::int16},
                                         {"int16", Type::int16},
                                         {"ushort", Type::uint16},
                                         {"uint16", Type::uint16},
                                         {"int", Type::int32},
                                         {"int32", Type::int32},
                                         {"uint", Type::uint32},
                                         {"uint32", Type::uint32},
                                         {"float", Type::float32},
                                         {"float32", Type::float32},
                                         {"double", Type::float64},
                                         {"float64", Type::float64}}};
  for (const Name& entry : kNames)
    if (entry.name == name) return entry.type;
  return Type::none;
}

size_t bytes_of(Type type) {
  constexpr std::array<uint8_t, 9> kBytes{0, 1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<size_t>(type)];
}

/// What a property means to us.
enum class Role : uint8_t { none, x, y, z, nx, ny, nz, red, green, blue, alpha, u, v, corners, texcoords, picture };

Role role_named(std::string_view name) {
  struct Name {
    std::string_view name;
    Role role;
  };
  constexpr std::array<Name, 26> kNames{{{"x", Role::x},
                                         {"y", Role::y},
                                         {"z", Role::z},
                                         {"nx", Role::nx},
                                         {"ny", Role::ny},
                                         {"nz", Role::nz},
                                         {"red", Role::red},
                                         {"green", Role::green},
                                         {"blue", Role::blue},
                                         {"alpha", Role::alpha},
                                         {"r", Role::red},
                                         {"g", Role::green},
                                         {"b", Role::blue},
                                         {"diffuse_red", Role::red},
                                         {"diffuse_green", Role::green},
                                         {"diffuse_blue", Role::blue},
                                         {"u", Role::u},
                                         {"v", Role::v},
                                         {"s", Role::u},
                                         {"t", Role::v},
                                         {"texture_u", Role::u},
                                         {"texture_v", Role::v},
                                         {"vertex_indices", Role::corners},
                                         {"vertex_index", Role::corners},
                                         {"texcoord", Role::texcoords},
                                         {"texnumber", Role::picture}}};
  for (const Name& entry : kNames)
    if (entry.name == name) return entry.role;
  return Role::none;
}

struct Property {
  Type type = Type::none;
  Type count_type = Type::none;  ///< of a list; none: a scalar
  Role role = Role::none;
};

struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;
};

/// The values after the header, one by one.
class ValueReader {
 public:
  virtual ~ValueReader() = default;
  /// False: the file ended or the text is no number.
  virtual bool value(Type type, double& out) = 0;
  virtual uint64_t bytes_left() const = 0;
};

class AsciiValues : public ValueReader {
 public:
  explicit AsciiValues(LineReader& lines) : lines_(lines) {}
  bool value(Type, double& out) override {
    for (;;) {
      const std::string_view word = take_word(line_);
      if (!word.empty()) return parse_number(word, out);
      if (!lines_.next(line_)) return false;
    }
  }
  uint64_t bytes_left() const override { return lines_.file_bytes() - lines_.byte_after() + line_.size(); }

 private:
  LineReader& lines_;
  std::string_view line_;
};

class BinaryValues : public ValueReader {
 public:
  BinaryValues(const RandomAccessFile& file, uint64_t at, bool big_endian)
      : file_(file), at_(at), big_endian_(big_endian) {}

  bool value(Type type, double& out) override {
    const size_t bytes = bytes_of(type);
    if (buffer_.size() - position_ < bytes && !fill(bytes)) return false;
    std::array<std::byte, 8> raw{};
    std::copy_n(buffer_.begin() + static_cast<ptrdiff_t>(position_), bytes, raw.begin());
    if (big_endian_) std::reverse(raw.begin(), raw.begin() + static_cast<ptrdiff_t>(bytes));
    position_ += bytes;
    out = decode(type, raw);
    return true;
  }
  uint64_t bytes_left() const override { return file_.size() - at_ + buffer_.size() - position_; }

 private:
  template <class T>
  static double as(const std::array<std::byte, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return static_cast<double>(value);
  }
  static double decode(Type type, const std::array<std::byte, 8>& raw) {
    switch (type) {
      case Type::int8:
        return as<int8_t>(raw);
      case Type::uint8:
        return as<uint8_t>(raw);
      case Type::int16:
        return as<int16_t>(raw);
      case Type::uint16:
        return as<uint16_t>(raw);
      case Type::int32:
        return as<int32_t>(raw);
      case Type::uint32:
        return as<uint32_t>(raw);
      case Type::float32:
        return as<float>(raw);
      default:
        return as<double>(raw);
    }
  }
  bool fill(size_t needed) {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<ptrdiff_t>(position_));
    position_ = 0;
    const auto more = static_cast<size_t>(std::min<uint64_t>(kPieceBytes, file_.size() - at_));
    const size_t had = buffer_.size();
    if (had + more < needed) return false;
    buffer_.resize(had + more);
    if (!file_.read(at_, std::span(buffer_).subspan(had)).ok()) return false;
    at_ += more;
    return true;
  }

  const RandomAccessFile& file_;
  uint64_t at_;
  bool big_endian_;
  std::vector<std::byte> buffer_;
  size_t position_ = 0;
};

/// A colour channel as a byte: whole numbers have their type's range, floats 0 to 1.
uint8_t color_byte(Type type, double value) {
  const double scale = type == Type::float32 || type == Type::float64 ? 255.0
                       : type == Type::uint16                         ? 255.0 / 65535.0
                                                                      : 1.0;
  return static_cast<uint8_t>(std::lround(std::clamp(std::isnan(value) ? 255.0 : value * scale, 0.0, 255.0)));
}

class PlyReader {
 public:
  PlyReader(fs::path path, std::string name, JobMonitor& monitor)
      : path_(std::move(path)), name_(std::move(name)), monitor_(monitor) {}

  Result<ReadScene> read() {
    Result<LineReader> lines = LineReader::open(path_, name_);
    if (!lines.ok()) return lines.error();
    PROMENADE_TRY(read_header(*lines));
    add_materials();
    if (ascii_) {
      AsciiValues values(*lines);
      PROMENADE_TRY(read_elements(values));
      if (!lines->status().ok()) return lines->status().error();
    } else {
      const Result<RandomAccessFile> file = RandomAccessFile::open(path_);
      if (!file.ok()) return file.error();
      BinaryValues values(*file, lines->byte_after(), big_endian_);
      PROMENADE_TRY(read_elements(values));
    }
    add_object(out_.scene, builder_, path_.stem().string(), "");
    out_.up = UpAxis::z;
    out_.sides_unknown = true;
    return std::move(out_);
  }

 private:
  Error broken(const std::string& what) const {
    return Error{fmt::format("{}: {}; the file is cut off or broken", name_, what)};
  }

  Status read_header(LineReader& lines) {
    std::string_view line;
    if (!lines.next(line) || trimmed(line) != "ply") return broken("no 'ply' in line 1");
    while (lines.next(line)) {
      if (lines.line_number() > kMaxHeaderLines) return broken("a header without end");
      const std::string_view keyword = take_word(line);
      if (keyword == "end_header") return has_format_ ? Status(Done{}) : Status(broken("header without a format"));
      if (keyword == "format")
        PROMENADE_TRY(read_format(take_word(line)));
      else if (keyword == "comment")
        read_comment(line);
      else if (keyword == "element")
        PROMENADE_TRY(read_element(line, lines.line_number()));
      else if (keyword == "property")
        PROMENADE_TRY(read_property(line, lines.line_number()));
    }
    if (!lines.status().ok()) return lines.status().error();
    return broken("a header without end");
  }

  Status read_format(std::string_view format) {
    has_format_ = true;
    ascii_ = format == "ascii";
    big_endian_ = format == "binary_big_endian";
    if (ascii_ || big_endian_ || format == "binary_little_endian") return Done{};
    return broken(fmt::format("unknown format '{}'", format.substr(0, 40)));
  }

  void read_comment(std::string_view line) {
    if (take_word(line) == "TextureFile" && pictures_.size() < kMaxHeaderLines) pictures_.emplace_back(trimmed(line));
  }

  Status read_element(std::string_view line, uint64_t number) {
    Element element;
    element.name = std::string(take_word(line));
    int64_t count = -1;
    if (!parse_number(take_word(line), count) || count < 0) return broken(fmt::format("line {}: no count", number));
    element.count = static_cast<uint64_t>(count);
    elements_.push_back(std::move(element));
    return Done{};
  }

  Status read_property(std::string_view line, uint64_t number) {
    Property property;
    std::string_view word = take_word(line);
    if (word == "list") {
      property.count_type = type_named(take_word(line));
      if (property.count_type == Type::none || property.count_type >= Type::float32)
        return broken(fmt::format("line {}: a list without a count", number));
      word = take_word(line);
    }
    property.type = type_named(word);
    property.role = role_named(take_word(line));
    if (property.type == Type::none || elements_.empty())
      return broken(fmt::format("line {}: a property of no type", number));
    elements_.back().properties.push_back(property);
    return Done{};
  }

  /// One material without a picture, or one a picture.
  void add_materials() {
    for (const std::string& name : pictures_) {
      SourceTexture texture{name.substr(0, 200), {}};
      if (const Result<fs::path> path = resolve_picture(path_.parent_path(), name); path.ok())
        if (Result<std::vector<std::byte>> bytes = read_file(*path, kMaxImageBytes); bytes.ok())
          texture.encoded = *std::move(bytes);
      Material material;
      material.texture = static_cast<uint32_t>(out_.scene.textures.size());
      out_.scene.textures.push_back(std::move(texture));
      out_.scene.materials.push_back(material);
    }
    if (pictures_.empty()) out_.scene.materials.emplace_back();
  }

  Status read_elements(ValueReader& values) {
    for (const Element& element : elements_) {
      uint64_t least = 0;
      for (const Property& p : element.properties)
        least += ascii_ ? 2 : bytes_of(p.count_type == Type::none ? p.type : p.count_type);
      // The last value of an ascii file needs no white space after it.
      if (least == 0 ? element.count != 0 : element.count > (values.bytes_left() + 1) / least)
        return broken(fmt::format("{} of '{}' announced, {} bytes left", element.count, element.name.substr(0, 40),
                                  values.bytes_left()));
      for (uint64_t i = 0; i < element.count; ++i) {
        if (i % kElementsPerProgress == 0) {
          if (monitor_.cancelled()) return Error{"interrupted"};
          monitor_.progress("import", i, element.count);
        }
        if (!read_row(values, element))
          return broken(fmt::format("{} {} of {} cannot be read", element.name.substr(0, 40), i, element.count));
        if (element.name == "vertex")
          add_vertex(element);
        else if (element.name == "face")
          add_face(element);
        else if (element.name == "tristrips")
          add_strips();
      }
    }
    return Done{};
  }

  /// The values of one element: scalars in row_, our lists in lists of their own.
  bool read_row(ValueReader& values, const Element& element) {
    row_.clear(), corners_.clear(), texcoords_.clear();
    for (const Property& property : element.properties) {
      double value = 0;
      if (!values.value(property.count_type == Type::none ? property.type : property.count_type, value)) return false;
      row_.push_back(value);
      if (property.count_type == Type::none) continue;
      if (!(value >= 0) || value > double(values.bytes_left())) return false;
      const auto count = static_cast<uint64_t>(value);
      for (uint64_t i = 0; i < count; ++i) {
        if (!values.value(property.type, value)) return false;
        if (property.role == Role::corners)
          corners_.push_back(value);
        else if (property.role == Role::texcoords)
          texcoords_.push_back(value);
      }
    }
    return true;
  }

  /// A scalar of the row, by its role.
  bool has(const Element& element, Role role, double& value, Type& type) const {
    for (size_t i = 0; i < element.properties.size(); ++i)
      if (element.properties[i].role == role && element.properties[i].count_type == Type::none) {
        value = row_[i];
        type = element.properties[i].type;
        return true;
      }
    return false;
  }

  std::optional<glm::u8vec4> color(const Element& element) const {
    constexpr std::array<Role, 4> kRoles{Role::red, Role::green, Role::blue, Role::alpha};
    glm::u8vec4 out(255);
    double value = 0;
    Type type = Type::none;
    bool any = false;
    for (int i = 0; i < 4; ++i)
      if (has(element, kRoles[static_cast<size_t>(i)], value, type)) {
        out[i] = color_byte(type, value);
        any = true;
      }
    return any ? std::optional(out) : std::nullopt;
  }

  void add_vertex(const Element& element) {
    SourceVertex vertex;
    double value = 0;
    Type type = Type::none;
    const auto get = [&](Role role) { return has(element, role, value, type) ? value : 0.0; };
    vertex.position = {get(Role::x), get(Role::y), get(Role::z)};
    if (has(element, Role::nx, value, type)) vertex.normal = glm::vec3(glm::dvec3(value, get(Role::ny), get(Role::nz)));
    if (has(element, Role::u, value, type))
      vertex.texcoord = glm::vec2(static_cast<float>(value), static_cast<float>(1.0 - get(Role::v)));
    vertex.color = color(element);
    vertices_.push_back(vertex.color ? *vertex.color : glm::u8vec4(255));
    builder_.add_vertex(vertex);
  }

  /// Vertex number of a list's value; false: it is none.
  bool vertex_of(double value, uint32_t& vertex) const {
    if (!(value >= 0) || !(value < double(vertices_.size()))) return false;
    vertex = static_cast<uint32_t>(value);
    return true;
  }

  void add_face(const Element& element) {
    face_.clear();
    uint32_t vertex = 0;
    for (const double corner : corners_) {
      if (!vertex_of(corner, vertex)) break;
      face_.push_back(vertex);
    }
    if (face_.size() != corners_.size() || face_.size() < 3) {
      ++out_.scene.report.counts["faces_dropped"];
      return;
    }
    const std::optional<glm::u8vec4> face_color = color(element);
    const bool wedges = texcoords_.size() == 2 * face_.size();
    if (face_color || wedges) own_corners(face_color, wedges);
    uint32_t material = 0;
    double picture = 0;
    Type type = Type::none;
    if (has(element, Role::picture, picture, type) && picture > 0 && picture < double(pictures_.size()))
      material = static_cast<uint32_t>(picture);
    const std::array<uint32_t, 1> ring{static_cast<uint32_t>(face_.size())};
    builder_.add_polygon(face_, ring, material, out_.scene.report.counts);
  }

  /// Gives a face with attributes of its own vertices of its own.
  void own_corners(const std::optional<glm::u8vec4>& face_color, bool wedges) {
    for (size_t i = 0; i < face_.size(); ++i) {
      SourceVertex vertex;
      vertex.position = builder_.position(face_[i]);
      vertex.color = face_color ? *face_color : vertices_[face_[i]];
      if (wedges)
        vertex.texcoord =
            glm::vec2(static_cast<float>(texcoords_[2 * i]), static_cast<float>(1.0 - texcoords_[2 * i + 1]));
      face_[i] = builder_.add_vertex(vertex);
    }
  }

  void add_strips() {
    std::vector<uint32_t> strip;
    uint32_t vertex = 0;
    for (const double corner : corners_) {
      if (!vertex_of(corner, vertex)) {  // -1 starts a new one
        strip.clear();
        continue;
      }
      strip.push_back(vertex);
      const size_t n = strip.size();
      if (n < 3) continue;
      const size_t odd = (n & 1U) ^ 1U;
      builder_.add_triangle(strip[n - 3], strip[n - 2 + odd], strip[n - 1 - odd], 0);
    }
  }

  fs::path path_;
  std::string name_;
  JobMonitor& monitor_;
  ReadScene out_;
  bool has_format_ = false, ascii_ = false, big_endian_ = false;
  std::vector<Element> elements_;
  std::vector<std::string> pictures_;
  MeshBuilder builder_;
  std::vector<glm::u8vec4> vertices_;  // colours of the file's vertices
  std::vector<double> row_, corners_, texcoords_;
  std::vector<uint32_t> face_;
};

}  // namespace

Result<ReadScene> read_ply(const fs::path& path, const std::string& name, JobMonitor& monitor) {
  return PlyReader(path, name, monitor).read();
}

}  // namespace promenade
