#include "runtime/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "layout/file_io.h"
#include "raster/visibility.h"
#include "runtime/calibration_scene.h"
#include "runtime/cpu_renderer.h"
#include "runtime/user_files.h"

namespace promenade {
namespace {

using Json = nlohmann::json;

constexpr int kFormat = 1;  // of the file; another one is measured again
constexpr uint64_t kLargestFile = uint64_t(1) << 16;
constexpr uint32_t kNodes = 15, kCells = 24;  // along each side; a cell is two triangles
constexpr float kTextureRepeats = 4;
constexpr uint32_t kTextureSide = 256;

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(':') + 2));
  return "unknown processor";
}

/// Names of what may hold a GPU; a new card changes them.
std::string graphics_devices() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const std::filesystem::path folder : {"/dev/dri", "/proc/driver/nvidia/gpus"})
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return fmt::format("{}", fmt::join(names, " "));
}

std::optional<Calibration> stored_in(const std::filesystem::path& file, const std::string& machine) {
  const Result<std::string> text = read_text_file(file, kLargestFile);
  if (!text) return std::nullopt;
  const Json json = Json::parse(*text, nullptr, false);
  if (!json.is_object() || !json.contains("format") || json["format"] != kFormat || !json.contains("machine") ||
      json["machine"] != machine)
    return std::nullopt;
  for (const char* name : {"gl_ms", "cpu_ms"})
    if (!json.contains(name) || !json[name].is_number() || !(json[name].get<double>() > 0)) return std::nullopt;
  if (!json.contains("gl") || !json["gl"].is_string()) return std::nullopt;
  return Calibration{json["gl_ms"].get<double>(), json["cpu_ms"].get<double>(), json["gl"].get<std::string>(), true};
}

void store(const std::filesystem::path& file, const std::string& machine, const Calibration& c) {
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  const Json json = {{"format", kFormat}, {"machine", machine}, {"gl", c.gl}, {"gl_ms", c.gl_ms}, {"cpu_ms", c.cpu_ms}};
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  static_cast<void>(write_file(file, std::string_view(text)));  // not stored: measured again, nothing worse
}

FrameView calibration_view() {
  FrameView view;
  view.camera.width_px = 1280, view.camera.height_px = 720;
  view.camera.pose = {{-10, -10, 25}, 45, -15, 0};
  return view;
}

/// Milliseconds of the fastest frame.
Result<double> least_frame_ms(Renderer& renderer, std::span<const DrawItem> items) {
  using Clock = std::chrono::steady_clock;
  double least = 0;
  for (int i = 0; i < 4; ++i) {
    const Clock::time_point start = Clock::now();
    PROMENADE_TRY(renderer.draw(calibration_view(), items));
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (i > 0) least = i == 1 ? ms : std::min(least, ms);  // the first compiles and touches memory
  }
  return std::max(least, 1e-3);
}

}  // namespace

std::filesystem::path calibration_file(std::string_view way) {
  return user_file("XDG_CACHE_HOME", ".cache", fmt::format("renderer-{}.json", way));
}

std::string calibration_machine(const std::string& gl) {
  constexpr const char* kWidths[] = {"best", "portable", "avx2", "avx512"};
  return fmt::format("promenade {}; {}; {} threads; {}; devices: {}; OpenGL: {}", PROMENADE_VERSION, processor_name(),
                     std::thread::hardware_concurrency(), kWidths[static_cast<size_t>(supported_simd(Simd::best))],
                     graphics_devices(), gl);
}

Result<Calibration> calibrated(const std::filesystem::path& file, const std::string& machine,
                               const std::function<Result<Calibration>()>& measure) {
  if (!file.empty())
    if (const std::optional<Calibration> known = stored_in(file, machine)) return *known;
  Result<Calibration> measured = measure();
  if (measured && !file.empty()) store(file, machine, *measured);
  return measured;
}

Result<Calibration> calibrate(Renderer& gl, const std::string& name) {
  const Result<double> gl_ms = calibration_frame_ms(gl);
  if (!gl_ms) return gl_ms.error();
  const Result<double> cpu_ms = calibration_frame_ms(*create_cpu_renderer());
  if (!cpu_ms) return cpu_ms.error();
  return Calibration{*gl_ms, *cpu_ms, name, false};
}

std::string reason_of(const Calibration& calibration, const std::filesystem::path& file) {
  return fmt::format("auto: a frame takes {:.1f} ms on the CPU, {:.1f} ms with {}; {}", calibration.cpu_ms,
                     calibration.gl_ms, calibration.gl,
                     calibration.stored ? "stored in " + file.string() : "measured now");
}

Result<double> calibration_frame_ms(Renderer& renderer) {
  Material material;
  material.texture = 0;
  const Result<TextureHandle> texture = renderer.create_texture(*renderer.stage_texture(striped_picture(kTextureSide)));
  if (!texture) return texture.error();
  std::vector<DrawItem> items;
  std::optional<Error> failed;
  for (uint32_t i = 0; i < kNodes * kNodes && !failed; ++i) {
    const Mesh mesh = hilly_square(i % kNodes, i / kNodes, kCells, kTextureRepeats);
    const Result<MeshHandle> handle = renderer.create_mesh(*renderer.stage_mesh(mesh, {&material, 1}), {&*texture, 1});
    if (handle)
      items.push_back({*handle, NodeId{i}, glm::mat4(1.0F)});
    else
      failed = handle.error();
  }
  const Result<double> ms = failed ? Result<double>(*failed) : least_frame_ms(renderer, items);
  for (const DrawItem& item : items) renderer.destroy(item.mesh);
  renderer.destroy(*texture);
  return ms;
}

}  // namespace promenade
