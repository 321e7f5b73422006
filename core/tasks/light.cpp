#include "core/tasks/light.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/tasks/evaluator_choice.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/stage.h"

namespace luxrig {
namespace {

Result<EvaluatorChoice> evaluator_for(const RayScene& scene, std::span<const Receiver> receivers,
                                      std::span<const Emitter> emitters, const EvaluateOptions& wanted, Model model) {
  switch (model) {
    case Model::automatic:
      break;
    case Model::direct:
      return EvaluatorChoice{make_direct_evaluator(scene), "asked for"};
    case Model::gather:
      return EvaluatorChoice{make_gather_evaluator(scene), "asked for"};
    case Model::path:
      return EvaluatorChoice{make_path_evaluator(scene), "asked for"};
  }
  return choose_evaluator(scene, receivers, emitters, wanted);
}

/// Sets the wanted error, and its floor if given.
void want_error(const ComputeOptions& options, EvaluateOptions& evaluate) {
  if (options.worst_error)
    evaluate.wanted_relative_error = *options.worst_error;
  else
    evaluate.wanted_rms_error = options.max_error;
  if (!options.error_floor_lx) return;
  evaluate.floor_lx = *options.error_floor_lx / evaluate.wanted_standard_error();
  evaluate.floor_of_mean = 0;
}

/// A second estimate is made if the error exceeds the wanted one by at most this factor; beyond, it costs as much as
/// computing all again.
constexpr double kMaxOver = 2;
/// Share of the wanted error that both estimates together aim at: error estimates are estimates, too.
constexpr double kAim = 0.95;

/// Makes second estimates of different looks independent.
std::uint64_t joints_hash(const Rig& rig, const Look& look) {
  std::uint64_t hash = 0;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Joints& at = look.joints.empty() ? rig.fixtures[f].joints : look.joints[f];
    for (const double angle : {at.pan_rad, at.tilt_rad, at.beam_rad}) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(angle)) + 0x9e3779b97f4a7c15;  // splitmix64
      hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9;
      hash = (hash ^ (hash >> 27)) * 0x94d049bb133111eb;
      hash ^= hash >> 31;
    }
  }
  return hash;
}

void set_errors(const TransportMatrix& transport, const EvaluateOptions& evaluate, ModelUsed& used) {
  used.relative_error = transport.relative_error;
  used.rms_error = transport.rms_error;
  used.error_floor_lx = evaluate.wanted_standard_error() * transport.floor_lx;
}

std::optional<double> limit_of(const ComputeOptions& options) {
  return options.max_seconds > 0 ? std::optional(options.max_seconds) : std::nullopt;
}

/// What light is wanted of, and in which stage: its time limit is that of all computations together.
struct Request {
  const Stage& stage;
  const RayScene& scene;
  std::span<const Receiver> receivers;
  std::span<const Emitter> emitters;
  EvaluateOptions wanted;
  ComputeOptions options;

  [[nodiscard]] Result<TransportMatrix> light(ModelUsed* used) const;
};

Result<TransportMatrix> Request::light(ModelUsed* used) const {
  EvaluateOptions evaluate = wanted;
  want_error(options, evaluate);
  evaluate.run() = options;
  evaluate.enough = stage.stop();
  if (options.watch.tell)
    evaluate.watch.progress = [&](double done) {
      stage.say(fmt::format("{:.0f} %", 100 * done));
      if (options.watch.progress) options.watch.progress(done);
    };
  ModelUsed by;
  by.wanted = options.worst_error.value_or(options.max_error);
  by.of_worst = options.worst_error.has_value();
  by.max_seconds = options.max_seconds;
  TransportMatrix light;
  if (emitters.empty()) {
    by.name = "direct";
    by.reason = "nothing shines";
    light.lux_per_level = light.direct_lux_per_level =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(receivers.size()), 0);
    if (evaluate.colour) light.rgb_per_level.assign(3, light.lux_per_level);
  } else {
    auto choice = evaluator_for(scene, receivers, emitters, evaluate, options.model);
    if (!choice) return tl::unexpected(std::move(choice.error()));
    auto found = choice->evaluator->evaluate(receivers, emitters, evaluate);
    if (!found) return found;
    light = std::move(*found);
    by.name = choice->evaluator->name();
    by.reason = std::move(choice->reason);
    by.time_was_up = stage.time_is_up();
  }
  set_errors(light, evaluate, by);
  if (used) *used = std::move(by);
  return light;
}

