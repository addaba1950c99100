#include "codec/quantized_mesh.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

namespace promenade {
namespace {

constexpr int kTexcoordExponent = -15;  // rounding by half a step is 1/16 texel of a picture 4096 wide
constexpr float kOctahedralScale = 256;
constexpr double kFarthestStep = 4503599627370496.0;  // 2^52: beyond, doubles do not count steps

/// 2^exponent. Products with it are exact, and far quicker than std::ldexp for every coordinate of a model.
double power_of_two(int exponent) { return std::ldexp(1.0, exponent); }

/// The nearest whole number, halves away from zero, as std::llround, which is a call.
int64_t rounded(double value) {
  const double whole = std::trunc(value);
  const double rest = value - whole;
  return static_cast<int64_t>(whole) + (rest >= 0.5 ? 1 : 0) - (rest <= -0.5 ? 1 : 0);
}

/// Steps of one coordinate along the grid through zero; steps a unit: a power of two.
int64_t steps_of(float value, double steps_a_unit) { return rounded(double(value) * steps_a_unit); }

float value_of(int64_t steps, double step) { return static_cast<float>(double(steps) * step); }

/// Smallest and largest value of one component.
template <class Vec>
std::pair<float, float> range_of(const std::vector<Vec>& values, int axis) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end(),
                                               [axis](const Vec& a, const Vec& b) { return a[axis] < b[axis]; });
  return {(*low)[axis], (*high)[axis]};
}

Status quantize_positions(const Mesh& mesh, int exponent, int fine_bits, QuantizedMesh& out) {
  out.on_grid = true;
  out.position_exponent = static_cast<int8_t>(exponent);
  out.fine_bits = static_cast<uint8_t>(fine_bits);
  const double steps_a_metre = power_of_two(fine_bits - exponent);
  const int64_t most_steps = kMaxPositionSteps << fine_bits;
  for (int axis = 0; axis < 3 && !mesh.positions.empty(); ++axis) {
    const auto [low, high] = range_of(mesh.positions, axis);
    if (std::max(std::abs(double(low)), std::abs(double(high))) * steps_a_metre > kFarthestStep)
      return Error{fmt::format("mesh coordinate {} is too far out for a step of 2^{} m; choose a larger step",
                               std::abs(low) > std::abs(high) ? low : high, exponent)};
    const int64_t base = steps_of(low, steps_a_metre) >> fine_bits << fine_bits;  // on the grid itself
    const int64_t extent = steps_of(high, steps_a_metre) - base;
    if (extent > most_steps)
      return Error{fmt::format("mesh of {} m is {} steps of 2^{} m across, at most {} are coded; choose a larger step",
                               double(high) - double(low), extent >> fine_bits, exponent, kMaxPositionSteps)};
    out.position_base[static_cast<size_t>(axis)] = base;
    for (size_t v = 0; v < mesh.positions.size(); ++v)
      out.positions[v][axis] = static_cast<uint32_t>(steps_of(mesh.positions[v][axis], steps_a_metre) - base);
  }
  return Done{};
}

void quantize_texcoords(const Mesh& mesh, int64_t max_steps, QuantizedMesh& out) {
  if (mesh.texcoords.empty()) return;
  const auto [u_low, u_high] = range_of(mesh.texcoords, 0);
  const auto [v_low, v_high] = range_of(mesh.texcoords, 1);
  const double extent = std::max(double(u_high) - double(u_low), double(v_high) - double(v_low));
  const double farthest =
      std::max({std::abs(double(u_low)), std::abs(double(u_high)), std::abs(double(v_low)), std::abs(double(v_high))});
  int exponent = kTexcoordExponent;
  while (std::ldexp(extent, -exponent) > double(max_steps - 2) || std::ldexp(farthest, -exponent) > kFarthestStep)
    ++exponent;
  out.texcoord_exponent = static_cast<int8_t>(exponent);
  const double steps_a_side = power_of_two(-exponent);
  out.texcoord_base = {steps_of(u_low, steps_a_side), steps_of(v_low, steps_a_side)};
  out.texcoords.resize(mesh.texcoords.size());
  for (size_t v = 0; v < mesh.texcoords.size(); ++v)
    for (int axis = 0; axis < 2; ++axis)
      out.texcoords[v][axis] = static_cast<uint32_t>(steps_of(mesh.texcoords[v][axis], steps_a_side) -
                                                     out.texcoord_base[static_cast<size_t>(axis)]);
}

