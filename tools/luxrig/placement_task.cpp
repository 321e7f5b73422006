#include "tools/luxrig/placement_task.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <limits>
#include <mutex>
#include <thread>

#include "core/transport/evaluator_choice.h"
#include "core/transport/rig_transport.h"

namespace luxrig {
namespace {

/// Tells how a search goes, from two seconds on, and stops it when asked to or when its time is up.
class SearchWatch {
 public:
  SearchWatch(std::string name, std::optional<double> seconds, std::stop_token stop)
      : name_(std::move(name)), seconds_(seconds), asked_(std::move(stop)), thread_([this] { run(); }) {}
  ~SearchWatch() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    changed_.notify_one();
    thread_.join();
    if (said_ && terminal_) fmt::print(stderr, "\n");
  }
  SearchWatch(const SearchWatch&) = delete;
  SearchWatch& operator=(const SearchWatch&) = delete;

  [[nodiscard]] std::stop_token stop() const { return source_.get_token(); }
  void better(std::size_t lights, double error) {
    const std::lock_guard lock(mutex_);
    best_ = fmt::format("{} light{}, error {:.2f} %", lights, lights == 1 ? "" : "s", 100 * error);
  }

 private:
  using Steady = std::chrono::steady_clock;
  static constexpr double kSilent_s = 2, kEvery_s = 10;  ///< not on a terminal, where a line each is kept

  void run() {
    std::unique_lock lock(mutex_);
    double said_s = 0;
    while (!changed_.wait_for(lock, std::chrono::milliseconds(100), [&] { return ended_; })) {
      const double now_s = std::chrono::duration<double>(Steady::now() - start_).count();
      if (asked_.stop_requested() || (seconds_ && now_s >= *seconds_)) source_.request_stop();
      if (now_s < kSilent_s || (said_ && now_s - said_s < (terminal_ ? 0.5 : kEvery_s))) continue;
      said_s = now_s;
      said_ = true;
      fmt::print(stderr, "{}{}: {:.0f} s, {}{}", terminal_ ? "\r\x1b[K" : "", name_, now_s, best_,
                 terminal_ ? " (Ctrl-C: take this)" : "\n");
      std::fflush(stderr);
    }
  }

  std::string name_;
  std::optional<double> seconds_;
  std::stop_token asked_;
  std::stop_source source_;
  Steady::time_point start_ = Steady::now();
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string best_ = "looking at places";
  bool ended_ = false, said_ = false;
  std::thread thread_;  // last: it uses all of these
};

/// The goal of the points that have one, or a limit; with colour, three channels.
struct GoalOfPoints {
  std::vector<Receiver> receivers;
  LightingGoal goal;
};

GoalOfPoints goal_of_points(const Rig& rig, const LightThere& there) {
  GoalOfPoints of;
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < rig.points.size(); ++i) {
    const Point& point = rig.points[i];
    if (!(point.goal_lx && point.weight > 0) && !point.max_lx) continue;
    of.receivers.push_back({point.position_world_m, point.normal_world});
    rows.push_back(static_cast<Eigen::Index>(i));
  }
  const auto points = static_cast<Eigen::Index>(rows.size());
  const Eigen::Index channels = rig.colour_goals() ? 3 : 1;
  LightingGoal& goal = of.goal;
  goal.lux = goal.fixed_lux = goal.row_weight = Eigen::VectorXd::Zero(points * channels);
  goal.max_lux.resize(points);
  for (Eigen::Index k = 0; k < points; ++k) {
    const Eigen::Index i = rows[static_cast<std::size_t>(k)];
    const Point& point = rig.points[static_cast<std::size_t>(i)];
    goal.max_lux[k] = point.max_lx.value_or(std::numeric_limits<double>::infinity());
    for (Eigen::Index c = 0; c < channels; ++c) {
      const Eigen::Index row = c * points + k;
      const double is = channels == 1 ? there.lux[i] : there.rgb(i, c);
      goal.fixed_lux[row] = is;
      if (!(point.goal_lx && point.weight > 0)) continue;
      goal.lux[row] = *point.goal_lx * (channels == 1 ? 1.0 : (*point.goal_rgb)[c]);
      // What is there beyond a goal is not the placed lights' fault.
      goal.fixed_lux[row] = std::min(is, goal.lux[row]);
      goal.row_weight[row] = point.weight / std::sqrt(static_cast<double>(channels));
    }
  }
  return of;
}

