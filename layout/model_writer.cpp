// How a model is published: everything is written and synced in PATH.partial; then what stands at PATH is renamed to
// PATH.old, PATH.partial to PATH, and PATH.old is removed. A crash between the two renames leaves the old model whole
// under PATH.old: opening finds it there and the next writer puts it back.
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "codec/frame.h"
#include "layout/file_system.h"
#include "layout/manifest.h"
#include "layout/model_folder.h"
#include "layout/model_io.h"
#include "layout/objects_codec.h"
#include "layout/tables_codec.h"

namespace promenade {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostTablesBytes = uint64_t(1) << 40;
constexpr std::array<const char*, 8> kOwnNames = {kManifestName, kTablesName,   kGeometryName, kTexturesName,
                                                  kCellsName,    kOpeningsName, kFarName,      kObjectsName};

bool exists(const fs::path& path, FileSystem& files) {
  FileInfo info;
  int result = 0;
  do result = files.info(path, info);
  while (result == -EINTR);
  return result >= 0;
}

Status rename(const fs::path& from, const fs::path& to, FileSystem& files) {
  int result = 0;
  do result = files.rename(from, to);
  while (result == -EINTR);
  if (result < 0) return file_error(from, fmt::format("rename it to {}", to.filename().string()), -result);
  return Done{};
}

/// Removes a folder with the files that a model has, finished or not, and nothing else: a folder that holds more stays.
Status remove_model_folder(const fs::path& folder, FileSystem& files) {
  for (const char* name : kOwnNames) {
    files.remove(folder / name);
    files.remove(folder / ("." + std::string(name) + ".partial"));
  }
  const int result = files.remove(folder);
  if (result >= 0 || result == -ENOENT) return Done{};
  if (result == -ENOTEMPTY || result == -EEXIST)
    return Error{fmt::format("{}: holds files that are no part of a model; move them away", folder.string())};
  return file_error(folder, "remove", -result);
}

/// Puts back what a crash between two renames left, and removes what one after them did.
Status recover(const fs::path& path, FileSystem& files) {
  const fs::path old = beside(path, ".old");
  if (!exists(old / kManifestName, files)) return Done{};
  if (exists(path, files)) return remove_model_folder(old, files);
  PROMENADE_TRY(rename(old, path, files));
  return sync_folder(folder_of(path), files);
}

Status check_manifest(const ModelManifest& manifest) {
  for (const glm::dvec3& v : {manifest.origin, manifest.world_box.min, manifest.world_box.max})
    for (int i = 0; i < 3; ++i)
      if (!std::isfinite(v[i])) return Error{"origin or world box is not finite"};
  return Done{};
}

}  // namespace

struct ModelWriter::State {
  fs::path path;
  fs::path partial;
  FileSystem* files = nullptr;
  std::optional<FileLock> lock;
  std::optional<AtomicFile> geometry;
  std::optional<AtomicFile> textures;
  std::vector<SegmentRecord> segments;
  StoredManifest staged;
  ModelTables staged_tables;
  ModelObjects staged_objects;
  bool published = false;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    geometry.reset();
    textures.reset();
    // A failure here leaves a folder that the next writer removes.
    if (!published && lock) static_cast<void>(remove_model_folder(partial, *files));
  }

  Status start();
  Status create_data_files();
  Status take_files_of_model();
  Status write_tables();
  Status publish();
};

Status ModelWriter::State::start() {
  Result<FileLock> held =
      FileLock::acquire(path.parent_path() / ("." + path.filename().string() + ".writing"), "model " + path.string());
  if (!held) return held.error();
  lock.emplace(std::move(*held));
  PROMENADE_TRY(recover(path, *files));
  if (exists(path, *files) && !exists(path / kManifestName, *files))
    return Error{fmt::format("{}: exists and is no model; choose another name or move it away", path.string())};
  PROMENADE_TRY(remove_model_folder(partial, *files));
  int result = 0;
  do result = files->make_folder(partial);
  while (result == -EINTR);
  if (result < 0) return file_error(partial, "make the folder", -result);
  return Done{};
}

Status ModelWriter::State::create_data_files() {
  for (auto& [file, name] : {std::pair(&geometry, kGeometryName), std::pair(&textures, kTexturesName)}) {
    Result<AtomicFile> created = AtomicFile::create(partial / name, *files);
    if (!created) return created.error();
    file->emplace(std::move(*created));
  }
  return Done{};
}

/// A file under a second name, or its bytes.
Status share_file(const fs::path& from, const fs::path& to, FileSystem& files) {
  int result = 0;
  do result = files.link(from, to);
  while (result == -EINTR);
  if (result >= 0) return Done{};
  const Result<RandomAccessFile> source = RandomAccessFile::open(from, files);
  if (!source) return source.error();
  Result<AtomicFile> copy = AtomicFile::create(to, files);
  if (!copy) return copy.error();
  constexpr uint64_t kPieceBytes = 1 << 20;
  std::vector<std::byte> piece;
  for (uint64_t at = 0; at < source->size(); at += piece.size()) {
    piece.resize(std::min(kPieceBytes, source->size() - at));
    PROMENADE_TRY(source->read(at, piece));
    PROMENADE_TRY(copy->write(piece));
  }
  return copy->commit();
}

