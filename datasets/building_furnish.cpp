#include "datasets/building_furnish.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/shapes.h"
#include "geometry/random.h"

namespace promenade {

namespace {

using glm::dvec3;

// Which way an item's front looks, in degrees to turn it in its room's frame.
constexpr double kToDoor = 0, kToRight = 90, kInward = 180, kToLeft = -90;

/// Puts items into one frame and names them. A mirrored frame swaps left and right (the items stay as they are).
class Furnisher {
 public:
  Furnisher(const FurnitureCatalogue& catalogue, std::vector<Placement>& out, uint64_t seed, double density)
      : random(seed), catalogue_(catalogue), out_(out), density_(density) {}

  void enter(const glm::dmat4& world_from_frame, double width_m, bool mirrored, std::string prefix) {
    frame_ = world_from_frame, width_ = width_m, mirrored_ = mirrored, prefix_ = std::move(prefix);
  }

  /// Puts an item at (u, v, w); the frame it stands in comes back, for what is put on it.
  glm::dmat4 put(const char* kind, uint32_t variant, double u, double v, double w = 0, double turn = 0) {
    const glm::dmat4 at = frame_ * moved({mirrored_ ? width_ - u : u, v, w}) * turned_z(mirrored_ ? -turn : turn);
    add(kind, variant, at);
    return at;
  }
  void add(const char* kind, uint32_t variant, const glm::dmat4& at) {
    const uint32_t item = catalogue_.find(kind, variant);
    out_.push_back({item, at, fmt::format("{}_{}_{}", prefix_, catalogue_.items()[item].class_name, ++number_)});
  }
  /// A small loose thing: there only as often as the density says.
  void loose(const char* kind, uint32_t variant, const glm::dmat4& at) {
    if (random.unit() < 2 * density_ - 1) add(kind, variant, at);
  }
  uint32_t any(const char* kind) { return random.below(catalogue_.variants(kind)); }
  double density() const { return density_; }

  Random random;

