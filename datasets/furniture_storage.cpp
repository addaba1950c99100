// Bookcases, books, cabinets, boxes.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "datasets/furniture.h"
#include "datasets/furniture_palette.h"
#include "datasets/furniture_variants.h"

namespace promenade {

namespace {

using glm::dvec3;
using namespace palette;

constexpr uint32_t kBooks = 24;

struct Bookcase {
  glm::u8vec4 wood = kOak;
  bool two_sided = false;
};

Mesh bookcase(const Bookcase& p, double quality) {
  Sculptor s(quality);
  const double half = 0.45, y0 = p.two_sided ? -0.26 : -0.15, y1 = p.two_sided ? 0.26 : 0.15;
  const double height = kShelfFirstM + kShelfBoards * kShelfPitchM;
  s.paint(p.wood);
  for (const double side : {-1.0, 1.0}) {
    const double a = side * half, b = side * (half - 0.025);
    s.rounded_box({std::min(a, b), y0, 0}, {std::max(a, b), y1, height + 0.02}, 0.004, s.steps(0.6, 0));
  }
  const double inner = half - 0.0251;
  s.paint(shaded(p.wood, 0.08));
  for (uint32_t i = 0; i <= kShelfBoards; ++i) {
    const double z = kShelfFirstM + i * kShelfPitchM;
    s.box({-inner, y0 + 0.005, z - 0.022}, {inner, y1 - (p.two_sided ? 0.005 : 0.012), z});
  }
  s.paint(shaded(p.wood, -0.15));
  const double back = p.two_sided ? 0.006 : 0.15;
  s.box({-inner, back - 0.0115, 0.02}, {inner, back, height + 0.015});
  s.box({-inner, y0 + 0.03, 0.001}, {inner, y0 + 0.045, kShelfFirstM - 0.023});
  return s.take();
}

struct Book {
  BookSize size;
  glm::u8vec4 cover;
  glm::u8vec4 label;
  bool banded;
};

Book book_parameters(uint32_t variant) {
  static constexpr std::array<glm::u8vec4, 8> kCovers = {kNavy, kWine,      kSage,  kMustard,
                                                         kRust, kTealCloth, kSlate, rgb(0x5a3d6b)};
  Random random(0xb00c + variant);
  Book book{};
  book.size = {random.range(0.024, 0.062), random.range(0.15, 0.21), random.range(0.19, 0.29)};
  book.cover = shaded(kCovers[variant % kCovers.size()], random.range(-0.25, 0.25));
  book.label = random.chance(0.5) ? kBrass : kPaper;
  book.banded = variant % 3 != 0;
  return book;
}

/// Standing upright, its spine towards -y at y = 0, leaves behind it.
void add_book(Sculptor& s, const Book& b) {
  const double w = b.size.width_m / 2, d = b.size.depth_m, h = b.size.height_m;
  s.paint(b.cover);
  if (s.quality() < kFineDetail) {  // a block whose head and tail show paper
    const glm::dvec2 block[] = {{-w, 0}, {w, 0}, {w, d}, {-w, d}};
    return s.extrude(block, {}, 0, h, &kPaper, &kPaper);
  }
  s.box({-w, 0.004, 0}, {-w + 0.0025, d, h});
  s.box({w - 0.0025, 0.004, 0}, {w, d, h});
  std::vector<glm::dvec2> spine{{w, 0.006}};
  const uint32_t arc = s.steps(2, 1);
  for (uint32_t i = 0; i <= arc; ++i) {
    const double u = 1 - 2.0 * i / arc;
    spine.emplace_back(w * u, 0.0041 * u * u * (arc > 1 ? 1 : 0.9));
  }
  spine.emplace_back(-w, 0.006);
  std::reverse(spine.begin(), spine.end());
  s.extrude(spine, {}, 0, h);
  s.paint(kPaper).box({-w + 0.0026, 0.0061, 0.004}, {w - 0.0026, d - 0.005, h - 0.004});
  if (b.banded) {
    s.paint(b.label).box({-w * 0.7, -0.0008, h * 0.62}, {w * 0.7, 0.0035, h * 0.78});
  }
}

Mesh book(uint32_t variant, double quality) {
  Sculptor s(quality);
  add_book(s, book_parameters(variant));
  return s.take();
}

/// Books lying flat, as they do on a desk.
Mesh book_pile(uint32_t first, uint32_t count, double quality) {
  Sculptor s(quality);
  double z = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const Book b = book_parameters(first + i);
    const double turn = 7.0 * i - 9;
    const glm::dmat4 laid(0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1);  // x turns up, z to the left
    s.stand(moved({0, 0, z + b.size.width_m / 2}) * turned_z(turn) *
            moved({b.size.height_m / 2, -b.size.depth_m / 2, 0}) * laid);
    add_book(s, b);
    z += b.size.width_m;
  }
  return s.take();
}

/// A run of books that fills most of a board, the last one leaning.
Mesh book_run(uint32_t variant, double quality) {
  Sculptor s(quality);
  Random random(0x5e1f + variant);
  double x = -kShelfInnerHalfM;
  const double end = random.range(0.05, 0.36);
  while (true) {
    const Book b = book_parameters(random.below(kBooks));
    if (x + b.size.width_m > end - 0.06) break;
    s.stand(moved({x + b.size.width_m / 2, random.range(0.0, 0.012), 0}));
    add_book(s, b);
    x += b.size.width_m + 0.001;
  }
  const Book b = book_parameters(random.below(kBooks));
  const double tilt = 8;
  const glm::dmat4 lean = turned_z(90) * turned_x(tilt) * turned_z(-90);  // about y: the top leans to the left
  s.stand(moved({x + b.size.width_m / 2 + b.size.height_m * 0.139 + 0.003, 0, b.size.width_m * 0.07}) * lean);
  add_book(s, b);
  return s.take();
}

struct Cabinet {
  double width_m = 0.47, depth_m = 0.6, height_m = 1.32;
  uint32_t drawers = 4;
  glm::u8vec4 body = kSteel;
};

Mesh filing_cabinet(const Cabinet& p, double quality) {
  Sculptor s(quality);
  const double w = p.width_m / 2, d = p.depth_m / 2, step = (p.height_m - 0.06) / p.drawers;
  s.paint(p.body).rounded_box({-w, -d + 0.02, 0}, {w, d, p.height_m}, 0.008, s.steps(1, 0));
  for (uint32_t i = 0; i < p.drawers; ++i) {
    const double z = 0.04 + i * step;
    s.paint(shaded(p.body, 0.12));
    s.rounded_box({-w + 0.012, -d, z}, {w - 0.012, -d + 0.019, z + step - 0.015}, 0.006, s.steps(1, 0));
    if (quality < 0.25) continue;
    const dvec3 handle[] = {{-0.07, -d + 0.01, z + step * 0.6},
                            {-0.07, -d - 0.022, z + step * 0.6},
                            {0.07, -d - 0.022, z + step * 0.6},
                            {0.07, -d + 0.01, z + step * 0.6}};
    s.paint(kChrome).tube(handle, 0.006, s.steps(6, 3));
    s.paint(kPaper).box({-0.045, -d - 0.003, z + step * 0.74}, {0.045, -d - 0.0005, z + step * 0.86});
  }
  return s.take();
}

Mesh cardboard_box(glm::u8vec4 side, double w, double d, double h, double quality) {
  Sculptor s(quality);
  s.paint(side).box({-w / 2, -d / 2, 0}, {w / 2, d / 2, h - 0.006});
  s.paint(shaded(side, 0.12)).box({-w / 2 - 0.004, -d / 2 - 0.004, h - 0.06}, {w / 2 + 0.004, d / 2 + 0.004, h});
  s.paint(kPaper).box({-w * 0.2, -d / 2 - 0.0015, h * 0.3}, {w * 0.2, -d / 2 - 0.0002, h * 0.55});
  return s.take();
}

Mesh lockers(glm::u8vec4 door, double quality) {
  Sculptor s(quality);
  for (int i = 0; i < 3; ++i) {
    const double x = -0.6 + 0.4 * i;
    s.paint(kSteel).box({x, -0.22, 0}, {x + 0.399, 0.25, 1.8});
    s.paint(door).rounded_box({x + 0.012, -0.24, 0.06}, {x + 0.387, -0.221, 1.77}, 0.006, s.steps(1, 0));
    for (int k = 0; k < 4; ++k)
      s.paint(kGraphite).box({x + 0.1, -0.2415, 1.5 + 0.05 * k}, {x + 0.3, -0.2402, 1.515 + 0.05 * k});
    s.paint(kChrome).cylinder({x + 0.34, -0.24, 0.95}, {x + 0.34, -0.265, 0.95}, 0.014, s.steps(10, 4));
  }
  return s.take();
}

}  // namespace