/// Which columns are known, and what light is wanted of the other emitters.
struct Columns {
  std::vector<std::optional<std::size_t>> kept;  ///< per emitter: its column in the transport before
  std::vector<Emitter> changed;
  EvaluateOptions of_changed;
};

Columns columns_of(const Rig& rig, const Look& look, const KeptTransport& before, const Request& request) {
  const std::size_t fixtures = rig.fixtures.size(), count = request.emitters.size();
  Columns columns{std::vector<std::optional<std::size_t>>(count), {}, request.wanted};
  columns.of_changed.levels.clear();
  Eigen::VectorXd kept_lux = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(request.receivers.size()));
  for (std::size_t e = 0; e < count; ++e) {
    const double level = request.wanted.levels.empty() ? 1.0 : request.wanted.levels[e];
    const auto looks_as_before = [&] {
      const Joints& now = look.joints.empty() ? rig.fixtures[e].joints : look.joints[e];
      return e < before.joints.size() && same_aim(now, before.joints[e]);
    };
    if (e >= fixtures || looks_as_before()) {
      columns.kept[e] = e < fixtures ? e : before.joints.size() + (e - fixtures);
      kept_lux += level * before.transport.lux_per_level.col(static_cast<Eigen::Index>(*columns.kept[e]));
    } else {
      columns.changed.push_back(request.emitters[e]);
      columns.of_changed.levels.push_back(level);
    }
  }
  // Errors are relative to all light; this much of it is certain.
  if (kept_lux.size() > 0) columns.of_changed.floor_lx = std::max(columns.of_changed.floor_lx, kept_lux.minCoeff());
  return columns;
}

/// The mean of light that is not exact enough and a second estimate of all, as coarse as will do.
/// seed   of the second estimate
/// used   of `light`; then of the mean
Result<TransportMatrix> mean_with_second(const Request& request, const TransportMatrix& light, std::uint64_t seed,
                                         ModelUsed& used) {
  const double over = used.error() / used.wanted;
  // For independent estimates, weighted by the inverse of their variances, the mean has the sum of these inverses.
  const double second = 1 / std::sqrt(1 / (kAim * kAim) - 1 / (over * over));
  Request coarse = request;
  coarse.options.seed = seed;
  coarse.options.max_error *= second;
  if (coarse.options.worst_error) *coarse.options.worst_error *= second;
  ModelUsed by;
  const auto again = coarse.light(&by);
  if (!again) return again;
  const double share = 1 / (over * over) / (1 / (over * over) + 1 / (second * second));
  EvaluateOptions wanted = request.wanted;
  want_error(request.options, wanted);
  TransportMatrix mean = mean_of(light, share, *again, wanted);
  set_errors(mean, wanted, used);
  used.time_was_up = by.time_was_up;
  return mean;
}

}  // namespace

std::string ModelUsed::warning() const {
  if (reached()) return "";
  return fmt::format(
      "not as exact as wanted: error {:.2g} {}, wanted {:g}{}: {} or ask for less (--{}-error, --error-floor)", error(),
      of_worst ? "of the worst point (two standard errors)" : "rms", wanted,
      time_was_up ? fmt::format(", when {:g} s were over", max_seconds) : ", after the most rays that are cast",
      time_was_up ? "give it more time (--max-seconds)" : "take another --model", of_worst ? "worst" : "max");
}