 private:
  const FurnitureCatalogue& catalogue_;
  std::vector<Placement>& out_;
  double density_;
  glm::dmat4 frame_{1};
  double width_ = 0;
  bool mirrored_ = false;
  std::string prefix_;
  uint32_t number_ = 0;
};

/// What lies on a desk 0.74 m high; its user sits at -y.
void dress_desk(Furnisher& f, const glm::dmat4& desk, bool lamp) {
  const auto on = [&](double x, double y, double turn = 0) { return desk * moved({x, y, 0.74}) * turned_z(turn); };
  f.add("monitor", f.any("monitor"), on(-0.05, 0.17, f.random.range(-6.0, 6.0)));
  const uint32_t keys = f.any("keyboard");
  f.add("keyboard", keys, on(-0.05, -0.16));
  f.add("mouse", keys, on(0.32, -0.17, f.random.range(-10.0, 10.0)));
  if (lamp) f.add("desk_lamp", f.any("desk_lamp"), on(-0.62, 0.22, 35));
  if (f.random.chance(0.6)) f.loose("telephone", f.any("telephone"), on(0.62, 0.15, -20));
  if (f.random.chance(0.3)) f.loose("mug", f.any("mug"), on(-0.45, -0.1, f.random.range(0.0, 360.0)));
  if (f.random.chance(0.4)) f.loose("pencil_cup", f.any("pencil_cup"), on(0.42, 0.25));
  if (f.random.chance(0.4)) f.loose("papers", f.any("papers"), on(-0.5, -0.22, f.random.range(-15.0, 15.0)));
  if (f.random.chance(0.7)) f.loose("book_pile", f.any("book_pile"), on(0.62, -0.18, f.random.range(-20.0, 20.0)));
  const int pencils = 1 + static_cast<int>(f.random.below(2));
  for (int i = 0; i < pencils; ++i)
    f.loose("pencil", f.any("pencil"), on(0.42 - 0.02 * i, -0.3 + 0.03 * i, f.random.range(-40.0, 40.0)));
  if (f.random.chance(0.15)) f.loose("desk_plant", f.any("desk_plant"), on(-0.68, -0.05));
}

/// Fills a one-sided bookcase with runs of books, some boards with boxes or a plant.
void fill_shelf(Furnisher& f, const glm::dmat4& shelf, double fullness) {
  for (uint32_t board = 0; board < kShelfBoards; ++board) {
    const double z = kShelfFirstM + board * kShelfPitchM;
    if (f.random.chance(fullness)) {
      f.loose("book_run", f.any("book_run"), shelf * moved({0, kSpineOneSidedM, z}));
    } else if (f.random.chance(0.3)) {
      f.loose("papers", f.any("papers"), shelf * moved({-0.21, -0.005, z}));
    } else if (f.random.chance(0.5)) {
      f.loose("book_pile", f.any("book_pile"), shelf * moved({-0.15, 0, z}));
      if (f.random.chance(0.5)) f.loose("desk_plant", f.any("desk_plant"), shelf * moved({0.22, 0, z}));
    }
  }
}

/// Fills both sides of a library bookcase with single books.
void fill_stacks(Furnisher& f, const glm::dmat4& shelf, uint32_t book_variants) {
  for (const double side : {0.0, 180.0}) {
    for (uint32_t board = 0; board < kShelfBoards; ++board) {
      const double end = kShelfInnerHalfM * f.random.range(0.45, 1.0);
      double x = -kShelfInnerHalfM;
      while (true) {
        const uint32_t book = f.random.below(book_variants);
        const BookSize size = book_size(book);
        if (x + size.width_m > end) break;
        f.loose("book", book,
                shelf * turned_z(side) *
                    moved({x + size.width_m / 2, kSpineTwoSidedM + f.random.range(0.0, 0.02),
                           kShelfFirstM + board * kShelfPitchM}));
        x += size.width_m + f.random.range(0.001, 0.004);
      }
    }
  }
}

struct RoomSize {
  double w, d;
};

/// Ceiling lights in a grid, cell by cell.
void light_grid(Furnisher& f, const RoomSize& r, double height_m, double pitch_m, uint32_t variant) {
  const int columns = std::max(1, static_cast<int>(std::lround(r.w / pitch_m))),
            rows = std::max(1, static_cast<int>(std::lround(r.d / pitch_m)));
  for (int i = 0; i < columns; ++i) {
    for (int k = 0; k < rows; ++k)
      f.put("ceiling_panel", variant, r.w * (i + 0.5) / columns, r.d * (k + 0.5) / rows, height_m, r.w < r.d ? 90 : 0);
  }
}

void furnish_office(Furnisher& f, const RoomSize& r) {
  const uint32_t wood = f.random.below(4);
  const bool facing_door = r.w > 3.7 && f.random.chance(0.5);
  const double u = facing_door ? r.w * 0.56 : r.w - 0.45, v = facing_door ? r.d - 1.75 : r.d - 1.6;
  const double turn = facing_door ? kInward : kToLeft;
  const glm::dmat4 desk = f.put("desk", wood, u, v, 0, turn);
  dress_desk(f, desk, true);
  const uint32_t chair = f.any("office_chair");
  f.add("office_chair", chair,
        desk * moved({f.random.range(-0.15, 0.1), -0.68, 0}) * turned_z(180 + f.random.range(-25.0, 25.0)));
  f.add("waste_bin", 2 * f.random.below(2), desk * moved({-0.95, 0.1, 0}));
  if (f.random.chance(0.6)) f.add("tower", f.any("tower"), desk * moved({-0.5, 0.1, 0}));
  const uint32_t visitor = f.any("visitor_chair");
  if (facing_door) {
    for (const double side : f.random.chance(0.3) ? std::vector<double>{-0.42, 0.42} : std::vector<double>{0.1})
      f.put("visitor_chair", visitor, u + side, v - 0.95, 0, kInward + f.random.range(-12.0, 12.0));
  } else {
    f.put("visitor_chair", visitor, r.w - 1.55, v - 1.25, 0, kInward + f.random.range(-20.0, 20.0));
    if (f.random.chance(0.4))
      f.put("visitor_chair", visitor, 0.42, r.d - 2.1, 0, kToRight + f.random.range(-10.0, 10.0));
  }
  const int shelves = f.random.chance(0.25) ? 2 : 1;
  for (int i = 0; i < shelves; ++i)
    fill_shelf(f, f.put("bookshelf", wood, r.w - 0.16, 0.85 + 0.92 * i, 0, kToLeft), 0.5);
  f.put("filing_cabinet", f.any("filing_cabinet"), r.w - 0.31, 1.1 + 0.92 * shelves, 0, kToLeft);
  if (f.random.chance(0.5)) f.put("plant", f.any("plant"), 0.45, r.d - 0.5, 0, f.random.range(0.0, 360.0));
  if (f.random.chance(0.7)) f.put("whiteboard", f.random.chance(0.5) ? 0 : 2, 0, 2.9, 1.5, kToRight);
  if (f.random.chance(0.6))
    f.put("picture", f.any("picture"), r.w, r.d - 1.6 + f.random.range(-0.2, 0.2), 1.65, kToLeft);
  if (f.random.chance(0.4)) f.put("picture", f.any("picture"), r.w * 0.62, 0, 1.6, kInward);
  if (f.random.chance(0.3)) f.put("coat_stand", 0, r.w - 0.5, 0.24);
  if (f.random.chance(0.3)) f.put("floor_lamp", f.any("floor_lamp"), r.w - 0.35, r.d - 0.4);
  if (f.random.chance(0.6)) f.put("radiator", 0, r.w / 2, r.d, 0, kToDoor);
}

void furnish_student_office(Furnisher& f, const RoomSize& r) {
  const int pairs = std::clamp(static_cast<int>((r.w - 2.4) / 1.75), 1, 3);
  for (int i = 0; i < pairs; ++i) {
    const double u = r.w - 0.9 - 1.75 * i;
    for (const bool far : {true, false}) {
      const glm::dmat4 desk = f.put("desk", 4, u, far ? r.d - 0.55 : r.d - 1.42, 0, far ? kToDoor + 180 : kToDoor);
      dress_desk(f, desk, f.random.chance(0.12));
      f.add("task_chair", f.any("task_chair"),
            desk * moved({0, far ? -0.6 : -0.68, 0}) * turned_z(180 + f.random.range(-30.0, 30.0)));
    }
  }
  for (int i = 0; i < 2; ++i) fill_shelf(f, f.put("bookshelf", 1, r.w - 0.55 - 0.92 * i, 0.16, 0, kInward), 0.7);
  f.put("whiteboard", 1, 0, r.d * 0.55, 1.5, kToRight);
  f.put("waste_bin", 0, r.w - 2.6, 0.25);
  f.put("plant", f.any("plant"), 0.45, r.d - 0.45);
  f.put("clock", 0, r.w - 3, 0, 2.3, kInward);
}

void furnish_laboratory(Furnisher& f, const RoomSize& r) {
  const uint32_t style = f.random.below(2);
  const int rows = 3, columns = static_cast<int>((r.w - 2.6) / 2.0);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const glm::dmat4 desk = f.put("lab_bench", style, 3.0 + 2.0 * column, 2.2 + 2.0 * row);
      const auto on = [&](double x, double y, double turn) { return desk * moved({x, y, 0.74}) * turned_z(turn); };
      f.add("monitor", f.any("monitor"), on(0, 0.15, f.random.range(-8.0, 8.0)));
      f.add("keyboard", style, on(-0.05, -0.18, 0));
      f.add("mouse", style, on(0.35, -0.18, 0));
      f.add("tower", style, desk * moved({0.55, 0.1, 0}));
      if (f.random.chance(0.3)) f.loose("papers", f.any("papers"), on(-0.5, -0.15, f.random.range(-20.0, 20.0)));
      f.add("task_chair", style + f.random.below(2),
            desk * moved({f.random.range(-0.15, 0.15), -0.66, 0}) * turned_z(180 + f.random.range(-40.0, 40.0)));
    }
  }
  f.put("whiteboard", 1, r.w, 2.4, 1.5, kToLeft);
  f.put("notice_board", f.any("notice_board"), r.w, 5.4, 1.6, kToLeft);
  const glm::dmat4 stand = f.put("printer_stand", 0, r.w - 0.5, 0.4, 0, kInward);
  f.add("printer", 1, stand * moved({0, 0, 0.66}));
  f.put("copier", 0, r.w - 1.6, 0.45, 0, kInward);
  f.put("server_rack", f.any("server_rack"), r.w - 2.7, 0.55, 0, kInward);
  f.put("waste_bin", 0, 2.3, 0.3), f.put("waste_bin", 1, r.w - 3.4, 0.3);
  f.put("projector", 0, r.w - 3, r.d / 2, kCeilingM, kToRight);
  f.put("clock", 0, r.w / 2, r.d, 2.4);
  f.put("plant", f.any("plant"), r.w - 0.45, r.d - 0.45);
}

