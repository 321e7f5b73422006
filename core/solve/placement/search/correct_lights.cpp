#include "core/solve/placement/search/correct_lights.h"

#include <optional>

namespace luxrig {
namespace {

double error_of(const LightingGoal& goal, const Eigen::VectorXd& lux) {
  const double wanted = goal.weighted(goal.lux).norm(), off = goal.weighted(lux - goal.lux).norm();
  return wanted > 0 ? off / wanted : off;
}

}  // namespace

Result<CorrectedLights> correct_lights(const MovableLight& light, const LightingGoal& goal, const PlacedLights& lights,
                                       const LuxOfLights& lux_of, const SearchAgain& search_again,
                                       const CorrectOptions& options) {
  const Eigen::VectorXd fixed = goal.fixed_lux.size() == 0 ? Eigen::VectorXd::Zero(goal.lux.size()) : goal.fixed_lux;
  std::optional<CorrectedLights> best;
  auto of_present = std::make_unique<LightingGoal>(goal);
  PlacedLights present(light, *of_present);
  for (const LightPose& pose : lights.poses()) present.add(pose);
  for (int round = 1; round <= options.max_rounds; ++round) {
    auto lux = lux_of(present.poses(), present.levels());
    if (!lux) {
      if (!best) return tl::unexpected(lux.error());
      break;
    }
    const Eigen::VectorXd fault = *lux - present.lux();
    const double error = error_of(goal, *lux + fixed);
    const bool better = !best || error < best->error;
    const bool last = best && error > (1 - options.min_improvement) * best->error;
    auto corrected = std::make_unique<LightingGoal>(goal);
    corrected->fixed_lux = fixed + fault;
    PlacedLights next(light, *corrected);
    for (const LightPose& pose : present.poses()) next.add(pose);
    if (better) best = CorrectedLights{std::move(of_present), present, *lux + fixed, error, 0};
    best->rounds = round;
    if (last) break;
    present = search_again(*corrected, next);
    of_present = std::move(corrected);
  }
  return std::move(*best);
}

}  // namespace luxrig
