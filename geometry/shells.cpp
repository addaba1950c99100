#include "geometry/shells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace promenade {
namespace {

constexpr size_t kMostShells = 1000;  // a factor just above 1 would take for ever

uint64_t cells_in(const glm::dvec3& model_m, double cell_m) {
  double cells = 1;
  for (int i = 0; i < 3; ++i) cells *= std::max(1.0, std::ceil(model_m[i] / cell_m));
  constexpr double kMost = 1e18;
  return static_cast<uint64_t>(std::min(cells, kMost));
}

double longest(const glm::dvec3& size) { return std::max({size.x, size.y, size.z}); }

Status check(const ShellSetup& setup) {
  for (int i = 0; i < 3; ++i)
    if (!(setup.model_m[i] >= 0 && std::isfinite(setup.model_m[i])))
      return Error{fmt::format("model of {} m: must be a finite size", setup.model_m[i])};
  return Done{};
}

}  // namespace

uint64_t cells_of(const std::vector<Shell>& shells) {
  uint64_t cells = 0;
  for (const Shell& shell : shells) cells += shell.cells;
  return cells;
}

Result<Shell> single_shell(const ShellSetup& setup) {
  PROMENADE_TRY(check(setup));
  const Result<double> cell_m =
      view_cell_length_m({setup.bound_rad, setup.inner_box_m, longest(setup.model_m), false, setup.rule});
  if (!cell_m) return cell_m.error();
  return Shell{*cell_m, setup.inner_box_m, cells_in(setup.model_m, *cell_m)};
}

Result<std::vector<Shell>> shells_of(const ShellSetup& setup, ShellSpacing spacing, double factor) {
  PROMENADE_TRY(check(setup));
  if (!(factor > 1 && std::isfinite(factor))) return Error{fmt::format("factor {}: must be above 1", factor)};
  if (spacing == ShellSpacing::exponential && !(setup.inner_box_m > 1))
    return Error{fmt::format("a box of {} m does not grow by a power: must be above 1 m", setup.inner_box_m)};
  const double model_m = longest(setup.model_m);
  std::vector<Shell> shells;
  double box_m = setup.inner_box_m;
  do {
    if (shells.size() >= kMostShells)
      return Error{fmt::format("factor {}: more than {} shells; take a larger one", factor, kMostShells)};
    shells.push_back({0, box_m, 0});
    box_m = spacing == ShellSpacing::linear ? box_m * factor : std::pow(box_m, factor);
  } while (box_m < model_m);
  // From the outermost inwards: how far a shell's pictures reach depends on the next one's cell and box.
  for (size_t i = shells.size(); i-- > 0;) {
    Shell& shell = shells[i];
    const bool outermost = i + 1 == shells.size();
    const double beyond_m = outermost ? model_m : (shells[i + 1].cell_m + shells[i + 1].box_m) / 2;
    const Result<double> cell_m = view_cell_length_m({setup.bound_rad, shell.box_m, beyond_m, !outermost, setup.rule});
    if (!cell_m) return cell_m.error();
    shell.cell_m = *cell_m;
    shell.cells = cells_in(setup.model_m, shell.cell_m);
  }
  return shells;
}

Result<ShellOptimum> best_shells(const ShellSetup& setup, ShellSpacing spacing, double from, double to,
                                 uint32_t tried) {
  ShellOptimum best;
  for (uint32_t i = 0; i < tried; ++i) {
    const double factor = tried == 1 ? from : from + (to - from) * i / (tried - 1);
    Result<std::vector<Shell>> shells = shells_of(setup, spacing, factor);
    if (!shells) return shells.error();
    if (best.shells.empty() || cells_of(*shells) <= cells_of(best.shells)) best = {factor, std::move(*shells)};
  }
  if (best.shells.empty()) return Error{"no factor to try"};
  return best;
}

}  // namespace promenade
