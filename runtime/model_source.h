#pragma once
// Where the runtime gets a model from: its tables, pieces of its segments, and what segments decode to.

#include <cstddef>
#include <memory>
#include <span>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "layout/cells_io.h"
#include "layout/far.h"
#include "layout/model.h"
#include "layout/openings.h"

namespace promenade {

class ModelReader;

/// A model on disk, or in a test's memory. All functions may be called from any thread at once.
class ModelSource {
 public:
  virtual ~ModelSource() = default;
  virtual const Model& model() const = 0;
  /// A piece of a segment: into.size() bytes from `offset` within it.
  virtual Status read_piece(uint32_t segment, uint64_t offset, std::span<std::byte> into) const = 0;
  /// Whole stored bytes to the thing itself, checksum compared first. Safe on any bytes.
  virtual Result<Mesh> decode_mesh(NodeId node, std::span<const std::byte> stored) const = 0;
  virtual Result<Image> decode_texture(uint32_t texture, std::span<const std::byte> stored) const = 0;

  /// The view cells; null: the model has none.
  virtual const CellTables* cells() const { return nullptr; }
  /// How many nodes a cell's vLOD has.
  virtual uint32_t vlod_nodes(CellId cell) const { return static_cast<void>(cell), 0; }
  /// What reading vLODs keeps in memory at most, besides the tables.
  virtual uint64_t vlod_reader_bytes() const { return 0; }
  virtual Result<Vlod> read_vlod(CellId cell) const;
  /// What is open in walls; null: the model does not say.
  virtual const Openings* openings() const { return nullptr; }

  /// The far pictures; null: the model has none.
  virtual const FarTables* far() const { return nullptr; }
  /// A face's stored bytes (codec/far_face.h), checked.
  virtual Result<std::vector<std::byte>> read_far_face(uint32_t face) const;
};

/// Whether some of the model's surfaces may be seen through (AlphaMode::blend).
bool has_see_through(const Model& model);

/// The model that a reader opened. The reader must outlive it.
std::unique_ptr<ModelSource> source_of(const ModelReader& reader);

}  // namespace promenade
