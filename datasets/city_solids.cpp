// Source: CityJSON 2.0.1, section 8, Text Sequences and Streaming with CityJSONFeature.

#include "datasets/city_solids.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <nlohmann/json.hpp>

namespace promenade {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kStepM = 0.001;
constexpr float kLevel = 0.7F;  // of a normal's z: flatter faces are roofs and floors

std::string_view type_of(std::string_view class_name) {
  if (class_name == "building") return "Building";
  if (class_name == "fountain") return "CityFurniture";
  return class_name == "park" ? "PlantCover" : "LandUse";
}

using Place = std::array<int64_t, 3>;

/// The mesh's triangles as surfaces; those that have no area on the grid are left out, their edges meet.
class FeatureWriter {
 public:
  explicit FeatureWriter(const UniqueObject& object) : object_(object) {
    for (size_t t = 0; t < object.mesh.triangle_count(); ++t) {
      std::array<uint32_t, 3> ring{};
      for (size_t i = 0; i < 3; ++i) ring[i] = vertex_of(object.mesh.positions[object.mesh.indices[3 * t + i]]);
      if (ring[0] == ring[1] || ring[1] == ring[2] || ring[2] == ring[0]) continue;
      surfaces_.push_back(Json::array({ring}));
      const float up = glm::normalize(triangle_cross(object.mesh, t)).z;
      semantics_.push_back(up > kLevel ? 0 : up < -kLevel ? 1 : 2);
    }
  }

  size_t triangles() const { return surfaces_.size(); }

  std::string line() {
    const std::string_view type = type_of(object_.class_name);
    const bool solid = type == "Building";
    Json geometry = {{"type", solid ? "Solid" : "MultiSurface"}, {"lod", solid ? "1.3" : "1"}};
    geometry["boundaries"] = solid ? Json::array({std::move(surfaces_)}) : std::move(surfaces_);
    if (solid)
      geometry["semantics"] = {
          {"surfaces",
           Json::array({{{"type", "RoofSurface"}}, {{"type", "GroundSurface"}}, {{"type", "WallSurface"}}})},
          {"values", Json::array({std::move(semantics_)})}};
    const Json feature = {{"type", "CityJSONFeature"},
                          {"id", object_.name},
                          {"CityObjects", {{object_.name, {{"type", type}, {"geometry", Json::array({geometry})}}}}},
                          {"vertices", std::move(vertices_)}};
    return feature.dump();
  }

 private:
  uint32_t vertex_of(const glm::vec3& position) {
    const glm::dvec3 p = (object_.origin + glm::dvec3(position)) / kStepM;
    const Place place = {std::llround(p.x), std::llround(p.y), std::llround(p.z)};
    const auto [known, is_new] = known_.emplace(place, static_cast<uint32_t>(known_.size()));
    if (is_new) vertices_.push_back(place);
    return known->second;
  }

  const UniqueObject& object_;
  std::map<Place, uint32_t> known_;
  Json surfaces_ = Json::array(), semantics_ = Json::array(), vertices_ = Json::array();
};

}  // namespace

bool is_city_solids(const std::filesystem::path& output) { return output.extension() == ".jsonl"; }

Result<std::unique_ptr<CityFile>> CitySolids::create(const std::filesystem::path& path) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return file.error();
  std::unique_ptr<CitySolids> solids(new CitySolids(std::move(*file)));
  const Json header = {{"type", "CityJSON"},
                       {"version", "2.0"},
                       {"transform", {{"scale", {kStepM, kStepM, kStepM}}, {"translate", {0, 0, 0}}}},
                       {"CityObjects", Json::object()},
                       {"vertices", Json::array()}};
  PROMENADE_TRY(solids->write_line(header.dump()));
  return std::unique_ptr<CityFile>(std::move(solids));
}

Status CitySolids::write_line(const std::string& line) {
  const std::string whole = line + "\n";
  return file_.write(std::as_bytes(std::span(whole)));
}

Status CitySolids::add(const CityBlock& block, uint32_t, uint32_t, const std::vector<EncodedFacade>&, PropLibrary&,
                       CityFigures& figures) {
  for (const UniqueObject& object : block.objects) {
    FeatureWriter feature(object);
    const Box box = bounds(object.mesh);
    figures.box.add(DBox{object.origin + glm::dvec3(box.min), object.origin + glm::dvec3(box.max)});
    figures.triangles += feature.triangles(), figures.unique_triangles += feature.triangles();
    ++figures.objects;
    if (object.class_name == "building") ++figures.buildings;
    PROMENADE_TRY(write_line(feature.line()));
  }
  return Done{};
}

Status CitySolids::add_traffic(const std::vector<MovingCar>&, PropLibrary&, CityFigures&) {
  return Error{"city: CityJSON knows nothing that moves"};
}

}  // namespace promenade
