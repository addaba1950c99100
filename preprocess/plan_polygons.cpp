#include "preprocess/plan_polygons.h"

#include <cmath>
#include <polyclipping/clipper.hpp>

namespace promenade {
namespace {

namespace cl = ClipperLib;

cl::Paths paths_of(const PlanLoops& loops) {
  cl::Paths paths;
  paths.reserve(loops.size());
  for (const PlanLoop& loop : loops) {
    cl::Path& path = paths.emplace_back();
    path.reserve(loop.size());
    for (const glm::dvec2& p : loop) path.emplace_back(std::llround(p.x / kPlanStepM), std::llround(p.y / kPlanStepM));
  }
  return paths;
}

PlanLoop loop_of(const cl::Path& path) {
  PlanLoop loop;
  loop.reserve(path.size());
  for (const cl::IntPoint& p : path) loop.emplace_back(double(p.X) * kPlanStepM, double(p.Y) * kPlanStepM);
  return loop;
}

PlanLoops loops_of(const cl::Paths& paths) {
  PlanLoops loops;
  loops.reserve(paths.size());
  for (const cl::Path& path : paths)
    if (path.size() > 2) loops.push_back(loop_of(path));
  return loops;
}

/// Each outline in the tree, and below, with its holes.
void take_apart(const cl::PolyNode& node, std::vector<PlanLoops>& parts) {
  for (const cl::PolyNode* outline : node.Childs) {
    PlanLoops& part = parts.emplace_back();
    part.push_back(loop_of(outline->Contour));
    for (const cl::PolyNode* hole : outline->Childs) part.push_back(loop_of(hole->Contour));
    for (const cl::PolyNode* hole : outline->Childs) take_apart(*hole, parts);
  }
}

}  // namespace

PlanLoops united(const PlanLoops& loops) {
  cl::Clipper clipper;
  clipper.AddPaths(paths_of(loops), cl::ptSubject, true);
  cl::Paths made;
  clipper.Execute(cl::ctUnion, made, cl::pftPositive, cl::pftPositive);
  return loops_of(made);
}

PlanLoops shrunk(const PlanLoops& loops, double by_m) {
  cl::ClipperOffset offset;
  offset.AddPaths(paths_of(loops), cl::jtMiter, cl::etClosedPolygon);
  cl::Paths made;
  offset.Execute(made, -by_m / kPlanStepM);
  return loops_of(made);
}

std::vector<PlanLoops> taken_apart(const PlanLoops& loops) {
  cl::Clipper clipper;
  clipper.AddPaths(paths_of(loops), cl::ptSubject, true);
  cl::PolyTree tree;
  clipper.Execute(cl::ctUnion, tree, cl::pftPositive, cl::pftPositive);
  std::vector<PlanLoops> parts;
  take_apart(tree, parts);
  return parts;
}

double area_m2(const PlanLoops& loops) {
  double twice = 0;
  for (const PlanLoop& loop : loops)
    for (size_t i = 0, last = loop.size() - 1; i < loop.size(); last = i++)
      twice +=
          (loop[last].x - loop[0].x) * (loop[i].y - loop[0].y) - (loop[i].x - loop[0].x) * (loop[last].y - loop[0].y);
  return twice / 2;
}

bool contains(const PlanLoops& loops, const glm::dvec2& point) {
  bool inside = false;
  for (const PlanLoop& loop : loops)
    for (size_t i = 0, last = loop.size() - 1; i < loop.size(); last = i++) {
      const glm::dvec2 &a = loop[last], &b = loop[i];
      if ((a.y > point.y) == (b.y > point.y)) continue;
      if (point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)) inside = !inside;
    }
  return inside;
}

}  // namespace promenade
