#include "core/tasks/evaluator_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/transport/paths/light_tracer.h"

namespace luxrig {
namespace {

/// A trial pays when reflected light may be negligible: below this reflectance, or from this wanted error on.
constexpr double kDarkReflectance = 0.1;
constexpr double kCoarseError = 0.08;
/// Measured by `luxrig bench transport`: sharing wins from this many receivers on, and its stated error holds down to
/// this wanted error.
constexpr std::size_t kSharingReceivers = 24;
constexpr double kSharingError = 0.001;

/// Largest share of reflected light in a receiver's total, with two standard errors on top; or the fault.
Result<double> reflected_share(const RayScene& scene, std::span<const Receiver> receivers,
                               std::span<const Emitter> emitters, EvaluateOptions options) {
  options.wanted_relative_error = 100;  // the first round is enough
  options.wanted_rms_error = 0;
  options.colour = false;
  options.watch.progress = nullptr;
  auto trial = make_path_evaluator(scene)->evaluate(receivers, emitters, options);
  if (!trial) return tl::unexpected(std::move(trial.error()));
  Eigen::VectorXd levels = Eigen::VectorXd::Ones(trial->emitters());
  for (std::size_t e = 0; e < options.levels.size(); ++e) levels[static_cast<Eigen::Index>(e)] = options.levels[e];
  const Eigen::VectorXd lux = trial->lux(levels), direct_lux = trial->direct_lux(levels),
                        error_lux = trial->standard_error_lux(levels);
  double largest = 0;
  for (Eigen::Index r = 0; r < lux.size(); ++r)
    if (lux[r] > 0.001 * lux.maxCoeff())
      largest = std::max(largest, (lux[r] - direct_lux[r] + 2 * error_lux[r]) / lux[r]);
  return largest;
}

}  // namespace

Result<EvaluatorChoice> choose_evaluator(const RayScene& scene, std::span<const Receiver> receivers,
                                         std::span<const Emitter> emitters, const EvaluateOptions& options) {
  const double reflectance = largest_reflectance(scene), wanted = options.wanted_standard_error(),
               left_out = options.wanted_rms_error > 0 ? wanted / 2 : options.wanted_relative_error / 2;
  if (!(reflectance > 0)) return EvaluatorChoice{make_direct_evaluator(scene), "nothing in the scene reflects light"};
  if (reflectance < kDarkReflectance || wanted >= kCoarseError) {
    const auto share = reflected_share(scene, receivers, emitters, options);
    if (!share) return tl::unexpected(share.error());
    if (*share < left_out)
      return EvaluatorChoice{
          make_direct_evaluator(scene),
          fmt::format("reflected light is at most {:.2g} of any point's, below {:g}, half of what is "
                      "wanted",
                      *share, left_out)};
  }
  if (receivers.size() < kSharingReceivers)
    return EvaluatorChoice{
        make_path_evaluator(scene),
        fmt::format("{} points are too few to share paths; {} or more do", receivers.size(), kSharingReceivers)};
  if (wanted < kSharingError)
    return EvaluatorChoice{make_path_evaluator(scene),
                           fmt::format("a standard error of {:g} needs unbiased paths; from {:g} on points share them",
                                       wanted, kSharingError)};
  return EvaluatorChoice{make_gather_evaluator(scene),
                         fmt::format("{} points share what their paths find", receivers.size())};
}

}  // namespace luxrig
