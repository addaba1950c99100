#include "preprocess/assemble.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "preprocess/coarser_leaves.h"
#include "preprocess/survey.h"

namespace promenade {

namespace {

constexpr size_t kBatch = 256;  // nodes read, renumbered and written together: some MiB

/// A node by the unit that it is in. Above a leaf there may be coarser ones of the same triangles (coarser_leaves.h).
struct Place {
  uint32_t unit = 0;
  uint32_t node = 0;
  uint32_t powers = 1;  ///< of those from this one on downwards; bit 0: the unit's own node
  uint32_t power() const { return static_cast<uint32_t>(std::bit_width(powers)) - 1; }
};

class Assembler {
 public:
  Assembler(const TreeUnits& units, const Survey& survey, const TextureStore& textures,
            const std::vector<Material>& materials, GeometryCodec codec, const WorkFolder& folder, ModelWriter& writer)
      : units_(units),
        survey_(survey),
        textures_(textures),
        codec_(codec),
        folder_(folder),
        writer_(writer),
        first_atlas_material_(static_cast<uint32_t>(materials.size())) {
    tables.materials = materials;
  }

  /// The source's, then their smaller versions that nodes show, with materials that do. After order().
  Status add_textures() {
    for (uint32_t i = 0; i < textures_.size(); ++i)
      PROMENADE_TRY(add_texture(i, 0, {textures_[i].width, textures_[i].height}));
    for (auto& [version, shown] : versions_) {
      shown.texture = static_cast<uint32_t>(tables.textures.size());
      PROMENADE_TRY(add_texture(version.first, version.second, textures_[version.first].smaller[version.second - 1]));
      for (uint32_t m = 0; m < first_atlas_material_; ++m) {
        if (tables.materials[m].texture != version.first) continue;
        shown.materials[m] = static_cast<uint32_t>(tables.materials.size());
        Material material = tables.materials[m];
        material.texture = shown.texture;
        tables.materials.push_back(material);
      }
    }
    return Done{};
  }

  /// Gives every node its id and fills in what links it to others.
  void order() {
    if (!units_.top.nodes.empty() || !units_.chunks.empty()) add_tree(root());
    const auto first_moving = static_cast<uint32_t>(tables.nodes.size());
    objects.animation = survey_.animation;
    for (uint32_t i = 0; i < units_.objects.size(); ++i) {
      const SurveyedObject& object = survey_.objects[i];
      objects.moving.push_back(
          {object.joint, NodeId{static_cast<uint32_t>(tables.nodes.size())}, object.joint_from_object});
      add_tree({static_cast<uint32_t>(units_.chunks.size()) + 1 + i, 0});
      while (first_moving + objects.moving_nodes.size() < tables.nodes.size()) sweep(i, first_moving);
    }
    grow_to_hold_children(first_moving);
    add_classes();
    objects.footprints = survey_.footprints;
  }

  Status add_nodes(JobMonitor& monitor) {
    for (size_t first = 0; first < places_.size(); first += kBatch) {
      const size_t last = std::min(first + kBatch, places_.size());
      PROMENADE_TRY(add_batch(first, last));
      monitor.progress("write", last, places_.size());
      if (monitor.cancelled()) return Error{kInterrupted};
    }
    return Done{};
  }

  ModelTables tables;
  ModelObjects objects;

 private:
  const NodeUnit& unit(uint32_t index) const {
    if (index < units_.chunks.size()) return units_.chunks[index];
    return index == units_.chunks.size() ? units_.top : units_.objects[index - units_.chunks.size() - 1];
  }
  const UnitNode& node(const Place& place) const { return unit(place.unit).nodes[place.node]; }

  /// A texture's version and what shows it.
  struct Shown {
    uint32_t texture = 0;                    ///< its number in the model
    std::map<uint32_t, uint32_t> materials;  ///< by the material of the whole texture
  };

  Status add_texture(uint32_t texture, uint32_t version, const StoredTexture::Size& size) {
    const Result<std::vector<std::byte>> bytes = textures_.encoded(texture, version);
    if (!bytes.ok()) return bytes.error();
    const Result<uint32_t> segment = writer_.append(SegmentRecord::Type::texture, *bytes);
    if (!segment.ok()) return segment.error();
    const uint32_t flags = textures_[texture].has_opacity ? TextureRecord::kHasOpacity : 0U;
    tables.textures.push_back({size.width, size.height, *segment, flags});
    return Done{};
  }

  /// The place, beginning with its coarsest version where it is a leaf's.
  Place with_coarser(Place place, const NodeRecord* parent) {
    const UnitNode& leaf = node(place);
    if (!leaf.children.empty() || leaf.textures.empty()) return place;
    place.powers = worthwhile_powers(leaf, parent, textures_);
    for (uint32_t powers = place.powers; powers > 1; powers &= ~std::bit_floor(powers)) {
      const std::vector<uint32_t> versions =
          texture_versions(leaf, static_cast<uint32_t>(std::bit_width(powers)) - 1, textures_);
      for (size_t i = 0; i < versions.size(); ++i)
        if (versions[i] > 0) versions_[{leaf.textures[i], versions[i]}];
    }
    return place;
  }