/// What each emitter of a luminaire gives, per unit of the luminaire with all of them at rated flux.
void set_emitters(const Rig& rig, std::size_t luminaire, LightingGoal& goal, Eigen::Index channels) {
  const std::vector<std::size_t> emitters = rig.emitters_or_itself(luminaire);
  const auto count = static_cast<Eigen::Index>(emitters.size());
  goal.emitters.resize(channels, count);
  goal.watts = Eigen::VectorXd::Zero(count);
  for (Eigen::Index e = 0; e < count; ++e) {
    const Luminaire& emitter = rig.luminaires[emitters[static_cast<std::size_t>(e)]];
    const double share = emitter.lumens / rig.luminaires[luminaire].lumens;
    goal.emitters.col(e) =
        channels == 1 ? Eigen::VectorXd::Constant(1, share) : Eigen::VectorXd(share * emitter.colour_rgb);
    goal.watts[e] = emitter.watts.value_or(0);
  }
}

}  // namespace

Result<PlacedInScene> search_places(const Rig& rig, const Scene& scene, const RayScene& rays, const Mounting& mounting,
                                    const Task& task, const LightThere& there, double max_watts,
                                    const ComputeOptions& options) {
  const PlacementSpec& spec = task.placement;
  const Eigen::Index channels = rig.colour_goals() ? 3 : 1;
  auto [receivers, goal] = goal_of_points(rig, there);
  if (!(goal.weighted().maxCoeff() > 0)) return PlacedInScene{};
  set_emitters(rig, spec.luminaire, goal, channels);
  goal.max_watts = max_watts;

  SearchWatch watch(task.name, spec.seconds, options.watch.stop);
  PlaceInSceneOptions place;
  if (spec.lights) place.lights = static_cast<std::size_t>(*spec.lights);
  place.max_lights = static_cast<std::size_t>(spec.max_lights);
  place.error_wanted = spec.error_wanted;
  place.improvement = spec.improvement;
  place.max_level = rig.limits.max_level;
  place.method = name_of(spec.method);
  place.aimed = spec.aimed;
  place.indirect = spec.indirect && options.model != Model::direct;
  place.bound_of_number = spec.bound;
  place.seed = options.seed;
  place.threads = options.threads;
  place.stop = watch.stop();
  place.better = [&](std::size_t lights, double error) { watch.better(lights, error); };
  place.front_limits = static_cast<std::size_t>(spec.energy_front);
  const Luminaire& luminaire = rig.luminaires[spec.luminaire];
  const auto points = static_cast<Eigen::Index>(receivers.size());
  place.lux_of = [&, &receivers = receivers, &goal = goal](std::span<const LightPose> poses,
                                                           const Eigen::VectorXd& levels) -> Result<Eigen::VectorXd> {
    std::vector<Emitter> lamps;
    EvaluateOptions evaluate;
    evaluate.colour = channels == 3;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      // A lamp's emitters shine alike but in colour: together they are one lamp of their mixture.
      const Eigen::VectorXd light =
          goal.emitters * levels.segment(static_cast<Eigen::Index>(i) * goal.emitters.cols(), goal.emitters.cols());
      const double level = channels == 3 ? luminance_of_rgb(light) : light[0];
      if (!(level > 0)) continue;
      lamps.push_back(emitter_of(luminaire, {aimed_rotation(Mat3::Identity(), poses[i].aim_world),
                                             mounting.snapped(poses[i].position_world_m)->place_world_m}));
      if (channels == 3) lamps.back().colour_rgb = light / level;
      evaluate.levels.push_back(level);
    }
    if (lamps.empty()) return Eigen::VectorXd::Zero(points * channels);
    evaluate.wanted_relative_error = options.max_error;
    evaluate.seed = options.seed;
    evaluate.threads = options.threads;
    evaluate.watch.stop = watch.stop();
    std::unique_ptr<Evaluator> evaluator = make_direct_evaluator(rays);
    if (place.indirect) {
      auto chosen = choose_evaluator(rays, receivers, lamps, evaluate);
      if (!chosen) return tl::unexpected(chosen.error());
      evaluator = std::move(chosen->evaluator);
    }
    const auto lit = evaluator->evaluate(receivers, lamps, evaluate);
    if (!lit) return tl::unexpected(lit.error());
    const Eigen::Map<const Eigen::VectorXd> at(evaluate.levels.data(),
                                               static_cast<Eigen::Index>(evaluate.levels.size()));
    if (channels == 1) return Eigen::VectorXd(lit->lux(at));
    Eigen::VectorXd rgb(points * channels);
    for (Eigen::Index c = 0; c < channels; ++c)
      rgb.segment(c * points, points) = lit->rgb_per_level[static_cast<std::size_t>(c)] * at;
    return rgb;
  };
  return place_in_scene(scene, rays, mounting, emitter_of(luminaire, Pose{}), receivers, goal, place);
}

}  // namespace luxrig
