#include "cli/command.h"
#include "cli/study_codecs.h"
#include "cli/study_far.h"
#include "cli/study_geometry.h"
#include "cli/study_hiders.h"
#include "cli/study_orders.h"
#include "cli/study_policies.h"
#include "cli/study_shells.h"

namespace promenade {

std::vector<Command> add_study(CLI::App& program) {
  CLI::App* study = program.add_subcommand("study", "Compare methods on a model: tables and figures");
  study->require_subcommand(1);
  return {add_study_codecs(*study), add_study_far(*study),      add_study_geometry(*study), add_study_hiders(*study),
          add_study_orders(*study), add_study_policies(*study), add_study_shells(*study)};
}

}  // namespace promenade
