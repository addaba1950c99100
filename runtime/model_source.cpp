#include "runtime/model_source.h"

#include <algorithm>

#include <fmt/format.h>

#include "codec/geometry_codec.h"
#include "codec/image_codec.h"
#include "layout/model_io.h"

namespace promenade {
namespace {

class ReaderSource final : public ModelSource {
 public:
  explicit ReaderSource(const ModelReader& reader) : reader_(reader) {}

  const Model& model() const override { return reader_.model(); }

  Status read_piece(uint32_t segment, uint64_t offset, std::span<std::byte> into) const override {
    return reader_.read_piece(segment, offset, into);
  }

  Result<Mesh> decode_mesh(NodeId node, std::span<const std::byte> stored) const override {
    PROMENADE_TRY(reader_.check_segment(model().tables.nodes[index_of(node)].segment, stored));
    return promenade::decode_mesh(stored);
  }

  Result<Image> decode_texture(uint32_t texture, std::span<const std::byte> stored) const override {
    const TextureRecord& record = model().tables.textures[texture];
    PROMENADE_TRY(reader_.check_segment(record.segment, stored));
    return decode_image(stored, fmt::format("texture {}", texture), uint64_t(record.width) * record.height);
  }

  const CellTables* cells() const override { return reader_.cells() != nullptr ? &reader_.cells()->tables() : nullptr; }
  uint32_t vlod_nodes(CellId cell) const override { return reader_.cells()->vlod_nodes(cell); }
  uint64_t vlod_reader_bytes() const override { return reader_.cells() != nullptr ? reader_.cells()->byte_size() : 0; }
  Result<Vlod> read_vlod(CellId cell) const override { return reader_.cells()->read_vlod(cell); }
  const Openings* openings() const override { return reader_.openings(); }

  const FarTables* far() const override { return reader_.far() != nullptr ? &reader_.far()->tables() : nullptr; }
  Result<std::vector<std::byte>> read_far_face(uint32_t face) const override { return reader_.far()->read_face(face); }

 private:
  const ModelReader& reader_;
};

}  // namespace

Result<Vlod> ModelSource::read_vlod(CellId cell) const {
  return Error{fmt::format("cell {}: the model has no cells", index_of(cell))};
}

Result<std::vector<std::byte>> ModelSource::read_far_face(uint32_t face) const {
  return Error{fmt::format("far face {}: the model has no far pictures", face)};
}

bool has_see_through(const Model& model) {
  return std::any_of(model.tables.materials.begin(), model.tables.materials.end(),
                     [](const Material& material) { return material.alpha == AlphaMode::blend; });
}

std::unique_ptr<ModelSource> source_of(const ModelReader& reader) { return std::make_unique<ReaderSource>(reader); }

}  // namespace promenade
