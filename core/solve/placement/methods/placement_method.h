#pragma once
/// What every way to place lights is given and gives back, so that they can be compared and chosen by name.

#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "core/result.h"
#include "core/run.h"
#include "core/solve/least_squares/columns_view.h"
#include "core/solve/placement/number_of_lights.h"
#include "core/solve/placement/placed_lights.h"

namespace luxrig {

/// All that it shows must outlive it.
struct PlacementProblem {
  const MovableLight* light = nullptr;
  const LightingGoal* goal = nullptr;
  ColumnsView columns;           ///< of the candidates: lux per unit emittance, one row per point
  std::vector<LightPose> poses;  ///< of the candidates, one per column
  double spacing_m = 0;          ///< between neighbouring candidates: the side of a cell

  /// Empty, or what is wrong: sizes that disagree, numbers that are not finite or too large. Reads all columns once.
  [[nodiscard]] std::string complaint() const;
};

/// Lights at candidates keep the candidates' columns; those which left them have columns of their own.
struct BestSoFar {
  double error = 1;  ///< as PlacedLights::error()
  const std::vector<LightPose>& poses;
  const Eigen::VectorXd& levels;  ///< ordered as PlacedLights::levels()
  std::size_t columns = 0;        ///< worked out anew until now, beside the candidates'
};

struct PlacementOptions : Run {
  std::size_t lights = 0;        ///< 0: the method is to choose the number
  std::size_t most_lights = 64;  ///< that it may choose
  /// wanted_error is also that at which a search of a given number ends; coarse_error is GP16's ε_opt, above which it
  /// does not look at a number of lights closer.
  NumberRule number;
  std::size_t most_columns = 200'000;  ///< to work out before it ends anyway; it may go over by those of one step
  int iterations = 0;                  ///< of one annealing; 0: as many as the method was described or tuned with
  /// How often a method that draws at random begins anew; the best stays, and most_columns is for all together.
  int starts = 1;
  /// Of baselines that refine by Nelder & Mead's simplex: Rowan's subplex (1990) instead, which runs that simplex in
  /// subspaces of a few unknowns and does not fail with thirty of them.
  bool subplex = false;
  bool whole_curve = false;        ///< ChooseOptions::whole_curve, of luxrig's own
  std::vector<LightPose> start{};  ///< lights to begin with, of methods that can (luxrig's own)
  /// Called with each better one, never by two threads at a time, but by any.
  std::function<void(const BestSoFar&)> better;
};

struct FoundLights {
  PlacedLights lights;
  std::size_t columns = 0;  ///< worked out anew, beside the candidates'
  std::vector<PlacedLights>
      cuts{};  ///< where the number was open: what was found for others that were looked at closer
  /// Of methods with a light tree: (lights, error) of every cut through it as built, fewest lights first.
  std::vector<std::pair<std::size_t, double>> tree{};
};

struct PlacementMethod {
  const char* name;
  const char* source;   ///< in a line
  bool takes_number;    ///< PlacementOptions::lights > 0
  bool chooses_number;  ///< PlacementOptions::lights == 0
  Result<FoundLights> (*run)(const PlacementProblem&, const PlacementOptions&);
};

}  // namespace luxrig