/// Keeps vertices at the places that `remap` gives them, as meshoptimizer does for plain arrays.
template <class T>
void remap_vertices(std::vector<T>& values, const std::vector<uint32_t>& remap, size_t count) {
  if (values.empty()) return;
  std::vector<T> kept(count);
  for (size_t v = 0; v < values.size(); ++v)
    if (remap[v] != ~0U) kept[remap[v]] = values[v];
  values = std::move(kept);
}

/// Numbers vertices by first use in `indices`, one number for all that agree in every attribute.
void merge_vertices(QuantizedMesh& mesh) {
  if (mesh.indices.empty()) {  // which meshoptimizer takes for: no indices, vertices in order
    mesh.positions.clear(), mesh.normals.clear(), mesh.texcoords.clear(), mesh.colors.clear();
    return;
  }
  std::vector<meshopt_Stream> streams = {{mesh.positions.data(), sizeof(mesh.positions[0]), sizeof(mesh.positions[0])}};
  const auto add = [&streams](const auto& values) {
    if (!values.empty()) streams.push_back({values.data(), sizeof(values[0]), sizeof(values[0])});
  };
  add(mesh.normals), add(mesh.texcoords), add(mesh.colors);
  std::vector<uint32_t> remap(mesh.positions.size(), ~0U);
  const size_t count = meshopt_generateVertexRemapMulti(remap.data(), mesh.indices.data(), mesh.indices.size(),
                                                        mesh.positions.size(), streams.data(), streams.size());
  for (uint32_t& i : mesh.indices) i = remap[i];
  remap_vertices(mesh.positions, remap, count);
  remap_vertices(mesh.normals, remap, count);
  remap_vertices(mesh.texcoords, remap, count);
  remap_vertices(mesh.colors, remap, count);
}

bool is_collapsed(const QuantizedMesh& mesh, size_t triangle) {
  const glm::u32vec3& a = mesh.positions[mesh.indices[3 * triangle]];
  const glm::u32vec3& b = mesh.positions[mesh.indices[3 * triangle + 1]];
  const glm::u32vec3& c = mesh.positions[mesh.indices[3 * triangle + 2]];
  return a == b || b == c || c == a;
}

}  // namespace

void tidy(QuantizedMesh& mesh, const std::vector<uint32_t>& materials) {
  std::vector<uint32_t> order;
  for (uint32_t t = 0; t < materials.size(); ++t)
    if (!is_collapsed(mesh, t)) order.push_back(t);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return materials[a] < materials[b]; });
  std::vector<uint32_t> indices;
  indices.reserve(order.size() * 3);
  mesh.runs.clear();
  for (const uint32_t t : order) {
    for (size_t corner = 0; corner < 3; ++corner) indices.push_back(mesh.indices[size_t(t) * 3 + corner]);
    if (mesh.runs.empty() || mesh.runs.back().material != materials[t]) mesh.runs.push_back({materials[t], 0});
    ++mesh.runs.back().triangles;
  }
  mesh.indices = std::move(indices);
  merge_vertices(mesh);
}