void furnish_class_room(Furnisher& f, const RoomSize& r) {
  const int rows = static_cast<int>((r.w - 4.6) / 1.25), columns = 3;
  const uint32_t chair = f.random.below(4), top = f.random.below(2);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double u = 1.8 + 1.25 * row, v = 2.0 + 1.75 * column;
      // Its user looks at the board on the right: the table's far side is there.
      f.put("class_table", top, u, v, 0, kToLeft);
      for (const double side : {-0.32, 0.32}) {
        f.put("stacking_chair", chair, u - 0.45, v + side, 0, kToRight + f.random.range(-8.0, 8.0));
        if (f.random.chance(0.15)) f.put("papers", 0, u, v + side, 0.74, 90);
      }
    }
  }
  f.put("blackboard", 0, r.w, r.d / 2, 1.55, kToLeft);
  const glm::dmat4 desk = f.put("desk", 0, r.w - 1.3, r.d - 1.5, 0, kToRight);
  f.add("laptop", f.any("laptop"), desk * moved({0, 0, 0.74}));
  f.add("visitor_chair", 2, desk * moved({0, -0.62, 0}) * turned_z(180));
  f.put("lectern", 0, r.w - 1.2, 1.5, 0, kToRight);
  f.put("projector", 0, r.w - 3.4, r.d / 2, kCeilingM, kToRight);
  f.put("clock", 0, r.w, 0.9, 2.3, kToLeft);
  f.put("notice_board", f.any("notice_board"), 4, 0, 1.5, kInward);
  f.put("waste_bin", 1, r.w - 0.4, 0.4);
  f.put("radiator", 0, 3, r.d), f.put("radiator", 0, r.w - 4, r.d);
}

void furnish_auditorium(Furnisher& f, const RoomSize& r) {
  const double rise = kStoreyM / kRows;
  const int seats = static_cast<int>((r.w - 2 * kAisleM - 0.1) / 0.55);
  const double first = (r.w - (seats - 1) * 0.55) / 2;
  for (uint32_t row = 0; row < kRows; ++row) {
    for (int seat = 0; seat < seats; ++seat)
      f.put("auditorium_seat", row % 2, first + 0.55 * seat, kFrontRowM + kRowDepthM * row + 0.62, (row + 1) * rise);
  }
  f.put("projection_screen", 1, r.w - 4.2, 0, 1.3, kInward);
  f.put("lectern", 0, r.w - 1.6, 1.5, 0, kToDoor + 180);
  const glm::dmat4 desk = f.put("desk", 2, r.w - 4.2, 1.5, 0, kToDoor);
  f.add("laptop", 0, desk * moved({0.2, 0, 0.74}));
  f.add("mug", 1, desk * moved({-0.3, 0.1, 0.74}));
  f.put("blackboard", 0, 0, 1.5, 1.6, kToRight);
  f.put("projector", 0, r.w - 4.2, r.d * 0.55, kStoreyM + 3.35, kToDoor);
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 5; ++k) f.put("ceiling_panel", 0, r.w * (i + 0.5) / 4, r.d * (k + 0.5) / 5, kStoreyM + 3.35);
  }
  for (const double v : {5.0, 8.5, 12.0}) {
    f.put("picture", f.any("picture"), r.w, v, 2.2 + v * 0.25, kToLeft);
    f.put("picture", f.any("picture"), 0, v, 2.2 + v * 0.25, kToRight);
  }
}

