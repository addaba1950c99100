#include "datasets/building.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <set>

#include "datasets/building_furnish.h"
#include "datasets/building_plan.h"
#include "datasets/building_structure.h"
#include "datasets/building_walk.h"
#include "datasets/furniture.h"
#include "layout/file_io.h"

namespace promenade {
namespace {

/// A folder of its own for a test's files.
class BuildingFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::path(testing::TempDir()) /
             (std::string("building_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::filesystem::path folder;
  JobMonitor monitor;
};

BuildingOptions small_building() {
  BuildingOptions options;
  options.floors = 2;
  options.triangles = 400'000;
  return options;
}

double distance_to_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  // Ericson, Real-Time Collision Detection, 5.1.5.
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return length(ap);
  const glm::dvec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return length(bp);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return length(ap - ab * (d1 / (d1 - d3)));
  const glm::dvec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return length(cp);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return length(ap - ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return length(bp - (c - b) * ((d4 - d3) / (d4 - d3 + d5 - d6)));
  const double sum = va + vb + vc;
  return length(ap - ab * (vb / sum) - ac * (vc / sum));
}

/// Points to test, in a grid of cells one metre wide; triangles come to them one by one.
class Clearance {
 public:
  explicit Clearance(std::vector<glm::dvec3> points)
      : points_(std::move(points)), least_(points_.size(), 1e300), who_(points_.size()) {
    for (size_t i = 0; i < points_.size(); ++i) cells_[cell(points_[i])].push_back(i);
  }

  /// Takes the triangle into account where it may come nearer than reach_m.
  void add(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const std::string& name) {
    constexpr double kReachM = 0.4;
    DBox box;
    box.add(a), box.add(b), box.add(c);
    const Cell low = cell(box.min - kReachM), high = cell(box.max + kReachM);
    if (volume(low, high) > cells_.size()) {
      for (const auto& [at, members] : cells_) measure(members, box.grown(kReachM), a, b, c, name);
      return;
    }
    for (int x = low[0]; x <= high[0]; ++x) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int z = low[2]; z <= high[2]; ++z) {
          const auto it = cells_.find({x, y, z});
          if (it != cells_.end()) measure(it->second, box.grown(kReachM), a, b, c, name);
        }
      }
    }
  }

  const std::vector<double>& least() const { return least_; }
  const std::string& who(size_t i) const { return who_[i]; }
  const glm::dvec3& point(size_t i) const { return points_[i]; }

 private:
  using Cell = std::array<int, 3>;
  static Cell cell(const glm::dvec3& p) {
    return {static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)), static_cast<int>(std::floor(p.z))};
  }
  static size_t volume(const Cell& a, const Cell& b) {
    size_t v = 1;
    for (size_t i = 0; i < 3; ++i) v *= static_cast<size_t>(b[i] - a[i] + 1);
    return v;
  }
  void measure(const std::vector<size_t>& members, const DBox& box, const glm::dvec3& a, const glm::dvec3& b,
               const glm::dvec3& c, const std::string& name) {
    for (const size_t i : members) {
      if (!box.contains(points_[i])) continue;
      const double distance = distance_to_triangle(points_[i], a, b, c);
      if (distance < least_[i]) least_[i] = distance, who_[i] = name;
    }
  }

  std::vector<glm::dvec3> points_;
  std::vector<double> least_;
  std::vector<std::string> who_;
  std::map<Cell, std::vector<size_t>> cells_;
};

void add_mesh(Clearance& clearance, const Mesh& mesh, const glm::dmat4& world, const std::string& name) {
  std::vector<glm::dvec3> points;
  for (const glm::vec3& p : mesh.positions) points.emplace_back(world * glm::dvec4(p, 1));
  for (size_t i = 0; i < mesh.indices.size(); i += 3)
    clearance.add(points[mesh.indices[i]], points[mesh.indices[i + 1]], points[mesh.indices[i + 2]], name);
}

std::vector<glm::dvec3> samples(const CameraPath& path, double step_m) {
  std::vector<glm::dvec3> points;
  for (size_t i = 1; i < path.keys.size(); ++i) {
    const glm::dvec3 a = path.keys[i - 1].pose.eye, b = path.keys[i].pose.eye;
    const int steps = std::max(1, static_cast<int>(std::ceil(glm::length(b - a) / step_m)));
    for (int k = 0; k < steps; ++k) points.push_back(a + (b - a) * (double(k) / steps));
  }
  points.push_back(path.keys.back().pose.eye);
  return points;
}

