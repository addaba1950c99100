#include "layout/openings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "codec/byte_io.h"
#include "codec/frame.h"
#include "layout/cell_faces.h"

namespace promenade {
namespace {

constexpr std::string_view kMagic = "PROMOPEN";
constexpr uint32_t kVersion = 1;
constexpr uint64_t kHeaderBytes = 48;
constexpr double kSteps = 255;
constexpr uint64_t kOpeningBytes = 4;

/// Of the tree that the regions follow from.
uint64_t checksum_of(const CellTables& regions) {
  ByteWriter w;
  for (const glm::vec3& corner : {regions.box.min, regions.box.max})
    for (int i = 0; i < 3; ++i) w.put(corner[i]);
  for (const CellTreeNode& n : regions.tree) w.put(n.axis), w.put(n.split_m), w.put(n.below), w.put(n.above);
  return checksum(w.bytes());
}

/// What openings of a face are told as parts of.
Box frame_of(const CellTables& regions, uint32_t face) {
  return rectangle_of(regions, regions.faces[face]).grown(kOpeningSlackM);
}

float place_in(const Box& frame, int axis, uint8_t step) {
  const double low = double(frame.min[axis]), high = double(frame.max[axis]);
  return step == 255 ? frame.max[axis] : static_cast<float>(low + (high - low) * step / kSteps);
}

void put(ByteWriter& w, const Box& frame, int face_axis, const Box& opening) {
  for (const int turn : {1, 2}) {
    const int axis = (face_axis + turn) % 3;
    const double size = std::max(1e-30, double(frame.max[axis]) - double(frame.min[axis]));
    const auto step_of = [&](float x) {
      return static_cast<int>(std::clamp((double(x) - double(frame.min[axis])) / size * kSteps, 0.0, kSteps));
    };
    int low = step_of(opening.min[axis]), high = step_of(opening.max[axis]);
    while (low < 255 && place_in(frame, axis, static_cast<uint8_t>(low + 1)) <= opening.min[axis]) ++low;
    while (low > 0 && place_in(frame, axis, static_cast<uint8_t>(low)) > opening.min[axis]) --low;
    while (high < 255 && place_in(frame, axis, static_cast<uint8_t>(high)) < opening.max[axis]) ++high;
    w.put(static_cast<uint8_t>(low)), w.put(static_cast<uint8_t>(high));
  }
}

Box get(ByteReader& r, const Box& frame, int face_axis) {
  Box box = frame;
  for (const int turn : {1, 2}) {
    const int axis = (face_axis + turn) % 3;
    const auto low = r.get<uint8_t>(), high = r.get<uint8_t>();
    box.min[axis] = place_in(frame, axis, low), box.max[axis] = place_in(frame, axis, high);
  }
  return box;
}

}  // namespace

uint64_t Openings::byte_size() const {
  return regions.byte_size() + first.capacity() * sizeof(uint32_t) + boxes.capacity() * sizeof(Box);
}

Result<CellTables> regions_of(const CellTables& cells) {
  CellTables regions;
  regions.bound = cells.bound, regions.box = cells.box, regions.tree = cells.tree;
  std::vector<Box> boxes(cells.tree.size(), cells.box);  // children stand after their parents
  for (size_t i = 0; i < regions.tree.size(); ++i) {
    CellTreeNode& node = regions.tree[i];
    if (node.axis == CellTreeNode::kLeaf) {
      node.below = static_cast<uint32_t>(regions.cells.size());
      regions.cells.push_back({boxes[i], 0, 0});
      continue;
    }
    const int axis = static_cast<int>(node.axis);
    boxes[node.below] = boxes[node.above] = boxes[i];
    boxes[node.below].max[axis] = boxes[node.above].min[axis] = node.split_m;
  }
  PROMENADE_TRY(find_faces(regions));
  return regions;
}

std::vector<std::byte> encode_openings(const Openings& openings, uint64_t tables_checksum) {
  const CellTables& regions = openings.regions;
  ByteWriter content;
  const auto ways = static_cast<uint32_t>(2 * regions.faces.size());
  for (uint32_t i = 0; i < ways; ++i) content.put(static_cast<uint8_t>(openings.first[i + 1] - openings.first[i]));
  for (uint32_t face = 0; face < regions.faces.size(); ++face) {
    const Box frame = frame_of(regions, face);
    for (const bool up : {false, true})
      for (const Box& box : openings.of(face, up)) put(content, frame, static_cast<int>(regions.faces[face].axis), box);
  }
  const std::vector<std::byte> stored = compress_frame(content.bytes());
  ByteWriter file;
  for (const char c : kMagic) file.put(static_cast<uint8_t>(c));
  file.put(kVersion), file.put(static_cast<uint32_t>(regions.faces.size()));
  file.put(tables_checksum), file.put(checksum_of(regions)), file.put(checksum(stored));
  file.put(checksum(file.bytes()));
  file.put_bytes(stored);
  return file.take();
}

Result<Openings> decode_openings(std::span<const std::byte> bytes, const CellTables& cells, uint64_t tables_checksum) {
  if (bytes.size() < kHeaderBytes)
    return Error{fmt::format("header: {} bytes, {} are due", bytes.size(), kHeaderBytes)};
  if (std::string_view(reinterpret_cast<const char*>(bytes.data()), kMagic.size()) != kMagic)
    return Error{"header: no openings of a model"};
  ByteReader header(bytes.first(kHeaderBytes).subspan(kMagic.size()));
  const auto version = header.get<uint32_t>(), faces = header.get<uint32_t>();
  if (version != kVersion)
    return Error{
        fmt::format("header @0x8: version {}, this program reads {}; build the model again", version, kVersion)};
  const auto tables_sum = header.get<uint64_t>(), regions_sum = header.get<uint64_t>(), sum = header.get<uint64_t>();
  constexpr uint64_t kSumOffset = kHeaderBytes - sizeof(uint64_t);
  if (const uint64_t found = checksum(bytes.first(kSumOffset)), due = header.get<uint64_t>(); found != due)
    return Error{fmt::format("header @{:#x}: checksum {:016x} != {:016x}", kSumOffset, found, due)};
  Result<CellTables> regions = regions_of(cells);
  if (!regions) return regions.error();
  if (tables_sum != tables_checksum || regions_sum != checksum_of(*regions) || faces != regions->faces.size())
    return Error{"belongs to other cells or tables; the files are not of one build"};
  const std::span<const std::byte> stored = bytes.subspan(kHeaderBytes);
  if (const uint64_t found = checksum(stored); found != sum)
    return Error{fmt::format("openings @{:#x}: checksum {:016x} != {:016x}", kHeaderBytes, found, sum)};
  const uint64_t most = 2 * uint64_t(faces) * (1 + kOpeningBytes * Openings::kMost);
  const Result<std::vector<std::byte>> content = decompress_frame(stored, most);
  if (!content) return Error{fmt::format("openings @{:#x}: {}", kHeaderBytes, content.error().message)};
  ByteReader counts(*content);
  Openings openings;
  openings.first.reserve(2 * size_t(faces) + 1);
  uint32_t end = 0;
  openings.first.push_back(0);
  for (uint32_t i = 0; i < 2 * faces; ++i) {
    const auto count = counts.get<uint8_t>();
    if (count > Openings::kMost)
      return Error{fmt::format("face {}: {} openings, at most {}", i / 2, count, Openings::kMost)};
    openings.first.push_back(end += count);
  }
  if (!counts.ok() || counts.remaining() != kOpeningBytes * end)
    return Error{fmt::format("openings: {} bytes, {} faces with {} openings are due", content->size(), faces, end)};
  openings.boxes.reserve(end);
  for (uint32_t i = 0; i < 2 * faces; ++i) {
    const Box frame = frame_of(*regions, i / 2);
    const int axis = static_cast<int>(regions->faces[i / 2].axis);
    for (uint32_t k = openings.first[i]; k < openings.first[i + 1]; ++k) {
      openings.boxes.push_back(get(counts, frame, axis));
      if (openings.boxes.back().empty()) return Error{fmt::format("face {}: an opening ends before it begins", i / 2)};
    }
  }
  openings.regions = std::move(*regions);
  return openings;
}

}  // namespace promenade
