#include "core/solve/placement/methods/anneal_candidates.h"

#include <cmath>

namespace luxrig {
namespace {

std::size_t drawn_below(std::size_t count, std::mt19937_64& random) {
  return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
}

/// False when there is no replacement for the light; `state` is then unusable.
bool mutate(ChosenCandidates& state, std::size_t nearest, std::mt19937_64& random) {
  const std::size_t light = drawn_below(state.size(), random);
  const CandidateLights& candidates = state.candidates();
  if (nearest == 0) {
    const std::size_t to = candidates.lit()[drawn_below(candidates.lit().size(), random)];
    if (state.holds(to)) return false;
    state.exchange(light, to);
    return true;
  }
  state.drop(light);
  const auto found = candidates.nearest(state.residual(), nearest);
  if (found.empty()) return false;
  const std::size_t to = found[drawn_below(found.size(), random)];
  if (state.holds(to)) return false;
  state.add(to);
  return true;
}

}  // namespace

ChosenCandidates anneal(ChosenCandidates start, const AnnealOptions& options, std::mt19937_64& random) {
  ChosenCandidates best = start;
  if (start.size() == 0 || start.candidates().lit().empty()) return best;
  ChosenCandidates now = std::move(start), trial = now;
  double best_error = best.error(), now_error = best_error;
  bool took_worse = false;
  std::uniform_real_distribution<double> share(0, 1);
  for (int i = 0; i < options.iterations && best_error > options.wanted_error; ++i) {
    if (options.stop.stop_requested()) break;
    trial = now;
    const bool made = mutate(trial, took_worse ? 0 : options.nearest, random);
    took_worse = false;
    if (!made) continue;
    const double temperature = best_error * options.hottest *
                               std::pow(options.coldest / options.hottest, static_cast<double>(i) / options.iterations);
    const double error = trial.error();
    const bool worse = error > now_error;
    if (worse && !(share(random) < std::exp((now_error - error) / temperature))) continue;
    took_worse = worse;
    std::swap(now, trial);
    now_error = error;
    if (!(error < best_error)) continue;
    best = now;
    best_error = error;
    if (options.better) options.better(best);
  }
  return best;
}

}  // namespace luxrig
