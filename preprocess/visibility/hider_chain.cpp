#include "preprocess/visibility/hider_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "geometry/process_memory.h"
#include "preprocess/visibility/hiders/backface.h"
#include "preprocess/visibility/hiders/cullmap.h"
#include "preprocess/visibility/hiders/horizon.h"
#include "preprocess/visibility/hiders/portals.h"
#include "preprocess/visibility/hiders/sampled.h"
#include "preprocess/visibility/hiders/shrunk.h"
#include "preprocess/visibility/hiders/umbra.h"
#include "preprocess/visibility/node_meshes.h"
#include "preprocess/visibility/node_parts.h"
#include "preprocess/visibility/occluders.h"
#include "preprocess/visibility/solid_boxes.h"

namespace promenade {
namespace {

// Of the hiders' memory; what is left of it is for occluders that were found.
constexpr uint64_t kPartsPart = 8;      // one in so many
constexpr uint64_t kTilesQuarters = 3;  // while occluders are looked for

OccluderOptions occluder_options(const HiderBuildOptions& options) {
  OccluderOptions occluders;
  occluders.memory_bytes = options.memory_bytes / 4 * kTilesQuarters;
  return occluders;
}

/// A hider with its share of what it needs, which it refers to.
template <class Share>
class Owning : public Hider {
 public:
  Owning(std::unique_ptr<Hider> hider, std::shared_ptr<Share> share)
      : share_(std::move(share)), hider_(std::move(hider)) {}
  std::string_view name() const override { return hider_->name(); }
  bool is_conservative() const override { return hider_->is_conservative(); }
  Status hide(const HiderQuestion& question, std::span<uint8_t> hidden) const override {
    return hider_->hide(question, hidden);
  }

