#include "cli/command.h"
#include "cli/study_hiders.h"

namespace promenade {

std::vector<Command> add_study(CLI::App& program) {
  CLI::App* study = program.add_subcommand("study", "Compare methods on a model: tables and figures");
  study->require_subcommand(1);
  return {add_study_hiders(*study)};
}

}  // namespace promenade
