/// Path tracing with randomised quasi-Monte-Carlo samples, spent where the error is.
///
/// Each receiver has 16 replicates: estimates from independent scrambles of one Sobol sequence. Their spread gives the
/// standard error. All replicates of a receiver have the same number of samples, which doubles until the error is as
/// small as wanted.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/transport/direct_light.h"
#include "core/transport/path_sampler.h"
#include "core/transport/progress.h"
#include "core/transport/replicate_error.h"

namespace luxrig {
namespace {

constexpr std::size_t kReplicates = 16;
/// First number of samples per replicate: 512 paths see most of what a hemisphere has to show.
constexpr std::uint32_t kFirstSamples = 32;
/// Where nothing reflected was found at all, an error of zero proves nothing yet; it is believed from here on.
constexpr std::uint32_t kSamplesToBelieveNothing = 256;
constexpr std::uint32_t kMostSamples = 1u << 30;
/// A receiver is done when this many of its standard errors are within the wanted error. One would keep the contract
/// on average; 2.5 makes the error itself, not only its standard deviation, stay below the wanted one for 98 of 100
/// receivers, and leaves room for the estimate from 16 replicates to be too low by 1.44 (χ², 15 degrees of freedom,
/// 5 %), which stopping at the first low estimate would make the rule. Costs about twice the rays.
constexpr double kStopMargin = 2.5;

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// How far a receiver has come.
struct Spent {
  std::uint32_t samples = 0;  ///< per replicate
  std::uint64_t rays = 0;
  double lux = 0;       ///< under the options' levels
  double error_lx = 0;  ///< standard error of lux
};

class Evaluation {
 public:
  Evaluation(const RayScene& scene, std::span<const Receiver> receivers, std::span<const Emitter> emitters,
             const EvaluateOptions& options)
      : scene_(scene), receivers_(receivers), emitters_(emitters), options_(options), lamps_(emitters) {
    levels_ = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(emitters.size()));
    for (std::size_t e = 0; e < options.levels.size(); ++e) levels_[static_cast<Eigen::Index>(e)] = options.levels[e];
  }

  Result<TransportMatrix> run() {
    const bool reflects = obstacles_in(scene_) && !emitters_.empty() && !receivers_.empty();
    auto direct = direct_light(scene_, receivers_, lamps_, emitters_.size(), options_.threads, options_.watch,
                               reflects ? 0.02 : 1.0);
    if (!direct) return tl::unexpected(std::move(direct.error()));
    matrix_.direct_lux_per_level = std::move(direct->lux_per_level);
    matrix_.rays = direct->rays;
    if (!reflects) {
      matrix_.lux_per_level = matrix_.direct_lux_per_level;
      return std::move(matrix_);
    }
    spent_.resize(receivers_.size());
    const auto rows = static_cast<Eigen::Index>(receivers_.size());
    sums_.assign(kReplicates, RowMatrix::Zero(rows, static_cast<Eigen::Index>(emitters_.size())));
    done_ = 0.02;
    for (auto round = first_round(); !round.empty(); round = next_round())
      if (!sample(round)) return tl::unexpected(Fault{Cause::cancelled, "", "stopped while tracing paths", {}});
    finish();
    return std::move(matrix_);
  }

