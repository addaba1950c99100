#include "runtime/viewer.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "codec/image_codec.h"
#include "geometry/path.h"
#include "layout/file_io.h"
#include "runtime/gl_window.h"
#include "runtime/motion.h"
#include "runtime/notices.h"
#include "runtime/panels.h"
#include "runtime/self_motion.h"
#include "runtime/surroundings.h"
#include "runtime/viewer_panel.h"
#include "runtime/viewer_settings.h"
#include "runtime/walk.h"
#include "runtime/window_renderer.h"

namespace promenade {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// Time between two keys of a recorded path: linear between them, so that hand movements stay visible.
constexpr double kRecordEveryS = 0.1;
/// A frame of more than this moves the eye no further: after a pause (a debugger, a suspended laptop) it does not leap.
constexpr double kLongestStepS = 0.25;
/// Part of the model's size that the first speed crosses in a second.
constexpr double kFirstSpeed = 0.05;
constexpr double kWalkSpeed = 1.4;  // m/s
/// A click takes the eye to this before what was clicked on.
constexpr double kBeforeM = 2;
constexpr double kFirstBirdM = 120, kBirdStep = 1.2;
constexpr int kBookmarks = 9;
constexpr float kPanelLetters = 25;  // of the panel's width, in heights of letters
/// What a walker's surroundings may take of the memory bound.
uint64_t surroundings_bytes(uint64_t memory_bytes) { return std::min(uint64_t(32) << 20, memory_bytes / 8); }

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

class Viewer {
 public:
  Viewer(const ModelSource& source, const ViewerOptions& options, GlWindow& window, const WindowRenderer& drawing,
         Session& session, ViewerSettings settings)
      : source_(source),
        options_(options),
        window_(window),
        drawing_(drawing),
        session_(session),
        settings_(std::move(settings)),
        panels_(window),
        surroundings_(source, surroundings_bytes(options.session.loader.memory_bytes)) {
    // A tap shorter than a frame counts, too.
    glfwSetInputMode(window.handle(), GLFW_STICKY_KEYS, GLFW_TRUE);
    const DBox box = box_of(source.model());
    camera_.vertical_fov_deg = options.vertical_fov_deg;
    camera_.near_m = options.near_m;
    home_ = camera_.pose = options.start.value_or(overview_of(box, options.vertical_fov_deg));
    speed_m_per_s_ =
        settings_.speed_m_per_s.value_or(std::max(kWalkSpeed, box.empty() ? kWalkSpeed : box.diagonal() * kFirstSpeed));
    on_foot_ = settings_.on_foot.value_or(false), panel_ = settings_.panel.value_or(true);
  }

  Result<ViewerReport> run();

 private:
  void read_mouse(Motion& motion);
  void read_keys(double dt_s);
  void read_bookmark_keys();
  void move(const Motion& motion, double dt_s);
  void go_to_click();
  bool pressed(int key);
  void record(double t_s);
  Status show(double now_s);
  Status draw(const FrameRow& row);
  Status present();
  Status screenshot();
  Status stop_recording();
  void write_files(double now_s);
  void draw_panel(const FrameRow& row);
  void draw_place(const FrameRow& row);
  void keep_settings();

  const ModelSource& source_;
  const ViewerOptions& options_;
  GlWindow& window_;
  const WindowRenderer& drawing_;
  Session& session_;
  ViewerSettings settings_;
  Panels panels_;
  Surroundings surroundings_;
  WalkState walk_;
  SelfMotion by_itself_;
  Camera camera_;
  Pose home_;
  double speed_m_per_s_ = kWalkSpeed;
  std::optional<std::pair<double, double>> mouse_;  ///< where a drag was last
  std::array<bool, GLFW_KEY_LAST + 1> was_down_{};
  bool panel_ = true, on_foot_ = false, bird_ = false;
  bool playing_ = true;          ///< what is animated moves
  double time_s_ = 0;            ///< of the animations
  double bird_m_ = kFirstBirdM;  ///< how high the bird is
  BoxColors boxes_ = BoxColors::none;
  std::optional<Policy> brute_from_;  ///< what brute force stands in for
  bool recording_ = false;
  CameraPath path_, recorded_;  ///< being recorded; the last that was
  FramePlots plots_;
  FrameRow row_;                                 ///< of the frame shown last
  double total_ms_ = 0, response_total_ms_ = 0;  ///< of all frames
  Notices notices_;
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

void Viewer::read_mouse(Motion& motion) {
  GLFWwindow* handle = window_.handle();
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse) {
    mouse_.reset();
    return;
  }
  if (bird_)
    bird_m_ = std::clamp(bird_m_ * std::pow(kBirdStep, -double(io.MouseWheel)), 5.0, 1e5);
  else
    speed_m_per_s_ = changed_speed(speed_m_per_s_, double(io.MouseWheel));
  if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) go_to_click();
  if (glfwGetMouseButton(handle, GLFW_MOUSE_BUTTON_LEFT) != GLFW_PRESS) {
    mouse_.reset();
    return;
  }
  double x = 0, y = 0;
  glfwGetCursorPos(handle, &x, &y);
  if (mouse_) motion.look_right_px = x - mouse_->first, motion.look_down_px = y - mouse_->second;
  mouse_ = {x, y};
}

