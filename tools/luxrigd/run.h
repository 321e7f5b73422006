#pragma once
/// `luxrig run` and luxrigd: load, solve, light up, correct, hold, and end with a fade.

#include <filesystem>
#include <optional>
#include <string>

#include "core/tasks/session.h"

namespace luxrig {

/// A simulated rig of our own.
struct SimArguments {
  bool start = false;
  std::uint64_t seed = 1;
  std::string deviations = "mild";  ///< how far it is off the rig file: mild, real or bad
};

struct RunArguments {
  std::filesystem::path rig;
  SimArguments sim;                                   ///< everything is sent there
  std::optional<std::filesystem::path> sim_ports;     ///< use the running simulator that wrote this file
  std::optional<std::filesystem::path> plan;          ///< apply this instead of solving
  std::optional<std::filesystem::path> state_folder;  ///< default: in the user's home; none with --sim
  bool fresh = false;                                 ///< ignore the saved state and replace it
  bool no_guardian = false;                           ///< start no guardian
  std::optional<int> http_port;                       ///< default: the rig's
  bool once = false;                                  ///< end when the look is held
  std::optional<std::filesystem::path> json;          ///< where the table goes with `once`
  std::optional<std::filesystem::path> pictures;      ///< folder for pictures of the rig as it hangs, then of the plan
  ComputeOptions compute;
};

/// Exit code 0: ended on request; with `once`: no goal missed and no limit exceeded.
int run_rig(const RunArguments& arguments);

}  // namespace luxrig