TEST(BuildingWalk, keeps_a_quarter_metre_from_everything) {
  for (const uint32_t floors : {1U, 7U}) {
    const BuildingPlan plan = plan_building(1, floors);
    Clearance clearance(samples(walk_building(plan), 0.25));
    const Structure structure = build_structure(plan, 1);
    for (const StructurePart& part : structure.parts)
      add_mesh(clearance, structure.meshes[part.mesh], part.world_from_part, part.name);
    const FurnitureCatalogue catalogue;
    std::vector<Mesh> meshes;
    std::vector<Box> boxes;
    for (const FurnitureItem& item : catalogue.items())
      meshes.push_back(item.build(0.6)), boxes.push_back(bounds(meshes.back()));
    for (const Placement& placement : furnish_building(plan, catalogue, 1, 1))
      add_mesh(clearance, meshes[placement.item], placement.world_from_item, placement.name);
    for (size_t i = 0; i < clearance.least().size(); ++i) {
      const glm::dvec3& p = clearance.point(i);
      EXPECT_GE(clearance.least()[i], 0.25) << "at " << p.x << ", " << p.y << ", " << p.z << " to " << clearance.who(i);
    }
  }
}

TEST(BuildingWalk, visits_every_floor_at_walking_speed_and_eye_height) {
  const CameraPath path = walk_building(plan_building(1, 7));
  std::set<int> floors;
  for (size_t i = 0; i < path.keys.size(); ++i) {
    const glm::dvec3& eye = path.keys[i].pose.eye;
    const double above = (eye.z - 1.65) / kStoreyM;
    if (std::abs(above - std::round(above)) < 1e-6) floors.insert(static_cast<int>(std::round(above)));
    if (i == 0) continue;
    const double step = glm::length(eye - path.keys[i - 1].pose.eye), time = path.keys[i].t_s - path.keys[i - 1].t_s;
    ASSERT_GT(time, 0) << "key " << i;
    if (step > 0) {
      EXPECT_NEAR(step / time, 1.4, 1e-6) << "key " << i;
    }
    EXPECT_LT(std::abs(path.keys[i].pose.yaw_deg - path.keys[i - 1].pose.yaw_deg) / time, 200) << "key " << i;
  }
  EXPECT_EQ(floors, (std::set<int>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(parse_path(to_json(path), "walk").ok());
}

TEST(BuildingPlan, has_the_rooms_of_a_university) {
  std::map<RoomKind, int> count;
  for (const Room& room : plan_building(1, 7).rooms) count[room.kind] += room.has_floor ? 1 : 0;
  EXPECT_GT(count[RoomKind::office], 100);
  EXPECT_EQ(count[RoomKind::laboratory], 12);
  EXPECT_EQ(count[RoomKind::class_room], 6);
  EXPECT_EQ(count[RoomKind::auditorium], 1);
  EXPECT_EQ(count[RoomKind::library], 1);
  EXPECT_EQ(count[RoomKind::stairwell], 14);
  EXPECT_EQ(count[RoomKind::lobby], 1);
  for (const RoomKind kind : {RoomKind::conference, RoomKind::toilet, RoomKind::kitchenette, RoomKind::lounge})
    EXPECT_GE(count[kind], 7) << name_of(kind);
}

TEST(BuildingPlan, gives_every_room_a_way_in_from_a_corridor) {
  const BuildingPlan plan = plan_building(3, 7);
  std::set<uint32_t> entered;
  for (const Wall& wall : plan.walls) {
    double reached = wall.from;
    for (const Opening& opening : wall.openings) {
      EXPECT_GT(opening.at - opening.width_m / 2, reached);
      reached = opening.at + opening.width_m / 2;
      if (opening.kind == OpeningKind::window) continue;
      const uint32_t other = wall.low == opening.room ? wall.high : wall.low;
      if (other != kOutside && plan.rooms[other].kind == RoomKind::corridor) entered.insert(opening.room);
    }
    EXPECT_LT(reached, wall.to);
  }
  for (uint32_t i = 0; i < plan.rooms.size(); ++i) {
    const Room& room = plan.rooms[i];
    EXPECT_TRUE(room.kind == RoomKind::corridor || entered.count(i) == 1) << room.name << " " << name_of(room.kind);
  }
}

TEST(BuildingStructure, is_sound_and_faces_outwards) {
  const Structure structure = build_structure(plan_building(1, 7), 1);
  for (size_t i = 0; i < structure.meshes.size(); ++i) {
    const Mesh& mesh = structure.meshes[i];
    EXPECT_EQ(find_defect(mesh), "") << i;
    double volume = 0;
    std::map<std::pair<std::array<float, 3>, std::array<float, 3>>, int> balance;
    const auto at = [&](size_t k) {
      return glm::dvec3(mesh.positions[mesh.indices[k]]) - glm::dvec3(bounds(mesh).center());
    };
    const auto name = [&](size_t k) {
      const glm::vec3& p = mesh.positions[mesh.indices[k]];
      return std::array<float, 3>{p.x + 0.0F, p.y + 0.0F, p.z + 0.0F};
    };
    for (size_t k = 0; k < mesh.indices.size(); ++k) {
      const size_t next = k % 3 == 2 ? k - 2 : k + 1;
      ++balance[{name(k), name(next)}], --balance[{name(next), name(k)}];
      if (k % 3 == 0) volume += glm::dot(at(k), glm::cross(at(k + 1), at(k + 2))) / 6;
    }
    EXPECT_GT(volume, 0) << i;
    EXPECT_TRUE(std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; })) << i;
  }
}

