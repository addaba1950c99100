// What can be seen through a window: a room and what people put in it.

#include <algorithm>
#include <array>

#include "datasets/city_facade.h"

namespace promenade {
namespace {

/// Puts boxes into a room: x along the window, y into the room, z up from its floor.
class Furnisher {
 public:
  Furnisher(Shape& shape, const Room& room, Random random)
      : shape_(shape), room_(room), random_(random), width_(room.x1 - room.x0) {}

  void walls();
  void bedroom();
  void living_room();
  void office();
  void pictures();

  float width() const { return width_; }

 private:
  void box(const Color& color, float x0, float y0, float z0, float x1, float y1, float z1) {
    shape_.color(color);
    const float top = std::min(z1, room_.ceiling_m - room_.floor_m - 0.02F);
    shape_.box(room_.frame, {room_.x0 + x0, -y1, room_.floor_m + z0}, {room_.x0 + x1, -y0, room_.floor_m + top});
  }
  void legs(const Color& color, float x0, float y0, float x1, float y1, float height) {
    for (const float x : {x0, x1 - 0.05F})
      for (const float y : {y0, y1 - 0.05F}) box(color, x, y, 0, x + 0.05F, y + 0.05F, height);
  }
  void table(const Color& color, float x0, float y0, float x1, float y1) {
    box(color, x0, y0, 0.7F, x1, y1, 0.75F);
    legs(shade(color, 0.8F), x0, y0, x1, y1, 0.7F);
  }
  void chair(const Color& color, float x, float y) {
    box(color, x, y, 0.42F, x + 0.42F, y + 0.42F, 0.47F);
    box(color, x, y + 0.38F, 0.47F, x + 0.42F, y + 0.42F, 0.9F);
    legs(shade(color, 0.8F), x, y, x + 0.42F, y + 0.42F, 0.42F);
  }
  void shelf(float x0, float x1);
  void lamp(float x, float y);