void Viewer::read_keys(double dt_s) {
  GLFWwindow* handle = window_.handle();
  Motion motion;
  read_mouse(motion);
  if (ImGui::GetIO().WantCaptureKeyboard) return move(motion, dt_s);
  const auto down = [handle](int a, int b) {
    return glfwGetKey(handle, a) == GLFW_PRESS || glfwGetKey(handle, b) == GLFW_PRESS ? 1.0 : 0.0;
  };
  motion.forward = down(GLFW_KEY_W, GLFW_KEY_UP) - down(GLFW_KEY_S, GLFW_KEY_DOWN);
  motion.right = down(GLFW_KEY_D, GLFW_KEY_RIGHT) - down(GLFW_KEY_A, GLFW_KEY_LEFT);
  motion.up = down(GLFW_KEY_SPACE, GLFW_KEY_PAGE_UP) - down(GLFW_KEY_C, GLFW_KEY_PAGE_DOWN);
  motion.roll = down(GLFW_KEY_E, GLFW_KEY_E) - down(GLFW_KEY_Q, GLFW_KEY_Q);
  move(motion, dt_s);
  if (pressed(GLFW_KEY_F)) camera_.pose.roll_deg = 0;
  if (pressed(GLFW_KEY_G)) {
    on_foot_ = !on_foot_;
    walk_ = {};
    if (on_foot_) camera_.pose.roll_deg = 0, speed_m_per_s_ = kWalkSpeed;
  }
  if (pressed(GLFW_KEY_B)) bird_ = !bird_;
  if (pressed(GLFW_KEY_T)) playing_ = !playing_;
  if (pressed(GLFW_KEY_V)) boxes_ = static_cast<BoxColors>((static_cast<int>(boxes_) + 1) % 5);
  if (pressed(GLFW_KEY_N)) notices_.say(show_next_style(session_, source_, brute_from_));
  if (pressed(GLFW_KEY_H)) panel_ = !panel_;
  if (pressed(GLFW_KEY_HOME)) by_itself_.glide(camera_.pose, home_);
  if (pressed(GLFW_KEY_L)) {
    if (by_itself_.replaying())
      by_itself_.stop();
    else if (!recorded_.keys.empty())
      by_itself_.replay(recorded_);
    else
      notices_.say("no path to replay: record one with R, or start with --path");
  }
  read_bookmark_keys();
  if (pressed(GLFW_KEY_ESCAPE)) glfwSetWindowShouldClose(handle, GLFW_TRUE);
}

/// A digit goes to a bookmark, with Control it sets one.
void Viewer::read_bookmark_keys() {
  const bool set = glfwGetKey(window_.handle(), GLFW_KEY_LEFT_CONTROL) == GLFW_PRESS ||
                   glfwGetKey(window_.handle(), GLFW_KEY_RIGHT_CONTROL) == GLFW_PRESS;
  for (int number = 1; number <= kBookmarks; ++number) {
    if (!pressed(GLFW_KEY_0 + number)) continue;
    if (set) {
      settings_.bookmarks[number] = camera_.pose;
      notices_.say(fmt::format("bookmark {} set", number));
      keep_settings();
    } else if (const auto found = settings_.bookmarks.find(number); found != settings_.bookmarks.end()) {
      by_itself_.glide(camera_.pose, found->second);
    } else {
      notices_.say(fmt::format("no bookmark {}: Control + {} sets it", number, number));
    }
  }
}

void Viewer::move(const Motion& motion, double dt_s) {
  const bool wanted = motion.forward != 0 || motion.right != 0 || motion.up != 0 || motion.roll != 0 ||
                      motion.look_right_px != 0 || motion.look_down_px != 0;
  if (wanted) by_itself_.stop();  // whoever takes the wheel drives
  if (const std::optional<Pose> pose = by_itself_.next(dt_s)) {
    camera_.pose = *pose;
    walk_ = {};
    return;
  }
  if (!on_foot_) {
    camera_.pose = moved(camera_.pose, motion, speed_m_per_s_, dt_s);
    return;
  }
  const glm::dvec3 origin = source_.model().manifest.origin;
  surroundings_.move_to(camera_.pose.eye - origin);
  const std::shared_ptr<const ClosestPointTree> surface = surroundings_.surface();
  static const ClosestPointTree nothing({}, {});
  camera_.pose = walked(camera_.pose, motion, speed_m_per_s_, dt_s, surface ? *surface : nothing, origin, {}, walk_);
}

