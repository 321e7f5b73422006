#pragma once
/// Lights found with a fast light model, corrected by a better one.
///
/// The error of the fast model at the present poses is measured and treated as fixed light. The fast search continues
/// from there, and the error is measured again. If it changes little with the poses, this ends where the better model
/// would (defect correction: Stetter 1978), at the cost of a few of its evaluations.

#include <functional>
#include <memory>
#include <span>

#include "core/result.h"
#include "core/solve/placement/placed_lights.h"

namespace luxrig {

/// Lux of lights at these poses and levels by the better model, without fixed_lux: points × channels.
using LuxOfLights =
    std::function<Result<Eigen::VectorXd>(std::span<const LightPose> poses, const Eigen::VectorXd& levels)>;

/// Lights for a goal by the fast model, starting from `start`; they refer to that goal.
using SearchAgain = std::function<PlacedLights(const LightingGoal& goal, const PlacedLights& start)>;

struct CorrectedLights {
  std::unique_ptr<LightingGoal> goal;  ///< the lights' own, with the error of the fast model as fixed light
  PlacedLights lights;
  Eigen::VectorXd lux;  ///< by the better model, with the goal's fixed light
  double error = 0;     ///< of this lux: ‖W (lux − b)‖ / ‖W b‖
  int rounds = 0;       ///< evaluations of the better model
};

struct CorrectOptions {
  int max_rounds = 4;
  double min_improvement = 0.05;  ///< share of the error; a round that improves less is the last
};

/// The best of the rounds by the better model; never worse than the given lights.
/// Cause: that of lux_of if its first call fails. Later failures end the rounds with the best so far.
[[nodiscard]] Result<CorrectedLights> correct_lights(const MovableLight& light, const LightingGoal& goal,
                                                     const PlacedLights& lights, const LuxOfLights& lux_of,
                                                     const SearchAgain& search_again,
                                                     const CorrectOptions& options = {});

}  // namespace luxrig
