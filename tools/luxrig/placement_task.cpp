#include "tools/luxrig/placement_task.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
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

}  // namespace

Result<PlacedInScene> search_places(const Rig& rig, const Scene& scene, const RayScene& rays, const Mounting& mounting,
                                    const Task& task, const Eigen::VectorXd& fixed_lx, const ComputeOptions& options) {
  const PlacementSpec& spec = task.placement;
  std::vector<Receiver> receivers;
  std::vector<double> goal_lx, there_lx, weight, most_lx;
  for (std::size_t i = 0; i < rig.points.size(); ++i) {
    const Point& point = rig.points[i];
    const bool wanted = point.goal_lx && point.weight > 0;
    if (!wanted && !point.max_lx) continue;
    const double is_lx = fixed_lx[static_cast<Eigen::Index>(i)];
    receivers.push_back({point.position_world_m, point.normal_world});
    // What is there beyond a goal is not the placed lights' fault.
    goal_lx.push_back(wanted ? *point.goal_lx : 0);
    there_lx.push_back(wanted ? std::min(*point.goal_lx, is_lx) : is_lx);
    weight.push_back(wanted ? point.weight : 0);
    most_lx.push_back(point.max_lx.value_or(std::numeric_limits<double>::infinity()));
  }
  const auto vector = [](const std::vector<double>& values) {
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  LightingGoal goal{vector(goal_lx), vector(weight)};
  goal.fixed_lux = vector(there_lx);
  goal.max_lux = vector(most_lx);
  if (!(goal.weighted().maxCoeff() > 0)) return PlacedInScene{};

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
  const Luminaire& luminaire = rig.luminaires[spec.luminaire];
  place.lux_of = [&](std::span<const LightPose> poses, const Eigen::VectorXd& levels) -> Result<Eigen::VectorXd> {
    std::vector<Emitter> lamps;
    EvaluateOptions evaluate;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double level = levels[static_cast<Eigen::Index>(i)];
      if (!(level > 0)) continue;
      lamps.push_back(emitter_of(luminaire, {aimed_rotation(Mat3::Identity(), poses[i].aim_world),
                                             mounting.snapped(poses[i].position_world_m)->place_world_m}));
      evaluate.levels.push_back(level);
    }
    if (lamps.empty()) return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(receivers.size()));
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
    return lit->lux(
        Eigen::Map<const Eigen::VectorXd>(evaluate.levels.data(), static_cast<Eigen::Index>(evaluate.levels.size())));
  };
  return place_in_scene(scene, rays, mounting, emitter_of(luminaire, Pose{}), receivers, goal, place);
}

}  // namespace luxrig
