#pragma once
/// How threads share the processor: output first, solvers last.

namespace luxrig {

/// Puts the calling thread under SCHED_FIFO. False where that is not allowed (no CAP_SYS_NICE, no rtprio limit).
bool make_realtime(int priority);

/// Whether make_realtime would be allowed, tried on a thread of its own.
bool realtime_allowed();

/// Keeps the process's memory in RAM, so that the output thread never waits for a page. False where not allowed.
bool lock_memory();

/// Lets the calling thread, and threads it starts, run only when others do not want to.
void make_background();

}  // namespace luxrig
