#pragma once
// Which renderer this machine draws faster with: measured once, stored in the user's cache folder, measured again when
// the program, the processor, its threads or the graphics devices change, or when the file is broken.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "runtime/renderer.h"

namespace promenade {

/// The least time of a frame of the calibration scene with each renderer.
struct Calibration {
  double gl_ms = 0, cpu_ms = 0;
  std::string gl;       ///< what OpenGL calls itself
  bool stored = false;  ///< read from the file, not measured now
  bool cpu_is_faster() const { return cpu_ms <= gl_ms; }
};

/// $XDG_CACHE_HOME/promenade/renderer-WAY.json, or below ~/.cache; empty where there is neither. way: a plain word for
/// the way to OpenGL, each of which has its own calibration: "window", or how an offscreen context is made.
std::filesystem::path calibration_file(std::string_view way);

/// What a stored calibration holds for: the program's version, the processor, its threads and vector width, the
/// graphics devices, and `gl`, the way to OpenGL that was asked for. Asks no driver: it takes no time and no memory.
std::string calibration_machine(const std::string& gl);

/// What is stored in `file` for this machine, else what `measure` returns, which is then stored (in one step: nobody
/// reads half of it). A file that is missing, broken or of another machine or version counts as nothing stored; one
/// that cannot be written is no error: the next start measures again. file empty: nothing is stored. Errors: measure's.
Result<Calibration> calibrated(const std::filesystem::path& file, const std::string& machine,
                               const std::function<Result<Calibration>()>& measure);

/// Times `gl` (called `name`), which stands on the context that is to be drawn with, and a CPU renderer. The renderer's
/// thread.
Result<Calibration> calibrate(Renderer& gl, const std::string& name);

/// Why the faster one was chosen, for reports. file: where the calibration is stored.
std::string reason_of(const Calibration& calibration, const std::filesystem::path& file);

/// Milliseconds that one renderer takes for a frame of 250 thousand textured triangles in 225 nodes, 1280 x 720: the
/// least of three after one that is not counted. What it uploads is gone afterwards. The renderer's thread.
Result<double> calibration_frame_ms(Renderer& renderer);

}  // namespace promenade