/// All but far pictures and the manifest, which is written anew.
Status ModelWriter::State::take_files_of_model() {
  std::vector<ModelManifest::File>& names = staged.manifest.files;
  std::erase_if(names, [](const ModelManifest::File& file) { return file.name == kFarName; });
  for (const ModelManifest::File& file : names)
    PROMENADE_TRY(share_file(path / file.name, partial / file.name, *files));
  return write_file(partial / kManifestName, std::string_view(manifest_text(staged)), *files);
}

Status ModelWriter::State::publish() {
  const fs::path old = beside(path, ".old");
  const bool replaces = exists(path, *files);
  if (replaces) PROMENADE_TRY(rename(path, old, *files));
  if (Status status = rename(partial, path, *files); !status) {
    // The old model must not stay under its other name.
    if (replaces) PROMENADE_TRY(rename(old, path, *files));
    return status;
  }
  published = true;
  PROMENADE_TRY(sync_folder(folder_of(path), *files));
  if (replaces) PROMENADE_TRY(remove_model_folder(old, *files));
  return Done{};
}

/// The staged tables, and what names them by their checksum.
Status ModelWriter::State::write_tables() {
  const std::vector<std::byte> bytes = encode_tables(staged_tables);
  PROMENADE_TRY(write_file(partial / kTablesName, bytes, *files));
  staged.tables_checksum = checksum(bytes);
  std::vector<ModelManifest::File>& names = staged.manifest.files;
  std::erase_if(names, [](const ModelManifest::File& file) { return file.name == kObjectsName; });
  if (!staged_objects.empty()) {
    const CellsOwner owner{staged.tables_checksum, static_cast<uint32_t>(staged_tables.nodes.size())};
    const std::vector<std::byte> objects = encode_objects(staged_objects, owner);
    PROMENADE_TRY(write_file(partial / kObjectsName, objects, *files));
    names.insert(names.end() - 1, {kObjectsName, objects.size()});
  }
  return write_file(partial / kManifestName, std::string_view(manifest_text(staged)), *files);
}

ModelWriter::ModelWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
ModelWriter::ModelWriter(ModelWriter&&) noexcept = default;
ModelWriter& ModelWriter::operator=(ModelWriter&&) noexcept = default;
ModelWriter::~ModelWriter() = default;

Result<std::unique_ptr<ModelWriter::State>> ModelWriter::started(const fs::path& path, FileSystem& files) {
  auto state = std::make_unique<State>();
  state->path = without_trailing_slash(path);
  if (!state->path.has_filename() || state->path.filename() == "." || state->path.filename() == "..")
    return Error{fmt::format("\"{}\": is no name for a model", path.string())};
  state->partial = beside(state->path, ".partial");
  state->files = &files;
  PROMENADE_TRY(state->start());
  return state;
}

Result<ModelWriter> ModelWriter::create(const fs::path& path, FileSystem& files) {
  Result<std::unique_ptr<State>> state = started(path, files);
  if (!state) return state.error();
  PROMENADE_TRY((*state)->create_data_files());
  return ModelWriter(std::move(*state));
}

Result<ModelWriter> ModelWriter::extend(const fs::path& path, const std::map<std::string, std::string>& settings,
                                        FileSystem& files) {
  Result<std::unique_ptr<State>> started_state = started(path, files);
  if (!started_state) return started_state.error();
  State& s = **started_state;
  // Sound, and held open until its files have been taken.
  const Result<ModelReader> reader = ModelReader::open(s.path, files);
  if (!reader) return reader.error();
  const Result<std::vector<std::byte>> tables = read_file(s.path / kTablesName, kMostTablesBytes, files);
  if (!tables) return tables.error();
  s.staged = {reader->model().manifest, checksum(*tables)};
  for (const auto& [name, value] : settings) s.staged.manifest.settings[name] = value;
  s.staged_tables = reader->model().tables;
  PROMENADE_TRY(s.take_files_of_model());
  return ModelWriter(std::move(*started_state));
}

Result<uint32_t> ModelWriter::append(SegmentRecord::Type type, std::span<const std::byte> bytes) {
  State& s = *state_;
  const bool mesh = type == SegmentRecord::Type::mesh;
  if (bytes.size() > std::numeric_limits<uint32_t>::max())
    return Error{
        fmt::format("{}: a segment of {} bytes; at most 4 GiB are stored as one", s.path.string(), bytes.size())};
  if (s.segments.size() >= std::numeric_limits<uint32_t>::max())
    return Error{fmt::format("{}: too many segments", s.path.string())};
  AtomicFile& file = mesh ? *s.geometry : *s.textures;
  SegmentRecord record;
  record.type = type;
  record.file = mesh ? 0 : 1;
  record.offset = file.size();
  record.stored_bytes = static_cast<uint32_t>(bytes.size());
  record.checksum = checksum(bytes);
  PROMENADE_TRY(file.write(bytes));
  s.segments.push_back(record);
  return static_cast<uint32_t>(s.segments.size() - 1);
}

