#include "preprocess/visibility/view_volume.h"

#include <atomic>

#include "preprocess/visibility/leaf_meshes.h"

namespace promenade {

namespace {

using Kind = ViewVolume::Kind;

constexpr std::array<glm::ivec3, 6> kSteps = {glm::ivec3(-1, 0, 0), glm::ivec3(1, 0, 0),  glm::ivec3(0, -1, 0),
                                              glm::ivec3(0, 1, 0),  glm::ivec3(0, 0, -1), glm::ivec3(0, 0, 1)};

/// What a cube sees along the grid's axes: the nearest surface, and whether that shows its front. As one number: the
/// distance in parts of a cube, twice, and 1 for a back. The least of several does not depend on the order of threads;
/// of two that are as near, the front is what one sees.
constexpr uint32_t kNothingSeen = 0xffffffffU;
constexpr float kDistanceParts = 4096;
constexpr int kReach = 6;  // cubes of surfaces that a look goes through

class Surveyor {
 public:
  Surveyor(const ModelReader& reader, const VoxelGrid& grid, JobMonitor& monitor)
      : reader_(reader),
        grid_(grid),
        monitor_(monitor),
        leaves_(leaves_of(reader.model())),
        kinds_(grid.size(), Kind::unknown),
        seen_(grid.size(), kNothingSeen) {}

  Result<ViewVolume> run() {
    PROMENADE_TRY(for_each_leaf([this](const Mesh& mesh) { mark(mesh); }));
    PROMENADE_TRY(for_each_leaf([this](const Mesh& mesh) { show(mesh); }));
    open_from_the_top();
    judge_the_rest();
    find_lowest_open();
    PROMENADE_TRY(for_each_leaf([this](const Mesh& mesh) { raise_floors(mesh); }));
    return ViewVolume(grid_, std::move(kinds_), std::move(floors_m_));
  }

 private:
  template <class Visit>
  Status for_each_leaf(Visit visit) {
    const Status done = for_each_mesh(reader_, leaves_, monitor_, [&](size_t, const Mesh& mesh) { visit(mesh); });
    done_ += leaves_.size();
    monitor_.progress("viewing space", done_, 3 * leaves_.size());
    return done;
  }

  static Corners corners_of(const Mesh& mesh, size_t triangle) {
    const uint32_t* at = mesh.indices.data() + 3 * triangle;
    return {mesh.positions[at[0]], mesh.positions[at[1]], mesh.positions[at[2]]};
  }

  void mark(const Mesh& mesh) {
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
      for_each_touched(grid_, corners_of(mesh, t), [this](const glm::ivec3& at) {
        std::atomic_ref(kinds_[grid_.index(at)]).store(Kind::surface, std::memory_order_relaxed);
      });
  }

  /// Each triangle shows itself to the cubes on both sides of it, along the lines through the middles of cubes.
  void show(const Mesh& mesh) {
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
      Corners p = corners_of(mesh, t);
      for (glm::vec3& corner : p) corner = (corner - grid_.box.min) / grid_.step_m - 0.5F;  // middles: whole numbers
      for (int axis = 0; axis < 3; ++axis) show_along(axis, p);
    }
  }

  void show_along(int axis, const Corners& p) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const glm::vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    if (normal[axis] == 0) return;
    const auto lines = [&](int along) {
      const auto [low, high] = std::minmax({p[0][along], p[1][along], p[2][along]});
      const auto most = float(grid_.count[along] - 1);
      return std::pair(static_cast<int>(std::ceil(std::max(low, 0.0F))),
                       static_cast<int>(std::floor(std::min(high, most))));
    };
    const auto [u0, u1] = lines(u);
    const auto [v0, v1] = lines(v);
    const float sign = normal[axis] > 0 ? 1.0F : -1.0F;
    for (int at_v = v0; at_v <= v1; ++at_v)
      for (int at_u = u0; at_u <= u1; ++at_u) {
        bool inside = true;
        for (size_t k = 0; k < 3 && inside; ++k) {
          const glm::vec3 &a = p[k], &b = p[(k + 1) % 3];
          inside = sign * ((b[u] - a[u]) * (float(at_v) - a[v]) - (b[v] - a[v]) * (float(at_u) - a[u])) >= 0;
        }
        if (!inside) continue;
        const float rise = normal[u] * (float(at_u) - p[0][u]) + normal[v] * (float(at_v) - p[0][v]);
        const float height = p[0][axis] - rise / normal[axis];
        glm::ivec3 at;
        at[u] = at_u, at[v] = at_v, at[axis] = static_cast<int>(std::floor(height + 0.5F));
        if (!grid_.holds(at)) continue;
        tell(at, axis, 1, height, sign > 0);
        tell(at, axis, -1, height, sign < 0);
      }
  }

