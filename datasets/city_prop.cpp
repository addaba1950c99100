#include "datasets/city_prop.h"

#include <glm/ext/matrix_transform.hpp>
#include <string_view>
#include <vector>

#include "datasets/city_smooth.h"

namespace promenade {
namespace {

constexpr Color kIron = rgb(52, 58, 60);
constexpr Color kSteel = rgb(150, 154, 158);

/// Sides of something round.
int sides_of(int level) { return level == 0 ? 6 : level == 1 ? 12 : level == 2 ? 24 : 48; }

Mesh make_lamp(uint32_t variant, int level) {
  SmoothShape s;
  const int n = sides_of(level);
  s.color(variant == 0 ? kIron : rgb(120, 124, 126));
  const std::vector<glm::vec2> pole = {{0.19F, 0},     {0.19F, 0.1F},  {0.14F, 0.16F}, {0.12F, 0.8F}, {0.15F, 0.86F},
                                       {0.08F, 0.95F}, {0.055F, 3.6F}, {0.08F, 3.65F}, {0.045F, 3.7F}};
  s.lathe({0, 0, 0}, pole, n);
  if (variant == 0) {
    s.lathe({0, 0, 3.7F}, std::vector<glm::vec2>{{0.045F, 0}, {0.16F, 0.12F}, {0.17F, 0.16F}}, n);
    s.color(rgb(252, 236, 190));
    s.lathe({0, 0, 3.86F}, std::vector<glm::vec2>{{0.12F, 0}, {0.2F, 0.18F}, {0.21F, 0.3F}, {0.19F, 0.42F}}, n);
    s.color(kIron);
    s.lathe({0, 0, 4.28F}, std::vector<glm::vec2>{{0.24F, 0}, {0.2F, 0.1F}, {0.06F, 0.2F}, {0.03F, 0.32F}, {0, 0.36F}},
            n);
    return s.take();
  }
  s.lathe({0, 0, 3.7F}, std::vector<glm::vec2>{{0.045F, 0}, {0.04F, 3.2F}, {0, 3.22F}}, n);
  for (int k = 0; k < 6; ++k) {
    const float t = static_cast<float>(k) / 6;
    s.box({-0.03F, 0.3F * static_cast<float>(k), 6.8F + 0.35F * t * (2 - t)},
          {0.03F, 0.3F * static_cast<float>(k + 1) + 0.02F, 6.87F + 0.35F * t * (2 - t)});
  }
  s.box({-0.12F, 1.7F, 7.13F}, {0.12F, 2.3F, 7.23F});
  s.color(rgb(252, 240, 206));
  s.box({-0.09F, 1.75F, 7.1F}, {0.09F, 2.25F, 7.13F});
  return s.take();
}

Mesh make_bench(int level) {
  SmoothShape s;
  const int slats = 4 + level * 2;
  s.color(rgb(132, 88, 54));
  for (int k = 0; k < slats; ++k) {
    const float w = 0.44F / static_cast<float>(slats), y = -0.24F + w * static_cast<float>(k);
    s.box({-0.85F, y, 0.43F}, {0.85F, y + w * 0.8F, 0.47F});
    const float h = 0.4F / static_cast<float>(slats), z = 0.5F + h * static_cast<float>(k);
    s.box({-0.85F, 0.2F + 0.02F * static_cast<float>(k), z},
          {0.85F, 0.235F + 0.02F * static_cast<float>(k), z + h * 0.78F});
  }
  s.color(kIron);
  for (const float x : {-0.7F, 0.66F}) {
    s.box({x, -0.22F, 0}, {x + 0.04F, -0.17F, 0.43F}), s.box({x, 0.15F, 0}, {x + 0.04F, 0.2F, 0.9F});
    s.box({x, -0.24F, 0.38F}, {x + 0.04F, 0.2F, 0.43F}), s.box({x, -0.24F, 0.62F}, {x + 0.04F, 0.2F, 0.66F});
    s.box({x, -0.22F, 0.43F}, {x + 0.04F, -0.18F, 0.62F});
  }
  return s.take();
}

Mesh make_hydrant(int level) {
  SmoothShape s;
  const int n = sides_of(level);
  s.color(rgb(186, 44, 36));
  s.lathe({0, 0, 0},
          std::vector<glm::vec2>{{0.17F, 0},
                                 {0.17F, 0.05F},
                                 {0.11F, 0.08F},
                                 {0.11F, 0.5F},
                                 {0.15F, 0.52F},
                                 {0.15F, 0.56F},
                                 {0.12F, 0.6F},
                                 {0.09F, 0.68F},
                                 {0.04F, 0.72F},
                                 {0.03F, 0.78F},
                                 {0, 0.79F}},
          n);
  s.color(rgb(214, 190, 80));
  for (const float angle : {90.0F, -90.0F, 0.0F}) {
    s.place(
        glm::rotate(glm::rotate(glm::translate(glm::mat4(1), {0, 0, 0.4F}), glm::radians(angle), glm::vec3(0, 0, 1)),
                    glm::radians(90.0F), glm::vec3(1, 0, 0)));
    s.lathe({0, 0, 0.1F},
            std::vector<glm::vec2>{{0.05F, 0}, {0.05F, 0.05F}, {0.065F, 0.06F}, {0.065F, 0.1F}, {0, 0.11F}}, n);
  }
  return s.take();
}

Mesh make_bin(uint32_t variant, int level) {
  SmoothShape s;
  const int n = sides_of(level) + 4;
  s.color(variant == 0 ? rgb(46, 84, 60) : rgb(78, 82, 88));
  s.lathe({0, 0, 0},
          std::vector<glm::vec2>{{0.22F, 0.03F},
                                 {0.26F, 0.08F},
                                 {0.28F, 0.78F},
                                 {0.3F, 0.8F},
                                 {0.3F, 0.86F},
                                 {0.24F, 0.86F},
                                 {0.22F, 0.55F},
                                 {0, 0.55F}},
          n);
  s.color(kIron);
  for (const float side : {-1.0F, 1.0F})
    s.box({side * 0.27F - 0.015F, -0.03F, 0.8F}, {side * 0.27F + 0.015F, 0.03F, 1.12F});
  s.lathe({0, 0, 1.1F}, std::vector<glm::vec2>{{0.31F, 0}, {0.3F, 0.04F}, {0.18F, 0.12F}, {0, 0.15F}}, n);
  return s.take();
}

/// A shelter 4 m long and 1.1 m deep, open to -y.
Mesh make_bus_stop(int level) {
  SmoothShape s;
  s.color(kIron);
  for (const float x : {-1.95F, 0.0F, 1.95F})
    for (const float y : {0.5F, -0.5F})
      s.lathe({x, y, 0}, std::vector<glm::vec2>{{0.04F, 0}, {0.04F, 2.35F}}, sides_of(level));
  s.color(rgb(58, 76, 92));
  s.box({-2.1F, -0.6F, 2.35F}, {2.1F, 0.58F, 2.45F});
  s.color(rgb(148, 176, 188));
  for (const float x : {-1.9F, 0.05F}) s.box({x, 0.49F, 0.3F}, {x + 1.85F, 0.51F, 2.2F});
  s.box({-1.96F, -0.4F, 0.3F}, {-1.94F, 0.45F, 2.2F});
  s.color(rgb(214, 96, 52));
  s.box({1.88F, -0.48F, 0.4F}, {2.0F, 0.46F, 2.1F});
  s.color(rgb(132, 88, 54));
  const int slats = 3 + level * 2;
  for (int k = 0; k < slats; ++k) {
    const float w = 0.36F / static_cast<float>(slats), y = 0.08F + w * static_cast<float>(k);
    s.box({-1.6F, y, 0.44F}, {0.9F, y + 0.8F * w, 0.48F});
  }
  s.color(kSteel);
  for (const float x : {-1.4F, 0.6F}) s.box({x, 0.22F, 0}, {x + 0.06F, 0.28F, 0.44F});
  return s.take();
}

Mesh make_sign(uint32_t variant, int level) {
  SmoothShape s;
  const int n = sides_of(level);
  s.color(kSteel);
  s.lathe({0, 0, 0}, std::vector<glm::vec2>{{0.03F, 0}, {0.03F, 2.75F}, {0, 2.76F}}, n);
  const glm::mat4 up =
      glm::rotate(glm::translate(glm::mat4(1), {0, -0.03F, 2.45F}), glm::radians(90.0F), glm::vec3(1, 0, 0));
  const int corners = variant == 0 ? 8 : n + 8;
  s.place(glm::rotate(up, variant == 0 ? glm::radians(22.5F) : 0.0F, glm::vec3(0, 0, 1)));
  s.color(variant == 0 ? rgb(190, 36, 36) : variant == 1 ? rgb(40, 84, 168) : rgb(190, 40, 40));
  s.lathe({0, 0, 0}, std::vector<glm::vec2>{{0.36F, 0}, {0.36F, 0.02F}, {0, 0.021F}}, corners);
  s.color(kSteel);
  s.lathe({0, 0, -0.001F}, std::vector<glm::vec2>{{0, 0}, {0.36F, 0.001F}}, corners);
  s.color(rgb(244, 244, 240));
  if (variant == 2) s.lathe({0, 0, 0.021F}, std::vector<glm::vec2>{{0.27F, 0}, {0.27F, 0.006F}, {0, 0.007F}}, corners);
  s.place(up);
  if (variant == 0) s.box({-0.22F, -0.06F, 0.02F}, {0.22F, 0.06F, 0.03F});
  if (variant == 1)
    s.box({-0.12F, -0.2F, 0.02F}, {-0.05F, 0.2F, 0.03F}), s.box({-0.05F, 0.0F, 0.02F}, {0.1F, 0.2F, 0.03F});
  return s.take();
}

Mesh make_traffic_light(int level) {
  SmoothShape s;
  const int n = sides_of(level);
  s.color(rgb(44, 48, 46));
  s.lathe({0, 0, 0}, std::vector<glm::vec2>{{0.12F, 0}, {0.12F, 0.2F}, {0.06F, 0.26F}, {0.055F, 3.4F}, {0, 3.42F}}, n);
  s.box({-0.15F, -0.28F, 2.5F}, {0.15F, -0.06F, 3.4F});
  const std::vector<Color> lights = {rgb(60, 190, 90), rgb(226, 170, 50), rgb(210, 52, 44)};
  for (size_t k = 0; k < 3; ++k) {
    s.place(glm::rotate(glm::translate(glm::mat4(1), {0, -0.28F, 2.66F + 0.29F * static_cast<float>(k)}),
                        glm::radians(90.0F), glm::vec3(1, 0, 0)));
    s.color(rgb(30, 32, 32));
    s.lathe({0, 0, 0}, std::vector<glm::vec2>{{0.125F, 0}, {0.12F, 0.14F}, {0.11F, 0.14F}, {0.1F, 0.01F}}, n);
    s.color(lights[k]);
    s.lathe({0, 0, 0}, std::vector<glm::vec2>{{0.1F, 0.01F}, {0.07F, 0.03F}, {0, 0.045F}}, n);
  }
  return s.take();
}

}  // namespace

std::string_view name_of(PropClass prop) {
  constexpr std::array<std::string_view, kPropClasses> kNames = {
      "car", "tree", "bush", "lamp", "bench", "hydrant", "bin", "bus_stop", "sign", "traffic_light"};
  return kNames[static_cast<size_t>(prop)];
}

uint32_t variants_of(PropClass prop) {
  constexpr std::array<uint32_t, kPropClasses> kVariants = {16, 8, 2, 2, 1, 1, 2, 1, 3, 1};
  return kVariants[static_cast<size_t>(prop)];
}

Mesh make_prop(const PropKind& kind) {
  switch (kind.prop) {
    case PropClass::car:
      return make_car(kind.variant, kind.level);
    case PropClass::tree:
      return make_tree(kind.variant, kind.level);
    case PropClass::bush:
      return make_bush(kind.variant, kind.level);
    case PropClass::lamp:
      return make_lamp(kind.variant, kind.level);
    case PropClass::bench:
      return make_bench(kind.level);
    case PropClass::hydrant:
      return make_hydrant(kind.level);
    case PropClass::bin:
      return make_bin(kind.variant, kind.level);
    case PropClass::bus_stop:
      return make_bus_stop(kind.level);
    case PropClass::sign:
      return make_sign(kind.variant, kind.level);
    case PropClass::traffic_light:
      return make_traffic_light(kind.level);
  }
  return {};
}

const Mesh& PropLibrary::mesh(const PropKind& kind) {
  const size_t index =
      (static_cast<size_t>(kind.prop) * kMaxVariants + kind.variant) * kPropLevels + static_cast<size_t>(kind.level);
  Entry& entry = entries_[index];
  std::call_once(entry.made, [&] { entry.mesh = make_prop(kind); });
  return entry.mesh;
}

}  // namespace promenade
