#pragma once
// The animations of a glTF file: which nodes move, and how.

#include <array>
#include <cstdint>
#include <unordered_map>

#include "geometry/animation.h"
#include "preprocess/gltf_document.h"
#include "preprocess/scene.h"

namespace promenade {

/// The tracks of a node that is animated, by AnimationJoint::Slot.
using GltfTracks = std::unordered_map<uint64_t, std::array<uint32_t, 3>>;

/// Reads the channels for translation, rotation and scale into scene.animation's tracks; all animations of the file run
/// at once, each from its beginning again when it is over. What cannot be played (times that do not ascend, numbers
/// that are not finite, as many values as do not fit, weights of morph targets, a second channel for the same) is left
/// out and counted: animation_channels_dropped. Safe on any bytes.
GltfTracks read_gltf_animations(GltfDocument& document, Scene& scene);

}  // namespace promenade