  Place root() const {
    if (!units_.top.nodes.empty()) return {static_cast<uint32_t>(units_.chunks.size()), 0};
    return {0, 0};
  }

  void add_tree(const Place& root_place) {
    const NodeId id{static_cast<uint32_t>(tables.nodes.size())};
    add_node(with_coarser(root_place, nullptr), kNoNode, 0);
    tables.roots.push_back(id);
    add_children(id);
  }

  /// The next node of an object: its box becomes what it sweeps, and it may be seen from any side.
  void sweep(uint32_t object, uint32_t first_moving) {
    NodeRecord& node = tables.nodes[first_moving + objects.moving_nodes.size()];
    const MovingObject& moving = objects.moving[object];
    objects.moving_nodes.push_back({object, node.box});
    const DBox swept = swept_box(survey_.animation, moving.joint, transformed_box(node.box, moving.joint_from_object));
    for (int i = 0; i < 3; ++i) {
      constexpr float kFar = std::numeric_limits<float>::infinity();
      node.box.min[i] = std::nextafter(static_cast<float>(swept.min[i] - survey_.origin[i]), -kFar);
      node.box.max[i] = std::nextafter(static_cast<float>(swept.max[i] - survey_.origin[i]), kFar);
    }
    node.cone = {{0, 0, 1}, -1};
    node.average_normal = glm::vec3(0);
  }

  /// Swept boxes hold their children's but for rounding.
  void grow_to_hold_children(uint32_t first_moving) {
    for (size_t i = tables.nodes.size(); i-- > first_moving;)
      if (const NodeId parent = tables.nodes[i].parent; parent != kNoNode)
        tables.nodes[index_of(parent)].box.add(tables.nodes[i].box);
  }

  void add_classes() {
    bool any = false;
    for (uint32_t i = 0; i < places_.size(); ++i) {
      if (places_[i].power() > 0) continue;
      for (const ClassArea& of : node(places_[i]).classes) {
        objects.class_shares.push_back({NodeId{i}, of.class_index, of.area_m2});
        any = true;
      }
    }
    if (!any) return;
    objects.classes.resize(survey_.classes.size());
    for (const auto& [name, index] : survey_.classes) objects.classes[index] = name;
  }

  void add_node(const Place& place, NodeId parent, uint32_t level) {
    NodeRecord record = coarser_record(node(place), place.power(), textures_);
    record.parent = parent;
    record.level = level;
    places_.push_back(place);
    tables.nodes.push_back(record);
  }

  std::vector<Place> children_of(NodeId id) {
    Place place = places_[index_of(id)];
    if (place.power() > 0) {
      place.powers &= ~std::bit_floor(place.powers);
      return {place};
    }
    std::vector<Place> children;
    for (const uint32_t child : node(place).children) {
      const bool other = (child & NodeUnit::kOtherUnit) != 0;
      const Place below = other ? Place{child & ~NodeUnit::kOtherUnit, 0} : Place{place.unit, child};
      children.push_back(with_coarser(below, &tables.nodes[index_of(id)]));
    }
    return children;
  }

  void add_children(NodeId id) {
    const std::vector<Place> children = children_of(id);
    const auto first = static_cast<uint32_t>(tables.nodes.size());
    tables.nodes[index_of(id)].first_child = static_cast<uint32_t>(tables.children.size());
    tables.nodes[index_of(id)].child_count = static_cast<uint32_t>(children.size());
    const uint32_t level = tables.nodes[index_of(id)].level + 1;
    for (const Place& child : children) {
      tables.children.push_back(NodeId{static_cast<uint32_t>(tables.nodes.size())});
      add_node(child, id, level);
    }
    for (uint32_t i = 0; i < children.size(); ++i) add_children(NodeId{first + i});
  }

  /// One node's bytes and the number of its first atlas material.
  struct Bytes {
    std::vector<std::byte> mesh, atlas;
    uint32_t first_material = 0;
    std::optional<Error> error;
  };

  Status add_batch(size_t first, size_t last) {
    std::vector<Bytes> batch(last - first);
    for (size_t i = first; i < last; ++i) {
      PROMENADE_TRY(read(places_[i], batch[i - first]));
      batch[i - first].first_material = static_cast<uint32_t>(tables.materials.size());
      PROMENADE_TRY(add_looks(i, batch[i - first]));
    }
    tbb::parallel_for(first, last, [&](size_t i) {
      if (places_[i].power() > 0 || !node(places_[i]).atlas_materials.empty()) renumber(places_[i], batch[i - first]);
    });
    for (size_t i = first; i < last; ++i) {
      if (batch[i - first].error) return *batch[i - first].error;
      const Result<uint32_t> segment = writer_.append(SegmentRecord::Type::mesh, batch[i - first].mesh);
      if (!segment.ok()) return segment.error();
      tables.nodes[i].segment = *segment;
    }
    return Done{};
  }

