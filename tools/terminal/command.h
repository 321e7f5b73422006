#pragma once
/// Shared parts of the subcommands: exit codes, messages about problems and faults, progress.

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "core/result.h"
#include "core/run.h"

namespace luxrig {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;    ///< the world failed, or a goal is missed
inline constexpr int kExitBadInput = 2;  ///< a file or an argument is wrong; nothing has moved

/// Prints one line each on standard error; returns kExitBadInput.
int report(const std::vector<Problem>& problems);
/// Prints it on standard error; returns kExitFailed.
int report(const Fault& fault);

/// A progress line on standard error, silent for the first half second. On a terminal it is rewritten in place;
/// elsewhere there is a line per quarter.
[[nodiscard]] Progress progress_line(std::string what);

/// Stops when the process gets SIGINT or SIGTERM. Install once, before other threads begin.
[[nodiscard]] std::stop_token stop_on_signals();

/// Holds such a signal back until on_signal() takes it. Call before other threads begin.
void keep_signal(int signal);
/// Calls `run`, on a thread of its own, for every held signal, until the thread is stopped.
[[nodiscard]] std::jthread on_signal(int signal, std::function<void()> run);

}  // namespace luxrig