void furnish_conference(Furnisher& f, const RoomSize& r) {
  const uint32_t style = f.any("conference_table"), chair = f.any("conference_chair");
  const bool across = r.w > r.d;
  const int tables = r.w > 10 ? 2 : 1;
  for (int t = 0; t < tables; ++t) {
    const double u = tables == 1 ? r.w * 0.55 : r.w * (0.34 + 0.36 * t), v = r.d * 0.54;
    const double turn = across ? 0 : 90;
    const glm::dmat4 table = f.put("conference_table", style, u, v, 0, turn);
    for (int i = 0; i < 3; ++i) {
      for (const double side : {-1.0, 1.0}) {
        const glm::dmat4 at = table * moved({-1.1 + 1.1 * i, side * 1.08, 0}) *
                              turned_z((side > 0 ? 0 : 180) + f.random.range(-14.0, 14.0));
        f.add("conference_chair", chair, at);
        if (f.random.chance(0.3))
          f.loose("papers", 0,
                  table * moved({-1.1 + 1.1 * i, side * 0.42, 0.74}) * turned_z(f.random.range(-15.0, 15.0)));
        if (f.random.chance(0.3))
          f.loose("mug", f.any("mug"),
                  table * moved({-0.85 + 1.1 * i, side * 0.36, 0.74}) * turned_z(f.random.range(0.0, 360.0)));
        if (f.random.chance(0.3))
          f.loose("pencil", f.any("pencil"),
                  table * moved({-1.1 + 1.1 * i, side * 0.25, 0.74}) * turned_z(f.random.range(-40.0, 40.0)));
      }
    }
    for (const double end : {-1.0, 1.0})
      f.add("conference_chair", chair, table * moved({end * 2.2, 0, 0}) * turned_z(end > 0 ? 90 : -90));
    f.add("laptop", f.any("laptop"), table * moved({1.2, 0, 0.74}) * turned_z(90));
    f.put("projector", 0, u, v, kCeilingM, kToRight);
  }
  f.put("projection_screen", 0, r.w, r.d * 0.5, 0.9, kToLeft);
  f.put("whiteboard", 1, r.w * 0.55, 0, 1.5, kInward);
  f.put("plant", f.any("plant"), r.w - 0.45, 0.5), f.put("plant", f.any("plant"), 0.45, r.d - 0.45);
  f.put("picture", f.any("picture"), 0, r.d * 0.6, 1.6, kToRight);
  f.put("clock", 0, r.w * 0.25 + 1, 0, 2.3, kInward);
}

void furnish_library(Furnisher& f, const RoomSize& r, uint32_t book_variants) {
  constexpr int kRanges = 4, kBays = 3;
  const double door = r.w / 2;
  for (int range = 0; range < kRanges; ++range) {
    for (int bay = 0; bay < kBays; ++bay) {
      const glm::dmat4 shelf =
          f.put("library_shelf", 0, door + 6.2 + 2.4 * range, r.d - 0.95 - 0.92 * bay, 0, kToRight);
      fill_stacks(f, shelf, book_variants);
    }
  }
  for (int i = 0; i < 12; ++i) fill_shelf(f, f.put("bookshelf", 2, door + 4.4 + 0.93 * i, 0.16, 0, kInward), 0.92);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 2; ++k) {
      const glm::dmat4 table = f.put("reading_table", f.random.below(2), 2.2 + 3.6 * i, 1.7 + 2.7 * k);
      for (const double x : {-0.45, 0.45}) {
        for (const double side : {-1.0, 1.0})
          f.add("visitor_chair", 2, table * moved({x, side * 0.75, 0}) * turned_z(side > 0 ? 0 : 180));
        f.loose("book_pile", f.any("book_pile"),
                table * moved({x, f.random.range(-0.3, 0.3), 0.74}) * turned_z(f.random.range(0.0, 90.0)));
      }
      f.add("desk_lamp", 1, table * moved({0, 0.1, 0.74}));
    }
  }
  for (int i = 0; i < 8; ++i) fill_shelf(f, f.put("bookshelf", 2, 1.6 + 0.93 * i, 0.16, 0, kInward), 0.9);
  const glm::dmat4 desk = f.put("counter", 1, door - 2.8, 3.6, 0, kInward);
  f.add("monitor", 0, desk * moved({0.3, -0.2, 0.735})), f.add("keyboard", 0, desk * moved({0.3, -0.36, 0.735}));
  f.add("office_chair", 2, desk * moved({0, -0.9, 0}) * turned_z(180));
  f.put("plant", 3, door - 1.5, r.d - 0.5), f.put("plant", 4, door + 3.8, r.d - 0.6);
  for (const double u : {door - 0.6, door + 2.2}) f.put("armchair", 0, u, r.d - 1.2, 0, kToDoor);
  f.put("coffee_table", 1, door + 0.8, r.d - 1.3);
}

