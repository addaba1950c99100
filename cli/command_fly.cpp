#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/flight_figures.h"
#include "cli/flight_setting.h"
#include "cli/picture.h"
#include "cli/video.h"
#include "codec/image_codec.h"

namespace promenade {
namespace {

struct FlyArguments {
  FlightSetting setting;
  std::filesystem::path frames_folder, report_file, video_file;
  uint32_t frames_every = 1;
  bool real_time = false, published_estimate = false;
  uint32_t noise_every = 0;
};

constexpr uint32_t kReportPictures = 9;
constexpr uint32_t kReportPictureWidth = 480;

/// Saves the frames that are asked for, and keeps small pictures for the report.
class PictureTaker {
 public:
  PictureTaker(const FlyArguments& arguments, const CameraPath& path, FlightPage& page)
      : arguments_(arguments), page_(page), frame_count_(path.frame_count()) {}

  Status operator()(const FrameRow& row, Renderer& renderer) {
    const bool save = !arguments_.frames_folder.empty() && row.frame % arguments_.frames_every == 0;
    const uint32_t stride = std::max(1U, frame_count_ / kReportPictures);
    const bool keep =
        !arguments_.report_file.empty() && row.frame % stride == stride / 2 && page_.pictures.size() < kReportPictures;
    if (!save && !keep) return Done{};
    const PixelSize& size = arguments_.setting.view.size;
    const Result<Frame> frame = read_frame(renderer, size.width, size.height, Aov::color);
    if (!frame) return frame.error();
    if (save)
      PROMENADE_TRY(
          write_frame(*frame, Aov::color, numbered(arguments_.frames_folder / "frame.png", row.frame, frame_count_)));
    if (!keep) return Done{};
    const uint32_t height = std::max(1U, kReportPictureWidth * frame->height_px / frame->width_px);
    Result<std::vector<std::byte>> jpeg =
        encode_image(resized(frame->color, kReportPictureWidth, height), ImageFormat::jpeg, 85);
    if (!jpeg) return jpeg.error();
    page_.pictures.push_back({row.frame, std::move(*jpeg)});
    return Done{};
  }

