// Measuring what drawing costs, and keeping it.

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "layout/file_io.h"
#include "runtime/calibration.h"
#include "runtime/draw_costs.h"
#include "runtime/user_files.h"

namespace promenade {
namespace {

using Json = nlohmann::json;

constexpr uint64_t kLargestFile = uint64_t(1) << 20;
constexpr int kFormat = 1;  // of the file; another one is measured again
constexpr uint32_t kWidthPx = 1280, kHeightPx = 720;
constexpr float kAheadM = 10;

/// A square of side_m across the view at kAheadM times `nearness`, cells x cells x 2 triangles.
Mesh screen_square(float side_m, uint32_t cells, float ahead_m, const glm::vec2& middle) {
  Mesh mesh;
  const uint32_t corners = cells + 1;
  mesh.positions.reserve(size_t(corners) * corners);
  mesh.texcoords.reserve(size_t(corners) * corners);
  for (uint32_t row = 0; row < corners; ++row)
    for (uint32_t column = 0; column < corners; ++column) {
      const glm::vec2 at(float(column) / float(cells), float(row) / float(cells));
      mesh.positions.emplace_back(ahead_m, middle.x + (0.5F - at.x) * side_m, middle.y + (at.y - 0.5F) * side_m);
      mesh.texcoords.push_back(at);
    }
  mesh.indices.reserve(size_t(cells) * cells * 6);
  for (uint32_t row = 0; row < cells; ++row)
    for (uint32_t column = 0; column < cells; ++column) {
      const uint32_t first = row * corners + column;
      for (const uint32_t step : {0U, 1U, corners + 1, 0U, corners + 1, corners}) mesh.indices.push_back(first + step);
    }
  return mesh;
}

Image gray_square() { return {64, 64, std::vector<glm::u8vec4>(64 * 64, glm::u8vec4(128, 128, 128, 255))}; }

/// Squares in view, and what they come to.
struct Scene {
  uint32_t across = 1, layers = 1, cells = 1;
  float side_m = 20;  ///< of the whole field of squares
  bool own_textures = false;
};

class Measuring {
 public:
  explicit Measuring(Renderer& renderer) : renderer_(renderer) { view_.camera = {{}, kWidthPx, kHeightPx, 60, 0.1}; }
  ~Measuring() { clear(); }
  Measuring(const Measuring&) = delete;
  Measuring& operator=(const Measuring&) = delete;

  Status add(const Scene& scene) {
    clear();
    DrawLoad load = load_of_picture(kWidthPx, kHeightPx);
    for (uint32_t i = 0; i < scene.across * scene.across * scene.layers; ++i) PROMENADE_TRY(add_square(scene, i, load));
    const Result<double> ms = least_ms();
    if (!ms) return ms.error();
    rows_.emplace_back(load, *ms);
    return Done{};
  }
  DrawCosts costs() const { return fitted_costs(rows_); }

 private:
  Status add_square(const Scene& scene, uint32_t i, DrawLoad& load) {
    Material material;
    if (scene.own_textures) {
      const Result<TextureHandle> texture = renderer_.create_texture(*renderer_.stage_texture(gray_square()));
      if (!texture) return texture.error();
      textures_.push_back(*texture);
      material.texture = static_cast<uint32_t>(textures_.size() - 1);
    }
    const uint32_t place = i % (scene.across * scene.across);
    const float step_m = scene.side_m / float(scene.across);
    const glm::vec2 middle((float(place % scene.across) + 0.5F) * step_m - scene.side_m / 2,
                           (float(place / scene.across) + 0.5F) * step_m - scene.side_m / 2);
    const float ahead_m = kAheadM * (1 + 0.01F * float(i / (scene.across * scene.across)));
    const Mesh mesh = screen_square(step_m * 0.9F, scene.cells, ahead_m, middle);
    const Result<MeshHandle> handle = renderer_.create_mesh(*renderer_.stage_mesh(mesh, {&material, 1}), textures_);
    if (!handle) return handle.error();
    items_.push_back({*handle, NodeId{static_cast<uint32_t>(items_.size())}, glm::mat4(1.0F)});
    NodeRecord node;
    node.box = bounds(mesh);
    node.triangles = static_cast<uint32_t>(mesh.triangle_count());
    node.texture_count = scene.own_textures ? 1 : 0;
    const double distance_m = double(node.box.distance(glm::vec3(0)));
    load += load_of_node(
        node, covered_pixels(node.box, distance_m, pixels_per_radian(view_.camera), double(kWidthPx) * kHeightPx));
    return Done{};
  }

