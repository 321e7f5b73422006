#include "core/highlight/seen/seen_selection.h"

#include <algorithm>
#include <limits>

#include "core/check.h"
#include "core/highlight/aim/head_sight.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr double kDarkestShare = 0.25;
constexpr double kTriedLevels[] = {1, 0.6, 0.35, 0.2, 0.1};
constexpr int kMaxExchanges = 4;        // rounds over all chosen lights
constexpr double kWorthAChange = 1e-4;  // of the objective
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

}  // namespace

SeenSelection::SeenSelection(const SeenContrast& seen, const RayScene& room, std::vector<SeenCandidate> candidates,
                             const IntensityDistribution& intensity, std::vector<float> fixed_lux,
                             const SeenSelectionOptions& options)
    : seen_(seen),
      candidates_(std::move(candidates)),
      lux_(candidates_.size()),
      fixed_lux_(std::move(fixed_lux)),
      options_(options) {
  fixed_lux_.resize(seen.samples().size(), 0);
  fixed_wanted_lx_ = mean_lx_of(options.role.wanted, fixed_lux_);
  parallel_for(candidates_.size(), options.threads, [&](std::size_t c) {
    const SeenCandidate& light = candidates_[c];
    const HeadSight sight = sight_of(room, light.position_world_m, seen.samples(), 1);
    std::vector<double> lux(seen.samples().size());
    lux_of_aim(sight, intensity, {shortest_rotation(-Vec3::UnitZ(), light.direction), light.position_world_m}, lux);
    for (const double lx : lux) lux_[c].push_back(static_cast<float>(lx + options.reflected_lx));
  });
  for (const std::vector<float>& lux : lux_)
    darkest_lx_ = std::max(darkest_lx_, kDarkestShare * seen.score(lux).mean_lx);
}

SeenScore SeenSelection::scored(std::span<const float> lux, std::span<const std::vector<float>> lights) const {
  SeenScore score = seen_.score(lux, darkest_lx_, lights);
  if (options_.role.asks())
    score.objective = score_role(options_.role, lux, fixed_lux_, darkest_lx_, score.objective).objective;
  return score;
}

std::vector<float> SeenSelection::light_of(const SeenChoice& choice, std::size_t without) const {
  std::vector<float> lux = fixed_lux_;
  for (std::size_t l = 0; l < choice.candidates.size(); ++l) {
    if (l == without) continue;
    const auto level = static_cast<float>(choice.levels[l]);
    const std::vector<float>& of_light = lux_[choice.candidates[l]];
    for (std::size_t i = 0; i < lux.size(); ++i) lux[i] += level * of_light[i];
  }
  return lux;
}

std::vector<std::vector<float>> SeenSelection::light_of_each(const SeenChoice& choice, std::size_t without) const {
  if (!(seen_.wishes().shadows_weight > 0)) return {};
  std::vector<std::vector<float>> lights = {fixed_lux_};
  for (std::size_t l = 0; l < choice.candidates.size(); ++l) {
    if (l == without) continue;
    lights.push_back(lux_[choice.candidates[l]]);
    for (float& lx : lights.back()) lx *= static_cast<float>(choice.levels[l]);
  }
  return lights;
}

SeenScore SeenSelection::score(std::span<const std::size_t> candidates, std::span<const double> levels) const {
  LUXRIG_CHECK(candidates.size() == levels.size(), "{} levels of {} lights", levels.size(), candidates.size());
  const SeenChoice choice{{candidates.begin(), candidates.end()}, {levels.begin(), levels.end()}, {}};
  return scored(light_of(choice, kNone), light_of_each(choice, kNone));
}

SeenSelection::Taken SeenSelection::best_beside(const SeenChoice& choice, std::size_t without) const {
  const std::vector<float> others = light_of(choice, without);
  const std::vector<std::vector<float>> each_of_others = light_of_each(choice, without);
  std::vector<Taken> best(candidates_.size());
  parallel_for(candidates_.size(), options_.threads, [&](std::size_t c) {
    best[c] = {c, 0, -std::numeric_limits<double>::infinity()};
    for (std::size_t l = 0; l < choice.candidates.size(); ++l)
      if (l != without &&
          ((candidates_[choice.candidates[l]].position_world_m - candidates_[c].position_world_m).norm() <
               options_.min_apart_m ||
           (candidates_[c].side != 0 && candidates_[choice.candidates[l]].side == candidates_[c].side)))
        return;
    std::vector<float> lux(others.size());
    std::vector<std::vector<float>> each = each_of_others;
    if (!each.empty()) each.push_back(lux_[c]);
    double most = 1;
    if (options_.role.asks() && options_.role.wanted_lx > 0) {
      const double full_lx = mean_lx_of(options_.role.wanted, lux_[c]);
      const double left_lx = options_.role.wanted_lx - (mean_lx_of(options_.role.wanted, others) - fixed_wanted_lx_);
      if (full_lx > 0) most = std::clamp(left_lx / full_lx, 0.0, 1.0);
    }
    for (const double share : kTriedLevels) {
      const double level = share * most;
      const auto factor = static_cast<float>(level);
      for (std::size_t i = 0; i < lux.size(); ++i) lux[i] = others[i] + factor * lux_[c][i];
      for (std::size_t i = 0; !each.empty() && i < lux.size(); ++i) each.back()[i] = factor * lux_[c][i];
      const double objective = scored(lux, each).objective;
      if (objective > best[c].objective) best[c] = {c, level, objective};
    }
  });
  return *std::max_element(best.begin(), best.end(),
                           [](const Taken& a, const Taken& b) { return a.objective < b.objective; });
}

void SeenSelection::settle(SeenChoice& choice) const {
  for (int round = 0; round < kMaxExchanges; ++round) {
    bool gained = false;
    for (std::size_t l = 0; l < choice.candidates.size() && !options_.watch.stop.stop_requested(); ++l) {
      const Taken better = best_beside(choice, l);
      if (better.objective < choice.score.objective + kWorthAChange) continue;
      choice.candidates[l] = better.candidate;
      choice.levels[l] = better.level;
      choice.score = score(choice.candidates, choice.levels);
      gained = true;
    }
    if (!gained) return;
  }
}

std::vector<SeenChoice> SeenSelection::up_to(int most) const {
  std::vector<SeenChoice> by_number;
  SeenChoice choice;
  for (int n = 0; n < most && !options_.watch.stop.stop_requested(); ++n) {
    const Taken taken = candidates_.empty() ? Taken{0, 0, 0} : best_beside(choice, kNone);
    if (!(taken.level > 0)) break;  // no place is left
    choice.candidates.push_back(taken.candidate);
    choice.levels.push_back(taken.level);
    choice.score = score(choice.candidates, choice.levels);
    settle(choice);
    by_number.push_back(choice);
  }
  return by_number;
}

}  // namespace luxrig
