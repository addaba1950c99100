#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <utility>

#include "codec/frame.h"
#include "codec/geometry_codec.h"
#include "codec/image_codec.h"
#include "layout/file_system.h"
#include "layout/manifest.h"
#include "layout/model_folder.h"
#include "layout/model_io.h"
#include "layout/objects_codec.h"
#include "layout/tables_codec.h"

namespace promenade {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxManifestBytes = uint64_t(1) << 26;  // bounds the parser's memory; real ones have kilobytes

/// The folder to read: PATH, or PATH.old when a crash left the model there.
Result<fs::path> folder_of_model(const fs::path& given, FileSystem& files) {
  const fs::path path = without_trailing_slash(given);
  FileInfo info;
  if (files.info(path / kManifestName, info) >= 0) return path;
  const bool there = files.info(path, info) >= 0;
  if (there && !info.folder)
    return Error{fmt::format("{}: is a file, not a model; a model is the folder that build writes", path.string())};
  if (there) return Error{fmt::format("{}: is no model: it has no {}", path.string(), kManifestName)};
  if (files.info(beside(path, ".old") / kManifestName, info) >= 0) return beside(path, ".old");
  return Error{fmt::format("{}: there is no such model; build one with promenade build", path.string())};
}

Result<StoredManifest> read_manifest(const fs::path& folder, FileSystem& files) {
  const fs::path path = folder / kManifestName;
  const Result<std::vector<std::byte>> bytes = read_file(path, kMaxManifestBytes, files);
  if (!bytes) return bytes.error();
  Result<StoredManifest> stored =
      parse_manifest(std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size()));
  if (!stored) return Error{fmt::format("{}: {}", path.string(), stored.error().message)};
  return stored;
}

Result<ModelTables> read_tables(const fs::path& folder, const StoredManifest& stored, FileSystem& files) {
  const fs::path path = folder / kTablesName;
  const Result<std::vector<std::byte>> bytes = read_file(path, uint64_t(1) << 40, files);
  if (!bytes) return bytes.error();
  Result<ModelTables> tables = decode_tables(*bytes);
  if (!tables) return Error{fmt::format("{}: {}", path.string(), tables.error().message)};
  if (const uint64_t found = checksum(*bytes); found != stored.tables_checksum)
    return Error{fmt::format("{}: checksum {:016x} != {:016x} of {}; the files are not of one build", path.string(),
                             found, stored.tables_checksum, kManifestName)};
  return tables;
}

bool names_file(const ModelManifest& manifest, const char* name) {
  return std::any_of(manifest.files.begin(), manifest.files.end(),
                     [name](const ModelManifest::File& file) { return file.name == name; });
}

/// Empty where the model has none.
Result<ModelObjects> read_objects(const fs::path& folder, const StoredManifest& stored, size_t nodes,
                                  FileSystem& files) {
  if (!names_file(stored.manifest, kObjectsName)) return ModelObjects();
  const fs::path path = folder / kObjectsName;
  const Result<std::vector<std::byte>> bytes = read_file(path, uint64_t(1) << 40, files);
  if (!bytes) return bytes.error();
  Result<ModelObjects> objects = decode_objects(*bytes, {stored.tables_checksum, static_cast<uint32_t>(nodes)});
  if (!objects) return Error{fmt::format("{}: {}", path.string(), objects.error().message)};
  return objects;
}

}  // namespace

struct ModelReader::State {
  fs::path folder;
  Model model;
  std::vector<RandomAccessFile> files;  // as in the manifest, without the tables
  std::optional<CellsReader> cells;
  std::optional<Openings> openings;
  std::optional<FarReader> far;

  std::string name_of_segment(uint32_t segment) const {
    const SegmentRecord& record = model.tables.segments[segment];
    return fmt::format("{}: segment {} @{:#x}", (folder / model.manifest.files[record.file].name).string(), segment,
                       record.offset);
  }