 private:
  std::vector<std::size_t> first_round() {
    std::vector<std::size_t> all(receivers_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    first_samples_ = kFirstSamples;
    // A path has seldom more than 4 vertices, each with a ray to reach it and one to each lamp.
    const std::uint64_t rays_per_sample = 4 * (emitters_.size() + 1) * kReplicates * all.size();
    const std::uint64_t rays_left = options_.max_rays > matrix_.rays ? options_.max_rays - matrix_.rays : 0;
    while (first_samples_ > 1 && rays_per_sample * first_samples_ > rays_left) first_samples_ /= 2;
    return all;
  }

  /// The receivers to be sampled as often again as they have been.
  std::vector<std::size_t> next_round() {
    std::vector<std::size_t> wanting;
    for (std::size_t r = 0; r < receivers_.size(); ++r)
      if (overshoot(r) > 1 && spent_[r].samples < kMostSamples) wanting.push_back(r);
    // As many as the remaining rays allow, the worst first.
    std::stable_sort(wanting.begin(), wanting.end(),
                     [&](std::size_t a, std::size_t b) { return overshoot(a) > overshoot(b); });
    std::uint64_t rays_left = options_.max_rays > matrix_.rays ? options_.max_rays - matrix_.rays : 0;
    std::erase_if(wanting, [&](std::size_t r) {
      if (spent_[r].rays > rays_left) return true;
      rays_left -= spent_[r].rays;
      return false;
    });
    std::sort(wanting.begin(), wanting.end());
    return wanting;
  }

  /// Estimated error relative to that at which the receiver is done; infinite when nothing is known yet.
  double overshoot(std::size_t r) const {
    const Spent& spent = spent_[r];
    if (spent.error_lx == 0) {
      const bool found = (row_of(0, r).array() != 0).any();
      return found || spent.samples >= kSamplesToBelieveNothing ? 0 : HUGE_VAL;
    }
    return relative_error(r) * kStopMargin / options_.wanted_relative_error;
  }

  double relative_error(std::size_t r) const {
    const double scale_lx = std::max(spent_[r].lux, 0.001 * brightest_lx_);
    return scale_lx > 0 ? spent_[r].error_lx / scale_lx : 0;
  }

  RowMatrix::ConstRowXpr row_of(std::size_t replicate, std::size_t r) const {
    return sums_[replicate].row(static_cast<Eigen::Index>(r));
  }

  bool sample(const std::vector<std::size_t>& round) {
    const std::size_t tasks = round.size() * kReplicates;
    std::vector<std::uint64_t> rays(tasks, 0);
    CallingThreadProgress progress(options_.watch, done_, done_after(round), tasks);
    const PathSampler sampler(scene_, lamps_);
    parallel_for(tasks, options_.threads, [&](std::size_t task) {
      const std::size_t r = round[task / kReplicates], k = task % kReplicates;
      const std::uint32_t begin = spent_[r].samples, end = begin == 0 ? first_samples_ : 2 * begin;
      const SobolSequence samples(mixed(mixed(options_.seed, r), k));
      std::vector<double> sums(emitters_.size(), 0.0);
      for (std::uint32_t i = begin; i < end; ++i) {
        if (options_.watch.stop.stop_requested()) return;
        rays[task] += sampler.add_path(receivers_[r], samples, i, sums);
      }
      sums_[k].row(static_cast<Eigen::Index>(r)) +=
          Eigen::Map<const Eigen::RowVectorXd>(sums.data(), static_cast<Eigen::Index>(sums.size()));
      progress.one_done();
    });
    if (options_.watch.stop.stop_requested()) return false;
    for (std::size_t i = 0; i < round.size(); ++i) {
      Spent& spent = spent_[round[i]];
      spent.samples = spent.samples == 0 ? first_samples_ : 2 * spent.samples;
      for (std::size_t k = 0; k < kReplicates; ++k) {
        spent.rays += rays[i * kReplicates + k];
        matrix_.rays += rays[i * kReplicates + k];
      }
      estimate(round[i]);
    }
    done_ = done_after({});
    brightest_lx_ = 0;
    for (const Spent& spent : spent_) brightest_lx_ = std::max(brightest_lx_, spent.lux);
    return true;
  }

  void estimate(std::size_t r) {
    std::array<double, kReplicates> reflected_lx{};
    double mean_lx = 0;
    for (std::size_t k = 0; k < kReplicates; ++k) {
      reflected_lx[k] = row_of(k, r).dot(levels_) / spent_[r].samples;
      mean_lx += reflected_lx[k] / kReplicates;
    }
    spent_[r].lux = mean_lx + matrix_.direct_lux_per_level.row(static_cast<Eigen::Index>(r)).dot(levels_);
    spent_[r].error_lx = standard_error_of_mean(reflected_lx);
  }

  void finish() {
    const auto n = static_cast<Eigen::Index>(receivers_.size());
    Eigen::MatrixXd reflected = Eigen::MatrixXd::Zero(n, levels_.size());
    for (std::size_t k = 0; k < kReplicates; ++k) {
      Eigen::MatrixXd& replicate = matrix_.replicates.emplace_back(sums_[k]);
      sums_[k].resize(0, 0);
      for (Eigen::Index r = 0; r < n; ++r) replicate.row(r) /= spent_[static_cast<std::size_t>(r)].samples;
      reflected += replicate / kReplicates;
      replicate += matrix_.direct_lux_per_level;
    }
    matrix_.lux_per_level = matrix_.direct_lux_per_level + reflected;
    for (std::size_t r = 0; r < receivers_.size(); ++r)
      matrix_.relative_error = std::max(matrix_.relative_error, relative_error(r));
    if (options_.watch.progress) options_.watch.progress(1.0);
  }

  /// Share of the whole work done so far, or after a round: error falls at least with the root of the samples.
  double done_after(const std::vector<std::size_t>& round) const {
    double spent = 0, left = 0;
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      spent += spent_[r].samples;
      const double factor = std::min(overshoot(r), 1e3);
      if (factor > 1) left += spent_[r].samples * std::max(1.0, factor * factor - 1);
    }
    double part = 0;
    for (const std::size_t r : round) part += spent_[r].samples;
    if (spent == 0) return round.empty() ? done_ : 0.1;
    return std::clamp((spent + part) / (spent + std::max(left, part)), done_, 1.0);
  }

  const RayScene& scene_;
  std::span<const Receiver> receivers_;
  std::span<const Emitter> emitters_;
  const EvaluateOptions& options_;
  Lamps lamps_;
  Eigen::VectorXd levels_;
  TransportMatrix matrix_;
  std::vector<Spent> spent_;
  std::vector<RowMatrix> sums_;  ///< per replicate: reflected light, receivers × emitters, summed over samples
  double brightest_lx_ = 0;
  double done_ = 0;
  std::uint32_t first_samples_ = kFirstSamples;
};

class PathEvaluator final : public Evaluator {
 public:
  explicit PathEvaluator(const RayScene& scene) : scene_(scene) {}
  std::string_view name() const override { return "path"; }

  Result<TransportMatrix> evaluate(std::span<const Receiver> receivers, std::span<const Emitter> emitters,
                                   const EvaluateOptions& options) const override {
    if (auto checked = check_evaluation(receivers, emitters, options); !checked)
      return tl::unexpected(std::move(checked.error()));
    return Evaluation(scene_, receivers, emitters, options).run();
  }

 private:
  const RayScene& scene_;
};

}  // namespace

std::unique_ptr<Evaluator> make_path_evaluator(const RayScene& scene) { return std::make_unique<PathEvaluator>(scene); }

}  // namespace luxrig