void furnish_toilet(Furnisher& f, const RoomSize& r) {
  const int basins = 3;
  for (int i = 0; i < basins; ++i) {
    f.put("wash_basin", 0, 1.9 + 0.95 * i, 0, 0, kInward);
    f.put("mirror", 0, 1.9 + 0.95 * i, 0, 1.5, kInward);
  }
  const int cubicles = static_cast<int>((r.w - 0.1) / 1.0);
  for (int i = 0; i < cubicles; ++i) {
    f.put("cubicle", 0, 0.6 + 1.0 * i, r.d);
    f.put("toilet", 0, 0.55 + 1.0 * i, r.d - 0.36);
  }
  f.put("waste_bin", 1, r.w - 0.35, 0.35);
}

void furnish_kitchenette(Furnisher& f, const RoomSize& r) {
  const glm::dmat4 unit = f.put("kitchen_unit", f.any("kitchen_unit"), r.w - 1.5, r.d, 0, kToDoor);
  f.add("coffee_machine", 0, unit * moved({0.2, -0.25, 0.91}));
  f.add("microwave", 0, unit * moved({0.75, -0.3, 0.91}));
  for (int i = 0; i < 4; ++i)
    f.loose("mug", f.any("mug"), unit * moved({-0.05 - 0.1 * i, -0.12 - 0.05 * (i % 2), 0.91}));
  f.put("fridge", 0, r.w - 0.4, 0.4, 0, kInward);
  const glm::dmat4 table = f.put("cafe_table", f.any("cafe_table"), r.w - 1.3, 1.45);
  for (int i = 0; i < 3; ++i)
    f.add("stacking_chair", static_cast<uint32_t>(i), table * turned_z(120 * i + 30) * moved({0, 0.62, 0}));
  f.put("waste_bin", 1, 0.35, r.d - 1.2);
  f.put("notice_board", 0, r.w - 2, 0, 1.5, kInward);
}

void furnish_lobby(Furnisher& f, const RoomSize& r) {
  const double m = r.w / 2;
  const glm::dmat4 desk = f.put("counter", 0, m - 4.4, 2.6, 0, kToLeft + 180 + 180);
  f.add("monitor", 1, desk * moved({0.4, -0.2, 0.735})), f.add("keyboard", 1, desk * moved({0.4, -0.36, 0.735}));
  f.add("office_chair", 0, desk * moved({0, -0.9, 0}) * turned_z(180));
  f.put("sofa", 0, m + 3.6, 1.2, 0, kInward), f.put("sofa", 2, m + 3.6, 4.2, 0, kToDoor);
  f.put("armchair", 0, m + 5.6, 2.7, 0, kToLeft);
  const glm::dmat4 table = f.put("coffee_table", 0, m + 3.6, 2.7);
  f.loose("book_pile", 1, table * moved({0.2, 0, 0.4})), f.loose("papers", 1, table * moved({-0.25, 0.1, 0.4}));
  f.put("sculpture", 0, m - 2.6, r.d - 1.2);
  for (const double u : {0.6, r.w - 0.6}) f.put("plant", f.any("plant"), u, 0.6), f.put("plant", 3, u, r.d - 0.7);
  for (int i = 0; i < 4; ++i) f.put("pendant", static_cast<uint32_t>(i), m - 5.25 + 3.5 * i, r.d * 0.5, kCeilingM);
  f.put("notice_board", 1, 0, r.d / 2, 1.5, kToRight);
  f.put("floor_lamp", 0, r.w - 0.8, 4.4);
  f.put("picture", 0, r.w, 2.7, 1.6, kToLeft), f.put("picture", 3, r.w, 3.9, 1.6, kToLeft);
}

void furnish_lounge(Furnisher& f, const RoomSize& r) {
  f.put("sofa", 1, r.w - 0.55, r.d * 0.5, 0, kToLeft);
  f.put("armchair", 1, r.w - 1.9, r.d * 0.5 + 1.5, 0, kToDoor),
      f.put("armchair", 0, r.w - 1.9, r.d * 0.5 - 1.5, 0, kInward);
  f.put("coffee_table", f.any("coffee_table"), r.w - 1.9, r.d * 0.5);
  const int tables = std::max(1, static_cast<int>((r.w - 4.5) / 2.2));
  for (int i = 0; i < tables; ++i) {
    const glm::dmat4 table = f.put("cafe_table", 0, 1.4 + 2.1 * i, r.d - 1.4);
    for (int k = 0; k < 4; ++k)
      f.add(i % 2 == 0 ? "stacking_chair" : "stool", static_cast<uint32_t>(i),
            table * turned_z(90 * k + 45) * moved({0, 0.66, 0}));
    f.loose("mug", f.any("mug"), table * moved({0.15, 0.1, 0.74}));
  }
  f.put("vending_machine", 0, r.w - 0.6, 0.45, 0, kInward), f.put("water_cooler", 0, r.w - 1.4, 0.25, 0, kInward);
  f.put("plant", 3, 0.45, r.d - 0.45), f.put("plant", 2, r.w - 0.45, r.d - 0.45), f.put("plant", 5, r.w - 0.5, 1.3);
  f.put("pendant", f.any("pendant"), r.w * 0.5, r.d * 0.6, kCeilingM);
  f.put("picture", f.any("picture"), r.w, r.d * 0.5, 1.7, kToLeft);
}