  /// The first cube in that direction that is no surface's sees the surface at a height along the axis.
  void tell(glm::ivec3 at, int axis, int way, float height, bool front) {
    for (int i = 0; i < kReach; ++i) {
      at[axis] += way;
      if (!grid_.holds(at)) return;
      const size_t index = grid_.index(at);
      if (kinds_[index] == Kind::surface) continue;
      const float distance = std::abs(float(at[axis]) - height);
      const uint32_t sight = 2 * static_cast<uint32_t>(distance * kDistanceParts) + (front ? 0 : 1);
      std::atomic_ref<uint32_t> nearest(seen_[index]);
      uint32_t known = nearest.load(std::memory_order_relaxed);
      while (sight < known && !nearest.compare_exchange_weak(known, sight, std::memory_order_relaxed)) {
      }
      return;
    }
  }

  /// Makes the space around a cube `kind`; returns how many more of its cubes see a front than a back.
  int64_t flood(const glm::ivec3& seed, Kind kind) {
    int64_t fronts = 0;
    kinds_[grid_.index(seed)] = kind;
    stack_.assign(1, static_cast<uint32_t>(grid_.index(seed)));
    while (!stack_.empty()) {
      const uint32_t index = stack_.back();
      stack_.pop_back();
      if (seen_[index] != kNothingSeen) fronts += seen_[index] % 2 == 0 ? 1 : -1;
      const glm::ivec3 at = grid_.at(index);
      for (const glm::ivec3& step : kSteps) {
        const glm::ivec3 next = at + step;
        if (!grid_.holds(next)) continue;
        Kind& there = kinds_[grid_.index(next)];
        if (there == kind || there == Kind::surface) continue;
        there = kind;
        stack_.push_back(static_cast<uint32_t>(grid_.index(next)));
      }
    }
    return fronts;
  }

  void open_from_the_top() {
    for (int y = 0; y < grid_.count.y; ++y)
      for (int x = 0; x < grid_.count.x; ++x)
        if (const glm::ivec3 at(x, y, grid_.count.z - 1); kinds_[grid_.index(at)] == Kind::unknown)
          flood(at, Kind::open);
  }

  void judge_the_rest() {
    for (int z = 0; z < grid_.count.z; ++z)
      for (int y = 0; y < grid_.count.y; ++y)
        for (int x = 0; x < grid_.count.x; ++x) {
          const glm::ivec3 at(x, y, z);
          if (kinds_[grid_.index(at)] != Kind::unknown) continue;
          if (flood(at, Kind::solid) > 0) flood(at, Kind::open);
        }
  }

  size_t column(const glm::ivec3& at) const { return size_t(at.y) * size_t(grid_.count.x) + size_t(at.x); }

  void find_lowest_open() {
    const size_t columns = size_t(grid_.count.x) * size_t(grid_.count.y);
    lowest_open_.assign(columns, grid_.count.z);
    floors_m_.assign(columns, ViewVolume::kNoFloor);
    for (size_t i = kinds_.size(); i-- > 0;)
      if (kinds_[i] == Kind::open) lowest_open_[i % columns] = static_cast<int>(i / columns);
  }

  /// A triangle that faces up is ground for the columns whose lowest open cube is right above it, the highest such
  /// triangle: below it there may be the tops of foundations.
  void raise_floors(const Mesh& mesh) {
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
      const Corners p = corners_of(mesh, t);
      if (glm::cross(p[1] - p[0], p[2] - p[0]).z <= 0) continue;
      const float lowest_m = std::min({p[0].z, p[1].z, p[2].z});
      for_each_touched(grid_, p, [&](const glm::ivec3& at) {
        const int above = lowest_open_[column(at)] - at.z;
        if (above < 0 || above > 1) return;
        const float floor_m = std::max(lowest_m, grid_.box.min.z + float(at.z) * grid_.step_m);
        std::atomic_ref<float> floor(floors_m_[column(at)]);
        float known = floor.load(std::memory_order_relaxed);
        while (floor_m > known && !floor.compare_exchange_weak(known, floor_m, std::memory_order_relaxed)) {
        }
      });
    }
  }

  const ModelReader& reader_;
  VoxelGrid grid_;
  JobMonitor& monitor_;
  std::vector<NodeId> leaves_;
  std::vector<Kind> kinds_;
  std::vector<uint32_t> seen_;
  std::vector<uint32_t> stack_;
  std::vector<int> lowest_open_;  ///< by column; the grid's height where nothing is open
  std::vector<float> floors_m_;
  uint64_t done_ = 0;
};

}  // namespace

