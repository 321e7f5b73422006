#pragma once
/// Splits work over threads that end with the call. They inherit the caller's scheduling: those of a niced solver
/// thread are nice, too.

#include <cstddef>
#include <functional>

namespace luxrig {

/// Number of threads to use when `wanted` are asked for (0 = one per core that the process may run on); at least 1.
[[nodiscard]] int thread_count(int wanted);

/// Calls body(i) once for each i in [0, count), in any order, on up to `threads` threads (0 = one per core). Returns
/// when all are done. body must not throw. To make results independent of the number of threads, let body(i) write only
/// to slot i, and reduce in order afterwards.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

}  // namespace luxrig
