#include "preprocess/texture_store.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "codec/frame.h"
#include "codec/image_codec.h"
#include "preprocess/unit_io.h"

namespace promenade {

namespace {

constexpr uint64_t kDecodedPixel = 20;  // bytes a source pixel while it is decoded and resampled in floats
constexpr uint64_t kWholeShare = 16;  // of the memory for pictures: what is larger is not kept for its smaller versions
constexpr uint64_t kLargestPixels = uint64_t(1) << 28;

bool starts_with(std::span<const std::byte> bytes, std::initializer_list<uint8_t> magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin(),
                                                    [](uint8_t m, std::byte b) { return std::byte(m) == b; });
}
bool may_stay(std::span<const std::byte> bytes) {
  return starts_with(bytes, {0xff, 0xd8, 0xff}) || starts_with(bytes, {0x89, 'P', 'N', 'G'});
}

bool has_opacity(const Image& image) {
  return std::any_of(image.pixels.begin(), image.pixels.end(), [](const glm::u8vec4& p) { return p.a < 255; });
}

/// A picture's encoded versions, the whole one first.
using Versions = std::vector<std::vector<std::byte>>;

std::vector<std::byte> unit_bytes(const StoredTexture& stored, const Versions& versions) {
  UnitWriter writer;
  writer.value(stored.width), writer.value(stored.height), writer.value(uint8_t(stored.has_opacity));
  writer.value(stored.reduction);
  writer.array(stored.smaller);
  for (const std::vector<std::byte>& version : versions) writer.array(version);
  return std::move(writer.bytes());
}

/// Fills in all but the unit's name.
std::optional<Versions> parse_unit(std::span<const std::byte> bytes, StoredTexture& stored) {
  UnitReader reader(bytes);
  stored.width = reader.value<uint32_t>(), stored.height = reader.value<uint32_t>();
  stored.has_opacity = reader.value<uint8_t>() != 0;
  stored.reduction = reader.value<float>();
  stored.smaller = reader.array<StoredTexture::Size>();
  stored.bytes = 0;
  Versions versions;
  for (size_t i = 0; i <= stored.smaller.size() && reader.ok(); ++i) {
    versions.push_back(reader.array<std::byte>());
    stored.bytes += versions.back().size();
  }
  if (!reader.ok()) return std::nullopt;
  return versions;
}

}  // namespace

/// What came of one picture: stored, or why not.
struct TextureStore::Prepared {
  StoredTexture stored;
  uint64_t unit_hash = 0;
  bool resumed = false;
  std::string missing;  ///< why it cannot be shown
  std::string failure;  ///< the disk
};

TextureStore::Prepared TextureStore::prepare(const SourceTexture& texture, uint64_t content) const {
  Prepared out;
  out.stored.unit = fmt::format("texture-{:016x}", content);
  UnitWriter key;
  key.value(content), key.value(options_.max_texture_px), key.value(options_.jpeg_quality),
      key.value(options_.tool_hash);
  out.unit_hash = checksum(key.bytes());
  if (const auto known = folder_.load(out.stored.unit, out.unit_hash))
    if (parse_unit(*known, out.stored)) {
      out.resumed = true;
      return out;
    }
  Result<Image> image = decode_image(texture.encoded, texture.name);
  if (!image.ok()) {
    out.missing = image.error().message;
    return out;
  }
  out.stored.has_opacity = has_opacity(*image);
  const uint32_t side = std::max(image->width, image->height);
  const ImageFormat format = out.stored.has_opacity ? ImageFormat::png : ImageFormat::jpeg;
  Versions versions = {texture.encoded};
  const auto encode = [&](std::vector<std::byte>& version) {
    Result<std::vector<std::byte>> bytes = encode_image(*image, format, options_.jpeg_quality);
    if (bytes.ok())
      version = std::move(*bytes);
    else
      out.missing = fmt::format("{}: {}", texture.name, bytes.error().message);
    return bytes.ok();
  };
  if (side > options_.max_texture_px || !may_stay(texture.encoded)) {
    if (side > options_.max_texture_px) {
      out.stored.reduction = float(side) / float(options_.max_texture_px);
      const auto shrunk = [&](uint32_t s) {
        return std::max(1U, static_cast<uint32_t>(std::lround(float(s) / out.stored.reduction)));
      };
      *image = resized(*image, shrunk(image->width), shrunk(image->height));
    }
    if (!encode(versions.front())) return out;
  }
  out.stored.width = image->width, out.stored.height = image->height;
  while (std::max(image->width, image->height) >= kSmallestTexture * kTextureStep) {
    *image = resized(*image, std::max(1U, image->width / kTextureStep), std::max(1U, image->height / kTextureStep));
    if (!encode(versions.emplace_back())) return out;
    out.stored.smaller.push_back({image->width, image->height});
  }
  for (const std::vector<std::byte>& version : versions) out.stored.bytes += version.size();
  const Status status = folder_.store(out.stored.unit, out.unit_hash, unit_bytes(out.stored, versions));
  if (!status.ok()) out.failure = status.error().message;
  return out;
}

