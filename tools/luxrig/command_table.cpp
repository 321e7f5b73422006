#include "tools/luxrig/command_table.h"

#include "tools/luxrig/commands.h"

namespace luxrig {
namespace {

/// A program of its own, so that nobody has to build the benches to light a rig.
constexpr Command kBenchCommand{"bench", command_group::kMeasure, "run time against error, on a named suite", nullptr,
                                "luxrig-bench"};

constexpr Command kTestCommand{"test", command_group::kRun, "scenarios on the simulated rig, judged", nullptr,
                               "luxrig-test"};

}  // namespace

const std::vector<Command>& command_table() {
  static const std::vector<Command> table = {
      kInitCommand,     kCheckCommand,      kImportCommand,   kPaintCommand,    kEvaluateCommand, kSolveCommand,
      kRenderCommand,   kRunCommand,        kApplyCommand,    kStatusCommand,   kLevelCommand,    kGoalCommand,
      kReleaseCommand,  kParkCommand,       kBlackoutCommand, kHandBackCommand, kReloadCommand,   kPageCommand,
      kAccountsCommand, kLogCommand,        kMonitorCommand,  kBypassCommand,   kTestCommand,     kDevicesCommand,
      kRdmCommand,      kIdentifyCommand,   kCameraCommand,   kRecordCommand,   kReplayCommand,   kCalibrateCommand,
      kBenchCommand,    kCompletionCommand,
  };
  return table;
}

}  // namespace luxrig