BookSize book_size(uint32_t variant) { return book_parameters(variant % kBooks).size; }

void add_storage(FurnitureCatalogue& catalogue) {
  catalogue.add("bookshelf", "bookshelf", each<Bookcase>(bookcase, {{kOak}, {kWhite}, {kWalnut}, {kBeech}}));
  catalogue.add("library_shelf", "bookshelf", each<Bookcase>(bookcase, {{kCherry, true}}));
  std::vector<std::function<Mesh(double)>> books, piles, runs;
  for (uint32_t i = 0; i < kBooks; ++i) books.emplace_back([i](double quality) { return book(i, quality); });
  for (uint32_t i = 0; i < 4; ++i)
    piles.emplace_back([i](double quality) { return book_pile(5 * i, 2 + i % 3, quality); });
  for (uint32_t i = 0; i < 10; ++i) runs.emplace_back([i](double quality) { return book_run(i, quality); });
  catalogue.add("book", "book", books);
  catalogue.add("book_pile", "books", piles);
  catalogue.add("book_run", "books", runs);
  catalogue.add(
      "filing_cabinet", "cabinet",
      each<Cabinet>(filing_cabinet, {{}, {.height_m = 0.72, .drawers = 2, .body = kGraphite}, {.body = kSand}}));
  catalogue.add("cardboard_box", "box",
                {[](double q) { return cardboard_box(kCardboard, 0.4, 0.3, 0.28, q); },
                 [](double q) { return cardboard_box(kOffWhite, 0.34, 0.32, 0.26, q); }});
  catalogue.add("lockers", "cabinet",
                {[](double q) { return lockers(kTealCloth, q); }, [](double q) { return lockers(kRust, q); }});
}

}  // namespace promenade
