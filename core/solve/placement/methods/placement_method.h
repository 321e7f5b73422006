#pragma once
/// Common interface of all placement methods, so that they can be compared and chosen by name.

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

/// Everything it refers to must outlive it.
struct PlacementProblem {
  const MovableLight* light = nullptr;
  const LightingGoal* goal = nullptr;
  ColumnsView columns;           ///< of the candidates: lux per unit emittance, one row per point
  std::vector<LightPose> poses;  ///< of the candidates, one per column
  double spacing_m = 0;          ///< between neighbouring candidates: the side of a cell

  /// Empty, or the error: sizes that disagree, numbers that are not finite or too large. Reads all columns once.
  [[nodiscard]] std::string complaint() const;
};

/// Lights at candidates keep the candidates' columns; moved lights have their own.
struct BestSoFar {
  double error = 1;  ///< as PlacedLights::error()
  const std::vector<LightPose>& poses;
  const Eigen::VectorXd& levels;  ///< ordered as PlacedLights::levels()
  std::size_t columns = 0;        ///< computed so far, without the candidates'
};

struct PlacementOptions : Run {
  std::size_t lights = 0;        ///< 0 = the method chooses the number
  std::size_t max_lights = 64;   ///< that it may choose
  /// wanted_error also ends a search with a given number. coarse_error is GP16's ε_opt: GP16 does not refine
  /// numbers of lights with a larger error.
  NumberRule number;
  std::size_t max_columns = 200'000;   ///< limit of columns to compute; the last step may exceed it
  int iterations = 0;                  ///< of one annealing; 0 = as many as the method was described or tuned with
  /// Number of starts of a method that draws at random; the best stays, and max_columns is for all together.
  int starts = 1;
  /// For baselines that refine by Nelder & Mead's simplex: use Rowan's subplex (1990), which runs that simplex in
  /// subspaces of a few unknowns and does not fail with thirty of them.
  bool subplex = false;
  bool whole_curve = false;        ///< ChooseOptions::whole_curve, for luxrig's own
  std::vector<LightPose> start{};  ///< lights to begin with, for methods that can (luxrig's own)
  /// Called with each better result, from any thread, but never from two at a time.
  std::function<void(const BestSoFar&)> better;
};

struct FoundLights {
  PlacedLights lights;
  std::size_t columns = 0;  ///< computed, without the candidates'
  std::vector<PlacedLights>
      cuts{};  ///< with an open number: results for the other numbers that were examined
  /// For methods with a light tree: (lights, error) of every cut as built, fewest lights first.
  std::vector<std::pair<std::size_t, double>> tree{};
};

struct PlacementMethod {
  const char* name;
  const char* source;   ///< in one line
  bool takes_number;    ///< PlacementOptions::lights > 0
  bool chooses_number;  ///< PlacementOptions::lights == 0
  Result<FoundLights> (*run)(const PlacementProblem&, const PlacementOptions&);
};

}  // namespace luxrig
