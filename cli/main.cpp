// promenade: one program, a subcommand for each thing that one does with a model.

#include <fmt/format.h>

#include <exception>
#include <new>

#include "cli/command.h"
#include "cli/console.h"
#include "geometry/process_memory.h"
#include "layout/file_io.h"

namespace promenade {
namespace {

constexpr int kDone = 0, kFailed = 1, kWrongUsage = 2;

int report_failure(const std::string& message) {
  fmt::print(stderr, "promenade: {}\n", message);
  return kFailed;
}

int run(const Command& command) {
  Json figures = Json::object();
  Status status = Done{};
  {
    ConsoleMonitor monitor;  // its destructor ends the progress line before anything else is printed
    status = command.run(monitor, figures);
  }
  if (!command.json_path.empty() && (status.ok() || !figures.empty())) {
    if (!status.ok()) figures["error"] = status.error().message;
    figures["peak_rss_bytes"] = peak_rss_bytes();
    const Status written = write_file(command.json_path, std::string_view(figures.dump(1) + "\n"));
    if (status.ok()) status = written;
  }
  return status.ok() ? kDone : report_failure(status.error().message);
}

int run_program(int argc, char** argv) {
  CLI::App program("Walk or fly through models far larger than memory.", "promenade");
  program.set_version_flag("--version", PROMENADE_VERSION);
  program.require_subcommand(1);
  program.failure_message(CLI::FailureMessage::simple);
  std::vector<Command> commands = {add_generate(program), add_build(program), add_info(program),   add_render(program),
                                   add_fly(program),      add_view(program),  add_verify(program), add_far(program)};
  for (Command& part : add_study(program)) commands.push_back(std::move(part));
  for (Command& command : commands)
    command.app
        ->add_option("--json", command.json_path,
                     "Write the command's figures to FILE as one JSON object; when it fails, those known so far and an "
                     "\"error\"")
        ->type_name("FILE");
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kDone : kWrongUsage;
  }
  catch_interrupts();
  for (const Command& command : commands)
    if (command.app->parsed()) return run(command);
  return kWrongUsage;
}

}  // namespace
}  // namespace promenade

int main(int argc, char** argv) {
  try {
    return promenade::run_program(argc, argv);
  } catch (const std::bad_alloc&) {
    return promenade::report_failure("out of memory: give --memory less, or close other programs");
  } catch (const std::exception& error) {
    return promenade::report_failure(fmt::format("internal error: {}", error.what()));
  }
}