Result<TransportMatrix> light_of(const RayScene& scene, std::span<const Receiver> receivers,
                                 std::span<const Emitter> emitters, EvaluateOptions wanted,
                                 const ComputeOptions& options, ModelUsed* used) {
  const Stage stage(options.watch.without_stop(), options.stage, "starting", limit_of(options));
  return Request{stage, scene, receivers, emitters, std::move(wanted), options}.light(used);
}

namespace {

/// A known light is as it was measured: traced light is scaled to it, at the point and at a luxmeter there.
void scale_to_known_lights(const Rig& rig, TransportMatrix& light) {
  /// What differs by more is not traced well enough to be scaled.
  constexpr double kMostScale = 5;
  for (const KnownLight& known : rig.known_lights) {
    const auto f = static_cast<Eigen::Index>(known.fixture);
    std::vector<Eigen::Index> rows{static_cast<Eigen::Index>(known.point)};
    for (std::size_t m = 0; m < rig.luxmeters.size(); ++m)
      if (rig.luxmeters[m].point == known.point) rows.push_back(static_cast<Eigen::Index>(rig.points.size() + m));
    for (const Eigen::Index row : rows) {
      const double scale = known.lux / light.lux_per_level(row, f);
      if (!(scale > 1 / kMostScale && scale < kMostScale)) continue;
      light.lux_per_level(row, f) *= scale;
      light.direct_lux_per_level(row, f) *= scale;
      for (Eigen::MatrixXd& replicate : light.replicates) replicate(row, f) *= scale;
      for (Eigen::MatrixXd& primary : light.rgb_per_level) primary(row, f) *= scale;
    }
  }
}

Result<TransportMatrix> traced(const Rig& rig, const RayScene& rays, const ComputeOptions& options, const Look& look,
                               ModelUsed* used, const KeptTransport* before) {
  const Stage stage(options.watch.without_stop(), options.stage, "starting", limit_of(options));
  const auto receivers = receivers_of(rig);
  const auto emitters = all_emitters_of(rig, look.joints);
  EvaluateOptions wanted;
  set_error_floor(rig, wanted);
  wanted.colour = rig.colour_goals();
  wanted.levels = look.levels;
  if (!wanted.levels.empty()) wanted.levels.resize(emitters.size(), 1.0);
  const Request all{stage, rays, receivers, emitters, wanted, options};
  if (!before) return all.light(used);

  const Columns columns = columns_of(rig, look, *before, all);
  ModelUsed by;
  const auto anew = Request{stage, rays, receivers, columns.changed, columns.of_changed, options}.light(&by);
  if (!anew) return anew;
  want_error(options, wanted);
  TransportMatrix joined = joined_columns(before->transport, *anew, columns.kept, wanted);
  set_errors(joined, wanted, by);
  const auto is_too_coarse = [&] {
    return !by.reached() && !by.time_was_up && columns.changed.size() < emitters.size();
  };
  if (is_too_coarse() && by.error() <= kMaxOver * by.wanted) {
    auto mean = mean_with_second(all, joined, options.seed ^ joints_hash(rig, look), by);
    if (!mean) return mean;
    joined = std::move(*mean);
  }
  if (is_too_coarse()) {
    ModelUsed of_all;
    auto light = all.light(&of_all);
    if (!light) return light;
    if (of_all.error() <= by.error()) {
      if (used) *used = std::move(of_all);
      return light;
    }
    by.time_was_up = of_all.time_was_up;  // it ended less exact
  }
  if (columns.changed.empty()) {
    by.name = "kept";
    by.reason = "nothing has turned";
  } else if (columns.changed.size() < emitters.size()) {
    by.reason += fmt::format("; {} of {} columns are known", emitters.size() - columns.changed.size(), emitters.size());
  }
  if (used) *used = std::move(by);
  return joined;
}

}  // namespace

Result<TransportMatrix> compute_transport(const Rig& rig, const RayScene& rays, const ComputeOptions& options,
                                          const Look& look, ModelUsed* used, const KeptTransport* before) {
  auto light = traced(rig, rays, options, look, used, before);
  if (light) scale_to_known_lights(rig, *light);
  return light;
}

}  // namespace luxrig
