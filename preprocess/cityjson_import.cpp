// CityJSON 1.0 to 2.0, and CityJSONSeq (a header line, then a feature a line, read one at a time). Of each object the
// geometry of the highest level of detail is taken; objects of extensions are read like any other. The whole JSON of a
// file, or of a line, is in memory while it is read.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>

#include "preprocess/cityjson_appearance.h"
#include "preprocess/cityjson_geometry.h"
#include "preprocess/import_readers.h"
#include "preprocess/import_text.h"

namespace promenade {

namespace fs = std::filesystem;

namespace {

constexpr uint64_t kMaxFileBytes = uint64_t(1) << 31;

/// x -> scale * x + translate, of the document's vertices.
struct Quantisation {
  std::array<double, 3> scale{1, 1, 1};
  std::array<double, 3> translate{0, 0, 0};
};

std::vector<glm::dvec3> read_vertices(const Json& declared, const Quantisation& q) {
  std::vector<glm::dvec3> out;
  if (!declared.is_array()) return out;
  out.reserve(declared.size());
  for (const Json& value : declared) {
    std::array<double, 3> v{};
    if (!numbers(value, v)) v.fill(std::nan(""));  // found and counted later
    out.emplace_back(v[0] * q.scale[0] + q.translate[0], v[1] * q.scale[1] + q.translate[1],
                     v[2] * q.scale[2] + q.translate[2]);
  }
  return out;
}

class CityReader {
 public:
  CityReader(const fs::path& path, std::string name, JobMonitor& monitor)
      : name_(std::move(name)), monitor_(monitor), appearance_(path.parent_path(), out_.scene) {}

  /// The document, or the header of a sequence.
  Status read_document(Json document) {
    header_ = std::move(document);
    if (text(member(header_, "type")) != "CityJSON")
      return Error{fmt::format("{}: JSON without \"type\": \"CityJSON\"; the file is of another format", name_)};
    const std::string version = text(member(header_, "version"));
    if (version.substr(0, 2) != "1." && version.substr(0, 2) != "2.")
      return Error{fmt::format("{}: CityJSON version '{}' cannot be read, only 1.x and 2.x; upgrade it with cjio",
                               name_, version.substr(0, 20))};
    const Json& transform = member(header_, "transform");
    numbers(member(transform, "scale"), quantisation_.scale);
    numbers(member(transform, "translate"), quantisation_.translate);
    read_templates();
    return read_objects(header_);
  }

  /// One line of a sequence after the header.
  Status read_feature(const Json& feature) {
    if (text(member(feature, "type")) == "CityJSONFeature") return read_objects(feature);
    ++out_.scene.report.counts["features_skipped"];
    return Done{};
  }

  ReadScene take() {
    out_.up = UpAxis::z;
    out_.sides_unknown = true;
    return std::move(out_);
  }

 private:
  Counts& counts() { return out_.scene.report.counts; }

  /// Template geometries become meshes when an object first shows them.
  void read_templates() {
    const Json& templates = member(header_, "geometry-templates");
    templates_ = &member(templates, "templates");
    template_vertices_ = read_vertices(member(templates, "vertices-templates"), Quantisation{});
  }

  Status read_objects(const Json& document) {
    const Json& objects = member(document, "CityObjects");
    if (!objects.is_object()) return Done{};
    appearance_in_use_ = &member(document, "appearance");
    appearance_.use(*appearance_in_use_);
    const std::vector<glm::dvec3> vertices = read_vertices(member(document, "vertices"), quantisation_);
    uint64_t done = 0;
    for (const auto& [id, object] : objects.items()) {
      if (monitor_.cancelled()) return Error{"interrupted"};
      if (++done % 1024 == 0) monitor_.progress("import", done, objects.size());
      read_object(id, object, objects, vertices);
    }
    return Done{};
  }

  static double highest_lod(const Json& object) {
    double highest = -2;
    if (const Json& geometries = member(object, "geometry"); geometries.is_array())
      for (const Json& geometry : geometries) highest = std::max(highest, city_lod(geometry));
    return highest;
  }

  /// Whether parts of the object show it in more detail: then its own, coarser shape is not drawn over them.
  static bool shown_by_parts(const Json& object, double own, const Json& objects) {
    const Json& children = member(object, "children");
    if (!children.is_array()) return false;
    return std::any_of(children.begin(), children.end(), [&](const Json& id) {
      const Json& child = member(objects, text(id).c_str());
      const std::string type = text(member(child, "type"));
      return type.size() > 4 && type.ends_with("Part") && highest_lod(child) > own;
    });
  }