/// To before what was clicked on; on foot, onto it.
void Viewer::go_to_click() {
  if (bird_) return;
  const ImVec2 at = ImGui::GetIO().MousePos, size = ImGui::GetIO().DisplaySize;
  const Camera& seen = session_.camera_drawn();  // the picture that was clicked on
  const double x_px = double(at.x) / double(size.x) * seen.width_px,
               y_px = double(at.y) / double(size.y) * seen.height_px;
  if (!(x_px >= 0 && y_px >= 0 && x_px < seen.width_px && y_px < seen.height_px)) return;
  const Result<std::vector<float>> depths = drawing_.renderer->read_depth();
  if (!depths) return;
  const float depth_m = (*depths)[static_cast<size_t>(y_px) * seen.width_px + static_cast<size_t>(x_px)];
  if (!std::isfinite(depth_m)) return;
  const RasterView view = perspective_view(seen, glm::dvec3(0));
  const glm::dvec3 way = ray_direction(view, x_px, y_px) * double(depth_m);
  const double distance_m = glm::length(way);
  Pose target = seen.pose;
  target.eye += way * (std::max(distance_m / 2, distance_m - kBeforeM) / distance_m);
  if (on_foot_) target.eye.z = seen.pose.eye.z + way.z + WalkOptions().eye_height_m;
  by_itself_.glide(camera_.pose, target);
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
  recorded_ = std::exchange(path_, CameraPath());
  const fs::path name = free_name(options_.folder, "path", "json");
  PROMENADE_TRY(write_file(name, to_json(recorded_)));
  notices_.say("wrote " + name.lexically_normal().string());
  report_.paths.push_back(name);
  return Done{};
}

/// The picture of the frame, or the bird's of it, with what is drawn over it.
Status Viewer::draw(const FrameRow& row) {
  const Camera& own = session_.camera_drawn();
  const Camera shown = bird_ ? birds_eye(own, bird_m_) : own;
  if (bird_) PROMENADE_TRY(session_.draw_from(shown));
  PROMENADE_TRY(present());
  if (bird_ || boxes_ != BoxColors::none)
    draw_overlay(perspective_view(shown, source_.model().manifest.origin), source_, session_, boxes_,
                 bird_ ? &own : nullptr, row);
  return Done{};
}