  Shape& shape_;
  const Room& room_;
  Random random_;
  float width_;
};

void Furnisher::walls() {
  const std::array<Color, 6> papers = {rgb(226, 216, 196), rgb(206, 214, 206), rgb(196, 206, 218),
                                       rgb(228, 204, 186), rgb(214, 200, 210), rgb(236, 232, 222)};
  const Color paper = papers[random_.below(6)];
  const WallFrame& f = room_.frame;
  const float a = room_.x0, b = room_.x1, y = -room_.depth_m, z0 = room_.floor_m, z1 = room_.ceiling_m;
  shape_.material(kOpaque);
  shape_.color(random_.chance(0.5) ? rgb(150, 108, 72) : rgb(132, 126, 118));
  shape_.face(f.at(a, -0.02F, z0), f.at(b, -0.02F, z0), f.at(b, y, z0), f.at(a, y, z0));
  shape_.color(rgb(240, 238, 232));
  shape_.face(f.at(a, y, z1), f.at(b, y, z1), f.at(b, -0.02F, z1), f.at(a, -0.02F, z1));
  shape_.color(paper);
  shape_.face(f.at(a, y, z0), f.at(b, y, z0), f.at(b, y, z1), f.at(a, y, z1));
  shape_.color(shade(paper, 0.92F));
  shape_.face(f.at(a, -0.02F, z0), f.at(a, y, z0), f.at(a, y, z1), f.at(a, -0.02F, z1));
  shape_.face(f.at(b, y, z0), f.at(b, -0.02F, z0), f.at(b, -0.02F, z1), f.at(b, y, z1));
  box(rgb(110, 78, 56), width_ * 0.5F - 0.45F, room_.depth_m - 0.06F, 0, width_ * 0.5F + 0.45F, room_.depth_m - 0.01F,
      2.05F);
}

void Furnisher::shelf(float x0, float x1) {
  const float back = room_.depth_m - 0.05F, front = back - 0.32F;
  const Color wood = rgb(122, 86, 58);
  for (int k = 0; k < 5; ++k)
    box(wood, x0, front, 0.05F + 0.4F * static_cast<float>(k), x1, back, 0.08F + 0.4F * static_cast<float>(k));
  box(wood, x0 - 0.03F, front, 0, x0, back, 1.7F), box(wood, x1, front, 0, x1 + 0.03F, back, 1.7F);
  for (int k = 0; k < 4; ++k) {
    const float z = 0.08F + 0.4F * static_cast<float>(k);
    for (float x = x0; x < x1 - 0.12F;) {
      const float w = random_.range(0.04F, 0.1F);
      const Color book = rgb(random_.between(50, 210), random_.between(40, 160), random_.between(40, 140));
      if (random_.chance(0.8)) box(book, x, front + 0.06F, z, x + w, back - 0.04F, z + random_.range(0.2F, 0.3F));
      x += w + 0.005F;
    }
  }
}

void Furnisher::lamp(float x, float y) {
  box(rgb(60, 56, 52), x - 0.12F, y - 0.12F, 0, x + 0.12F, y + 0.12F, 0.03F);
  box(rgb(60, 56, 52), x - 0.015F, y - 0.015F, 0.03F, x + 0.015F, y + 0.015F, 1.35F);
  shape_.color(rgb(250, 226, 170));
  shape_.cylinder(room_.frame.at(room_.x0 + x, -y, room_.floor_m + 1.3F), 0.2F, 0.12F, 0.28F, 10);
}

void Furnisher::bedroom() {
  const Color cover = rgb(random_.between(90, 220), random_.between(90, 200), random_.between(100, 220));
  const float x = 0.3F, y = room_.depth_m - 2.2F;
  box(rgb(112, 80, 58), x, y, 0.1F, x + 1.5F, y + 2.05F, 0.35F);
  box(cover, x + 0.03F, y + 0.02F, 0.35F, x + 1.47F, y + 1.5F, 0.56F);
  box(rgb(238, 236, 230), x + 0.03F, y + 1.5F, 0.35F, x + 1.47F, y + 2.0F, 0.54F);
  for (const float px : {0.12F, 0.82F})
    box(rgb(250, 248, 244), x + px, y + 1.55F, 0.54F, x + px + 0.56F, y + 1.95F, 0.68F);
  box(rgb(112, 80, 58), x, y + 2.05F, 0, x + 1.5F, y + 2.12F, 1.0F);
  if (width_ > 2.6F) box(rgb(156, 120, 86), width_ - 0.65F, y + 0.6F, 0, width_ - 0.05F, y + 2.1F, 2.0F);
  lamp(x + 1.75F, y + 1.8F);
}

void Furnisher::living_room() {
  const Color cloth = rgb(random_.between(80, 180), random_.between(70, 130), random_.between(60, 140));
  const float x = std::max(0.2F, width_ / 2 - 1.0F), y = room_.depth_m * 0.45F, w = std::min(2.0F, width_ - 0.4F);
  box(shade(cloth, 0.7F), x - 0.1F, y - 1.2F, 0.005F, x + w + 0.1F, y + 0.3F, 0.015F);
  box(cloth, x, y, 0.12F, x + w, y + 0.85F, 0.42F), box(cloth, x, y + 0.65F, 0.42F, x + w, y + 0.85F, 0.85F);
  for (const float side : {x, x + w - 0.2F}) box(shade(cloth, 0.9F), side, y, 0.42F, side + 0.2F, y + 0.65F, 0.6F);
  table(rgb(128, 92, 62), x + 0.3F, y - 0.9F, x + w - 0.3F, y - 0.3F);
  if (width_ > 2.2F) shelf(0.3F, width_ * 0.5F - 0.6F);
  lamp(width_ - 0.35F, y + 0.6F);
}

void Furnisher::office() {
  const Color wood = rgb(176, 140, 100);
  for (float x = 0.25F; x + 1.5F < width_; x += 2.1F)
    for (float y = 0.9F; y + 1.3F < room_.depth_m; y += 2.0F) {
      table(wood, x, y, x + 1.4F, y + 0.7F);
      box(rgb(40, 42, 46), x + 0.45F, y + 0.4F, 0.82F, x + 0.95F, y + 0.44F, 1.15F);
      box(rgb(40, 42, 46), x + 0.68F, y + 0.4F, 0.75F, x + 0.72F, y + 0.44F, 0.82F);
      box(rgb(200, 200, 198), x + 0.45F, y + 0.1F, 0.75F, x + 0.95F, y + 0.28F, 0.77F);
      box(rgb(246, 244, 238), x + 1.05F, y + 0.15F, 0.75F, x + 1.27F, y + 0.45F, 0.77F);
      chair(rgb(60, 66, 84), x + 0.5F, y + 0.8F);
    }
  if (width_ > 3) shelf(0.3F, width_ * 0.5F - 0.6F);
}

void Furnisher::pictures() {
  for (int k = 0; k < 2; ++k) {
    const float x = width_ * (k == 0 ? 0.2F : 0.8F), w = random_.range(0.25F, 0.5F), z = random_.range(1.3F, 1.5F);
    if (x - w < 0.05F || x + w > width_ - 0.05F) continue;
    box(rgb(70, 52, 38), x - w, room_.depth_m - 0.04F, z, x + w, room_.depth_m - 0.005F, z + 0.6F);
    box(rgb(random_.between(90, 220), random_.between(90, 200), random_.between(90, 200)), x - w + 0.05F,
        room_.depth_m - 0.05F, z + 0.05F, x + w - 0.05F, room_.depth_m - 0.035F, z + 0.55F);
  }
}

}  // namespace

void build_room(Shape& shape, const Room& room, Random random) {
  Furnisher furnisher(shape, room, random);
  furnisher.walls();
  if (room.depth_m < 2.6F || furnisher.width() < 2.2F) return;
  const uint32_t kind = random.fork(5).below(3);
  if (kind == 0)
    furnisher.bedroom();
  else if (kind == 1)
    furnisher.living_room();
  else
    furnisher.office();
  furnisher.pictures();
}

}  // namespace promenade
