#pragma once
// What the subcommands share.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/values.h"
#include "geometry/job_monitor.h"
#include "geometry/result.h"

namespace promenade {

using Json = nlohmann::ordered_json;

/// A subcommand as main runs it: its action, and the place for its figures.
struct Command {
  CLI::App* app = nullptr;
  std::filesystem::path json_path;  ///< empty: no figures wanted
  std::function<Status(JobMonitor& monitor, Json& figures)> run;
};

/// Each adds one subcommand with its options. The returned command owns what its options write to.
Command add_generate(CLI::App& program);
Command add_build(CLI::App& program);
Command add_info(CLI::App& program);
Command add_render(CLI::App& program);
Command add_fly(CLI::App& program);
Command add_view(CLI::App& program);
Command add_verify(CLI::App& program);
Command add_far(CLI::App& program);
/// One for each part of `study`.
std::vector<Command> add_study(CLI::App& program);

struct ImportOptions;
/// --unit, --up, --no-repair: how a source is read.
void add_import_options(CLI::App& app, ImportOptions& import);

/// An option whose text one of the parsers of values.h turns into a value; a text it refuses is wrong usage (exit 2).
template <class T>
CLI::Option* add_parsed(CLI::App& app, const std::string& name, T& target, Result<T> (*parse)(const std::string&),
                        const std::string& help) {
  return app.add_option_function<std::string>(
      name,
      [&target, parse, name](const std::string& text) {
        Result<T> value = parse(text);
        if (!value) throw CLI::ValidationError(name, value.error().message);
        target = *value;
      },
      help);
}

}  // namespace promenade
