// Source: Khronos, glTF 2.0, sections 3.11 and 5.3 to 5.6.

#include "preprocess/gltf_animation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace promenade {

namespace {

// Samplers may all name one accessor: bounds what a small file can blow up to.
constexpr uint64_t kFreeValues = uint64_t(1) << 22;

std::optional<AnimationJoint::Slot> slot_of(const std::string& path) {
  if (path == "translation") return AnimationJoint::translation_slot;
  if (path == "rotation") return AnimationJoint::rotation_slot;
  if (path == "scale") return AnimationJoint::scale_slot;
  return std::nullopt;
}

std::optional<AnimationTrack::Way> way_of(const std::string& interpolation) {
  if (interpolation.empty() || interpolation == "LINEAR") return AnimationTrack::Way::linear;
  if (interpolation == "STEP") return AnimationTrack::Way::step;
  if (interpolation == "CUBICSPLINE") return AnimationTrack::Way::cubic;
  return std::nullopt;
}

bool all_finite(std::span<const float> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](float v) { return std::isfinite(v); });
}

class Reader {
 public:
  Reader(GltfDocument& document, Scene& scene) : document_(document), scene_(scene) {}

  GltfTracks run() {
    const Json& animations = member(document_.json(), "animations");
    if (!animations.is_array()) return {};
    for (const Json& animation : animations) read_animation(animation);
    return std::move(tracks_of_);
  }

 private:
  void read_animation(const Json& animation) {
    const Json& channels = member(animation, "channels");
    if (!channels.is_array()) return;
    known_.clear();
    const size_t first = scene_.animation.tracks.size();
    for (const Json& channel : channels)
      if (!read_channel(animation, channel)) ++scene_.report.counts["animation_channels_dropped"];
    float length_s = 0;
    for (size_t i = first; i < scene_.animation.tracks.size(); ++i) {
      const AnimationTrack& track = scene_.animation.tracks[i];
      length_s = std::max(length_s, scene_.animation.times[track.first_time + track.keys - 1]);
    }
    for (size_t i = first; i < scene_.animation.tracks.size(); ++i) scene_.animation.tracks[i].period_s = length_s;
  }

  /// False: left out.
  bool read_channel(const Json& animation, const Json& channel) {
    const Json& target = member(channel, "target");
    const std::optional<uint64_t> node = whole(member(target, "node")), sampler = whole(member(channel, "sampler"));
    const std::optional<AnimationJoint::Slot> slot = slot_of(text(member(target, "path")));
    if (!node || !sampler || !slot) return false;
    const Json& nodes = member(document_.json(), "nodes");
    // A node with a matrix has nothing that could be animated.
    if (!nodes.is_array() || *node >= nodes.size() || nodes[*node].contains("matrix")) return false;
    if (const auto taken = tracks_of_.find(*node); taken != tracks_of_.end() && taken->second[*slot] != kNoTrack)
      return false;
    const uint32_t components = *slot == AnimationJoint::rotation_slot ? 4 : 3;
    const auto [place, is_new] = known_.try_emplace({*sampler, components}, kNoTrack);
    if (is_new) place->second = read_track(element(member(animation, "samplers"), *sampler), components);
    if (place->second == kNoTrack) return false;
    tracks_of_.try_emplace(*node, std::array<uint32_t, 3>{kNoTrack, kNoTrack, kNoTrack}).first->second[*slot] =
        place->second;
    return true;
  }

  /// kNoTrack: it cannot be played.
  uint32_t read_track(const Json& sampler, uint32_t components) {
    const std::optional<AnimationTrack::Way> way = way_of(text(member(sampler, "interpolation")));
    const std::optional<uint64_t> input = whole(member(sampler, "input")), output = whole(member(sampler, "output"));
    if (!way || !input || !output) return kNoTrack;
    const Result<GltfAccessor> times = document_.accessor(*input), values = document_.accessor(*output);
    if (!times.ok() || !values.ok() || times->components != 1 || values->components != components || times->count == 0)
      return kNoTrack;
    const uint64_t per_key = *way == AnimationTrack::Way::cubic ? 3 : 1;
    if (times->count > values->count || values->count != times->count * per_key) return kNoTrack;
    read_values_ += times->count + values->count * components;
    if (read_values_ > kFreeValues + document_.source_bytes()) return kNoTrack;
    Animation& animation = scene_.animation;
    AnimationTrack track{*way,
                         components,
                         static_cast<uint32_t>(animation.times.size()),
                         static_cast<uint32_t>(animation.values.size()),
                         static_cast<uint32_t>(times->count),
                         0};
    std::vector<float> keys(times->count), numbers(values->count * components);
    if (!document_.read_floats(*input, 0, keys).ok() || !document_.read_floats(*output, 0, numbers).ok())
      return kNoTrack;
    const bool ascend = std::adjacent_find(keys.begin(), keys.end(), std::greater_equal<>()) == keys.end();
    if (!ascend || !all_finite(keys) || !all_finite(numbers)) return kNoTrack;
    animation.times.insert(animation.times.end(), keys.begin(), keys.end());
    animation.values.insert(animation.values.end(), numbers.begin(), numbers.end());
    animation.tracks.push_back(track);
    return static_cast<uint32_t>(animation.tracks.size() - 1);
  }

  GltfDocument& document_;
  Scene& scene_;
  GltfTracks tracks_of_;
  std::map<std::pair<uint64_t, uint32_t>, uint32_t> known_;  ///< of the animation in work: sampler, components
  uint64_t read_values_ = 0;
};

}  // namespace

GltfTracks read_gltf_animations(GltfDocument& document, Scene& scene) { return Reader(document, scene).run(); }

}  // namespace promenade