void furnish_storage(Furnisher& f, const RoomSize& r) {
  const int bays = std::min(4, static_cast<int>((r.d - 1.6) / 0.92));
  for (int i = 0; i < bays; ++i) {
    const glm::dmat4 shelf = f.put("bookshelf", 1, r.w - 0.16, 1.4 + 0.92 * i, 0, kToLeft);
    for (uint32_t board = 0; board < kShelfBoards; ++board) {
      for (const double x : {-0.21, 0.21}) {
        if (f.random.chance(0.28))
          f.loose("cardboard_box", f.any("cardboard_box"),
                  shelf * moved({x, -0.01, kShelfFirstM + board * kShelfPitchM}));
      }
    }
  }
  for (int i = 0; i < 4; ++i)
    f.loose("cardboard_box", 0,
            f.put("cardboard_box", 1, 0.45 + 0.5 * (i % 2), r.d - (i < 2 ? 0.4 : 0.8), 0, f.random.range(-10.0, 10.0)) *
                moved({0, 0, 0.27}));
  if (r.w > 2.6) f.put("lockers", f.any("lockers"), 0.9, r.d - 1.5, 0, kToDoor);
}

void furnish_server_room(Furnisher& f, const RoomSize& r) {
  const int racks = static_cast<int>((r.w - 3.2) / 0.62);
  for (int row = 0; row < 3; ++row) {
    for (int i = 0; i < racks; ++i)
      f.put("server_rack", static_cast<uint32_t>(row), 2.6 + 0.62 * i, 2.0 + 2.0 * row, 0,
            row % 2 == 0 ? kToDoor : kInward);
  }
  f.put("extinguisher", 0, r.w, 1, 1.1, kToLeft);
}

void furnish_corridor(Furnisher& f, const RoomSize& r) {
  // Along the longer axis; the middle and 0.9 m to either side stay free of everything below 2 m.
  const bool across = r.w > r.d;
  const double length = across ? r.w : r.d, width = across ? r.d : r.w;
  const auto at = [&](const char* kind, uint32_t variant, double along, double side, double w, double turn) {
    return across ? f.put(kind, variant, along, side, w, turn)
                  : f.put(kind, variant, width - side, along, w, turn + 90);
  };
  const int lights = static_cast<int>(length / 4.6);
  for (int i = 0; i < lights; ++i) at("ceiling_panel", 0, length * (i + 0.5) / lights, width / 2, kCorridorCeilingM, 0);
  const int signs = std::max(1, static_cast<int>(length / 16));
  for (int i = 0; i < signs; ++i)
    at("exit_sign", 0, length * (i + 0.35) / signs, width * 0.5 + 0.75, kCorridorCeilingM, 90);
}

void furnish_room(Furnisher& f, const Room& room, const RoomSize& r, uint32_t book_variants) {
  switch (room.kind) {
    case RoomKind::office:
      return furnish_office(f, r);
    case RoomKind::student_office:
      return furnish_student_office(f, r);
    case RoomKind::laboratory:
      return furnish_laboratory(f, r);
    case RoomKind::class_room:
      return furnish_class_room(f, r);
    case RoomKind::auditorium:
      return room.has_floor ? furnish_auditorium(f, r) : void();
    case RoomKind::conference:
      return furnish_conference(f, r);
    case RoomKind::library:
      return furnish_library(f, r, book_variants);
    case RoomKind::toilet:
      return furnish_toilet(f, r);
    case RoomKind::kitchenette:
      return furnish_kitchenette(f, r);
    case RoomKind::lobby:
      return furnish_lobby(f, r);
    case RoomKind::lounge:
      return furnish_lounge(f, r);
    case RoomKind::storage:
      return furnish_storage(f, r);
    case RoomKind::server_room:
      return furnish_server_room(f, r);
    case RoomKind::corridor:
      return furnish_corridor(f, r);
    case RoomKind::stairwell:
    case RoomKind::lift:
      return;
  }
}

/// Handrails along the flights that leave a stairwell, or a guard before the hole where no further one does.
void furnish_stairwell(Furnisher& f, const Room& room, uint32_t floors, double width_m) {
  const glm::dmat4 corner = moved({room.min + kWallHalfM, room.floor * kStoreyM});
  if (room.floor + 1 < floors)
    f.add("stair_rail", 0, corner * moved({width_m / 2, kLandingM, 0}));
  else if (floors > 1)
    f.add("stair_guard", 0, corner * moved({kFlightWidthM / 2, kLandingM - 0.04, 0}));
}

void light_room(Furnisher& f, const Room& room, const RoomSize& r) {
  switch (room.kind) {
    case RoomKind::corridor:
    case RoomKind::auditorium:
    case RoomKind::stairwell:
    case RoomKind::lift:
      return;
    case RoomKind::laboratory:
    case RoomKind::class_room:
    case RoomKind::library:
      return light_grid(f, r, kCeilingM, 3.6, 0);
    default:
      return light_grid(f, r, kCeilingM, 4.4, f.random.chance(0.5) ? 1 : 0);
  }
}