TEST_F(BuildingFiles, default_building_is_soda_hall_in_kind) {
  const Result<BuildingFigures> made = generate_building({}, folder / "hall.glb", monitor);
  ASSERT_TRUE(made.ok()) << made.error().message;
  EXPECT_GE(made->objects, 13'000U);
  EXPECT_LE(made->objects, 15'500U);
  EXPECT_NEAR(double(made->triangles), 1.4e6, 0.14e6);
  EXPECT_NEAR(double(made->structure_triangles), 3e4, 1.2e4);
  EXPECT_GT(made->unique_objects, 100U);
  EXPECT_EQ(made->files, 2U);
  EXPECT_EQ(made->bytes,
            std::filesystem::file_size(folder / "hall.glb") + std::filesystem::file_size(folder / "hall_walk.json"));
  const Result<std::string> walk = read_text_file(folder / "hall_walk.json");
  ASSERT_TRUE(walk.ok());
  EXPECT_TRUE(parse_path(*walk, "hall_walk.json").ok());
}

TEST_F(BuildingFiles, same_seed_means_same_bytes_at_any_number_of_threads) {
  BuildingOptions options = small_building();
  std::vector<std::vector<std::byte>> files;
  for (const uint32_t jobs : {1U, 3U}) {
    options.jobs = jobs;
    ASSERT_TRUE(generate_building(options, folder / "a.glb", monitor).ok());
    for (const char* name : {"a.glb", "a_walk.json"}) files.push_back(*read_file(folder / name));
  }
  EXPECT_EQ(files[0], files[2]);
  EXPECT_EQ(files[1], files[3]);
  options.seed = 2;
  ASSERT_TRUE(generate_building(options, folder / "a.glb", monitor).ok());
  EXPECT_NE(files[0], *read_file(folder / "a.glb"));
}

TEST_F(BuildingFiles, triangles_come_within_a_tenth_of_what_was_asked) {
  for (const auto& [floors, triangles] :
       std::vector<std::pair<uint32_t, uint64_t>>{{1, 100'000}, {2, 250'000}, {1, 2'000'000}}) {
    BuildingOptions options;
    options.floors = floors, options.triangles = triangles;
    const Result<BuildingFigures> made = generate_building(options, folder / "b.glb", monitor);
    ASSERT_TRUE(made.ok()) << made.error().message;
    EXPECT_NEAR(double(made->triangles), double(triangles), 0.1 * double(triangles)) << floors << " floors";
  }
}

TEST_F(BuildingFiles, more_triangles_than_furniture_can_take_add_floors) {
  BuildingOptions options;
  options.floors = 1, options.triangles = 20'000'000;
  const Result<BuildingFigures> made = generate_building(options, folder / "tower.glb", monitor);
  ASSERT_TRUE(made.ok()) << made.error().message;
  EXPECT_NEAR(double(made->triangles), 2e7, 2e6);
  EXPECT_GT(made->box.max.z, 2 * kStoreyM);
}

TEST_F(BuildingFiles, bad_options_are_refused_in_one_line_and_leave_nothing) {
  const auto refuse = [&](uint32_t floors, uint64_t triangles, const std::filesystem::path& path, const char* word) {
    BuildingOptions options;
    options.floors = floors, options.triangles = triangles;
    const Result<BuildingFigures> made = generate_building(options, path, monitor);
    ASSERT_FALSE(made.ok());
    EXPECT_NE(made.error().message.find(word), std::string::npos) << made.error().message;
    EXPECT_EQ(made.error().message.find('\n'), std::string::npos);
  };
  refuse(0, 1'000'000, folder / "a.glb", "0 floors");
  refuse(100'000, 1'000'000, folder / "a.glb", "100000 floors");
  refuse(7, 0, folder / "a.glb", "0 triangles");
  refuse(7, 1000, folder / "a.glb", "too few");
  refuse(7, uint64_t{1} << 60U, folder / "a.glb", "fewer triangles");
  refuse(7, 1'400'000, folder / "a.obj", ".glb");
  refuse(1, 200'000, folder / "missing" / "a.glb", "missing");
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(BuildingFiles, cancelling_leaves_nothing) {
  struct Impatient : JobMonitor {
    bool cancelled() const override { return true; }
  } impatient;
  const Result<BuildingFigures> made = generate_building(small_building(), folder / "a.glb", impatient);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().message, "interrupted");
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(BuildingFurniture, every_class_is_there_by_default) {
  const FurnitureCatalogue catalogue;
  std::set<std::string> all, placed, names;
  for (const FurnitureItem& item : catalogue.items()) all.insert(item.class_name);
  for (const Placement& placement : furnish_building(plan_building(1, 7), catalogue, 1, 1)) {
    placed.insert(catalogue.items()[placement.item].class_name);
    EXPECT_TRUE(names.insert(placement.name).second) << placement.name;
  }
  EXPECT_EQ(placed, all);
}

}  // namespace
}  // namespace promenade