  Result<double> least_ms() {
    using Clock = std::chrono::steady_clock;
    constexpr int kFrames = 6;
    double least = 1e9;
    for (int i = 0; i < kFrames; ++i) {
      const Clock::time_point begin = Clock::now();
      PROMENADE_TRY(renderer_.draw(view_, items_));
      const double ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
      if (i > 0) least = std::min(least, ms);  // the first compiles and touches memory
    }
    return std::max(least, 1e-3);
  }

  void clear() {
    for (const DrawItem& item : items_) renderer_.destroy(item.mesh);
    for (const TextureHandle texture : textures_) renderer_.destroy(texture);
    items_.clear();
    textures_.clear();
  }

  Renderer& renderer_;
  FrameView view_;
  std::vector<DrawItem> items_;
  std::vector<TextureHandle> textures_;
  std::vector<std::pair<DrawLoad, double>> rows_;
};

Json read_costs_file(const std::filesystem::path& file) {
  const Result<std::string> text = read_text_file(file, kLargestFile);
  Json json = text ? Json::parse(*text, nullptr, false) : Json();
  const bool sound = json.is_object() && json.contains("format") && json["format"] == kFormat &&
                     json.contains("machines") && json["machines"].is_object();
  return sound ? json : Json{{"format", kFormat}, {"machines", Json::object()}};
}

std::optional<DrawCosts> costs_of(const Json& file, const std::string& key) {
  const auto found = file["machines"].find(key);
  if (found == file["machines"].end() || !found->is_array() || found->size() != DrawLoad::kTerms) return std::nullopt;
  DrawCosts costs;
  costs.stored = true;
  for (size_t i = 0; i < DrawLoad::kTerms; ++i) {
    if (!(*found)[i].is_number() || !((*found)[i].get<double>() >= 0)) return std::nullopt;
    costs.ms[i] = (*found)[i].get<double>();
  }
  return costs;
}

}  // namespace

Result<DrawCosts> measure_draw_costs(Renderer& renderer) {
  Measuring measuring(renderer);
  const Scene scenes[] = {
      {.across = 1, .layers = 0},                             // the sky
      {.across = 1, .layers = 1},                             // a wall
      {.across = 1, .layers = 16},                            // walls behind walls
      {.across = 24, .layers = 1, .cells = 1, .side_m = 4},   // many small things
      {.across = 8, .layers = 1, .cells = 32, .side_m = 10},  // many triangles
      {.across = 8, .layers = 3, .cells = 32, .side_m = 10},  // more, partly hidden
      {.across = 8, .layers = 1, .cells = 32, .side_m = 10, .own_textures = true},
  };
  for (const Scene& scene : scenes) PROMENADE_TRY(measuring.add(scene));
  return measuring.costs();
}

Result<DrawCosts> stored_draw_costs(const std::filesystem::path& file, const std::string& key,
                                    const std::function<Result<DrawCosts>()>& measure) {
  if (!file.empty())
    if (const std::optional<DrawCosts> known = costs_of(read_costs_file(file), key)) return *known;
  Result<DrawCosts> measured = measure();
  if (!measured || file.empty()) return measured;
  Json json = read_costs_file(file);  // as it is now: another process may have added to it
  json["machines"][key] = measured->ms;
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  static_cast<void>(write_file(file, std::string_view(text)));  // not stored: measured again, nothing worse
  return measured;
}

Result<DrawCosts> draw_costs_here(Renderer& renderer, const std::string& renderer_name) {
  return stored_draw_costs(user_file("XDG_CACHE_HOME", ".cache", "draw_costs.json"), calibration_machine(renderer_name),
                           [&renderer] { return measure_draw_costs(renderer); });
}

}  // namespace promenade
