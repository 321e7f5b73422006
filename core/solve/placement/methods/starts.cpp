#include "core/solve/placement/methods/starts.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>

#include "core/parallel.h"

namespace luxrig {

FoundLights best_of_starts(const PlacementOptions& options,
                           const std::function<FoundLights(const PlacementStart&)>& run) {
  const auto count = static_cast<std::size_t>(std::max(1, options.starts));
  std::mutex mutex;
  double best_error = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> columns(count, 0);
  std::vector<std::optional<FoundLights>> found(count);
  std::atomic<std::size_t> first_to_reach = count;
  parallel_for(count, options.threads, [&](std::size_t i) {
    if (i > first_to_reach || (i > 0 && options.watch.stop.stop_requested())) return;
    PlacementStart start{
        static_cast<int>(i), options.seed * 0x9E3779B97F4A7C15ull + i, options.max_columns / count, {}};
    if (options.better)
      start.better = [&, i](const BestSoFar& better) {
        const std::lock_guard lock(mutex);
        columns[i] = better.columns;
        if (!(better.error < best_error)) return;
        best_error = better.error;
        BestSoFar of_all = better;
        of_all.columns = std::accumulate(columns.begin(), columns.end(), std::size_t{0});
        options.better(of_all);
      };
    found[i] = run(start);
    if (found[i]->lights.error() > options.number.wanted_error) return;
    for (std::size_t was = first_to_reach; i < was && !first_to_reach.compare_exchange_weak(was, i);) {
    }
  });
  std::size_t best = 0, sum = 0;
  for (std::size_t i = 0; i < std::min(count, first_to_reach + 1); ++i) {
    if (!found[i]) continue;
    sum += found[i]->columns;
    if (found[i]->lights.error() < found[best]->lights.error() || i == first_to_reach) best = i;
  }
  FoundLights answer = std::move(*found[best]);
  answer.columns = sum;
  return answer;
}

}  // namespace luxrig
