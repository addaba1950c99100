#include "runtime/viewer.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "codec/image_codec.h"
#include "geometry/path.h"
#include "layout/file_io.h"
#include "runtime/calibration.h"
#include "runtime/cpu_renderer.h"
#include "runtime/gl_renderer.h"
#include "runtime/gl_window.h"
#include "runtime/motion.h"
#include "runtime/panels.h"

namespace promenade {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// Time between two keys of a recorded path: linear between them, so that hand movements stay visible.
constexpr double kRecordEveryS = 0.1;
constexpr size_t kPlotFrames = 120;
/// A frame of more than this moves the eye no further: after a pause (a debugger, a suspended laptop) it does not leap.
constexpr double kLongestStepS = 0.25;
/// Part of the model's size that the first speed crosses in a second.
constexpr double kFirstSpeed = 0.05;

/// NAME-0001.ENDING, the first that is free.
fs::path free_name(const fs::path& folder, const std::string& name, const std::string& ending) {
  for (int i = 1;; ++i) {
    fs::path path = folder / fmt::format("{}-{:04}.{}", name, i, ending);
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return path;
  }
}

DBox box_of(const Model& model) {
  if (!model.manifest.world_box.empty()) return model.manifest.world_box;
  DBox box;
  for (const NodeId root : model.tables.roots) {
    const Box& b = model.tables.nodes[index_of(root)].box;
    box.add(glm::dvec3(b.min) + model.manifest.origin);
    box.add(glm::dvec3(b.max) + model.manifest.origin);
  }
  return box;
}

/// Who draws into a window.
struct WindowRenderer {
  std::unique_ptr<Renderer> renderer;
  GlRenderer* gl = nullptr;  ///< the same, if it draws with the window's OpenGL
};

/// Whether the CPU's renderer draws frames faster than the window's OpenGL: as measured here once.
bool cpu_is_faster(GlWindow& window) {
  const std::filesystem::path file = calibration_file("window");
  const std::string name = window.description();
  const Result<Calibration> known = calibrated(file, calibration_machine(name), [&]() -> Result<Calibration> {
    const Result<std::unique_ptr<GlRenderer>> gl = create_gl_renderer(window);
    if (!gl) return gl.error();
    return calibrate(**gl, name);
  });
  const std::string why = known ? reason_of(*known, file) : "auto: no OpenGL: " + known.error().message;
  const bool cpu = !known || known->cpu_is_faster();
  fmt::print(stderr, "renderer: {} ({})\n", cpu ? "cpu: visibility buffer" : name, why);
  return cpu;
}

Result<WindowRenderer> make_renderer(RendererKind kind, GlWindow& window) {
  const bool on_cpu = kind == RendererKind::cpu || (kind == RendererKind::automatic && cpu_is_faster(window));
  WindowRenderer drawing;
  if (on_cpu) {
    drawing.renderer = create_cpu_renderer();
    return drawing;
  }
  Result<std::unique_ptr<GlRenderer>> renderer = create_gl_renderer(window);
  if (!renderer) return renderer.error();
  drawing.gl = renderer->get();
  drawing.renderer = std::move(*renderer);
  return drawing;
}

class Viewer {
 public:
  Viewer(const ModelSource& source, const ViewerOptions& options, GlWindow& window, const WindowRenderer& drawing,
         Session& session)
      : options_(options), window_(window), drawing_(drawing), session_(session), panels_(window) {
    const DBox box = box_of(source.model());
    camera_.vertical_fov_deg = options.vertical_fov_deg;
    camera_.near_m = options.near_m;
    camera_.pose = options.start.value_or(overview_of(box, options.vertical_fov_deg));
    speed_m_per_s_ = std::max(1.4, box.empty() ? 1.4 : box.diagonal() * kFirstSpeed);
  }

  Result<ViewerReport> run();

 private:
  void read_keys(double dt_s);
  bool pressed(int key);
  void record(double t_s);
  Status present();
  Status screenshot();
  Status stop_recording();
  void draw_panel(const FrameRow& row);
  void draw_settings();

