#pragma once
// The container of glTF 2.0: its JSON, buffers, buffer views and accessors, every range checked before it is read.
//
// Why not tinygltf: it copies the whole binary chunk before anything can be checked, follows external URIs out of the
// folder by itself, recurses as deep as the JSON nests, and leaves every accessor's range to its caller. With
// nlohmann-json underneath either way, what remains to be done is this file; it reads from disk straight into meshes,
// so that an import costs its result and little more.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/result.h"
#include "layout/file_io.h"
#include "preprocess/import_json.h"

namespace promenade {

/// An accessor as the file declares it; its range lies within its view.
struct GltfAccessor {
  uint64_t count = 0;
  uint32_t components = 0;      ///< 1 to 16
  uint32_t component_type = 0;  ///< 5120 to 5126: byte, ubyte, short, ushort, -, uint, float
  bool normalized = false;
  std::optional<uint64_t> view;  ///< absent: zeros
  uint64_t offset = 0;           ///< in the view
  uint64_t stride = 0;           ///< bytes from one element to the next
};

/// One .glb or .gltf. Errors name the file and the part of it. One thread.
class GltfDocument {
 public:
  static Result<GltfDocument> open(const std::filesystem::path& path, const std::string& name);

  const Json& json() const { return json_; }
  const std::filesystem::path& folder() const { return folder_; }
  const std::string& name() const { return name_; }
  uint64_t source_bytes() const { return source_bytes_; }  ///< all buffers and the JSON

  /// Bytes of a view, decompressed when it is compressed.
  Result<std::vector<std::byte>> view_bytes(uint64_t view);
  Result<GltfAccessor> accessor(uint64_t index);
  /// Fills `out` with floats of the elements from `first` on, as many as it holds (they must be there); normalised
  /// integers are mapped as glTF says.
  Status read_floats(uint64_t index, uint64_t first, std::span<float> out);
  /// Fills `out` (count of the accessor, which must be a scalar of whole numbers).
  Status read_indices(uint64_t index, std::span<uint32_t> out);

 private:
  struct Buffer {
    std::shared_ptr<RandomAccessFile> file;  ///< null: in memory
    uint64_t offset = 0;                     ///< of the buffer in the file
    uint64_t size = 0;
    std::vector<std::byte> memory;
  };
  struct View {
    size_t buffer = 0;
    uint64_t offset = 0, size = 0, stride = 0;
    std::shared_ptr<const std::vector<std::byte>> decoded;  ///< of a compressed view, once it was asked for
    bool compressed = false;
  };

  Status open_binary(const std::filesystem::path& path);
  Status open_buffers();
  Result<Buffer> open_buffer(const Json& declared, size_t index);
  Status describe_views();
  Result<View> describe_view(const Json& declared, size_t index) const;
  Status decode_view(size_t index);
  Status read_view(size_t index, uint64_t offset, std::span<std::byte> into);
  template <class T>
  Status read_elements(uint64_t index, const GltfAccessor& accessor, uint64_t first, std::span<T> out);
  template <class T>
  Status apply_sparse(uint64_t index, const GltfAccessor& accessor, uint64_t first, std::span<T> out);
  Error fail(const char* what, uint64_t index, const std::string& message) const;

  Json json_;
  std::string name_;
  std::filesystem::path folder_;
  std::vector<Buffer> buffers_;
  std::vector<View> views_;
  std::optional<Buffer> binary_chunk_;
  uint64_t source_bytes_ = 0;
};

}  // namespace promenade