/// Frame, leaves and handles of a door; its frame: x along the wall, +y into the room.
void hang_door(Furnisher& f, const glm::dmat4& door, const Room& room, bool is_double, bool entrance) {
  f.add(entrance ? "entrance_frame" : is_double ? "double_door_frame" : "door_frame", room.floor % 2, door);
  const bool glazed = room.kind == RoomKind::laboratory || room.kind == RoomKind::library || entrance;
  const uint32_t leaf = glazed ? 3 + room.floor % 2 : room.floor % 3;
  const double half = is_double ? kDoubleDoorM / 2 - 0.05 : kDoorWidthM / 2 - 0.05;
  const double open = room.door_closed ? 0 : f.random.range(86.0, 94.0);
  const double hinge_y = room.door_closed ? 0 : 0.14;
  for (const double side : {-1.0, 1.0}) {
    if (!is_double && side > 0) continue;
    const glm::dmat4 at = door * moved({side * half, hinge_y, 0}) * turned_z(side < 0 ? open : 180 - open);
    f.add("door_leaf", leaf, at);
    f.add("door_handle", room.kind == RoomKind::office ? 0 : 1, at * moved({0.83, 0, 1.05}));
  }
  if (!entrance)
    f.add("room_sign", room.kind == RoomKind::office ? 0 : 1,
          door * moved({is_double ? 1.25 : 0.78, -kWallHalfM, 1.5}));
}

void fit_openings(Furnisher& f, const BuildingPlan& plan, const Wall& wall) {
  const double z = wall.floor * kStoreyM;
  const bool outer = wall.low == kOutside || wall.high == kOutside;
  for (const Opening& opening : wall.openings) {
    const Room& room = plan.rooms[opening.room];
    f.enter(glm::dmat4(1), 0, false, fmt::format("f{}_{}", wall.floor + 1, room.name));
    const bool room_above = wall.high == opening.room;
    // Turns +y into the room.
    const double turn = wall.along_x ? (room_above ? 0 : 180) : (room_above ? -90 : 90);
    const dvec3 place = wall.along_x ? dvec3(opening.at, wall.line, z) : dvec3(wall.line, opening.at, z);
    const glm::dmat4 at = moved(place) * turned_z(turn);
    if (opening.kind == OpeningKind::window) f.add("window", 0, at * turned_z(180) * moved({0, 0, opening.bottom_m}));
    if (opening.kind == OpeningKind::lift) {
      f.add("lift_door", room.floor == 0 ? 1 : 0, at);
      if (room.floor == 0) f.add("lift_cabin", 0, at * moved({0, 0.2, 0}));
    }
    if (opening.kind != OpeningKind::door) continue;
    // The middle of the outer wall lies outside its line.
    const glm::dmat4 middle = outer ? at * moved({0, -(kFacadeM - kWallHalfM) / 2, 0}) : at;
    hang_door(f, middle, room, opening.width_m > 1.5, outer);
  }
}

/// Pictures, boards and bins on the corridor's walls, between the doors.
void dress_corridor_wall(Furnisher& f, const BuildingPlan& plan, const Wall& wall) {
  const auto is_corridor = [&](uint32_t id) { return id != kOutside && plan.rooms[id].kind == RoomKind::corridor; };
  const bool above = is_corridor(wall.high);
  if (!above && !is_corridor(wall.low)) return;
  const Room& corridor = plan.rooms[above ? wall.high : wall.low];
  f.enter(glm::dmat4(1), 0, false, fmt::format("f{}_{}", wall.floor + 1, corridor.name));
  const double turn = wall.along_x ? (above ? 180 : 0) : (above ? 90 : -90), face = (above ? 1 : -1) * kWallHalfM;
  std::vector<double> edges{wall.from};
  for (const Opening& opening : wall.openings)
    edges.insert(edges.end(), {opening.at - opening.width_m / 2 - 0.3, opening.at + opening.width_m / 2 + 0.45});
  edges.push_back(wall.to);
  for (size_t i = 0; i + 1 < edges.size(); i += 2) {
    const double room = edges[i + 1] - edges[i];
    if (room < 1.3) continue;
    const double along = (edges[i] + edges[i + 1]) / 2;
    const auto at = [&](double shift, double z) {
      const double a = along + shift, across = wall.line + face;
      return moved(wall.along_x ? dvec3(a, across, wall.floor * kStoreyM + z)
                                : dvec3(across, a, wall.floor * kStoreyM + z)) *
             turned_z(turn);
    };
    const uint32_t what = f.random.below(12);
    if (what < 5) f.add("picture", f.any("picture"), at(0, 1.6));
    if (what == 6 && room > 1.8) f.add("notice_board", f.any("notice_board"), at(0, 1.5));
    if (what == 7) f.add("extinguisher", 0, at(0, 1.1));
    if (what == 8) f.add("waste_bin", 1, at(0, 0) * moved({0, -0.22, 0}));
    if (what == 9 && room > 2.0) f.add("bench", f.any("bench"), at(0, 0) * moved({0, -0.24, 0}));
    if (what == 10) f.add("plant", f.any("plant") == 1 ? 1 : 2, at(0, 0) * moved({0, -0.25, 0}));
    if (what == 11) f.add("water_cooler", 0, at(0, 0) * moved({0, -0.18, 0}));
  }
}

