// Source: [funkhouser1993] section 3.2 divides buildings along their major axial walls and lists the portals between
// cells from what the walls leave open.

#include "preprocess/visibility/rooms.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "geometry/box_tree.h"
#include "layout/cell_faces.h"
#include "preprocess/visibility/leaf_meshes.h"
#include "preprocess/visibility/wall_openings.h"
#include "preprocess/visibility/wall_planes.h"

namespace promenade {
namespace {

/// Triangles whose corners all lie this near to a plane are in it. The rest of the slack is a wall's rim.
constexpr float kInPlaneM = 0.0015F;
constexpr float kFlat = 0.9F;
constexpr size_t kMostOpenings = 24;  // of a face, one direction: more are united
constexpr float kThinnestM = 0.012F;  // a floor's finish is a room of its own: beneath it walls have gaps
constexpr float kThinM = 0.7F;        // what is thinner is a wall or a slab, cut where holes go through it
constexpr float kMarginM = 2;         // of air around the model

enum Way : uint8_t { down = 0, up = 1 };

class RoomFinder {
 public:
  RoomFinder(const ModelReader& reader, const RoomOptions& options, JobMonitor& monitor)
      : reader_(reader), options_(options), monitor_(monitor), leaves_(leaves_of(reader.model())) {}

  Result<Rooms> run() {
    PROMENADE_TRY(divide());
    PROMENADE_TRY(find_faces(rooms_.space));
    PROMENADE_TRY(find_exits());
    sort_rooms();
    return std::move(rooms_);
  }

  Result<Rooms> run_in(CellTables space) {
    rooms_.space = std::move(space);
    PROMENADE_TRY(find_exits());
    return std::move(rooms_);
  }

 private:
  Status find_exits() {
    list_faces();
    PROMENADE_TRY(for_each_wall([this](size_t leaf, const std::vector<WallTriangle>& found) { meet(leaf, found); }));
    list_walls();
    for (uint32_t first = 0; first < work_.size();) {
      const uint32_t end = end_of_group(first);
      PROMENADE_TRY(for_each_wall(
          [this, first, end](size_t, const std::vector<WallTriangle>& found) { hold(found, first, end); }));
      find_openings(first, end);
      first = end;
    }
    list_exits();
    return Done{};
  }

  /// A triangle that lies in a face's plane and reaches into the face.
  struct WallTriangle {
    uint32_t face;
    FlatTriangle corners;
    bool closes_down, closes_up;  ///< to those who walk that way it shows its front
  };
  struct FaceWork {
    std::vector<uint32_t> leaves;
    std::array<uint64_t, 2> met{};  ///< by way: triangles that close it; none: all open
    std::array<std::vector<FlatTriangle>, 2> walls;
    std::array<std::vector<Box>, 2> openings;
  };

  Status divide();
  void list_faces();
  template <class Visit>
  Status for_each_wall(const Visit& visit);
  void find_walls(const Mesh& mesh, std::vector<WallTriangle>& found) const;
  void add_walls(const std::array<glm::vec3, 3>& p, int axis, bool shows_up, bool two_sided,
                 std::vector<WallTriangle>& found) const;
  void meet(size_t leaf, const std::vector<WallTriangle>& found);
  void list_walls();
  uint32_t end_of_group(uint32_t first) const;
  void hold(const std::vector<WallTriangle>& found, uint32_t first, uint32_t end);
  void find_openings(uint32_t first, uint32_t end);
  void list_exits();
  void sort_rooms();

