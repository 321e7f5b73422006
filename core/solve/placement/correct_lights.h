#pragma once
/// Lights found with a quick model of light, brought to what a better one says of them.
///
/// The quick model's fault at the lights' present poses is measured and taken as light that is there anyway; the quick
/// search goes on from there, and the fault is measured again. Where it changes little with the poses this ends where
/// the better model would (defect correction: Stetter 1978), at the price of a few of its evaluations.

#include <functional>
#include <memory>
#include <span>

#include "core/result.h"
#include "core/solve/placement/placed_lights.h"

namespace luxrig {

/// Lux of lights at these poses and levels by the better model, without fixed_lux: points × channels.
using LuxOfLights =
    std::function<Result<Eigen::VectorXd>(std::span<const LightPose> poses, const Eigen::VectorXd& levels)>;

/// Lights for a goal by the quick model, from those there are; they refer to that goal.
using SearchAgain = std::function<PlacedLights(const LightingGoal& goal, const PlacedLights& start)>;

struct CorrectedLights {
  std::unique_ptr<LightingGoal> goal;  ///< the lights' own, with the fault as fixed light
  PlacedLights lights;
  Eigen::VectorXd lux;  ///< by the better model, fixed light of the goal included
  double error = 0;     ///< of this lux: ‖W (lux − b)‖ / ‖W b‖
  int rounds = 0;       ///< evaluations of the better model
};

struct CorrectOptions {
  int most_rounds = 4;
  double least_improvement = 0.05;  ///< share of the error; a round below it is the last
};

/// The best of the rounds by the better model; never worse than the lights as they came.
/// Cause: that of lux_of, when its first call fails; later failures end it with the best so far.
[[nodiscard]] Result<CorrectedLights> correct_lights(const MovableLight& light, const LightingGoal& goal,
                                                     const PlacedLights& lights, const LuxOfLights& lux_of,
                                                     const SearchAgain& search_again,
                                                     const CorrectOptions& options = {});

}  // namespace luxrig