 private:
  std::shared_ptr<Share> share_;
  std::unique_ptr<Hider> hider_;
};

template <class Share>
std::unique_ptr<Hider> owning(std::unique_ptr<Hider> hider, std::shared_ptr<Share> share) {
  return std::make_unique<Owning<Share>>(std::move(hider), std::move(share));
}

}  // namespace

uint64_t hash_of(const HiderBuildOptions& options) { return most_tile_bytes(occluder_options(options)); }

std::string_view hider_names() { return "backface, horizon, cullmap, portals, umbra, shrunk, sampled"; }

const std::vector<std::string>& hiders_for(CellStyle style) {
  static const std::vector<std::string> outdoors = {"backface", "horizon"}, indoors = {"backface", "portals"};
  return style == CellStyle::kd ? indoors : outdoors;
}

bool hiders_are_auto(const std::vector<std::string>& names) { return names.size() == 1 && names[0] == kAutoHiders; }

const std::vector<std::string>& resolved_hiders(const std::vector<std::string>& names, CellStyle style) {
  return hiders_are_auto(names) ? hiders_for(style) : names;
}

Result<std::vector<std::string>> parse_hiders(std::string_view list) {
  std::vector<std::string> names;
  if (list.empty() || list == "none") return names;
  if (list == kAutoHiders) return std::vector<std::string>{std::string(list)};
  for (size_t at = 0; at <= list.size();) {
    const size_t end = std::min(list.find(',', at), list.size());
    const std::string name(list.substr(at, end - at));
    at = end + 1;
    const std::string known = fmt::format(", {},", hider_names());
    if (name.empty() || known.find(fmt::format(" {},", name)) == std::string::npos)
      return Error{fmt::format("unknown hider '{}': one of {}", name, hider_names())};
    if (std::find(names.begin(), names.end(), name) != names.end())
      return Error{fmt::format("hider '{}' twice in '{}'", name, list)};
    names.push_back(name);
  }
  return names;
}

HiderMaker::HiderMaker(const ModelReader& model, HiderBuildOptions options, JobMonitor& monitor)
    : model_(model), options_(std::move(options)), monitor_(monitor) {}

Result<std::vector<std::unique_ptr<Hider>>> HiderMaker::make(std::span<const std::string> names) {
  std::vector<std::unique_ptr<Hider>> hiders;
  for (const std::string& name : names) {
    Result<std::unique_ptr<Hider>> hider = make_one(name);
    if (!hider) return hider.error();
    hiders.push_back(std::move(*hider));
  }
  return hiders;
}

Result<std::unique_ptr<Hider>> HiderMaker::make_one(std::string_view name) {
  if (name == "backface") {
    PROMENADE_TRY(need_parts());
    return owning(make_backface_hider(model_.model(), *parts_), parts_);
  }
  if (name == "horizon" || name == "cullmap") {
    PROMENADE_TRY(need_parts());
    PROMENADE_TRY(need_occluders());
    struct Share {
      std::shared_ptr<NodeParts> parts;
      std::shared_ptr<OccluderSet> occluders;
    };
    auto share = std::make_shared<Share>(Share{parts_, occluders_});
    return owning(name == "horizon" ? make_horizon_hider(model_.model(), *share->parts, *share->occluders)
                                    : make_cullmap_hider(model_.model(), *share->parts, *share->occluders),
                  share);
  }
  if (name == "portals") {
    Result<Rooms> rooms = find_rooms(model_, RoomOptions(), monitor_);
    if (!rooms) return rooms.error();
    Result<RoomParts> parts = find_room_parts(model_, *rooms, monitor_);
    if (!parts) return parts.error();
    struct Share {
      Rooms rooms;
      RoomParts parts;
    };
    auto share = std::make_shared<Share>(Share{std::move(*rooms), std::move(*parts)});
    return owning(make_portals_hider(model_.model(), share->rooms, share->parts), share);
  }
  if (name == "umbra" || name == "shrunk") {
    PROMENADE_TRY(need_parts());
    PROMENADE_TRY(need_solid_boxes());
    struct Share {
      std::shared_ptr<NodeParts> parts;
      std::shared_ptr<std::vector<Box>> boxes;
    };
    auto share = std::make_shared<Share>(Share{parts_, solid_boxes_});
    return owning(name == "umbra" ? make_umbra_hider(model_.model(), *share->parts, *share->boxes)
                                  : make_shrunk_hider(model_.model(), *share->parts, *share->boxes),
                  share);
  }
  if (name == "sampled") {
    PROMENADE_TRY(need_meshes());
    return owning(make_sampled_hider(*meshes_), meshes_);
  }
  return Error{fmt::format("unknown hider '{}': one of {}", name, hider_names())};
}

Status HiderMaker::need_parts() {
  if (parts_) return Done{};
  Result<NodeParts> parts =
      NodeParts::make(model_, monitor_, {options_.memory_bytes / kPartsPart, options_.folder, options_.files});
  if (!parts) return parts.error();
  parts_ = std::make_shared<NodeParts>(std::move(*parts));
  return_freed_memory();
  return Done{};
}

Status HiderMaker::need_occluders() {
  if (occluders_) return Done{};
  Result<OccluderSet> occluders = extract_occluders(model_, occluder_options(options_), monitor_);
  if (!occluders) return occluders.error();
  occluders_ = std::make_shared<OccluderSet>(std::move(*occluders));
  return Done{};
}

Status HiderMaker::need_solid_boxes() {
  if (solid_boxes_) return Done{};
  Result<std::vector<Box>> boxes = find_solid_boxes(model_, SolidBoxOptions(), monitor_);
  if (!boxes) return boxes.error();
  solid_boxes_ = std::make_shared<std::vector<Box>>(std::move(*boxes));
  return Done{};
}

Status HiderMaker::need_meshes() {
  if (meshes_) return Done{};
  Result<std::unique_ptr<NodeMeshes>> meshes = NodeMeshes::make(model_, options_.memory_bytes / 2);
  if (!meshes) return meshes.error();
  meshes_ = std::move(*meshes);
  return Done{};
}

}  // namespace promenade
