#pragma once
/// The entries of the table. Each is defined in the file that does the work, NAME_command.cpp.

#include "tools/luxrig/command_table.h"

namespace luxrig {

extern const Command kInitCommand, kCheckCommand, kImportCommand;
extern const Command kPaintCommand, kEvaluateCommand, kSolveCommand, kRenderCommand;
extern const Command kRunCommand, kStatusCommand, kMonitorCommand;
extern const Command kCalibrateCommand, kDevicesCommand, kRdmCommand, kCameraCommand, kRecordCommand, kReplayCommand;
extern const Command kAccountsCommand, kCompletionCommand;

/// In client_commands.cpp: commands that only send a request to a running daemon.
extern const Command kPageCommand, kLogCommand, kApplyCommand, kReloadCommand, kIdentifyCommand, kBlackoutCommand,
    kParkCommand, kHandBackCommand, kBypassCommand;
/// In by_hand_commands.cpp.
extern const Command kLevelCommand, kGoalCommand, kReleaseCommand;

}  // namespace luxrig
