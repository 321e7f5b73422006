#pragma once
/// How threads share the processor: output first, solvers last.

namespace luxrig {

/// Puts the calling thread under SCHED_FIFO. False if not allowed (no CAP_SYS_NICE, no rtprio limit).
bool make_realtime(int priority);

/// Whether make_realtime would be allowed, tried on a thread of its own.
bool realtime_allowed();

/// Locks the process's memory in RAM, so that the output thread never waits for a page. False if not allowed.
bool lock_memory();

/// Low priority (nice 15) for the calling thread and the threads it starts, so that others run first.
void make_background();

}  // namespace luxrig