Result<std::vector<uint32_t>> TextureStore::add(std::span<const SourceTexture> textures, const std::vector<bool>& used,
                                                std::vector<std::string>& notes) {
  const size_t count = textures.size();
  std::vector<uint64_t> contents(count);
  std::vector<std::optional<Prepared>> prepared(count);
  std::vector<uint32_t> together, alone;  // small ones share the memory, large ones have it to themselves
  std::unordered_map<uint64_t, uint32_t> first;
  for (uint32_t i = 0; i < count; ++i) {
    if (!used[i]) continue;
    contents[i] = checksum(textures[i].encoded, textures[i].encoded.size());
    if (by_content_.contains(contents[i]) || !first.emplace(contents[i], i).second) continue;
    const auto missing = [&](std::string why) { prepared[i].emplace().missing = std::move(why); };
    if (textures[i].encoded.empty()) {
      missing(fmt::format("missing texture {}", textures[i].name));
      continue;
    }
    const Result<ImageSize> size = image_size(textures[i].encoded, textures[i].name);
    const uint64_t pixels = size.ok() ? uint64_t(size->width) * size->height : 0;
    if (!size.ok())
      missing(size.error().message);
    else if (pixels > kLargestPixels || pixels * kDecodedPixel > options_.memory_bytes * 4)
      missing(fmt::format("{}: {} x {} pixels do not fit into the build's memory; give more --memory", textures[i].name,
                          size->width, size->height));
    else
      (pixels * kDecodedPixel > options_.memory_bytes / 8 ? alone : together).push_back(i);
  }
  const auto work = [&](uint32_t i) { prepared[i] = prepare(textures[i], contents[i]); };
  tbb::parallel_for(size_t(0), together.size(), [&](size_t k) { work(together[k]); });
  for (const uint32_t i : alone) work(i);

  std::vector<uint32_t> ids(count, kNoTexture);
  for (uint32_t i = 0; i < count; ++i) {
    if (!used[i]) continue;
    if (prepared[i]) {
      if (!prepared[i]->failure.empty()) return Error{prepared[i]->failure};
      resumed_ += prepared[i]->resumed ? 1U : 0U;
      const bool stored = prepared[i]->missing.empty();
      if (!stored) notes.push_back(prepared[i]->missing + " (drawn in a plain colour)");
      by_content_[contents[i]] = stored ? static_cast<uint32_t>(textures_.size()) : kNoTexture;
      if (stored) textures_.push_back(prepared[i]->stored);
    }
    ids[i] = by_content_[contents[i]];
  }
  return ids;
}

Result<std::vector<std::byte>> TextureStore::encoded(uint32_t texture, uint32_t version) const {
  const StoredTexture& stored = textures_[texture];
  Result<std::vector<std::byte>> bytes = read_file(folder_.path_of(stored.unit), uint64_t(1) << 34, folder_.files());
  if (!bytes.ok()) return bytes.error();
  constexpr size_t kUnitHeader = 32;
  StoredTexture again;
  if (bytes->size() > kUnitHeader)
    if (auto versions = parse_unit(std::span(*bytes).subspan(kUnitHeader), again))
      if (version < versions->size()) return std::move((*versions)[version]);
  return Error{
      fmt::format("{}: damaged; remove the .work folder and build again", folder_.path_of(stored.unit).string())};
}

std::shared_ptr<const Image> TextureStore::cached(uint64_t key) const {
  const std::lock_guard lock(mutex_);
  const auto found = cache_.find(key);
  if (found == cache_.end()) return nullptr;
  recent_.splice(recent_.begin(), recent_, found->second.place);
  return found->second.image;
}

void TextureStore::keep(uint64_t key, const std::shared_ptr<const Image>& image) const {
  const std::lock_guard lock(mutex_);
  if (cache_.contains(key)) return;
  recent_.push_front(key);
  cache_[key] = {image, recent_.begin()};
  cached_bytes_ += image->pixels.size() * sizeof(glm::u8vec4);
  while (cached_bytes_ > options_.memory_bytes && recent_.size() > 1) {
    const auto last = cache_.find(recent_.back());
    cached_bytes_ -= last->second.image->pixels.size() * sizeof(glm::u8vec4);
    cache_.erase(last);
    recent_.pop_back();
  }
}

Result<std::shared_ptr<const Image>> TextureStore::image(uint32_t texture, uint32_t halvings) const {
  const auto key_of = [texture](uint32_t h) { return uint64_t(h) << 32 | texture; };
  if (auto known = cached(key_of(halvings))) return known;
  // Who asks for what another thread decodes waits for it.
  const std::lock_guard decoding(decoding_[texture % decoding_.size()]);
  if (auto known = cached(key_of(halvings))) return known;
  std::shared_ptr<const Image> whole = cached(key_of(0));
  if (!whole) {
    Result<std::vector<std::byte>> bytes = encoded(texture);
    if (!bytes.ok()) return bytes.error();
    Result<Image> decoded = decode_image(*bytes, textures_[texture].unit);
    if (!decoded.ok()) return decoded.error();
    whole = std::make_shared<const Image>(std::move(*decoded));
    if (halvings == 0 || whole->pixels.size() * sizeof(glm::u8vec4) <= options_.memory_bytes / kWholeShare)
      keep(key_of(0), whole);
  }
  if (halvings == 0) return whole;
  auto image = std::make_shared<const Image>(
      resized(*whole, std::max(1U, whole->width >> halvings), std::max(1U, whole->height >> halvings)));
  keep(key_of(halvings), image);
  return std::shared_ptr<const Image>(std::move(image));
}

}  // namespace promenade