  Status read(const Place& place, Bytes& bytes) {
    if (!file_ || open_unit_ != place.unit) {
      Result<RandomAccessFile> file = folder_.open_unit(unit(place.unit).name);
      if (!file.ok()) return file.error();
      file_ = std::move(*file), open_unit_ = place.unit;
    }
    const UnitNode& from = node(place);
    Result<std::vector<std::byte>> mesh = folder_.read(*file_, from.mesh.offset, from.mesh.bytes);
    if (!mesh.ok()) return mesh.error();
    Result<std::vector<std::byte>> atlas = folder_.read(*file_, from.atlas.offset, from.atlas.bytes);
    if (!atlas.ok()) return atlas.error();
    bytes.mesh = std::move(*mesh), bytes.atlas = std::move(*atlas);
    return Done{};
  }

  /// The node's textures and materials into the tables.
  Status add_looks(size_t id, const Bytes& bytes) {
    const UnitNode& from = node(places_[id]);
    tables.nodes[id].first_texture = static_cast<uint32_t>(tables.node_textures.size());
    const std::vector<uint32_t> versions = texture_versions(from, places_[id].power(), textures_);
    for (size_t i = 0; i < versions.size(); ++i)
      tables.node_textures.push_back(versions[i] == 0 ? from.textures[i]
                                                      : versions_.at({from.textures[i], versions[i]}).texture);
    if (!bytes.atlas.empty()) {
      const Result<uint32_t> segment = writer_.append(SegmentRecord::Type::texture, bytes.atlas);
      if (!segment.ok()) return segment.error();
      const auto texture = static_cast<uint32_t>(tables.textures.size());
      tables.textures.push_back(from.atlas_record);
      tables.textures.back().segment = *segment;
      tables.node_textures.push_back(texture);
      for (Material material : from.atlas_materials) {
        material.texture = texture;
        tables.materials.push_back(material);
      }
    }
    tables.nodes[id].texture_count =
        static_cast<uint32_t>(tables.node_textures.size()) - tables.nodes[id].first_texture;
    return Done{};
  }

  /// From the node's own numbers of its atlas materials to the model's, and to those of smaller textures. The positions
  /// are on the grid already, so that coding them again moves nothing.
  void renumber(const Place& place, Bytes& bytes) const {
    Result<Mesh> mesh = decode_mesh(bytes.mesh);
    if (!mesh.ok()) {
      bytes.error = mesh.error();
      return;
    }
    const UnitNode& from = node(place);
    const std::vector<uint32_t> versions = texture_versions(from, place.power(), textures_);
    const auto renumbered = [&](uint32_t material) {
      if (material >= first_atlas_material_) return material + bytes.first_material - first_atlas_material_;
      const auto texture = std::find(from.textures.begin(), from.textures.end(), tables.materials[material].texture);
      if (texture == from.textures.end()) return material;
      const uint32_t version = versions[static_cast<size_t>(texture - from.textures.begin())];
      return version == 0 ? material : versions_.at({*texture, version}).materials.at(material);
    };
    for (uint32_t& material : mesh->materials) material = renumbered(material);
    Result<EncodedMesh> encoded = encode_mesh(*mesh, encode_options(codec_, from.step_m, fine_step_m(bytes.mesh)));
    if (!encoded.ok())
      bytes.error = encoded.error();
    else
      bytes.mesh = std::move(encoded->bytes);
  }

  const TreeUnits& units_;
  const Survey& survey_;
  const TextureStore& textures_;
  GeometryCodec codec_;
  const WorkFolder& folder_;
  ModelWriter& writer_;
  uint32_t first_atlas_material_;
  std::map<std::pair<uint32_t, uint32_t>, Shown> versions_;  ///< smaller ones that nodes show, by texture and version
  std::vector<Place> places_;                                ///< by id
  std::optional<RandomAccessFile> file_;
  uint32_t open_unit_ = 0;
};

}  // namespace

Result<AssembledModel> assemble_model(const TreeUnits& units, const Survey& survey, const TextureStore& textures,
                                      const std::vector<Material>& materials, GeometryCodec codec,
                                      const WorkFolder& folder, ModelWriter& writer, JobMonitor& monitor) {
  Assembler assembler(units, survey, textures, materials, codec, folder, writer);
  assembler.order();
  PROMENADE_TRY(assembler.add_textures());
  PROMENADE_TRY(assembler.add_nodes(monitor));
  return AssembledModel{std::move(assembler.tables), std::move(assembler.objects)};
}

}  // namespace promenade
