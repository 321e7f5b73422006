#pragma once
/// What the subcommands share: exit codes, how problems and faults are told to a person, progress.

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

/// One line each on standard error; returns kExitBadInput.
int report(const std::vector<Problem>& problems);
/// Returns kExitFailed.
int report(const Fault& fault);

/// A progress line on standard error, rewritten in place on a terminal, and a line per quarter elsewhere; silent for
/// the first half second.
[[nodiscard]] Progress progress_line(std::string what);

/// Stops when the process gets SIGINT or SIGTERM. Install once, before other threads begin.
[[nodiscard]] std::stop_token stop_on_signals();

/// Such a signal waits from now on until on_signal() takes it. To be called before other threads begin.
void keep_signal(int signal);
/// Calls `run`, on a thread of its own, for every such signal that was kept, until the thread is stopped.
[[nodiscard]] std::jthread on_signal(int signal, std::function<void()> run);

}  // namespace luxrig
