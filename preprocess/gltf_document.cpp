#include "preprocess/gltf_document.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <limits>
#include <type_traits>

#include "preprocess/import_uri.h"

namespace promenade {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian and is read as it lies");

namespace {

constexpr uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr uint32_t kBinChunk = 0x004E4942;   // "BIN"
constexpr uint64_t kHeaderBytes = 12;
constexpr uint64_t kChunkHeaderBytes = 8;
constexpr uint64_t kMaxJsonBytes = uint64_t(1) << 30;
// An accessor without a view costs the file nothing: bounds what it can make us allocate.
constexpr uint64_t kMaxZeroElements = uint64_t(1) << 22;
// meshoptimizer's vertex coder stores at best 2 bits for 16 equal bytes; bounds what a view can claim to expand to.
constexpr uint64_t kMaxMeshoptRatio = 80;
constexpr size_t kReadPieceBytes = size_t(1) << 20;

struct ComponentType {
  uint32_t code;
  uint32_t bytes;
};

uint32_t component_bytes(uint64_t code) {
  constexpr std::array<ComponentType, 6> kTypes{{{5120, 1}, {5121, 1}, {5122, 2}, {5123, 2}, {5125, 4}, {5126, 4}}};
  for (const ComponentType& type : kTypes)
    if (type.code == code) return type.bytes;
  return 0;
}

uint32_t component_count(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4" || type == "MAT2") return 4;
  if (type == "MAT3") return 9;
  return type == "MAT4" ? 16 : 0;
}

uint32_t read_u32(std::span<const std::byte> bytes, size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

template <class Stored, class T>
T convert(const std::byte* at, bool normalized) {
  Stored stored;
  std::memcpy(&stored, at, sizeof(stored));
  if constexpr (std::is_same_v<Stored, float> && std::is_same_v<T, uint32_t>) {
    return 0;  // read_indices refuses floats
  } else if constexpr (std::is_integral_v<Stored> && std::is_same_v<T, float>) {
    if (normalized)
      return std::max(static_cast<float>(double(stored) / double(std::numeric_limits<Stored>::max())), -1.0F);
    return static_cast<float>(stored);
  } else {
    return static_cast<T>(stored);
  }
}

template <class Stored, class T>
void convert_all(const std::byte* from, uint64_t count, const GltfAccessor& a, T* out) {
  for (uint64_t i = 0; i < count; ++i)
    for (uint64_t c = 0; c < a.components; ++c)
      *out++ = convert<Stored, T>(from + i * a.stride + c * sizeof(Stored), a.normalized);
}

template <class T>
void convert_elements(const std::byte* from, uint64_t count, const GltfAccessor& a, T* out) {
  switch (a.component_type) {
    case 5120:
      return convert_all<int8_t>(from, count, a, out);
    case 5121:
      return convert_all<uint8_t>(from, count, a, out);
    case 5122:
      return convert_all<int16_t>(from, count, a, out);
    case 5123:
      return convert_all<uint16_t>(from, count, a, out);
    case 5125:
      return convert_all<uint32_t>(from, count, a, out);
    default:
      return convert_all<float>(from, count, a, out);
  }
}

/// Whether a run of `count` elements fits into `size` bytes, without overflow.
bool fits(uint64_t offset, uint64_t count, uint64_t stride, uint64_t element, uint64_t size) {
  if (count == 0) return offset <= size;
  if (offset > size || element > size - offset) return false;
  return stride == 0 ? count == 1 : count - 1 <= (size - offset - element) / stride;
}

}  // namespace

Error GltfDocument::fail(const char* what, uint64_t index, const std::string& message) const {
  return Error{fmt::format("{}: {} {}: {}; the file is cut off or broken", name_, what, index, message)};
}

Result<GltfDocument> GltfDocument::open(const std::filesystem::path& path, const std::string& name) {
  GltfDocument document;
  document.name_ = name;
  document.folder_ = path.parent_path();
  PROMENADE_TRY(document.open_binary(path));
  if (!document.json_.is_object()) return Error{fmt::format("{}: the JSON is no object; the file is not glTF", name)};
  const std::string version = text(member(member(document.json_, "asset"), "version"));
  if (version.substr(0, 2) != "2.")
    return Error{fmt::format("{}: glTF version '{}' cannot be read, only 2.x; convert it to glTF 2.0", name, version)};
  PROMENADE_TRY(document.open_buffers());
  PROMENADE_TRY(document.describe_views());
  return document;
}

Status GltfDocument::open_binary(const std::filesystem::path& path) {
  Result<RandomAccessFile> opened = RandomAccessFile::open(path);
  if (!opened.ok()) return opened.error();
  auto file = std::make_shared<RandomAccessFile>(*std::move(opened));
  const uint64_t size = file->size();
  std::array<std::byte, kHeaderBytes + kChunkHeaderBytes> header{};
  const size_t head = static_cast<size_t>(std::min<uint64_t>(size, header.size()));
  PROMENADE_TRY(file->read(0, std::span(header).first(head)));
  const bool binary = head >= 4 && read_u32(header, 0) == kMagic;
  uint64_t json_at = 0;
  uint64_t json_bytes = size;
  if (binary) {
    if (head < header.size() || read_u32(header, 16) != kJsonChunk)
      return Error{fmt::format("{}: {} bytes without a JSON chunk; the file is cut off or broken", name_, size)};
    if (read_u32(header, 4) != 2)
      return Error{fmt::format("{}: GLB version {} cannot be read, only 2; convert it", name_, read_u32(header, 4))};
    json_at = header.size();
    json_bytes = read_u32(header, 12);
  }
  if (json_bytes > size - json_at || json_bytes > kMaxJsonBytes)
    return Error{fmt::format("{}: JSON of {} bytes where the file has {}; the file is cut off or broken", name_,
                             json_bytes, size - json_at)};
  std::string json_text(static_cast<size_t>(json_bytes), '\0');
  PROMENADE_TRY(file->read(json_at, std::as_writable_bytes(std::span(json_text))));
  Result<Json> parsed = parse_json(json_text, name_);
  if (!parsed.ok()) return parsed.error();
  json_ = *std::move(parsed);
  source_bytes_ += json_bytes;
  const uint64_t chunk_at = json_at + json_bytes;
  if (!binary || size - chunk_at < kChunkHeaderBytes) return Done{};
  PROMENADE_TRY(file->read(chunk_at, std::span(header).first(kChunkHeaderBytes)));
  if (read_u32(header, 4) != kBinChunk) return Done{};
  binary_chunk_ = Buffer{file, chunk_at + kChunkHeaderBytes, read_u32(header, 0), {}};
  if (binary_chunk_->size > size - binary_chunk_->offset)
    return Error{fmt::format("{}: binary chunk of {} bytes at byte {} where {} are left; the file is cut off", name_,
                             binary_chunk_->size, chunk_at, size - binary_chunk_->offset)};
  return Done{};
}

Status GltfDocument::open_buffers() {
  const Json& declared = member(json_, "buffers");
  if (!declared.is_array()) return Done{};
  for (size_t i = 0; i < declared.size(); ++i) {
    Result<Buffer> buffer = open_buffer(declared[i], i);
    if (!buffer.ok()) return buffer.error();
    const std::optional<uint64_t> wanted = whole(member(declared[i], "byteLength"));
    // A buffer that only stands for its compressed views is declared without bytes.
    const bool fallback =
        truth(member(member(member(declared[i], "extensions"), "EXT_meshopt_compression"), "fallback"));
    if (!fallback && (!wanted || *wanted > buffer->size))
      return fail("buffer", i, fmt::format("{} bytes declared, {} there", wanted.value_or(0), buffer->size));
    source_bytes_ += buffer->size;
    buffers_.push_back(*std::move(buffer));
  }
  return Done{};
}

Result<GltfDocument::Buffer> GltfDocument::open_buffer(const Json& declared, size_t index) {
  const Json& uri = member(declared, "uri");
  if (!uri.is_string()) {
    if (index == 0 && binary_chunk_) return *binary_chunk_;
    return Buffer{};
  }
  const auto& reference = uri.get_ref<const std::string&>();
  Buffer buffer;
  if (is_data_uri(reference)) {
    std::optional<std::vector<std::byte>> bytes = decode_data_uri(reference);
    if (!bytes) return fail("buffer", index, "a data URI that is not base64");
    buffer.memory = *std::move(bytes);
    buffer.size = buffer.memory.size();
    return buffer;
  }
  Result<std::filesystem::path> path = resolve_reference(folder_, reference, true);
  if (!path.ok())
    return Error{fmt::format("{}: buffer {}: '{}' {}; put the file beside the source", name_, index,
                             reference.substr(0, 200), path.error().message)};
  Result<RandomAccessFile> file = RandomAccessFile::open(*path);
  if (!file.ok()) return file.error();
  buffer.file = std::make_shared<RandomAccessFile>(*std::move(file));
  buffer.size = buffer.file->size();
  return buffer;
}

Status GltfDocument::describe_views() {
  const Json& declared = member(json_, "bufferViews");
  if (!declared.is_array()) return Done{};
  for (size_t i = 0; i < declared.size(); ++i) {
    Result<View> view = describe_view(declared[i], i);
    if (!view.ok()) return view.error();
    views_.push_back(*std::move(view));
  }
  return Done{};
}

Result<GltfDocument::View> GltfDocument::describe_view(const Json& declared, size_t index) const {
  View view;
  const Json& compression = member(member(declared, "extensions"), "EXT_meshopt_compression");
  view.compressed = compression.is_object();
  const Json& stored = view.compressed ? compression : declared;
  const std::optional<uint64_t> buffer = whole(member(stored, "buffer"));
  const std::optional<uint64_t> size = whole(member(stored, "byteLength"));
  view.offset = whole(member(stored, "byteOffset")).value_or(0);
  view.stride = whole(member(declared, "byteStride")).value_or(0);
  if (!buffer || *buffer >= buffers_.size()) return fail("bufferView", index, "names no buffer");
  view.buffer = static_cast<size_t>(*buffer);
  view.size = size.value_or(0);
  const uint64_t there = buffers_[view.buffer].size;
  if (!size || view.offset > there || view.size > there - view.offset)
    return fail("bufferView", index, fmt::format("{} bytes at {} of a buffer of {}", view.size, view.offset, there));
  if (!view.compressed) return view;
  // The size after decompression; bounded by what the coder can reach.
  const uint64_t count = whole(member(stored, "count")).value_or(0);
  const uint64_t stride = whole(member(stored, "byteStride")).value_or(0);
  if (stride == 0 || stride > 256 || count > (view.size * kMaxMeshoptRatio + 4096) / stride)
    return fail("bufferView", index, fmt::format("{} x {} bytes from {} compressed", count, stride, view.size));
  return view;
}

Status GltfDocument::decode_view(size_t index) {
  View& view = views_[index];
  if (view.decoded) return Done{};
  std::vector<std::byte> packed(static_cast<size_t>(view.size));
  const Buffer& buffer = buffers_[view.buffer];
  if (buffer.file)
    PROMENADE_TRY(buffer.file->read(buffer.offset + view.offset, packed));
  else
    std::copy_n(buffer.memory.begin() + static_cast<ptrdiff_t>(view.offset), packed.size(), packed.begin());

  const Json& how = member(member(json_["bufferViews"][index], "extensions"), "EXT_meshopt_compression");
  const auto count = static_cast<size_t>(whole(member(how, "count")).value_or(0));
  const auto stride = static_cast<size_t>(whole(member(how, "byteStride")).value_or(0));
  const std::string mode = text(member(how, "mode"));
  const std::string filter = text(member(how, "filter"));
  std::vector<std::byte> bytes(count * stride);
  // The coders read as many bytes at once as they like near the end only after checking; sizes are given exactly.
  const auto* from = reinterpret_cast<const unsigned char*>(packed.data());
  int code = -1;
  if (mode == "ATTRIBUTES" && stride % 4 == 0)
    code = meshopt_decodeVertexBuffer(bytes.data(), count, stride, from, packed.size());
  else if (mode == "TRIANGLES" && (stride == 2 || stride == 4) && count % 3 == 0)
    code = meshopt_decodeIndexBuffer(bytes.data(), count, stride, from, packed.size());
  else if (mode == "INDICES" && (stride == 2 || stride == 4))
    code = meshopt_decodeIndexSequence(bytes.data(), count, stride, from, packed.size());
  if (code != 0) return fail("bufferView", index, fmt::format("compressed {} do not decode", mode.substr(0, 20)));
  // The SIMD filters round the count up to 4 inside a copy of their own; any count is fine.
  if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
    meshopt_decodeFilterOct(bytes.data(), count, stride);
  else if (filter == "QUATERNION" && stride == 8)
    meshopt_decodeFilterQuat(bytes.data(), count, stride);
  else if (filter == "EXPONENTIAL" && stride % 4 == 0)
    meshopt_decodeFilterExp(bytes.data(), count, stride);
  else if (!filter.empty() && filter != "NONE")
    return fail("bufferView", index, fmt::format("filter {} for {} bytes", filter.substr(0, 20), stride));
  view.decoded = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  view.size = view.decoded->size();
  return Done{};
}

Status GltfDocument::read_view(size_t index, uint64_t offset, std::span<std::byte> into) {
  const View& view = views_[index];
  assert(offset <= view.size && into.size() <= view.size - offset);
  const Buffer& buffer = buffers_[view.buffer];
  if (view.decoded)
    std::copy_n(view.decoded->begin() + static_cast<ptrdiff_t>(offset), into.size(), into.begin());
  else if (buffer.file)
    return buffer.file->read(buffer.offset + view.offset + offset, into);
  else
    std::copy_n(buffer.memory.begin() + static_cast<ptrdiff_t>(view.offset + offset), into.size(), into.begin());
  return Done{};
}

Result<std::vector<std::byte>> GltfDocument::view_bytes(uint64_t view) {
  if (view >= views_.size()) return fail("bufferView", view, "is not there");
  const auto index = static_cast<size_t>(view);
  if (views_[index].compressed) PROMENADE_TRY(decode_view(index));
  std::vector<std::byte> bytes(static_cast<size_t>(views_[index].size));
  PROMENADE_TRY(read_view(index, 0, bytes));
  return bytes;
}

Result<GltfAccessor> GltfDocument::accessor(uint64_t index) {
  const Json& declared = element(member(json_, "accessors"), index);
  if (!declared.is_object()) return fail("accessor", index, "is not there");
  GltfAccessor a;
  a.components = component_count(text(member(declared, "type")));
  const uint64_t code = whole(member(declared, "componentType")).value_or(0);
  const uint64_t element_bytes = uint64_t(component_bytes(code)) * a.components;
  const std::optional<uint64_t> count = whole(member(declared, "count"));
  if (element_bytes == 0 || !count) return fail("accessor", index, "has no count or an unknown type");
  a.component_type = static_cast<uint32_t>(code);
  a.count = *count;
  a.normalized = truth(member(declared, "normalized"));
  a.view = whole(member(declared, "bufferView"));
  a.offset = whole(member(declared, "byteOffset")).value_or(0);
  if (!a.view) {
    if (a.count > kMaxZeroElements) return fail("accessor", index, fmt::format("{} elements without data", a.count));
    return a;
  }
  if (*a.view >= views_.size()) return fail("accessor", index, "names no bufferView");
  const auto view_index = static_cast<size_t>(*a.view);
  if (views_[view_index].compressed) PROMENADE_TRY(decode_view(view_index));
  const View& view = views_[view_index];
  a.stride = view.stride != 0 ? view.stride : element_bytes;
  if (a.stride < element_bytes || a.stride > 256 || !fits(a.offset, a.count, a.stride, element_bytes, view.size))
    return fail("accessor", index,
                fmt::format("{} elements every {} bytes from {} in a view of {} bytes", a.count, a.stride, a.offset,
                            view.size));
  return a;
}

template <class T>
Status GltfDocument::read_elements(uint64_t index, const GltfAccessor& a, uint64_t first, std::span<T> out) {
  const uint64_t wanted = out.size() / a.components;
  assert(first <= a.count && wanted <= a.count - first);
  const uint64_t begin = a.offset + first * a.stride;
  const uint64_t element_bytes = uint64_t(component_bytes(a.component_type)) * a.components;
  const bool as_it_lies = a.component_type == (std::is_same_v<T, float> ? 5126 : 5125) && a.stride == element_bytes;
  if (!a.view) {
    std::fill(out.begin(), out.end(), T{});
  } else if (as_it_lies) {
    PROMENADE_TRY(read_view(static_cast<size_t>(*a.view), begin, std::as_writable_bytes(out)));
  } else {
    const uint64_t per_piece = std::max<uint64_t>(kReadPieceBytes / a.stride, 1);
    std::vector<std::byte> piece;
    for (uint64_t done = 0; done < wanted; done += per_piece) {
      const uint64_t count = std::min(per_piece, wanted - done);
      piece.resize(static_cast<size_t>((count - 1) * a.stride + element_bytes));
      PROMENADE_TRY(read_view(static_cast<size_t>(*a.view), begin + done * a.stride, piece));
      convert_elements(piece.data(), count, a, out.data() + done * a.components);
    }
  }
  return apply_sparse(index, a, first, out);
}

template <class T>
Status GltfDocument::apply_sparse(uint64_t index, const GltfAccessor& a, uint64_t first, std::span<T> out) {
  const Json& sparse = member(element(member(json_, "accessors"), index), "sparse");
  if (!sparse.is_object()) return Done{};
  const uint64_t count = whole(member(sparse, "count")).value_or(0);
  const Json& where = member(sparse, "indices");
  const Json& what = member(sparse, "values");
  GltfAccessor places;
  places.count = count, places.components = 1;
  places.component_type = static_cast<uint32_t>(whole(member(where, "componentType")).value_or(0) & 0xffffU);
  places.view = whole(member(where, "bufferView"));
  places.offset = whole(member(where, "byteOffset")).value_or(0);
  GltfAccessor values = a;
  values.count = count;
  values.view = whole(member(what, "bufferView"));
  values.offset = whole(member(what, "byteOffset")).value_or(0);
  std::vector<uint32_t> place_of;
  for (GltfAccessor* part : {&places, &values}) {
    const uint64_t bytes = uint64_t(component_bytes(part->component_type)) * part->components;
    part->stride = bytes;
    if (bytes == 0 || count > a.count || !part->view || *part->view >= views_.size() ||
        !fits(part->offset, count, bytes, bytes, views_[static_cast<size_t>(*part->view)].size))
      return fail("accessor", index, fmt::format("{} sparse elements out of range", count));
    std::vector<std::byte> bytes_of(static_cast<size_t>(count * bytes));
    const auto view = static_cast<size_t>(*part->view);
    if (views_[view].compressed) return fail("accessor", index, "sparse elements in a compressed view");
    PROMENADE_TRY(read_view(view, part->offset, bytes_of));
    if (part == &places) {
      place_of.resize(static_cast<size_t>(count));
      convert_elements(bytes_of.data(), count, places, place_of.data());
      continue;
    }
    std::vector<T> converted(static_cast<size_t>(count * a.components));
    convert_elements(bytes_of.data(), count, values, converted.data());
    for (size_t i = 0; i < place_of.size(); ++i) {
      if (place_of[i] >= a.count) return fail("accessor", index, "a sparse index is out of range");
      if (place_of[i] < first || place_of[i] - first >= out.size() / a.components) continue;
      std::copy_n(converted.begin() + static_cast<ptrdiff_t>(i * a.components), a.components,
                  out.begin() + static_cast<ptrdiff_t>((place_of[i] - first) * a.components));
    }
  }
  return Done{};
}

Status GltfDocument::read_floats(uint64_t index, uint64_t first, std::span<float> out) {
  const Result<GltfAccessor> a = accessor(index);
  if (!a.ok()) return a.error();
  return read_elements(index, *a, first, out);
}

Status GltfDocument::read_indices(uint64_t index, std::span<uint32_t> out) {
  const Result<GltfAccessor> a = accessor(index);
  if (!a.ok()) return a.error();
  if (a->components != 1 || a->component_type == 5126) return fail("accessor", index, "is no list of indices");
  return read_elements(index, *a, 0, out);
}

}  // namespace promenade