  Status open_files(FileSystem& file_system) {
    for (const ModelManifest::File& file : model.manifest.files) {
      if (file.name == kTablesName) continue;
      Result<RandomAccessFile> opened = RandomAccessFile::open(folder / file.name, file_system);
      if (!opened) return opened.error();
      if (opened->size() != file.bytes)
        return Error{fmt::format("{}: has {} bytes, {} says {}; copy the model again", (folder / file.name).string(),
                                 opened->size(), kManifestName, file.bytes)};
      files.push_back(std::move(*opened));
    }
    return Done{};
  }

  Status open_far(uint64_t tables_checksum, FileSystem& file_system) {
    if (!names_file(model.manifest, kFarName)) return Done{};
    const CellsOwner owner{tables_checksum, static_cast<uint32_t>(model.tables.nodes.size())};
    Result<FarReader> opened = FarReader::open(folder / kFarName, owner, file_system);
    if (!opened) return opened.error();
    far.emplace(std::move(*opened));
    return Done{};
  }

  Status open_cells(uint64_t tables_checksum, FileSystem& file_system) {
    if (!names_file(model.manifest, kCellsName)) return Done{};
    const CellsOwner owner{tables_checksum, static_cast<uint32_t>(model.tables.nodes.size())};
    Result<NodeForest> forest = node_forest(model.tables);
    if (!forest) return Error{fmt::format("{}: {}", (folder / kTablesName).string(), forest.error().message)};
    Result<CellsReader> opened = CellsReader::open(folder / kCellsName, owner, std::move(*forest), file_system);
    if (!opened) return opened.error();
    cells.emplace(std::move(*opened));
    return Done{};
  }

  Status open_openings(uint64_t tables_checksum, FileSystem& file_system) {
    if (!names_file(model.manifest, kOpeningsName)) return Done{};
    const fs::path path = folder / kOpeningsName;
    if (!cells) return Error{fmt::format("{}: openings without {}", path.string(), kCellsName)};
    const Result<std::vector<std::byte>> bytes = read_file(path, uint64_t(1) << 32, file_system);
    if (!bytes) return bytes.error();
    Result<Openings> decoded = decode_openings(*bytes, cells->tables(), tables_checksum);
    if (!decoded) return Error{fmt::format("{}: {}", path.string(), decoded.error().message)};
    openings.emplace(std::move(*decoded));
    return Done{};
  }
};

ModelReader::ModelReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
ModelReader::ModelReader(ModelReader&&) noexcept = default;
ModelReader& ModelReader::operator=(ModelReader&&) noexcept = default;
ModelReader::~ModelReader() = default;

Result<ModelReader> ModelReader::open(const fs::path& path, FileSystem& files) {
  const Result<fs::path> folder = folder_of_model(path, files);
  if (!folder) return folder.error();
  auto state = std::make_unique<State>();
  state->folder = *folder;
  Result<StoredManifest> stored = read_manifest(*folder, files);
  if (!stored) return stored.error();
  Result<ModelTables> tables = read_tables(*folder, *stored, files);
  if (!tables) return tables.error();
  Result<ModelObjects> objects = read_objects(*folder, *stored, tables->nodes.size(), files);
  if (!objects) return objects.error();
  state->model = {std::move(stored->manifest), std::move(*tables), std::move(*objects)};
  if (const std::string defect = find_defect(state->model); !defect.empty())
    return Error{fmt::format("{}: {}", (*folder / kTablesName).string(), defect)};
  PROMENADE_TRY(state->open_files(files));
  PROMENADE_TRY(state->open_cells(stored->tables_checksum, files));
  PROMENADE_TRY(state->open_openings(stored->tables_checksum, files));
  PROMENADE_TRY(state->open_far(stored->tables_checksum, files));
  return ModelReader(std::move(state));
}

const Model& ModelReader::model() const { return state_->model; }

const Openings* ModelReader::openings() const { return state_->openings ? &*state_->openings : nullptr; }
const CellsReader* ModelReader::cells() const { return state_->cells ? &*state_->cells : nullptr; }

const FarReader* ModelReader::far() const { return state_->far ? &*state_->far : nullptr; }

Status ModelReader::read_piece(uint32_t segment, uint64_t offset, std::span<std::byte> into) const {
  const SegmentRecord& record = state_->model.tables.segments[segment];
  if (offset > record.stored_bytes || into.size() > record.stored_bytes - offset)
    return Error{fmt::format("{}: piece of {} bytes from {} of {}", state_->name_of_segment(segment), into.size(),
                             offset, record.stored_bytes)};
  return state_->files[record.file].read(record.offset + offset, into);
}

