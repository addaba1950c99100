#include "preprocess/cityjson_geometry.h"

#include <unordered_map>

#include "preprocess/import_text.h"

namespace promenade {

namespace {

constexpr uint64_t kNoUv = 0xffffffffU;

/// Arrays above a surface, by the geometry's type; -1: no surfaces in it.
int depth_of(const std::string& type) {
  if (type == "MultiSurface" || type == "CompositeSurface") return 1;
  if (type == "Solid") return 2;
  return type == "MultiSolid" || type == "CompositeSolid" ? 3 : -1;
}

/// The values that a geometry gives beside its boundaries, nested alike.
struct Values {
  const Json* semantics;
  const Json* material;
  const Json* texture;

  Values at(size_t i) const { return {&element(*semantics, i), &element(*material, i), &element(*texture, i)}; }
};

class GeometryReader {
 public:
  GeometryReader(const Json& geometry, const std::vector<glm::dvec3>& vertices, CityAppearance& appearance,
                 MeshBuilder& builder, Counts& counts)
      : surfaces_(member(member(geometry, "semantics"), "surfaces")),
        vertices_(vertices),
        appearance_(appearance),
        builder_(builder),
        counts_(counts) {}

  void read(const Json& geometry, int depth, const std::string& object_type) {
    look_.object_type = object_type;
    const Json& materials = member(geometry, "material");
    const Json& material = member(materials, appearance_.theme_of(materials, "default-theme-material").c_str());
    one_material_ = whole(member(material, "value"));
    const Json& textures = member(geometry, "texture");
    const Json& texture = member(textures, appearance_.theme_of(textures, "default-theme-texture").c_str());
    walk(member(geometry, "boundaries"), depth,
         {&member(member(geometry, "semantics"), "values"), &member(material, "values"), &member(texture, "values")});
  }

 private:
  void walk(const Json& boundaries, int depth, const Values& values) {
    if (depth == 0) {
      add_surface(boundaries, values);
      return;
    }
    if (!boundaries.is_array()) return;
    for (size_t i = 0; i < boundaries.size(); ++i) walk(boundaries[i], depth - 1, values.at(i));
  }

  void add_surface(const Json& rings, const Values& values) {
    corners_.clear(), ring_sizes_.clear();
    look_.texture.reset();
    bool sound = rings.is_array() && !rings.empty();
    for (size_t r = 0; sound && r < rings.size(); ++r)
      sound = add_ring(rings[r], element(*values.texture, r)) || r != 0;
    if (!sound) {
      ++counts_["faces_dropped"];
      return;
    }
    look_.material = one_material_ ? one_material_ : whole(*values.material);
    const std::optional<uint64_t> semantic = whole(*values.semantics);
    look_.surface_type = semantic ? text(member(element(surfaces_, *semantic), "type")) : std::string();
    builder_.add_polygon(corners_, ring_sizes_, appearance_.material_of(look_), counts_);
  }

  /// False: no ring (too short, or a vertex that is not there).
  bool add_ring(const Json& ring, const Json& uvs) {
    if (!ring.is_array()) return false;
    // "texture": the picture's number, then one texture vertex a corner.
    const std::optional<uint64_t> texture = whole(element(uvs, 0));
    const bool textured = texture && uvs.size() == ring.size() + 1;
    if (textured) look_.texture = texture;
    size_t size = ring.size();
    if (size > 1 && ring[0] == ring[size - 1]) --size;  // some writers close rings
    if (size < 3) return false;
    const size_t before = corners_.size();
    for (size_t i = 0; i < size; ++i) {
      const std::optional<uint64_t> vertex = whole(ring[i]);
      if (!vertex || *vertex >= vertices_.size()) {
        corners_.resize(before);
        return false;
      }
      corners_.push_back(vertex_of(*vertex, textured ? whole(uvs[i + 1]).value_or(kNoUv) : kNoUv));
    }
    ring_sizes_.push_back(static_cast<uint32_t>(size));
    return true;
  }

  uint32_t vertex_of(uint64_t vertex, uint64_t uv) {
    std::array<double, 2> place{};
    const bool has_uv = uv < kNoUv && numbers(element(appearance_.texture_vertices(), uv), place);
    const uint64_t key = vertex << 32 | (has_uv ? uv : kNoUv);
    const auto [known, is_new] = known_.emplace(key, 0);
    if (!is_new) return known->second;
    SourceVertex source;
    source.position = vertices_[static_cast<size_t>(vertex)];
    // CityJSON's origin is at the bottom.
    if (has_uv) source.texcoord = glm::vec2(static_cast<float>(place[0]), static_cast<float>(1.0 - place[1]));
    return known->second = builder_.add_vertex(source);
  }

  const Json& surfaces_;
  const std::vector<glm::dvec3>& vertices_;
  CityAppearance& appearance_;
  MeshBuilder& builder_;
  Counts& counts_;
  CityLook look_;
  std::optional<uint64_t> one_material_;
  std::unordered_map<uint64_t, uint32_t> known_;
  std::vector<uint32_t> corners_, ring_sizes_;
};

}  // namespace

double city_lod(const Json& geometry) {
  const Json& lod = member(geometry, "lod");
  double value = -1;
  if (lod.is_string()) parse_number(lod.get_ref<const std::string&>(), value);
  return lod.is_string() ? value : number(lod, -1);
}

bool is_city_solid(const Json& geometry) { return depth_of(text(member(geometry, "type"))) > 1; }

void add_city_geometry(const Json& geometry, const std::vector<glm::dvec3>& vertices, const std::string& object_type,
                       CityAppearance& appearance, MeshBuilder& builder, Counts& counts) {
  const int depth = depth_of(text(member(geometry, "type")));
  if (depth < 0) {
    ++counts["primitives_skipped"];
    return;
  }
  GeometryReader(geometry, vertices, appearance, builder, counts).read(geometry, depth, object_type);
}

}  // namespace promenade
