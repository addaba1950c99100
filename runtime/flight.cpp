#include "runtime/flight.h"
#include "geometry/process_memory.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <thread>

namespace promenade {
namespace {

using Clock = std::chrono::steady_clock;

/// Nearest rank: a value that occurred. p in (0, 1].
double percentile(std::vector<double> values, double p) {
  if (values.empty()) return 0;
  const size_t rank = static_cast<size_t>(std::ceil(p * double(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

template <class F>
double mean_of(const std::vector<FrameRow>& rows, F&& value) {
  double sum = 0;
  for (const FrameRow& row : rows) sum += static_cast<double>(value(row));
  return rows.empty() ? 0 : sum / double(rows.size());
}

/// The frames of a path as time passes: which pose is next.
class Timeline {
 public:
  Timeline(const CameraPath& path, Pacing pacing) : path_(path), pacing_(pacing), begin_(Clock::now()) {}

  double interval_s() const { return 1.0 / path_.fps; }
  /// To the next frame, the first at first, when its time has come; false: the path is over.
  bool next() {
    if (started_) advance();
    started_ = true;
    over_ = over_ || (pacing_ == Pacing::every_frame ? frame_ >= path_.frame_count() : t_s_ > path_.duration_s());
    return !over_;
  }
  double t_s() const { return t_s_; }
  double dt_s() const { return t_s_ - last_t_s_; }
  Pose pose() const { return pose_at(path_, path_.keys.front().t_s + t_s_); }

 private:
  void advance() {
    ++frame_;
    last_t_s_ = t_s_;
    if (pacing_ == Pacing::every_frame) {
      t_s_ = double(frame_) * interval_s();
      return;
    }
    // Not faster than the path's own frames.
    std::this_thread::sleep_until(
        begin_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(last_t_s_ + interval_s())));
    t_s_ = std::chrono::duration<double>(Clock::now() - begin_).count();
  }

  const CameraPath& path_;
  Pacing pacing_;
  Clock::time_point begin_;
  uint32_t frame_ = 0;
  bool started_ = false, over_ = false;
  double t_s_ = 0, last_t_s_ = 0;
};

/// In percent: what the two times of frames that were drawn twice deviate by.
double noise_of(const std::vector<FrameRow>& rows, double FrameRow::*first, double FrameRow::*second) {
  double squares = 0;
  uint64_t pairs = 0;
  for (const FrameRow& row : rows) {
    if (row.*second <= 0) continue;
    const double mean = (row.*first + row.*second) / 2;
    const double off = (row.*first - row.*second) / mean;
    squares += off * off / 2;  // the difference of two has twice the variance of one
    ++pairs;
  }
  return pairs == 0 ? 0 : 100 * std::sqrt(squares / double(pairs));
}

/// Compares each picture with the one before it.
class PoppingMeter {
 public:
  Status measure(Renderer& renderer, const Camera& camera, FrameRow& row) {
    Result<Image> color = renderer.read_color();
    if (!color) return color.error();
    Result<std::vector<float>> depth = renderer.read_depth();
    if (!depth) return depth.error();
    SeenFrame now{camera, std::move(*color), std::move(*depth)};
    if (before_) {
      const Popping popping = popping_between(*before_, now);
      row.popped_share = popping.popped_share(), row.popped_area_share = popping.popped_area_share();
    }
    before_ = std::move(now);
    return Done{};
  }

 private:
  std::optional<SeenFrame> before_;
};

void add_popping(const std::vector<FrameRow>& rows, std::optional<double> FrameRow::*of, std::optional<double>& mean,
                 std::optional<double>& p99) {
  std::vector<double> shares;
  double sum = 0;
  for (const FrameRow& row : rows)
    if (row.*of) shares.push_back(*(row.*of)), sum += *(row.*of);
  if (shares.empty()) return;
  mean = sum / double(shares.size());
  p99 = percentile(shares, 0.99);
}

}  // namespace

FlightTotals totals_of(const std::vector<FrameRow>& rows, double target_ms) {
  FlightTotals totals;
  totals.frames = rows.size();
  std::vector<double> frame_ms, response_ms;
  for (const FrameRow& row : rows) {
    frame_ms.push_back(row.frame_ms);
    response_ms.push_back(row.response_ms);
    totals.toggles_loading += row.toggles_loading, totals.toggles_back += row.toggles_back;
    totals.coarsening_max = std::max(totals.coarsening_max, row.coarsening);
    totals.stalls += row.frame_ms > 2 * target_ms ? 1 : 0;
    totals.bytes_read += row.bytes_read;
    totals.cells_crossed += row.cell_crossed ? 1 : 0;
    totals.vlods_missing += row.vlod_missing ? 1 : 0;
    totals.far_crossed += row.far_crossed ? 1U : 0U;
    totals.far_late += row.far_late ? 1U : 0U, totals.far_missing += row.far_missing ? 1U : 0U;
    totals.resident_bytes_peak = std::max(totals.resident_bytes_peak, row.resident_bytes);
  }
  totals.frame_ms_mean = mean_of(rows, [](const FrameRow& r) { return r.frame_ms; });
  totals.frame_ms_p50 = percentile(frame_ms, 0.50);
  totals.frame_ms_p99 = percentile(frame_ms, 0.99);
  totals.frame_ms_stddev = std::sqrt(mean_of(rows, [&totals](const FrameRow& r) {
    return (r.frame_ms - totals.frame_ms_mean) * (r.frame_ms - totals.frame_ms_mean);
  }));
  totals.response_ms_mean = mean_of(rows, [](const FrameRow& r) { return r.response_ms; });
  totals.response_ms_p50 = percentile(response_ms, 0.50), totals.response_ms_p99 = percentile(response_ms, 0.99);
  if (!rows.empty()) totals.coarsening_mean = mean_of(rows, [](const FrameRow& r) { return r.coarsening; });
  totals.select_ms_mean = mean_of(rows, [](const FrameRow& r) { return r.select_ms; });
  totals.upload_ms_mean = mean_of(rows, [](const FrameRow& r) { return r.upload_ms; });
  totals.draw_ms_mean = mean_of(rows, [](const FrameRow& r) { return r.draw_ms; });
  totals.wait_ms_mean = mean_of(rows, [](const FrameRow& r) { return r.wait_ms; });
  totals.triangles_drawn_mean = mean_of(rows, [](const FrameRow& r) { return r.triangles_drawn; });
  totals.far_triangles_mean = mean_of(rows, [](const FrameRow& r) { return r.far_triangles; });
  totals.nodes_drawn_mean = mean_of(rows, [](const FrameRow& r) { return r.nodes_drawn; });
  totals.nodes_missing_mean = mean_of(rows, [](const FrameRow& r) { return r.nodes_missing; });
  const double crossings = std::max(1.0, double(totals.cells_crossed)), count = double(rows.size());
  totals.delta_bytes_mean = mean_of(rows, [](const FrameRow& r) { return r.delta_bytes; }) * count / crossings;
  totals.delta_nodes_mean = mean_of(rows, [](const FrameRow& r) { return r.delta_nodes; }) * count / crossings;
  totals.toggles_per_frame = mean_of(rows, [](const FrameRow& r) { return r.toggles; });
  totals.nodes_fading_mean = mean_of(rows, [](const FrameRow& r) { return r.nodes_fading; });
  totals.frame_noise_percent = noise_of(rows, &FrameRow::draw_ms, &FrameRow::redraw_ms);
  totals.frame_cpu_noise_percent = noise_of(rows, &FrameRow::draw_cpu_ms, &FrameRow::redraw_cpu_ms);
  totals.draw_cpu_ms_mean = mean_of(rows, [](const FrameRow& r) { return r.draw_cpu_ms; });
  totals.teleports = teleports_of(rows);
  add_popping(rows, &FrameRow::popped_share, totals.popped_share_mean, totals.popped_share_p99);
  add_popping(rows, &FrameRow::popped_area_share, totals.popped_area_share_mean, totals.popped_area_share_p99);
  return totals;
}

Result<FlightReport> fly(const ModelSource& source, Renderer& renderer, const CameraPath& path,
                         const FlightOptions& options, const FrameCallback& on_frame, JobMonitor& monitor) {
  if (path.keys.empty()) return Error{"the camera path has no keys"};
  SessionOptions session_options = options.session;
  session_options.frame_bytes =
      renderer.frame_bytes(options.width_px, options.height_px, has_see_through(source.model()));
  Result<Session> session = Session::open(source, renderer, session_options);
  if (!session) return session.error();
  Camera camera{pose_of_frame(path, 0), options.width_px, options.height_px, options.vertical_fov_deg, options.near_m};
  if (options.measure_overhead) PROMENADE_TRY(session->measure_overhead(camera));

  if (options.settle_first)
    if (const Result<FrameRow> settled = session->settle(camera); !settled) return settled.error();

  FlightReport report;
  PoppingMeter popping;
  const bool paced = options.pacing == Pacing::every_frame;
  const bool threaded = session_options.loader_thread;
  const uint64_t frames = path.frame_count();
  Timeline time(path, options.pacing);
  /// Of the frames asked for: when and where on the path, and how much time had been spent on other things than frames.
  struct Asked {
    double t_s = 0, elsewhere_ms = 0;
    Camera camera;
  };
  std::deque<Asked> asked;
  double elsewhere_ms = 0;
  for (bool more = true;;) {
    if (monitor.cancelled()) return Error{"interrupted"};
    while (more && asked.size() <= session_options.frames_ahead) {
      more = time.next();
      if (!more) break;
      camera.pose = time.pose();
      session->set_time(time.t_s());
      session->ask(camera, time.dt_s());
      asked.push_back({time.t_s(), elsewhere_ms, camera});
    }
    if (asked.empty()) break;
    // A thread loads while the frame is drawn; without one the loader's turn comes after it.
    const double loader_ms = time.interval_s() * 1e3;
    if (paced && threaded) session->run_loader(loader_ms);
    Result<FrameRow> row = session->draw_next();
    if (!row) return row.error();
    const Clock::time_point drawn = Clock::now();
    const Asked shown = asked.front();
    asked.pop_front();
    row->frame = static_cast<uint32_t>(report.rows.size());
    row->t_s = shown.t_s;
    if (paced) row->response_ms -= elsewhere_ms - shown.elsewhere_ms;
    if (options.redraw_every > 0 && row->frame % options.redraw_every == 0) {
      const Result<Session::Redraw> again = session->redraw();
      if (!again) return again.error();
      row->redraw_ms = again->ms, row->redraw_cpu_ms = again->cpu_ms;
    }
    if (options.measure_popping) PROMENADE_TRY(popping.measure(renderer, shown.camera, *row));
    if (!threaded) session->run_loader(loader_ms);
    if (paced) session->wait_for_loader();
    if (on_frame) PROMENADE_TRY(on_frame(*row, renderer));
    report.rows.push_back(std::move(*row));
    monitor.progress("fly", report.rows.size(), paced ? frames : 0);
    elsewhere_ms += std::chrono::duration<double, std::milli>(Clock::now() - drawn).count();
  }
  report.loader = session->loader_counts();
  report.totals = totals_of(report.rows, session_options.select.time.target_ms);
  report.totals.bytes_read = report.loader.bytes_read;
  report.totals.reads = report.loader.reads;
  report.totals.bytes_read_useful = report.loader.bytes_read_useful;
  report.totals.resident_bytes_peak = session->resident_bytes_peak();
  report.totals.peak_rss_bytes = peak_rss_bytes();
  report.totals.memory_bytes = session_options.loader.memory_bytes;
  if (const uint32_t side = session->texture_side_px(); side != kAnySide) report.totals.texture_side_px = side;
  for (const std::string& failure : session->failures()) monitor.warning(failure);
  return report;
}

}  // namespace promenade
