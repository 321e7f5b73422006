#include "tools/luxrig/command_table.h"

#include "tools/luxrig/commands.h"

namespace luxrig {

const std::vector<Command>& command_table() {
  static const std::vector<Command> table = {
      kInitCommand,     kCheckCommand,    kImportCommand,   kEvaluateCommand, kSolveCommand,
      kRenderCommand,   kRunCommand,      kPageCommand,     kStatusCommand,   kMonitorCommand,
      kApplyCommand,    kReloadCommand,   kLevelCommand,    kGoalCommand,     kReleaseCommand,
      kParkCommand,     kBlackoutCommand, kHandBackCommand, kBypassCommand,   kDevicesCommand,
      kIdentifyCommand, kRdmCommand,      kCameraCommand,   kBenchCommand,    kCompletionCommand,
  };
  return table;
}

}  // namespace luxrig