Status ModelReader::check_segment(uint32_t segment, std::span<const std::byte> bytes) const {
  const SegmentRecord& record = state_->model.tables.segments[segment];
  const uint64_t found = checksum(bytes);
  if (bytes.size() == record.stored_bytes && found == record.checksum) return Done{};
  return Error{fmt::format("{}: checksum {:016x} != {:016x} of {} bytes; copy or build the model again",
                           state_->name_of_segment(segment), found, record.checksum, record.stored_bytes)};
}

Result<std::vector<std::byte>> ModelReader::read_segment(uint32_t segment) const {
  std::vector<std::byte> bytes(state_->model.tables.segments[segment].stored_bytes);
  PROMENADE_TRY(read_piece(segment, 0, bytes));
  PROMENADE_TRY(check_segment(segment, bytes));
  return bytes;
}

Result<Mesh> ModelReader::read_mesh(NodeId id) const {
  const ModelTables& tables = state_->model.tables;
  const NodeRecord& node = tables.nodes[index_of(id)];
  const Result<std::vector<std::byte>> bytes = read_segment(node.segment);
  if (!bytes) return bytes.error();
  Result<Mesh> mesh = decode_mesh(*bytes);
  if (!mesh) return Error{fmt::format("{}: {}", state_->name_of_segment(node.segment), mesh.error().message)};
  if (mesh->triangle_count() > node.triangles || mesh->vertex_count() > node.vertices)
    return Error{fmt::format("{}: {} triangles and {} vertices, node {} has {} and {}",
                             state_->name_of_segment(node.segment), mesh->triangle_count(), mesh->vertex_count(),
                             index_of(id), node.triangles, node.vertices)};
  for (const uint32_t material : mesh->materials)
    if (material >= tables.materials.size())
      return Error{fmt::format("{}: material {} of {}", state_->name_of_segment(node.segment), material,
                               tables.materials.size())};
  return mesh;
}

Result<Image> ModelReader::read_texture(uint32_t texture) const {
  const TextureRecord& record = state_->model.tables.textures[texture];
  const Result<std::vector<std::byte>> bytes = read_segment(record.segment);
  if (!bytes) return bytes.error();
  const std::string name = state_->name_of_segment(record.segment);
  Result<Image> image = decode_image(*bytes, name, uint64_t(record.width) * record.height);
  if (image && (image->width != record.width || image->height != record.height))
    return Error{fmt::format("{}: picture of {} x {} pixels, texture {} has {} x {}", name, image->width, image->height,
                             texture, record.width, record.height)};
  return image;
}

Status verify_checksums(const ModelReader& reader, JobMonitor& monitor) {
  const std::vector<SegmentRecord>& segments = reader.model().tables.segments;
  for (uint32_t i = 0; i < segments.size(); ++i) {
    if (monitor.cancelled()) return Error{"interrupted"};
    const Result<std::vector<std::byte>> bytes = reader.read_segment(i);
    if (!bytes) return bytes.error();
    monitor.progress("checksums", i + 1, segments.size());
  }
  const uint32_t cells = reader.cells() != nullptr ? static_cast<uint32_t>(reader.cells()->tables().cells.size()) : 0;
  for (uint32_t i = 0; i < cells; ++i) {
    if (monitor.cancelled()) return Error{"interrupted"};
    if (const Result<Vlod> vlod = reader.cells()->read_vlod(CellId{i}); !vlod) return vlod.error();
    monitor.progress("cells", i + 1, cells);
  }
  const uint32_t faces = reader.far() != nullptr ? static_cast<uint32_t>(reader.far()->tables().faces.size()) : 0;
  for (uint32_t i = 0; i < faces; ++i) {
    if (monitor.cancelled()) return Error{"interrupted"};
    if (const Result<std::vector<std::byte>> bytes = reader.far()->read_face(i); !bytes) return bytes.error();
    monitor.progress("far pictures", i + 1, faces);
  }
  return Done{};
}

}  // namespace promenade