Status ModelWriter::stage(ModelTables tables, ModelManifest manifest, ModelObjects objects) {
  State& s = *state_;
  Model model{std::move(manifest), std::move(tables), std::move(objects)};
  model.tables.segments = s.segments;
  model.manifest.files = {{kGeometryName, s.geometry->size()},
                          {kTexturesName, s.textures->size()},
                          {kTablesName, encode_tables(model.tables).size()}};
  std::string defect = find_defect(model);
  if (const Status status = check_manifest(model.manifest); defect.empty() && !status) defect = status.error().message;
  if (!defect.empty()) return Error{fmt::format("{}: refused to write an unsound model: {}", s.path.string(), defect)};
  PROMENADE_TRY(s.geometry->commit());
  PROMENADE_TRY(s.textures->commit());
  s.staged = {std::move(model.manifest), 0};
  s.staged_tables = std::move(model.tables);
  s.staged_objects = std::move(model.objects);
  return s.write_tables();
}

std::filesystem::path ModelWriter::staged_folder() const { return state_->partial; }

Status ModelWriter::reorder(std::span<const uint32_t> nodes) {
  State& s = *state_;
  ModelTables& tables = s.staged_tables;
  const Result<RandomAccessFile> from = RandomAccessFile::open(s.partial / kGeometryName, *s.files);
  if (!from) return from.error();
  Result<AtomicFile> to = AtomicFile::create(s.partial / kGeometryName, *s.files);
  if (!to) return to.error();
  std::vector<SegmentRecord> moved = tables.segments;
  std::vector<std::byte> bytes;
  for (const uint32_t node : nodes) {
    const SegmentRecord& segment = tables.segments[tables.nodes[node].segment];
    bytes.resize(segment.stored_bytes);
    PROMENADE_TRY(from->read(segment.offset, bytes));
    moved[tables.nodes[node].segment].offset = to->size();
    PROMENADE_TRY(to->write(bytes));
  }
  if (to->size() != from->size())
    return Error{
        fmt::format("{}: an order of {} bytes of meshes, there are {}", s.path.string(), to->size(), from->size())};
  PROMENADE_TRY(to->commit());
  tables.segments = std::move(moved);
  return s.write_tables();
}

Status ModelWriter::add_cells(const CellTables& cells, const VlodSource& vlod_of) {
  State& s = *state_;
  const Result<NodeForest> forest = node_forest(s.staged_tables);
  if (!forest) return Error{fmt::format("{}: {}", s.path.string(), forest.error().message)};
  const CellsOwner owner{s.staged.tables_checksum, static_cast<uint32_t>(s.staged_tables.nodes.size())};
  const Result<uint64_t> bytes = write_cells(s.partial / kCellsName, cells, owner, *forest, vlod_of, *s.files);
  if (!bytes) return bytes.error();
  std::vector<ModelManifest::File>& names = s.staged.manifest.files;
  names.insert(names.end() - 1, {kCellsName, *bytes});
  return write_file(s.partial / kManifestName, std::string_view(manifest_text(s.staged)), *s.files);
}

Status ModelWriter::add_openings(const Openings& openings) {
  State& s = *state_;
  const std::vector<std::byte> bytes = encode_openings(openings, s.staged.tables_checksum);
  PROMENADE_TRY(write_file(s.partial / kOpeningsName, bytes, *s.files));
  std::vector<ModelManifest::File>& names = s.staged.manifest.files;
  names.insert(names.end() - 1, {kOpeningsName, bytes.size()});
  return write_file(s.partial / kManifestName, std::string_view(manifest_text(s.staged)), *s.files);
}

Status ModelWriter::add_far(const FarTables& tables, const FarCellSource& next_cells) {
  State& s = *state_;
  const CellsOwner owner{s.staged.tables_checksum, static_cast<uint32_t>(s.staged_tables.nodes.size())};
  const Result<uint64_t> bytes = write_far(s.partial / kFarName, tables, owner, next_cells, *s.files);
  if (!bytes) return bytes.error();
  std::vector<ModelManifest::File>& names = s.staged.manifest.files;
  names.insert(names.end() - 1, {kFarName, *bytes});
  return write_file(s.partial / kManifestName, std::string_view(manifest_text(s.staged)), *s.files);
}

Status ModelWriter::publish() { return state_->publish(); }

Status ModelWriter::finish(ModelTables tables, ModelManifest manifest) {
  PROMENADE_TRY(stage(std::move(tables), std::move(manifest)));
  return publish();
}

}  // namespace promenade