  void read_object(const std::string& id, const Json& object, const Json& objects,
                   const std::vector<glm::dvec3>& vertices) {
    const Json& geometries = member(object, "geometry");
    const double lod = highest_lod(object);
    if (!geometries.is_array() || geometries.empty() || shown_by_parts(object, lod, objects)) return;
    const std::string type = text(member(object, "type"));
    MeshBuilder builder;
    bool solid = true;
    for (const Json& geometry : geometries) {
      if (text(member(geometry, "type")) == "GeometryInstance")
        place_template(geometry, id, type, vertices);
      else if (city_lod(geometry) == lod) {
        solid = solid && is_city_solid(geometry);
        add_city_geometry(geometry, vertices, type, appearance_, builder, counts());
      }
    }
    add_object(out_.scene, builder, id, type, solid);
  }

  void place_template(const Json& geometry, const std::string& id, const std::string& type,
                      const std::vector<glm::dvec3>& vertices) {
    const std::optional<uint64_t> index = whole(member(geometry, "template"));
    const std::optional<uint64_t> anchor = whole(element(member(geometry, "boundaries"), 0));
    std::array<double, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    numbers(member(geometry, "transformationMatrix"), m);
    if (!index || !anchor || *anchor >= vertices.size()) {
      ++counts()["instances_dropped"];
      return;
    }
    const auto [mesh, offset] = template_mesh(*index, type);
    glm::dmat4 world(1);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        world[column][row] = m[static_cast<size_t>(row) * 4 + static_cast<size_t>(column)];
    world = glm::translate(glm::dmat4(1), vertices[static_cast<size_t>(*anchor)]) * world *
            glm::translate(glm::dmat4(1), offset);
    out_.scene.instances.push_back({mesh, world, id, type});
  }

  std::pair<uint32_t, glm::dvec3> template_mesh(uint64_t index, const std::string& type) {
    const auto known = template_meshes_.find(index);
    if (known != template_meshes_.end()) return known->second;
    MeshBuilder builder;
    appearance_.use(member(header_, "appearance"));  // which templates refer to, whatever the feature has
    add_city_geometry(element(*templates_, index), template_vertices_, type, appearance_, builder, counts());
    appearance_.use(*appearance_in_use_);
    glm::dvec3 offset(0);
    const auto mesh = static_cast<uint32_t>(out_.scene.meshes.size());
    out_.scene.meshes.push_back(builder.finish(offset));
    return template_meshes_[index] = {mesh, offset};
  }

  std::string name_;
  JobMonitor& monitor_;
  ReadScene out_;
  CityAppearance appearance_;
  Json header_;
  Quantisation quantisation_;
  const Json* templates_ = nullptr;
  const Json* appearance_in_use_ = nullptr;
  std::vector<glm::dvec3> template_vertices_;
  std::map<uint64_t, std::pair<uint32_t, glm::dvec3>> template_meshes_;
};

Result<ReadScene> read_sequence(const fs::path& path, const std::string& name, JobMonitor& monitor) {
  Result<LineReader> lines = LineReader::open(path, name);
  if (!lines.ok()) return lines.error();
  CityReader reader(path, name, monitor);
  std::string_view line;
  bool has_header = false;
  while (lines->next(line)) {
    if (trimmed(line).empty()) continue;
    Result<Json> parsed = parse_json(line, fmt::format("{}: line {}", name, lines->line_number()));
    if (!parsed.ok()) return parsed.error();
    PROMENADE_TRY(has_header ? reader.read_feature(*parsed) : reader.read_document(*std::move(parsed)));
    has_header = true;
    monitor.progress("import", lines->byte_after(), lines->file_bytes());
  }
  if (!lines->status().ok()) return lines->status().error();
  if (!has_header) return Error{fmt::format("{}: an empty file, no CityJSONSeq", name)};
  return reader.take();
}

}  // namespace

Result<ReadScene> read_cityjson(const fs::path& path, const std::string& name, JobMonitor& monitor) {
  if (path.extension().string().ends_with("l")) return read_sequence(path, name, monitor);  // .jsonl
  Result<std::string> content = read_text_file(path, kMaxFileBytes);
  if (!content.ok()) return content.error();
  Result<Json> parsed = parse_json(*content, name);
  if (!parsed.ok()) return parsed.error();
  *content = {};
  CityReader reader(path, name, monitor);
  PROMENADE_TRY(reader.read_document(*std::move(parsed)));
  return reader.take();
}

}  // namespace promenade
