#include "tools/bench/placement/solve.h"

#include <chrono>

#include "core/solve/placement/corrected_placement.h"
#include "tools/bench/stop_after.h"

namespace luxrig {
namespace {

/// Of gathered light: rms over the points, like the error of a goal.
constexpr double kGatherError = 0.01;
constexpr int kGatherRounds = 3;
constexpr std::size_t kSearchColumns = 150'000;
/// With reflected light. Fewer, because a better model corrects the lights later anyway.
constexpr std::size_t kGlobalColumns = 80'000;

MountingSpec mounting_of(const PlacementCase& one) {
  MountingSpec spec;
  spec.box_world_m = one.lights_in_world_m;
  spec.clearance_m = one.clearance_m;
  if (one.near_surfaces_m) {
    spec.surfaces = {{"*", {}}};
    spec.offset_min_m = one.clearance_m;
    spec.offset_max_m = *one.near_surfaces_m;
  }
  return spec;
}

/// The light of isotropic lights, by gathered light.
Result<Eigen::VectorXd> gathered_lux(const ReadyCase& ready, std::span<const LightPose> poses,
                                     const Eigen::VectorXd& levels, int threads) {
  std::vector<Emitter> lamps;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (const double lumens = levels[static_cast<Eigen::Index>(i)]; lumens > 0)
      lamps.push_back({make_isotropic(lumens), {Mat3::Identity(), poses[i].position_world_m}});
  if (lamps.empty()) return Eigen::VectorXd::Zero(ready.goal().lux.size());
  EvaluateOptions options;
  options.wanted_rms_error = kGatherError;
  options.threads = threads;
  const auto matrix = make_gather_evaluator(ready.rays())->evaluate(ready.of().receivers, lamps, options);
  if (!matrix) return tl::unexpected(matrix.error());
  return matrix->lux(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(lamps.size())));
}

}  // namespace

Result<std::unique_ptr<ReadyCase>> ReadyCase::make(PlacementCase one, int threads, std::optional<double> spacing_m) {
  std::unique_ptr<ReadyCase> ready(new ReadyCase(std::move(one)));
  const PlacementCase& of = ready->case_;
  ready->goal_.lux = of.goal_lux.reshaped();
  if (of.goal_lux.cols() == 3) ready->goal_.emitters = Eigen::Matrix3d::Identity();
  std::optional<Fault> fault;
  ready->seconds_ = timed([&] {
    MountingSpec spec = mounting_of(of);
    spec.spacing_m = spacing_m;
    auto mounting = Mounting::make(spec, "bench", of.scene, ready->rays_);
    if (!mounting) {
      fault = Fault{Cause::invalid, "", mounting.error().front().text(), {}};
      return;
    }
    ready->mounting_ = std::move(*mounting);
    const auto places_m = ready->mounting_->candidates(threads);
    if (!places_m) {
      fault = places_m.error();
      return;
    }
    SearchSpaceOptions options;
    options.indirect = of.global;
    options.threads = threads;
    auto space = SearchSpace::make(of.scene, ready->rays_, of.receivers, {make_isotropic(1), {}}, *places_m, options);
    if (!space) {
      fault = space.error();
      return;
    }
    ready->space_ = std::move(*space);
    ready->light_ = std::make_unique<MountedLight>(ready->space_->light(), *ready->mounting_);
    ready->problem_.light = ready->light_.get();
    ready->problem_.goal = &ready->goal_;
    ready->problem_.columns = ready->space_->columns();
    ready->problem_.poses.assign(ready->space_->poses().begin(), ready->space_->poses().end());
    ready->problem_.spacing_m = ready->mounting_->spacing_m();
  });
  if (fault) return tl::unexpected(*fault);
  return ready;
}

Solved solve_case(const ReadyCase& ready, const PlacementMethod& method, const SolveCaseOptions& how) {
  using Steady = std::chrono::steady_clock;
  Solved solved;
  PlacementOptions options;
  options.lights = how.lights;
  options.seed = how.seed;
  options.threads = how.threads;
  options.number.wanted_error = how.wanted_error;
  options.max_columns = ready.of().global ? kGlobalColumns : kSearchColumns;
  const StopAfter time_up(how.max_seconds);
  options.watch.stop = time_up.token();
  const auto start = Steady::now();
  options.better = [&](const BestSoFar& best) {
    solved.curve.push_back(
        {std::chrono::duration<double>(Steady::now() - start).count(), best.error, best.poses.size()});
  };
  solved.seconds = timed([&] {
    CorrectedPlacementOptions correction;
    correction.max_rounds = kGatherRounds;
    if (ready.of().global)
      correction.lux_of = [&](std::span<const LightPose> poses, const Eigen::VectorXd& levels) {
        return gathered_lux(ready, poses, levels, how.threads);
      };
    const auto done = place_and_correct(method, ready.problem(), options, correction);
    if (!done || done->failed) {
      solved.refused = done ? done->failed->detail : done.error().detail;
      return;
    }
    const PlacedLights& best = done->corrected ? done->corrected->lights : done->found.lights;
    solved.poses = best.poses();
    solved.levels = best.levels();
    solved.error = done->corrected ? done->corrected->error : best.error();
    solved.residual = best.residual();
    solved.columns = done->columns;
    if (done->corrected) solved.evaluations = done->corrected->rounds;
  });
  solved.seconds.wall += ready.seconds().wall;
  solved.seconds.cpu += ready.seconds().cpu;
  return solved;
}

}  // namespace luxrig
