#pragma once
/// Work split over threads that end with the call. They inherit the caller's scheduling (a solver
/// thread that was made nice stays nice).

#include <cstddef>
#include <functional>

namespace luxrig {

/// Threads to use for a wish of `wanted` (0 = one per core the process may run on); at least 1.
[[nodiscard]] int thread_count(int wanted);

/// Calls body(i) once for each i in [0, count), in any order, on up to `threads` threads (0 = one per
/// core), and returns when all are done. body must not throw. For results that do not depend on the
/// number of threads, let body(i) write to slot i only and reduce afterwards in order.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

}  // namespace luxrig