  const ViewerOptions& options_;
  GlWindow& window_;
  const WindowRenderer& drawing_;
  Session& session_;
  Panels panels_;
  Camera camera_;
  double speed_m_per_s_ = 1.4;
  std::optional<std::pair<double, double>> mouse_;  ///< where a drag was last
  std::array<bool, GLFW_KEY_LAST + 1> was_down_{};
  bool panel_ = true;
  bool recording_ = false;
  CameraPath path_;
  std::array<float, kPlotFrames> frame_ms_{};
  std::string message_;
  ViewerReport report_;
};

/// True in the frame in which the key goes down.
bool Viewer::pressed(int key) {
  bool& was = was_down_[static_cast<size_t>(key)];
  const bool is = glfwGetKey(window_.handle(), key) == GLFW_PRESS;
  const bool now = is && !was;
  was = is;
  return now;
}

void Viewer::read_keys(double dt_s) {
  GLFWwindow* handle = window_.handle();
  const ImGuiIO& io = ImGui::GetIO();
  Motion motion;
  if (!io.WantCaptureKeyboard) {
    const auto down = [handle](int a, int b) {
      return glfwGetKey(handle, a) == GLFW_PRESS || glfwGetKey(handle, b) == GLFW_PRESS ? 1.0 : 0.0;
    };
    motion.forward = down(GLFW_KEY_W, GLFW_KEY_UP) - down(GLFW_KEY_S, GLFW_KEY_DOWN);
    motion.right = down(GLFW_KEY_D, GLFW_KEY_RIGHT) - down(GLFW_KEY_A, GLFW_KEY_LEFT);
    motion.up = down(GLFW_KEY_SPACE, GLFW_KEY_PAGE_UP) - down(GLFW_KEY_C, GLFW_KEY_PAGE_DOWN);
    motion.roll = down(GLFW_KEY_E, GLFW_KEY_E) - down(GLFW_KEY_Q, GLFW_KEY_Q);
  }
  if (!io.WantCaptureMouse && glfwGetMouseButton(handle, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
    double x = 0, y = 0;
    glfwGetCursorPos(handle, &x, &y);
    if (mouse_) {
      motion.look_right_px = x - mouse_->first;
      motion.look_down_px = y - mouse_->second;
    }
    mouse_ = {x, y};
  } else {
    mouse_.reset();
  }
  if (!io.WantCaptureMouse) speed_m_per_s_ = changed_speed(speed_m_per_s_, double(io.MouseWheel));
  camera_.pose = moved(camera_.pose, motion, speed_m_per_s_, dt_s);
  if (pressed(GLFW_KEY_F)) camera_.pose.roll_deg = 0;
  if (pressed(GLFW_KEY_H)) panel_ = !panel_;
  if (pressed(GLFW_KEY_ESCAPE)) glfwSetWindowShouldClose(handle, GLFW_TRUE);
}

void Viewer::record(double t_s) {
  if (!recording_) return;
  if (!path_.keys.empty() && t_s - path_.keys.back().t_s < kRecordEveryS) return;
  path_.keys.push_back({t_s, camera_.pose});
}

Status Viewer::stop_recording() {
  recording_ = false;
  if (path_.keys.empty()) return Done{};
  const double begin_s = path_.keys.front().t_s;
  for (CameraPath::Key& key : path_.keys) key.t_s -= begin_s;
  const fs::path name = free_name(options_.folder, "path", "json");
  PROMENADE_TRY(write_file(name, to_json(path_)));
  message_ = "wrote " + name.string();
  report_.paths.push_back(name);
  path_.keys.clear();
  return Done{};
}

Status Viewer::present() {
  if (drawing_.gl != nullptr) {
    drawing_.gl->present(camera_.width_px, camera_.height_px);
    return Done{};
  }
  const Result<Image> picture = drawing_.renderer->read_color();
  if (!picture) return picture.error();
  panels_.show(*picture);
  return Done{};
}

Status Viewer::screenshot() {
  const Result<Image> image = drawing_.renderer->read_color();
  if (!image) return image.error();
  const Result<std::vector<std::byte>> png = encode_image(*image, ImageFormat::png);
  if (!png) return png.error();
  const fs::path name = free_name(options_.folder, "view", "png");
  PROMENADE_TRY(write_file(name, *png));
  message_ = "wrote " + name.string();
  report_.screenshots.push_back(name);
  return Done{};
}

void Viewer::draw_settings() {
  SelectOptions& select = session_.select_options();
  static constexpr std::array<Policy, 7> kPolicies = {
      Policy::vlod_time_slices, Policy::vlod,   Policy::front, Policy::time_slices,
      Policy::static_error,     Policy::lakhia, Policy::none};
  if (ImGui::BeginCombo("policy", std::string(name_of(select.policy)).c_str())) {
    for (const Policy policy : kPolicies)
      if (ImGui::Selectable(std::string(name_of(policy)).c_str(), policy == select.policy)) select.policy = policy;
    ImGui::EndCombo();
  }
  float pixel_error = static_cast<float>(select.pixel_error), target_ms = static_cast<float>(select.time.target_ms);
  if (ImGui::SliderFloat("pixel error", &pixel_error, 0.25F, 16, "%.2f", ImGuiSliderFlags_Logarithmic))
    select.pixel_error = double(pixel_error);
  if (ImGui::SliderFloat("target ms", &target_ms, 5, 200, "%.0f", ImGuiSliderFlags_Logarithmic))
    select.time.target_ms = double(target_ms);
  ImGui::Checkbox("textures", &session_.frame_view().textures);
}

void Viewer::draw_panel(const FrameRow& row) {
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({340, 0}, ImGuiCond_FirstUseEver);
  ImGui::Begin("Promenade (H hides)");
  ImGui::PlotLines("##frames", frame_ms_.data(), static_cast<int>(frame_ms_.size()), 0,
                   fmt::format("frame {:.1f} ms, estimated {:.1f}", row.frame_ms, row.estimated_ms).c_str(), 0,
                   static_cast<float>(3 * session_.select_options().time.target_ms), {320, 60});
  ImGui::Text("select %.2f  upload %.2f  draw %.2f ms", row.select_ms, row.upload_ms, row.draw_ms);
  ImGui::Text("%llu triangles in %llu nodes, %llu missing", static_cast<unsigned long long>(row.triangles_drawn),
              static_cast<unsigned long long>(row.nodes_drawn), static_cast<unsigned long long>(row.nodes_missing));
  std::string levels = "levels";
  for (const uint32_t count : row.nodes_by_level) levels += fmt::format(" {}", count);
  ImGui::TextUnformatted(levels.c_str());
  const double bound = double(options_.session.loader.memory_bytes);
  ImGui::ProgressBar(
      static_cast<float>(double(row.resident_bytes) / bound), {-1, 0},
      fmt::format("{:.1f} of {:.0f} MiB", double(row.resident_bytes) / 1048576, bound / 1048576).c_str());
  const LoaderCounts counts = session_.loader_counts();
  ImGui::Text("read %.1f MB in %llu runs; loaded %llu, evicted %llu", double(counts.bytes_read) / 1e6,
              static_cast<unsigned long long>(counts.reads), static_cast<unsigned long long>(counts.nodes_loaded),
              static_cast<unsigned long long>(counts.nodes_evicted));
  const Pose& p = camera_.pose;
  ImGui::Text("eye %.2f %.2f %.2f\nyaw %.1f  pitch %.1f  roll %.1f", p.eye.x, p.eye.y, p.eye.z, p.yaw_deg, p.pitch_deg,
              p.roll_deg);
  ImGui::Text("speed %.2f m/s%s", speed_m_per_s_, recording_ ? "  RECORDING" : "");
  draw_settings();
  if (!message_.empty()) ImGui::TextUnformatted(message_.c_str());
  ImGui::PushTextWrapPos();
  ImGui::TextDisabled(
      "drag: look   WASD, arrows, space, C: move   Q E: roll   wheel: speed   F: straighten   P: picture   R: record   "
      "H: hide this   Esc: quit");
  ImGui::PopTextWrapPos();
  ImGui::End();
}

Result<ViewerReport> Viewer::run() {
  const Clock::time_point begin = Clock::now();
  double last_s = 0, total_ms = 0;
  while (!window_.closing() && (options_.max_frames == 0 || report_.frames < options_.max_frames)) {
    const double now_s = std::chrono::duration<double>(Clock::now() - begin).count();
    const double dt_s = std::min(now_s - last_s, kLongestStepS);
    last_s = now_s;
    panels_.begin();
    read_keys(dt_s);
    record(now_s);
    camera_.width_px = window_.width_px();
    camera_.height_px = window_.height_px();
    const Result<FrameRow> row = session_.frame(camera_, dt_s);
    if (!row) return row.error();
    ++report_.frames;
    total_ms += row->frame_ms;
    std::rotate(frame_ms_.begin(), frame_ms_.begin() + 1, frame_ms_.end());
    frame_ms_.back() = static_cast<float>(row->frame_ms);
    // A picture that cannot be written ends nothing: the panel says why.
    if (pressed(GLFW_KEY_P))
      if (const Status status = screenshot(); !status) message_ = status.error().message;
    if (pressed(GLFW_KEY_R)) {
      if (!recording_)
        recording_ = true;
      else if (const Status status = stop_recording(); !status)
        message_ = status.error().message;
    }
    PROMENADE_TRY(present());
    if (panel_) draw_panel(*row);
    panels_.end();
    window_.swap_and_poll();
  }
  if (recording_) PROMENADE_TRY(stop_recording());
  report_.frame_ms_mean = report_.frames == 0 ? 0 : total_ms / double(report_.frames);
  return report_;
}

}  // namespace

Result<ViewerReport> view(const ModelSource& source, const ViewerOptions& options) {
  Result<std::unique_ptr<GlWindow>> window = create_gl_window(options.title, options.width_px, options.height_px);
  if (!window) return window.error();
  const Result<WindowRenderer> drawing = make_renderer(options.renderer, **window);
  if (!drawing) return drawing.error();
  SessionOptions session_options = options.session;
  session_options.frame_bytes = drawing->renderer->frame_bytes((*window)->width_px(), (*window)->height_px());
  Result<Session> session = Session::open(source, *drawing->renderer, session_options);
  if (!session) return session.error();
  return Viewer(source, options, **window, *drawing, *session).run();
}

}  // namespace promenade