Status Viewer::present() {
  if (drawing_.gl != nullptr) {
    drawing_.gl->present(session_.camera_drawn().width_px, session_.camera_drawn().height_px);
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
  notices_.say("wrote " + name.lexically_normal().string());
  report_.screenshots.push_back(name);
  return Done{};
}

/// A picture or path that cannot be written ends nothing: the panel says why.
void Viewer::write_files(double now_s) {
  if (pressed(GLFW_KEY_P))
    if (const Status status = screenshot(); !status) notices_.say(status.error().message);
  if (pressed(GLFW_KEY_R)) {
    if (!recording_)
      recording_ = true;
    else if (const Status status = stop_recording(); !status)
      notices_.say(status.error().message);
  }
  record(now_s);
}

void Viewer::keep_settings() {
  const SelectOptions& select = session_.select_options();
  settings_.speed_m_per_s = speed_m_per_s_, settings_.on_foot = on_foot_, settings_.panel = panel_;
  settings_.textures = session_.frame_view().textures;
  settings_.policy = std::string(name_of(select.policy));
  settings_.pixel_error = select.pixel_error, settings_.target_ms = select.time.target_ms;
  if (options_.settings_file.empty()) return;
  const Status status = write_viewer_settings(settings_, options_.settings_file, options_.model_name);
  if (!status) notices_.say(status.error().message);
}

void Viewer::draw_panel(const FrameRow& row) {
  const float letter = ImGui::GetFontSize();
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
  // As high as what is in it, but within the window.
  ImGui::SetNextWindowSizeConstraints({kPanelLetters * letter, 0},
                                      {kPanelLetters * letter, std::max(ImGui::GetIO().DisplaySize.y - 16, letter)});
  ImGui::Begin("Promenade", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  plots_.draw_plots(session_.select_options().time.target_ms, options_.session.loader.memory_bytes);
  if (ImGui::CollapsingHeader("Frame")) plots_.draw_figures(session_);
  if (ImGui::CollapsingHeader("Place", ImGuiTreeNodeFlags_DefaultOpen)) draw_place(row);
  if (ImGui::CollapsingHeader("Drawing", ImGuiTreeNodeFlags_DefaultOpen)) {
    draw_box_colors_setting(boxes_);
    draw_settings(session_);
  }
  if (ImGui::CollapsingHeader("Keys", ImGuiTreeNodeFlags_DefaultOpen)) draw_keys();
  ImGui::End();
}

void Viewer::draw_place(const FrameRow& row) {
  const Pose& p = camera_.pose;
  {
    const FigureTable table("##place");
    table.row("eye", fmt::format("{:.2f}, {:.2f}, {:.2f} m", p.eye.x, p.eye.y, p.eye.z));
    table.row("yaw, pitch, roll", fmt::format("{:.1f}, {:.1f}, {:.1f} degrees", p.yaw_deg, p.pitch_deg, p.roll_deg));
    table.row("speed", fmt::format("{:.1f} m/s", speed_m_per_s_));
    table.row("view cell", row.cell ? fmt::format("{}", index_of(*row.cell)) : "none");
  }
  ImGui::Checkbox("walk", &on_foot_);
  ImGui::SameLine();
  ImGui::Checkbox("bird's eye", &bird_);
  if (!source_.model().objects.moving.empty()) {
    ImGui::SameLine();
    ImGui::Checkbox(fmt::format("moving ({:.1f} s)###moving", time_s_).c_str(), &playing_);
  }
}

/// The frame that was asked for first; none while those ahead are still too few.
Status Viewer::show(double now_s) {
  if (session_.frames_asked() > session_.frames_ahead()) {
    Result<FrameRow> row = session_.draw_next();
    if (!row) return row.error();
    ++report_.frames;
    total_ms_ += row->frame_ms;
    plots_.add(*row);
    row_ = std::move(*row);
    PROMENADE_TRY(draw(row_));
  }
  write_files(now_s);
  if (panel_) draw_panel(row_);
  notices_.draw(recording_ ? "recording" : by_itself_.replaying() ? "replaying" : "");
  return Done{};
}

Result<ViewerReport> Viewer::run() {
  recorded_ = options_.replay;
  if (!recorded_.keys.empty()) by_itself_.replay(recorded_);
  const Clock::time_point begin = Clock::now();
  Clock::time_point polled = begin;
  double last_s = 0;
  while (!window_.closing() && (options_.max_frames == 0 || report_.frames < options_.max_frames)) {
    const double now_s = std::chrono::duration<double>(Clock::now() - begin).count();
    const double dt_s = std::min(now_s - last_s, kLongestStepS);
    last_s = now_s;
    panels_.begin();
    read_keys(dt_s);
    camera_.width_px = window_.width_px();
    camera_.height_px = window_.height_px();
    if (playing_) time_s_ += dt_s;
    session_.set_time(time_s_);
    // Keys and mouse of this frame are as they were when they were last polled.
    session_.ask(camera_, dt_s, polled);
    PROMENADE_TRY(show(now_s));
    panels_.end();
    window_.swap_and_poll();
    polled = Clock::now();
    response_total_ms_ += plots_.shown();
  }
  if (recording_) PROMENADE_TRY(stop_recording());
  keep_settings();
  const double frames = std::max(1.0, double(report_.frames));
  report_.frame_ms_mean = total_ms_ / frames, report_.response_ms_mean = response_total_ms_ / frames;
  return report_;
}

/// What was set the last time, but for what the caller asks for.
void use_settings(const ViewerSettings& settings, const ViewerOptions& options, SessionOptions& session) {
  if (settings.textures) session.textures = *settings.textures;
  if (options.keep_policy)
    if (const std::optional<Policy> policy = policy_named(settings.policy.value_or("")))
      session.select.policy = *policy;
  if (options.keep_pixel_error) session.select.pixel_error = settings.pixel_error.value_or(session.select.pixel_error);
  if (options.keep_target) session.select.time.target_ms = settings.target_ms.value_or(session.select.time.target_ms);
}

}  // namespace

Result<ViewerReport> view(const ModelSource& source, const ViewerOptions& options) {
  Result<std::unique_ptr<GlWindow>> window = create_gl_window(options.title, options.width_px, options.height_px);
  if (!window) return window.error();
  const Result<WindowRenderer> drawing = make_window_renderer(options.renderer, **window);
  if (!drawing) return drawing.error();
  SessionOptions session_options = options.session;
  ViewerSettings settings = read_viewer_settings(options.settings_file, options.model_name);
  use_settings(settings, options, session_options);
  if (!session_options.draw_costs)
    if (const Result<DrawCosts> costs = draw_costs_here(*drawing->renderer, drawing->gl != nullptr ? "window" : "cpu"))
      session_options.draw_costs = *costs;
  session_options.frame_bytes =
      drawing->renderer->frame_bytes((*window)->width_px(), (*window)->height_px(), has_see_through(source.model())) +
      surroundings_bytes(session_options.loader.memory_bytes);
  Result<Session> session = Session::open(source, *drawing->renderer, session_options);
  if (!session) return session.error();
  return Viewer(source, options, **window, *drawing, *session, std::move(settings)).run();
}

}  // namespace promenade
