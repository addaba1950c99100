#include "preprocess/node_order.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "codec/id_set.h"
#include "layout/file_io.h"

namespace promenade {
namespace {

constexpr std::string_view kFilePrefix = "file:";
constexpr uint64_t kMostFileBytes = uint64_t(1) << 32;

/// A row a face: what changes across it.
Result<Incidence> deltas_of(const Model& model, const Visibility& visibility) {
  const auto nodes = static_cast<uint32_t>(model.tables.nodes.size());
  std::vector<std::vector<uint32_t>> sets, deltas;
  for (const CodedVlod& vlod : visibility.vlods) {
    Result<std::vector<uint32_t>> ids = decode_ids(vlod.ids, nodes);
    if (!ids.ok()) return ids.error();
    sets.push_back(std::move(*ids));
  }
  for (const CellFace& face : visibility.cells.faces)
    deltas.push_back(symmetric_difference(sets[index_of(face.below)], sets[index_of(face.above)]));
  return incidence_of(deltas, nodes);
}

Result<ColumnOrder> read_order(const std::filesystem::path& file, uint32_t nodes) {
  const Result<std::vector<std::byte>> bytes = read_file(file, kMostFileBytes);
  if (!bytes.ok()) return bytes.error();
  Result<ColumnOrder> order = parse_order({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, nodes);
  if (!order.ok()) return Error{fmt::format("{}: {}", file.string(), order.error().message)};
  return order;
}

}  // namespace

Result<NodeOrderOptions> parse_node_order(const std::string& text) {
  const std::span<const std::string_view> names = order_names();
  if (std::find(names.begin(), names.end(), text) != names.end()) return NodeOrderOptions{text, {}};
  if (text.starts_with(kFilePrefix) && text.size() > kFilePrefix.size())
    return NodeOrderOptions{"file", text.substr(kFilePrefix.size())};
  return Error{fmt::format("\"{}\" is no order of nodes: {} or file:FILE", text, fmt::join(names, ", "))};
}

Result<ColumnOrder> node_order(const Model& model, const Visibility& visibility, const NodeOrderOptions& options) {
  if (options.name == "file") return read_order(options.file, static_cast<uint32_t>(model.tables.nodes.size()));
  const Result<Incidence> matrix = deltas_of(model, visibility);
  if (!matrix.ok()) return matrix.error();
  std::vector<glm::vec3> points;
  for (const NodeRecord& node : model.tables.nodes) points.push_back(node.box.center());
  const OrderQuestion question{&*matrix, points};
  std::vector<MadeOrder> orders;
  orders.push_back(make_order("input", question));
  if (options.name != "input") orders.push_back(make_order(options.name, question));
  return best_of(orders).order;
}

}  // namespace promenade