void furnish_outside(Furnisher& f, const BuildingPlan& plan) {
  f.enter(glm::dmat4(1), 0, false, "outside");
  const double paving = -0.02, lawn = -0.1;
  for (int i = 0; i < 9; ++i) {
    if (i != 4)
      f.put("tree", f.any("tree"), -6 + 9.2 * i + f.random.range(-1.0, 1.0), -10 + f.random.range(-1.5, 1.5), lawn,
            f.random.range(0.0, 360.0));
    f.put("tree", f.any("tree"), -6 + 9.2 * i + f.random.range(-1.5, 1.5), kDepthM + 10 + f.random.range(-2.0, 2.0),
          lawn, f.random.range(0.0, 360.0));
  }
  for (int i = 0; i < 5; ++i) {
    f.put("tree", f.any("tree"), -11 + f.random.range(-2.0, 2.0), 8.0 * i, lawn);
    f.put("tree", f.any("tree"), kWidthM + 11 + f.random.range(-2.0, 2.0), 8.0 * i, lawn);
  }
  for (int i = 0; i < 6; ++i) {
    for (const double side : {-3.6, 3.6}) {
      f.put("street_lamp", 0, kWidthM / 2 + side, -8.0 - 8 * i, lawn);
      if (i % 2 == 0) f.put("bench", 1, kWidthM / 2 + side * 1.35, -11.0 - 8 * i, lawn, side > 0 ? kToLeft : kToRight);
    }
  }
  for (int i = 0; i < 26; ++i) {
    const double x = 1.2 + 2.4 * i;
    if (std::abs(x - kWidthM / 2) > 4.5)
      f.put("shrub", f.any("shrub"), x, -1.6 + f.random.range(-0.2, 0.2), paving, f.random.range(0.0, 360.0));
  }
  for (int i = 0; i < 10; ++i) f.put("bicycle_stand", 0, 44 + 0.9 * i, -3.2, paving, 90);
  for (const double u : {-2.4, -0.9, 0.9, 2.4}) f.put("bollard", 0, kWidthM / 2 + u * 1.05, -5.2, -0.1);
  const double roof = plan.floors * kStoreyM;
  for (int i = 0; i < 4; ++i)
    f.put("air_handler", static_cast<uint32_t>(i), 9.0 + 13.5 * i, i % 2 == 0 ? 9 : 24, roof, i % 2 == 0 ? 0 : 90);
  f.put("mast", 0, 46, 17, roof);
}

/// A pier on the facade at each wall piece's ends, storey by storey.
void dress_facade(Furnisher& f, const BuildingPlan& plan) {
  f.enter(glm::dmat4(1), 0, false, "facade");
  for (uint32_t floor = 0; floor < plan.floors; ++floor) {
    const double z = floor * kStoreyM + (floor == 0 ? -0.02 : -0.06), height = floor == 0 ? 3.5 : kStoreyM - 0.26;
    const auto pier = [&](double x, double y, double turn) {
      glm::dmat4 stretch(1);
      stretch[2][2] = height;
      f.add("pilaster", floor == 0 ? 0 : 1, moved({x, y, z}) * turned_z(turn) * stretch);
    };
    // The same axes on every storey, wherever its partitions are; between the windows of most.
    for (int i = 0; i <= 8; ++i) {
      const double x = 9.2 + (kWidthM - 2 * 9.2) * i / 8;
      if (floor == 0 && std::abs(x - kWidthM / 2) < 3) continue;
      pier(x, -kFacadeM, 0), pier(x, kDepthM + kFacadeM, 180);
    }
  }
}

}  // namespace

std::vector<Placement> furnish_building(const BuildingPlan& plan, const FurnitureCatalogue& catalogue, uint64_t seed,
                                        double density) {
  std::vector<Placement> placements;
  Furnisher f(catalogue, placements, seed * 0x2545f491ULL + 5, density);
  const uint32_t book_variants = catalogue.variants("book");
  uint64_t number = 0;
  for (const Room& room : plan.rooms) {
    const RoomFrame frame = frame_of(room);
    const bool mirrored = room.door_width_m > 0 && frame.door_u > frame.width_m / 2;
    f.enter(frame.world_from_room, frame.width_m, mirrored, fmt::format("f{}_{}", room.floor + 1, room.name));
    const RoomSize size{frame.width_m, frame.depth_m};
    // A stream of its own for each room: what one draws never moves the next one's furniture.
    f.random = Random(seed * 0x2545f491ULL + ++number);
    const bool furnished = f.random.unit() < 2 * density;
    if (furnished || room.kind == RoomKind::corridor) furnish_room(f, room, size, book_variants);
    light_room(f, room, size);
    if (room.kind == RoomKind::stairwell) furnish_stairwell(f, room, plan.floors, frame.width_m);
  }
  for (const Wall& wall : plan.walls) {
    fit_openings(f, plan, wall);
    dress_corridor_wall(f, plan, wall);
  }
  dress_facade(f, plan);
  furnish_outside(f, plan);
  return placements;
}

}  // namespace promenade