bool ViewVolume::may_stand(const glm::ivec3& at) const {
  const Kind here = kind(at);
  if (here != Kind::surface) return here == Kind::open;
  return std::any_of(kSteps.begin(), kSteps.end(),
                     [&](const glm::ivec3& step) { return grid_.holds(at + step) && kind(at + step) == Kind::open; });
}

template <class Test>
bool ViewVolume::any_cube(const Box& box, Test test) const {
  // Shrunk by a little: a cube that the box only touches is another box's.
  const glm::vec3 rim(grid_.step_m * 1e-3F);
  const glm::ivec3 low = grid_.clamped(grid_.place(box.min + rim)), high = grid_.clamped(grid_.place(box.max - rim));
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        if (test(glm::ivec3(x, y, z))) return true;
  return false;
}

bool ViewVolume::is_open(const Box& box) const {
  return any_cube(box, [this](const glm::ivec3& at) { return may_stand(at); });
}

bool ViewVolume::holds_open(const Box& box) const {
  return any_cube(box, [this](const glm::ivec3& at) { return kind(at) == Kind::open; });
}

double ViewVolume::roofed_share() const {
  uint64_t open = 0, all = 0;
  std::vector<uint8_t> roof(size_t(grid_.count.x) * size_t(grid_.count.y), 0);
  for (size_t i = kinds_.size(); i-- > 0;) {
    uint8_t& above = roof[i % roof.size()];
    if (kinds_[i] == Kind::surface) above = 1;
    if (kinds_[i] == Kind::surface || above == 0) continue;
    ++all;
    open += kinds_[i] == Kind::open ? 1U : 0U;
  }
  return all > 0 ? double(open) / double(all) : 0;
}

Box ViewVolume::above_ground(const Box& box) const {
  const glm::vec3 rim(grid_.step_m * 1e-3F);
  const glm::ivec3 low = grid_.clamped(grid_.place(box.min + rim)), high = grid_.clamped(grid_.place(box.max - rim));
  float floor_m = box.max.z;
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x)
      if (const float here_m = floors_m_[size_t(y) * size_t(grid_.count.x) + size_t(x)]; here_m != kNoFloor)
        floor_m = std::min(floor_m, here_m);
  Box above = box;
  if (floor_m > box.min.z && floor_m < box.max.z) above.min.z = floor_m;
  return above;
}

void ViewVolume::keep_walkable(float height_m) {
  const int reach = std::max(1, static_cast<int>(std::ceil(height_m / grid_.step_m)));
  for (int y = 0; y < grid_.count.y; ++y)
    for (int x = 0; x < grid_.count.x; ++x) {
      int above = reach + 1;  // cubes since the last surface
      for (int z = 0; z < grid_.count.z; ++z) {
        Kind& here = kinds_[grid_.index({x, y, z})];
        above = here == Kind::surface ? 0 : above + 1;
        if (here == Kind::open && above > reach) here = Kind::unknown;
      }
    }
}

void ViewVolume::keep_inside(const std::vector<Box>& boxes) {
  for (int z = 0; z < grid_.count.z; ++z)
    for (int y = 0; y < grid_.count.y; ++y)
      for (int x = 0; x < grid_.count.x; ++x) {
        const glm::vec3 low = grid_.box.min + glm::vec3(x, y, z) * grid_.step_m;
        const Box cube{low, low + grid_.step_m};
        const auto touches = [&cube](const Box& box) { return box.overlaps(cube); };
        if (Kind& here = kinds_[grid_.index({x, y, z})];
            here == Kind::open && std::none_of(boxes.begin(), boxes.end(), touches))
          here = Kind::unknown;
      }
}

Result<ViewVolume> survey_volume(const ModelReader& reader, const Box& space, uint64_t max_voxels,
                                 JobMonitor& monitor) {
  return Surveyor(reader, VoxelGrid::over(space, max_voxels), monitor).run();
}

}  // namespace promenade