Result<QuantizedMesh> quantize(const Mesh& mesh, std::optional<float> position_step_m, int fine_bits,
                               int64_t max_texcoord_steps) {
  QuantizedMesh out;
  out.has_materials = !mesh.materials.empty();
  out.positions.resize(mesh.positions.size());
  if (position_step_m) {
    PROMENADE_TRY(quantize_positions(mesh, std::ilogb(*position_step_m), fine_bits, out));
  } else {
    for (size_t v = 0; v < mesh.positions.size(); ++v)
      for (int axis = 0; axis < 3; ++axis)  // + 0 turns -0 into 0, so that equal places have equal bits
        out.positions[v][axis] = std::bit_cast<uint32_t>(mesh.positions[v][axis] + 0.0F);
  }
  out.normals.reserve(mesh.normals.size());
  for (const glm::vec3& n : mesh.normals) out.normals.push_back(octahedral_of_normal(n));
  quantize_texcoords(mesh, max_texcoord_steps, out);
  out.colors = mesh.colors;
  out.indices = mesh.indices;
  std::vector<uint32_t> materials = mesh.materials;
  materials.resize(mesh.triangle_count());
  tidy(out, materials);
  return out;
}

Mesh dequantize(const QuantizedMesh& mesh) {
  Mesh out;
  const double step_m = power_of_two(mesh.position_exponent - mesh.fine_bits),
               texcoord_step = power_of_two(mesh.texcoord_exponent);
  out.positions.resize(mesh.positions.size());
  for (size_t v = 0; v < mesh.positions.size(); ++v)
    for (int axis = 0; axis < 3; ++axis) {
      const uint32_t coded = mesh.positions[v][axis];
      out.positions[v][axis] = mesh.on_grid ? value_of(mesh.position_base[static_cast<size_t>(axis)] + coded, step_m)
                                            : std::bit_cast<float>(coded);
    }
  out.normals.reserve(mesh.normals.size());
  for (const glm::i16vec2& n : mesh.normals) out.normals.push_back(normal_of_octahedral(n));
  out.texcoords.resize(mesh.texcoords.size());
  for (size_t v = 0; v < mesh.texcoords.size(); ++v)
    for (int axis = 0; axis < 2; ++axis)
      out.texcoords[v][axis] =
          value_of(mesh.texcoord_base[static_cast<size_t>(axis)] + mesh.texcoords[v][axis], texcoord_step);
  out.colors = mesh.colors;
  out.indices = mesh.indices;
  if (mesh.has_materials) {
    out.materials.reserve(mesh.indices.size() / 3);
    for (const MaterialRun& run : mesh.runs) out.materials.insert(out.materials.end(), run.triangles, run.material);
  }
  return out;
}

glm::vec3 snapped(const glm::vec3& position, float step_m) {
  const double steps_a_metre = 1 / double(step_m);
  glm::vec3 out = position;
  // A float that is 2^24 steps or more has no digits below a step.
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(double(position[axis])) * steps_a_metre < double(1 << 24))
      out[axis] = value_of(steps_of(position[axis], steps_a_metre), double(step_m));
  return out;
}

glm::i16vec2 octahedral_of_normal(const glm::vec3& normal) {
  const float sum = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  if (!(sum > 0)) return kNoNormal;
  float x = normal.x / sum, y = normal.y / sum;
  if (normal.z < 0) {
    const float folded_x = (1 - std::abs(y)) * (x >= 0 ? 1.0F : -1.0F);
    y = (1 - std::abs(x)) * (y >= 0 ? 1.0F : -1.0F);
    x = folded_x;
  }
  return {static_cast<int16_t>(std::lround(x * kOctahedralScale)),
          static_cast<int16_t>(std::lround(y * kOctahedralScale))};
}

glm::vec3 normal_of_octahedral(const glm::i16vec2& code) {
  if (code == kNoNormal) return glm::vec3(0);
  const float x = std::clamp(float(code.x) / kOctahedralScale, -1.0F, 1.0F);
  const float y = std::clamp(float(code.y) / kOctahedralScale, -1.0F, 1.0F);
  glm::vec3 n(x, y, 1 - std::abs(x) - std::abs(y));
  if (n.z < 0) {
    n.x = (1 - std::abs(y)) * (x >= 0 ? 1.0F : -1.0F);
    n.y = (1 - std::abs(x)) * (y >= 0 ? 1.0F : -1.0F);
  }
  return glm::normalize(n);
}

}  // namespace promenade
