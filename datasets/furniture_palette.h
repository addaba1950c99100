#pragma once
// The colours that the furniture is made in.

#include "datasets/shapes.h"

namespace promenade::palette {

constexpr glm::u8vec4 kOak = rgb(0xb98a55), kBeech = rgb(0xd2ab78), kWalnut = rgb(0x6f4a31), kMaple = rgb(0xe0c59a),
                      kCherry = rgb(0x95552f), kTeak = rgb(0xa06a3c);
constexpr glm::u8vec4 kSteel = rgb(0xa9adb2), kDarkSteel = rgb(0x54585e), kChrome = rgb(0xd4d8dc),
                      kBrass = rgb(0xc9a24a), kBlack = rgb(0x26272b), kGraphite = rgb(0x3b3d42),
                      kAluminium = rgb(0xc3c7cb);
constexpr glm::u8vec4 kWhite = rgb(0xf2f1ec), kOffWhite = rgb(0xe6e2d8), kPaper = rgb(0xf6f2e4), kLight = rgb(0xfffbea),
                      kCeramic = rgb(0xf4f6f6), kCardboard = rgb(0xc49a68);
constexpr glm::u8vec4 kNavy = rgb(0x2f4a73), kTealCloth = rgb(0x2f7f7b), kRust = rgb(0xa94f32),
                      kMustard = rgb(0xcf9a33), kSage = rgb(0x7c9470), kWine = rgb(0x7c2f3d), kSlate = rgb(0x566270),
                      kSand = rgb(0xc9b48f);
constexpr glm::u8vec4 kLeaf = rgb(0x4c8a3f), kDarkLeaf = rgb(0x2f6a3a), kLime = rgb(0x82ad4a), kSoil = rgb(0x4a3526),
                      kTerracotta = rgb(0xb5643f), kBark = rgb(0x6b4f38);

}  // namespace promenade::palette