 private:
  const FlyArguments& arguments_;
  FlightPage& page_;
  uint32_t frame_count_;
};

void print_totals(const FlyArguments& arguments, const FlightReport& report) {
  const FlightTotals& t = report.totals;
  fmt::print("{} frames: {:.1f} ms median, {:.1f} ms p99, {:.2f} ms deviation\n", t.frames, t.frame_ms_p50,
             t.frame_ms_p99, t.frame_ms_stddev);
  fmt::print("  response {:.1f} ms median, {:.1f} ms p99; a frame selects {:.2f} ms, uploads {:.2f}, draws {:.2f}{}\n",
             t.response_ms_p50, t.response_ms_p99, t.select_ms_mean, t.upload_ms_mean, t.draw_ms_mean,
             t.wait_ms_mean > 0 ? fmt::format(", waits {:.2f} for what is chosen", t.wait_ms_mean) : "");
  const EstimateError error = estimate_error(report, true), cpu = estimate_cpu_error(report);
  fmt::print("  estimates {:+.1f} % off, deviation {:.1f} % (of drawing's processor time {:+.1f} % and {:.1f} %)",
             error.mean_percent, error.stddev_percent, cpu.mean_percent, cpu.stddev_percent);
  if (t.frame_noise_percent > 0)
    fmt::print("; one picture drawn twice deviates by {:.1f} % ({:.1f} % of processor time)", t.frame_noise_percent,
               t.frame_cpu_noise_percent);
  fmt::print("\n  {:.0f} triangles and {:.1f} nodes a frame, {:.3f} missing, {:.4f} toggles a frame\n",
             t.triangles_drawn_mean, t.nodes_drawn_mean, t.nodes_missing_mean, t.toggles_per_frame);
  if (t.popped_share_mean)
    fmt::print(
        "  popped: {:.0f} pixels of a million a frame, {:.0f} at the 99th percentile; by areas, as eyes see fades, "
        "{:.0f} and {:.0f}\n",
        *t.popped_share_mean * 1e6, t.popped_share_p99.value_or(0) * 1e6, t.popped_area_share_mean.value_or(0) * 1e6,
        t.popped_area_share_p99.value_or(0) * 1e6);
  if (const Teleports& jumps = t.teleports; jumps.count > 0)
    fmt::print("  {} teleports: all that was chosen is there after {:.0f} ms, {:.0f} at most; {} never got there\n",
               jumps.count, jumps.full_ms_mean, jumps.full_ms_max, jumps.unfinished);
  if (t.cells_crossed > 0)
    fmt::print("  {} cells crossed, {:.0f} nodes and {:.0f} bytes a step, {} frames before a cell's vLOD was read\n",
               t.cells_crossed, t.delta_nodes_mean, t.delta_bytes_mean, t.vlods_missing);
  if (t.far_triangles_mean > 0)
    fmt::print(
        "  far pictures: {:.0f} triangles a frame, {} borders crossed, {} frames with the last cell's, {} without\n",
        t.far_triangles_mean, t.far_crossed, t.far_late, t.far_missing);
  fmt::print("  {} of {} resident at most, {} read in {} reads, {:.0f} % of it drawn before it left\n",
             human_bytes(t.resident_bytes_peak), human_bytes(t.memory_bytes), human_bytes(t.bytes_read), t.reads,
             100 * double(t.bytes_read_useful) / std::max(1.0, double(t.bytes_read)));
  if (t.coarsening_max > 1)
    fmt::print("  the bound in pixels gives way to memory: {:.2f} times as coarse, {:.2f} at most\n", t.coarsening_mean,
               t.coarsening_max);
  if (t.texture_side_px)
    fmt::print("  pictures that nodes share are halved to {} pixels a side, so that all of them fit\n",
               *t.texture_side_px);
  if (!arguments.report_file.empty()) fmt::print("  report: {}\n", arguments.report_file.string());
  if (!arguments.frames_folder.empty()) fmt::print("  pictures: {}\n", arguments.frames_folder.string());
}

Status run_fly(const FlyArguments& arguments, JobMonitor& monitor, Json& figures) {
  const FlightSetting& setting = arguments.setting;
  const Result<OpenFlight> flight = open_flight(setting);
  if (!flight) return flight.error();
  if (!arguments.frames_folder.empty()) PROMENADE_TRY(make_folder(arguments.frames_folder));
  FlightOptions options = flight_options(setting);
  options.redraw_every = arguments.noise_every;
  options.pacing = arguments.real_time ? Pacing::real_time : Pacing::every_frame;
  if (!arguments.published_estimate) {
    const Result<DrawCosts> costs = draw_costs_of(flight->offscreen);
    if (!costs) return costs.error();
    options.session.draw_costs = *costs;
  }
  const SelectOptions& select = setting.view.session.select;
  FlightPage page{setting.model.filename().string(),
                  setting.path_file.filename().string(),
                  std::string(name_of(select.policy)),
                  flight->offscreen.description,
                  select.time.target_ms,
                  setting.view.session.loader.memory_bytes,
                  {}};
  PictureTaker pictures(arguments, flight->path, page);
  std::unique_ptr<VideoWriter> video;
  if (!arguments.video_file.empty()) {
    const PixelSize& size = setting.view.size;
    Result<std::unique_ptr<VideoWriter>> started =
        VideoWriter::start(arguments.video_file, size.width, size.height, flight->path.fps);
    if (!started) return started.error();
    video = std::move(*started);
  }
  const auto on_frame = [&](const FrameRow& row, Renderer& renderer) -> Status {
    if (video) {
      const Result<Image> picture = renderer.read_color();
      if (!picture) return picture.error();
      PROMENADE_TRY(video->add(*picture));
    }
    return pictures(row, renderer);
  };
  const Result<FlightReport> report =
      fly(*flight->source, *flight->offscreen.renderer, flight->path, options, on_frame, monitor);
  if (!report) return report.error();
  if (video) PROMENADE_TRY(video->finish());
  figures = json_of(*report);
  figures["policy"] = page.policy;
  figures["renderer"] = page.renderer;
  figures["target_ms"] = page.target_ms;
  if (!arguments.report_file.empty())
    PROMENADE_TRY(write_file(arguments.report_file, std::string_view(html_of(*report, page))));
  print_totals(arguments, *report);
  return Done{};
}

}  // namespace

Command add_fly(CLI::App& program) {
  auto arguments = std::make_shared<FlyArguments>();
  CLI::App* app =
      program.add_subcommand("fly", "Fly a recorded path through a model offscreen, with figures for every frame");
  app->add_option("--frames", arguments->frames_folder, "Save the frames as pictures in DIR")->type_name("DIR");
  app->add_option("--frames-every", arguments->frames_every, "Save only every so many frames")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--report", arguments->report_file, "Write a page with pictures and plots")->type_name("FILE.html");
  app->add_option("--video", arguments->video_file, "Write a video (by ffmpeg; the ending says which kind)")
      ->type_name("FILE.mp4");
  app->add_flag("--real-time", arguments->real_time,
                "Move by the clock and drop late frames, instead of drawing every frame of the path");
  app->add_option("--noise-every", arguments->noise_every,
                  "Draw every so many frames twice: what their times differ by is the machine's noise (0: none)")
      ->capture_default_str();
  app->add_flag("--published-estimate", arguments->published_estimate,
                "Foretell frame times by triangles alone, as [lakhia2004] did, not by the machine's measured costs");
  add_flight_options(*app, arguments->setting);
  return {app, {}, [arguments](JobMonitor& monitor, Json& figures) { return run_fly(*arguments, monitor, figures); }};
}

}  // namespace promenade