  /// Of those across an axis, every one whose rectangle touches the box. Not by rooms: around a town is one with a face
  /// for every wall outdoors.
  template <class Visit>
  void for_each_face(int axis, const Box& near, const Visit& visit) const {
    const Faces& faces = faces_[static_cast<size_t>(axis)];
    faces.tree.for_each_near(near, [&](uint32_t i) { visit(faces.numbers[i]); });
  }
  std::mutex& lock_of(uint32_t face) { return locks_[face % locks_.size()]; }
  Box rectangle(uint32_t face) const { return rectangle_of(rooms_.space, rooms_.space.faces[face]); }
  static glm::vec2 flat(const glm::vec3& p, int axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

  const ModelReader& reader_;
  const RoomOptions& options_;
  JobMonitor& monitor_;
  std::vector<NodeId> leaves_;
  Rooms rooms_;
  struct Faces {
    BoxTree tree;
    std::vector<uint32_t> numbers;  ///< by number in the tree
  };
  std::array<Faces, 3> faces_;        ///< by the axis that they are across
  std::vector<FaceWork> work_;        ///< by face
  std::array<std::mutex, 64> locks_;  ///< of work_, by face
};

Status RoomFinder::divide() {
  const Result<std::vector<AxialPatch>> patches = find_axial_patches(reader_, monitor_);
  if (!patches) return patches.error();
  Box box;
  for (const NodeId root : reader_.model().tables.roots) box.add(reader_.model().tables.nodes[index_of(root)].box);
  if (box.empty()) box.add(glm::vec3(0));
  CellPlan plan(box.grown(kMarginM + box.diagonal() * 0.25F));
  WallSplitOptions options;
  options.least_cover = options_.least_cover;
  options.thinnest_m = kThinnestM, options.thin_m = kThinM;
  for (const uint32_t leaf : split_along_walls(plan, CellPlan::kRoot, *patches, options))
    plan.set_cell(leaf, plan.box_of(leaf));
  std::vector<uint32_t> leaves;
  rooms_.space = tables_of(plan, FrontBound(), leaves);
  return Done{};
}

void RoomFinder::list_faces() {
  work_.resize(rooms_.space.faces.size());
  std::array<std::vector<Box>, 3> rectangles;
  for (uint32_t i = 0; i < work_.size(); ++i) {
    const uint32_t axis = rooms_.space.faces[i].axis;
    rectangles[axis].push_back(rectangle(i));
    faces_[axis].numbers.push_back(i);
  }
  for (size_t axis = 0; axis < 3; ++axis) faces_[axis].tree = BoxTree(rectangles[axis]);
}

template <class Visit>
Status RoomFinder::for_each_wall(const Visit& visit) {
  return for_each_mesh(reader_, leaves_, monitor_, [&](size_t i, const Mesh& mesh) {
    std::vector<WallTriangle> found;
    find_walls(mesh, found);
    visit(i, found);
  });
}

void RoomFinder::find_walls(const Mesh& mesh, std::vector<WallTriangle>& found) const {
  const std::vector<Material>& materials = reader_.model().tables.materials;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Material& material = materials[mesh.material_of(t)];
    if (material.alpha != AlphaMode::opaque) continue;
    std::array<glm::vec3, 3> p;
    for (size_t k = 0; k < 3; ++k) p[k] = mesh.positions[mesh.indices[3 * t + k]];
    const glm::vec3 cross = triangle_cross(mesh, t);
    for (int axis = 0; axis < 3; ++axis) {
      const float low = std::min({p[0][axis], p[1][axis], p[2][axis]});
      const float high = std::max({p[0][axis], p[1][axis], p[2][axis]});
      // The second test: a strip across the plane, narrower than the slack, is in it but closes nothing.
      if (high - low > 2 * kInPlaneM || std::abs(cross[axis]) < kFlat * glm::length(cross) || cross[axis] == 0)
        continue;
      add_walls(p, axis, cross[axis] > 0, material.two_sided, found);
    }
  }
}

void RoomFinder::add_walls(const std::array<glm::vec3, 3>& p, int axis, bool shows_up, bool two_sided,
                           std::vector<WallTriangle>& found) const {
  Box around;
  for (const glm::vec3& corner : p) around.add(corner);
  const Box wide = around.grown(kInPlaneM);
  for_each_face(axis, wide, [&](uint32_t face) {
    const float at = rectangle(face).min[axis];
    if (around.min[axis] < at - kInPlaneM || around.max[axis] > at + kInPlaneM) return;
    found.push_back(
        {face, {flat(p[0], axis), flat(p[1], axis), flat(p[2], axis)}, two_sided || shows_up, two_sided || !shows_up});
  });
}

void RoomFinder::meet(size_t leaf, const std::vector<WallTriangle>& found) {
  for (const WallTriangle& triangle : found) {
    const std::lock_guard lock(lock_of(triangle.face));
    FaceWork& face = work_[triangle.face];
    face.met[Way::down] += triangle.closes_down ? 1 : 0, face.met[Way::up] += triangle.closes_up ? 1 : 0;
    if (face.leaves.empty() || face.leaves.back() != leaf) face.leaves.push_back(static_cast<uint32_t>(leaf));
  }
}

/// What closes a face, and what closes those beside it in its plane: an opening is as wide as the walls around it
/// leave.
void RoomFinder::list_walls() {
  for (FaceWork& face : work_) {
    std::sort(face.leaves.begin(), face.leaves.end());
    face.leaves.erase(std::unique(face.leaves.begin(), face.leaves.end()), face.leaves.end());
  }
  rooms_.first_wall.reserve(work_.size() + 1);
  rooms_.first_wall.push_back(0);
  std::vector<uint32_t> leaves;
  for (uint32_t i = 0; i < work_.size(); ++i) {
    const uint32_t axis = rooms_.space.faces[i].axis;
    const Box near = rectangle(i).grown(Rooms::kSlackM);
    leaves.clear();
    for_each_face(static_cast<int>(axis), near, [&](uint32_t face) {
      leaves.insert(leaves.end(), work_[face].leaves.begin(), work_[face].leaves.end());
    });
    std::sort(leaves.begin(), leaves.end());
    leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
    for (const uint32_t leaf : leaves) rooms_.walls.push_back(leaves_[leaf]);
    rooms_.first_wall.push_back(static_cast<uint32_t>(rooms_.walls.size()));
  }
}

/// Faces from the first on whose triangles are held together: one, or as many as memory is for.
uint32_t RoomFinder::end_of_group(uint32_t first) const {
  uint64_t held = 0;
  uint32_t end = first;
  while (end < work_.size() &&
         (end == first || held + work_[end].met[0] + work_[end].met[1] <= options_.most_triangles))
    held += work_[end].met[0] + work_[end].met[1], ++end;
  return end;
}

void RoomFinder::hold(const std::vector<WallTriangle>& found, uint32_t first, uint32_t end) {
  for (const WallTriangle& t : found) {
    if (t.face < first || t.face >= end) continue;
    const std::lock_guard lock(lock_of(t.face));
    std::array<std::vector<FlatTriangle>, 2>& walls = work_[t.face].walls;
    if (t.closes_down) walls[Way::down].push_back(t.corners);
    if (t.closes_up) walls[Way::up].push_back(t.corners);
  }
}

void RoomFinder::find_openings(uint32_t first, uint32_t end) {
  tbb::parallel_for(first, end, [&](uint32_t i) {
    const Box whole = rectangle(i);
    const int axis = static_cast<int>(rooms_.space.faces[i].axis), u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (size_t way = 0; way < 2; ++way) {
      std::vector<Box>& openings = work_[i].openings[way];
      std::vector<FlatTriangle> walls = std::move(work_[i].walls[way]);
      if (walls.empty()) {
        openings.push_back(whole.grown(Rooms::kSlackM));
        continue;
      }
      for (const WallOpening& open :
           find_wall_openings(flat(whole.min, axis), flat(whole.max, axis), walls, options_.step_m, kMostOpenings)) {
        Box box = whole;
        box.min[u] = static_cast<float>(open.low.x), box.max[u] = static_cast<float>(open.high.x);
        box.min[v] = static_cast<float>(open.low.y), box.max[v] = static_cast<float>(open.high.y);
        openings.push_back(box.grown(Rooms::kSlackM));
      }
    }
  });
}

void RoomFinder::list_exits() {
  const size_t rooms = rooms_.space.cells.size();
  rooms_.first_exit.reserve(6 * rooms + 1);
  for (uint32_t room = 0; room < rooms; ++room)
    for (uint32_t way = 0; way < 6; ++way) {
      rooms_.first_exit.push_back(static_cast<uint32_t>(rooms_.exits.size()));
      for (const uint32_t face : rooms_.space.faces_of(CellId{room})) {
        const CellFace& f = rooms_.space.faces[face];
        const bool upwards = index_of(f.below) == room;
        if (2 * f.axis + (upwards ? 1 : 0) != way) continue;
        const std::vector<Box>& openings = work_[face].openings[upwards ? Way::up : Way::down];
        if (work_[face].met[upwards ? Way::up : Way::down] > 0) {
          const glm::dvec2 size = flat(rectangle(face).size(), static_cast<int>(f.axis));
          double open_m2 = 0;
          for (const Box& box : openings) {
            const glm::dvec2 part = flat(box.size(), static_cast<int>(f.axis));
            open_m2 += part.x * part.y;
          }
          rooms_.open_m2 += open_m2, rooms_.closed_m2 += std::max(0.0, size.x * size.y - open_m2);
        }
        if (openings.empty()) continue;
        rooms_.exits.push_back({index_of(f.other(CellId{room})), face, static_cast<uint32_t>(rooms_.openings.size()),
                                static_cast<uint32_t>(openings.size())});
        rooms_.openings.insert(rooms_.openings.end(), openings.begin(), openings.end());
      }
    }
  rooms_.first_exit.push_back(static_cast<uint32_t>(rooms_.exits.size()));
}

void RoomFinder::sort_rooms() {
  for (uint32_t octant = 0; octant < 8; ++octant) {
    std::vector<uint32_t>& order = rooms_.order[octant];
    order.reserve(rooms_.space.cells.size());
    std::vector<uint32_t> open = {0};
    while (!open.empty()) {
      const CellTreeNode& node = rooms_.space.tree[open.back()];
      open.pop_back();
      if (node.axis == CellTreeNode::kLeaf) {
        if (node.below != index_of(kNoCell)) order.push_back(node.below);
        continue;
      }
      const bool walks_down = (octant >> node.axis & 1U) != 0;
      open.push_back(walks_down ? node.below : node.above);
      open.push_back(walks_down ? node.above : node.below);
    }
  }
}

}  // namespace

Result<Rooms> find_rooms(const ModelReader& reader, const RoomOptions& options, JobMonitor& monitor) {
  return RoomFinder(reader, options, monitor).run();
}

Result<Rooms> find_rooms_in(const ModelReader& reader, CellTables space, const RoomOptions& options,
                            JobMonitor& monitor) {
  return RoomFinder(reader, options, monitor).run_in(std::move(space));
}

}  // namespace promenade
