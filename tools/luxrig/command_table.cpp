#include "tools/luxrig/command_table.h"

#include "tools/luxrig/commands.h"

namespace luxrig {

const std::vector<Command>& command_table() {
  static const std::vector<Command> table = {
      kInitCommand,   kCheckCommand,    kImportCommand,  kEvaluateCommand, kSolveCommand,
      kRenderCommand, kRunCommand,      kApplyCommand,   kStatusCommand,   kLevelCommand,
      kGoalCommand,   kReleaseCommand,  kParkCommand,    kBlackoutCommand, kHandBackCommand,
      kReloadCommand, kPageCommand,     kMonitorCommand, kBypassCommand,   kDevicesCommand,
      kRdmCommand,    kIdentifyCommand, kCameraCommand,  kBenchCommand,    kCompletionCommand,
  };
  return table;
}

}  // namespace luxrig
