#pragma once
/// A placement case made ready for any method, and one timed solve.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/solve/placement/scene/mounted_light.h"
#include "core/solve/placement/scene/search_space.h"
#include "tools/bench/measured.h"
#include "tools/bench/methods/compared_methods.h"
#include "tools/bench/placement_cases/placement_case.h"

namespace luxrig {

/// Its time includes everything except the scene's tree of rays: places and clearance, transport of the candidates.
class ReadyCase {
 public:
  /// spacing_m   of candidates; none = about 20 000 of them
  [[nodiscard]] static Result<std::unique_ptr<ReadyCase>> make(PlacementCase one, int threads,
                                                               std::optional<double> spacing_m = {});

  [[nodiscard]] const PlacementCase& of() const { return case_; }
  [[nodiscard]] const PlacementProblem& problem() const { return problem_; }
  [[nodiscard]] const LightingGoal& goal() const { return goal_; }
  [[nodiscard]] const RayScene& rays() const { return rays_; }
  [[nodiscard]] CallSeconds seconds() const { return seconds_; }

 private:
  explicit ReadyCase(PlacementCase one) : case_(std::move(one)), rays_(case_.scene) {}

  PlacementCase case_;
  RayScene rays_;
  LightingGoal goal_;
  std::optional<Mounting> mounting_;
  std::optional<SearchSpace> space_;
  std::unique_ptr<MountedLight> light_;
  PlacementProblem problem_;
  CallSeconds seconds_;
};

/// The best error up to a time.
struct BetterAt {
  double seconds = 0;  ///< wall time of the search
  double error = 1;
  std::size_t lights = 0;
};

struct Solved {
  std::vector<LightPose> poses;
  Eigen::VectorXd levels;
  double error = 1;          ///< of the light that the case is judged by
  Eigen::VectorXd residual;  ///< by the search's own model
  std::size_t columns = 0;
  int evaluations = 0;          ///< of a better model, in a global case
  CallSeconds seconds;          ///< making the case ready included
  std::vector<BetterAt> curve;  ///< during the search, by its own model
  std::string refused;
};

struct SolveCaseOptions {
  std::size_t lights = 0;  ///< 0 = the method chooses the number
  std::uint64_t seed = 1;
  int threads = 0;
  double wanted_error = 1e-4;
  std::optional<double> max_seconds{};  ///< of the search, which then ends with the best so far
};

/// Global cases end with correct_lights() against gathered light of 1 %.
[[nodiscard]] Solved solve_case(const ReadyCase& ready, const PlacementMethod& method, const SolveCaseOptions& options);

}  // namespace luxrig
