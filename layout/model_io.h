#pragma once
// Writing and opening a model: a directory with manifest.json, tables.bin and a few large data files. See FORMAT.md.

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "geometry/job_monitor.h"
#include "layout/cells_io.h"
#include "layout/far_io.h"
#include "layout/file_io.h"
#include "layout/model.h"
#include "layout/openings.h"

namespace promenade {

/// Writes a model into "PATH.partial" and publishes it by one rename. What stood at PATH (a model, or nothing; never
/// anything else) is replaced only then. Destroyed without finish(): PATH is untouched. One thread.
class ModelWriter {
 public:
  /// Refuses a PATH that exists and is no model.
  static Result<ModelWriter> create(const std::filesystem::path& path, FileSystem& files = real_file_system());
  /// The model at PATH once more, staged, without its far pictures: its files under second names, or copied where the
  /// filesystem has none. settings take the place of those of the same names. For add_far() and publish() alone.
  static Result<ModelWriter> extend(const std::filesystem::path& path,
                                    const std::map<std::string, std::string>& settings,
                                    FileSystem& files = real_file_system());
  ModelWriter(ModelWriter&&) noexcept;
  ModelWriter& operator=(ModelWriter&&) noexcept;
  ~ModelWriter();

  /// Appends bytes to the data file of that type (geometry.bin or textures.bin) and returns the segment's index.
  Result<uint32_t> append(SegmentRecord::Type type, std::span<const std::byte> bytes);

  /// Writes tables and manifest (files, segments and checksums are filled in here), checks find_defect and syncs: a
  /// whole model, though not under its name, that can be opened at staged_folder().
  Status stage(ModelTables tables, ModelManifest manifest, ModelObjects objects = {});
  std::filesystem::path staged_folder() const;
  /// Lays the staged model's meshes out in this order of its nodes, each of them once. Before add_cells.
  Status reorder(std::span<const uint32_t> nodes);
  /// View cells for the staged model. At most once.
  Status add_cells(const CellTables& cells, const VlodSource& vlod_of);
  /// What is open between the regions of these cells, which have been added. At most once.
  Status add_openings(const Openings& openings);
  /// Far pictures for the staged model, last of all. At most once. tables: without cells and faces.
  Status add_far(const FarTables& tables, const FarCellSource& next_cells);
  /// Renames the staged model to its name.
  Status publish();
  /// stage() and publish(): a model without cells.
  Status finish(ModelTables tables, ModelManifest manifest);

 private:
  struct State;
  static Result<std::unique_ptr<State>> started(const std::filesystem::path& path, FileSystem& files);
  explicit ModelWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// An open model. Tables are in memory; segments are read on demand, from any thread at once.
class ModelReader {
 public:
  /// Reads and checks manifest and tables. An error names file, section, offset, what was found and the limit.
  static Result<ModelReader> open(const std::filesystem::path& path, FileSystem& files = real_file_system());
  ModelReader(ModelReader&&) noexcept;
  ModelReader& operator=(ModelReader&&) noexcept;
  ~ModelReader();

  const Model& model() const;

  /// A piece of a segment: into.size() bytes from `offset` within it. Not checked against the checksum: pieces cannot
  /// be; check_segment does.
  Status read_piece(uint32_t segment, uint64_t offset, std::span<std::byte> into) const;
  /// Compares whole stored bytes with the checksum.
  Status check_segment(uint32_t segment, std::span<const std::byte> bytes) const;
  /// Whole segment, checked.
  Result<std::vector<std::byte>> read_segment(uint32_t segment) const;

  /// Reads, checks and decodes a node's mesh.
  Result<Mesh> read_mesh(NodeId id) const;
  /// Reads, checks and decodes a texture's picture.
  Result<Image> read_texture(uint32_t texture) const;

  /// The model's view cells and what they see; null: it has none.
  const CellsReader* cells() const;
  /// What is open in walls; null: the model does not say.
  const Openings* openings() const;
  /// The model's far pictures; null: it has none.
  const FarReader* far() const;

 private:
  struct State;
  explicit ModelReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Checks every segment, every cell's vLOD and every far picture against its checksum. Error: the first that fails.
Status verify_checksums(const ModelReader& reader, JobMonitor& monitor);

}  // namespace promenade
