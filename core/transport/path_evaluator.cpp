/// Bidirectional path tracing with randomised quasi-Monte-Carlo samples, spent where the error is.
///
/// Each receiver has 16 replicates: estimates from independent scrambles of one Sobol sequence. Their spread gives the
/// standard error. All replicates of a receiver have the same number of samples, which doubles until the error is as
/// small as wanted.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/parallel.h"
#include "core/transport/direct_light.h"
#include "core/transport/path_sampler.h"
#include "core/transport/progress.h"
#include "core/transport/replicate_error.h"
#include "core/transport/shared_tails.h"

namespace luxrig {
namespace {

constexpr std::size_t kReplicates = 16;
/// First number of samples per replicate: 128 paths say roughly how bright it is, which later rounds build on.
constexpr std::uint32_t kFirstSamples = 8;
/// Where nothing reflected was found at all, an error of zero proves nothing yet; it is believed from here on.
constexpr std::uint32_t kSamplesToBelieveNothing = 256;
constexpr std::uint32_t kMostSamples = 1u << 30;
/// Samples that are taken from one filling of the pools of light hits.
constexpr std::uint32_t kChunk = 2048;
/// Hits cost one ray and serve all receivers, so that pools hold more than one receiver needs: receivers then err less
/// in the same direction, and paths are joined with more different hits. For each this many receivers one share more.
constexpr std::size_t kReceiversPerShare = 8;
constexpr std::uint32_t kMostHits = 2 * kChunk * PathSampler::kHitsPerPath;  ///< of a pool
/// A receiver is done when this many of its standard errors are within the wanted error. One would keep the contract
/// on average; 2.5 makes the error itself, not only its standard deviation, stay below the wanted one for 98 of 100
/// receivers, and leaves room for the estimate from 16 replicates to be too low by 1.44 (χ², 15 degrees of freedom,
/// 5 %), which stopping at the first low estimate would make the rule.
constexpr double kStopMargin = 2.5;
/// Light of sources with size is sampled, too: closer than the whole is wanted, so that it does not keep it waiting.
constexpr double kDirectMargin = 5;
/// Connections worth less than this share of a path's mean are made only now and then.
constexpr double kCut = 0.1;
/// With shared tails: records per receiver at first, then one for so many paths of the receivers (and a replicate),
/// each with so many paths of its own. Fewer records let their distance count more. With few paths of their own,
/// records that end in one another would follow the same few ways and err together.
constexpr std::size_t kFirstRecords = 16;
constexpr std::size_t kFewestRecords = 256;
constexpr std::size_t kPathsPerRecord = 4;
constexpr std::uint32_t kRecordPaths = 2;
/// Fewer receivers than this at work have more to gain from paths of their own than from shared noise.
constexpr std::size_t kFewestSharing = 24;
constexpr std::size_t kMostRecords = 1u << 15;
constexpr std::size_t kMostRecordBytes = 256u << 20;
/// Every so many paths one goes on beside its record, to tell how far records are off.
constexpr std::uint32_t kCheckedPaths = 8;

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// How far a receiver has come.
struct Spent {
  std::uint32_t samples = 0;  ///< per replicate
  std::uint64_t rays = 0;
  double lux = 0;  ///< under the options' levels
  double direct_lx = 0;
  double error_lx = 0;  ///< standard error of lux
  double taken_lx = 0;  ///< from tail records, summed over samples and replicates
};

class Evaluation {
 public:
  Evaluation(const RayScene& scene, std::span<const Receiver> receivers, std::span<const Emitter> emitters,
             const EvaluateOptions& options, bool shares_tails)
      : scene_(scene),
        receivers_(receivers),
        emitters_(emitters),
        options_(options),
        lamps_(emitters, options.levels, scene.bounds_world_m()),
        bsdfs_(bsdfs_of(scene)),
        channels_(options.colour ? 3 : 1),
        columns_(emitters.size() * channels_),
        importance_(emitters.size()),
        sampler_(scene, lamps_, bsdfs_, importance_) {
    levels_ = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(emitters.size()));
    for (std::size_t e = 0; e < options.levels.size(); ++e) levels_[static_cast<Eigen::Index>(e)] = options.levels[e];
    for (std::size_t e = 0; e < emitters.size(); ++e) importance_[e] = lamps_.importance(e);
    if (shares_tails) tails_.emplace(scene_, sampler_, bsdfs_, emitters.size(), kReplicates, options.seed);
  }

  Result<TransportMatrix> run() {
    const bool reflects = obstacles_in(scene_) && !emitters_.empty() && !receivers_.empty() &&
                          std::any_of(bsdfs_.begin(), bsdfs_.end(), [](const Bsdf& b) { return !b.black(); });
    EvaluateOptions direct_options = options_;
    direct_options.wanted_relative_error /= reflects ? kDirectMargin : 1;
    auto direct = direct_light(scene_, receivers_, emitters_, direct_options, reflects ? 0.05 : 1.0);
    if (!direct) return tl::unexpected(std::move(direct.error()));
    matrix_.direct_lux_per_level = std::move(direct->lux_per_level);
    direct_replicates_ = std::move(direct->replicates);
    matrix_.rays = direct->rays;
    if (!reflects) {
      matrix_.lux_per_level = matrix_.direct_lux_per_level;
      matrix_.replicates = std::move(direct_replicates_);
      matrix_.relative_error = direct->relative_error;
      if (channels_ == 3) start_colours();
      return std::move(matrix_);
    }
    spent_.resize(receivers_.size());
    const auto rows = static_cast<Eigen::Index>(receivers_.size());
    sums_.assign(kReplicates, RowMatrix::Zero(rows, static_cast<Eigen::Index>(columns_)));
    done_ = 0.05;
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
    // A path has seldom more than 4 vertices, each with a ray to reach it, one to a lamp and one to a light hit.
    const std::uint64_t rays_per_sample = (12 * all.size() + PathSampler::kHitsPerPath) * kReplicates;
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

  /// Gives each receiver of the round as many samples again as it has.
  bool sample(const std::vector<std::size_t>& round) {
    // Receivers at the same sample share light hits; nearly always that is all of them.
    std::map<std::uint32_t, std::vector<std::size_t>> at_sample;
    for (const std::size_t r : round) at_sample[spent_[r].samples].push_back(r);
    CallingThreadProgress progress(options_.watch, done_, done_after(round), parts_of(at_sample));
    for (const auto& [begin, group] : at_sample) {
      const std::uint32_t end = end_after(begin);
      for (std::uint32_t at = begin; at < end; at += kChunk)
        sample_chunk(group, at, std::min(end, at + kChunk), progress);
    }
    if (options_.watch.stop.stop_requested()) return false;
    for (const std::size_t r : round) {
      spent_[r].samples = end_after(spent_[r].samples);
      estimate(r);
    }
    done_ = done_after({});
    brightest_lx_ = 0;
    for (const Spent& spent : spent_) brightest_lx_ = std::max(brightest_lx_, spent.lux);
    return true;
  }

  std::uint32_t end_after(std::uint32_t begin) const { return begin == 0 ? first_samples_ : 2 * begin; }

  std::size_t parts_of(const std::map<std::uint32_t, std::vector<std::size_t>>& at_sample) const {
    std::size_t parts = 0;
    for (const auto& [begin, group] : at_sample)
      parts += (end_after(begin) - begin + kChunk - 1) / kChunk * kReplicates * group.size();
    return parts;
  }

  SobolSequence samples_of_lights(std::size_t replicate) const {
    return SobolSequence(mixed(mixed(options_.seed, 0x11647), replicate));
  }

  void sample_chunk(const std::vector<std::size_t>& group, std::uint32_t begin, std::uint32_t end,
                    CallingThreadProgress& progress) {
    const std::uint32_t shares = shares_of(group.size(), end - begin);
    trace_lights(begin * shares, end * shares);
    const bool shares_now = tails_ && group.size() >= kFewestSharing;
    if (shares_now) grow_tails(group, begin, end);
    std::vector<std::uint64_t> rays(group.size() * kReplicates, 0);
    std::vector<TailShare> told(rays.size());
    parallel_for(rays.size(), options_.threads, [&](std::size_t task) {
      const std::size_t r = group[task / kReplicates], k = task % kReplicates;
      const SobolSequence samples(mixed(mixed(options_.seed, r), k));
      PathScratch scratch;
      std::vector<double> values(columns_, 0.0);
      const PathSums sums{values, channels_};
      const std::size_t first_hit = (r % shares) * std::size_t{end - begin} * PathSampler::kHitsPerPath;
      const double cut_lx = kCut * (spent_[r].lux - spent_[r].direct_lx);
      TailShare tails;
      if (shares_now) tails.records = &tails_->records();
      tails.replicate = k;
      for (std::uint32_t i = begin; i < end; ++i) {
        if (options_.watch.stop.stop_requested()) return;
        tails.check = i % kCheckedPaths == r % kCheckedPaths;
        rays[task] += sampler_.add_path(receivers_[r], samples, i, pools_[k],
                                        first_hit + std::size_t{i - begin} * PathSampler::kHitsPerPath, cut_lx, scratch,
                                        sums, &tails);
      }
      told[task] = tails;
      sums_[k].row(static_cast<Eigen::Index>(r)) +=
          Eigen::Map<const Eigen::RowVectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
      progress.one_done();
    });
    for (std::size_t task = 0; task < rays.size(); ++task) {
      Spent& spent = spent_[group[task / kReplicates]];
      spent.rays += rays[task];
      spent.taken_lx += told[task].taken_lx;
      by_record_lx_[task % kReplicates] += told[task].by_record_lx;
      by_path_lx_[task % kReplicates] += told[task].by_path_lx;
      matrix_.rays += rays[task];
    }
  }

  /// Adds records for a chunk: many at first, that all receivers have one near wherever they look, then as many as
  /// keeps their noise and distance in step with the receivers' own noise.
  void grow_tails(const std::vector<std::size_t>& group, std::uint32_t begin, std::uint32_t end) {
    std::vector<Receiver> from;
    for (const std::size_t r : group) from.push_back(receivers_[r]);
    const std::size_t wanted = begin == 0 ? std::max(kFewestRecords, kFirstRecords * group.size())
                                          : group.size() * (end - begin) / kPathsPerRecord;
    const std::size_t memory_allows = kMostRecordBytes / (kReplicates * 3 * sizeof(float) * emitters_.size());
    const std::size_t room = std::min(kMostRecords, memory_allows) - std::min(kMostRecords, tails_->records().size());
    matrix_.rays += tails_->grow(from, std::min(wanted, room), kRecordPaths, pools_, options_.threads, options_.watch);
  }

  /// Shares of a pool for different receivers; a power of two, which keeps the strata of each.
  static std::uint32_t shares_of(std::size_t receivers, std::uint32_t samples) {
    std::uint32_t shares = 1;
    while (2 * shares * kReceiversPerShare <= receivers &&
           2 * shares * samples * PathSampler::kHitsPerPath <= kMostHits)
      shares *= 2;
    return shares;
  }

  /// Fills the pools with the light hits of samples [begin, end).
  void trace_lights(std::uint32_t begin, std::uint32_t end) {
    const LightHits lights(scene_, lamps_, bsdfs_);
    pools_.resize(kReplicates);
    std::vector<std::uint64_t> rays(kReplicates, 0);
    parallel_for(kReplicates, options_.threads, [&](std::size_t k) {
      HitPool& pool = pools_[k];
      pool.hits.clear();
      pool.shining.clear();
      const SobolSequence samples = samples_of_lights(k);
      Lamps::Weights weights;
      for (std::uint32_t i = begin * PathSampler::kHitsPerPath; i < end * PathSampler::kHitsPerPath; ++i) {
        if (options_.watch.stop.stop_requested()) return;
        pool.hits.push_back(lights.trace(samples, i, weights, rays[k]));
        if (pool.hits.back().shines()) pool.shining.push_back(static_cast<std::uint32_t>(pool.hits.size() - 1));
      }
    });
    for (const std::uint64_t n : rays) matrix_.rays += n;
  }

  /// Reflected lux at the levels in one replicate.
  double reflected_lx(std::size_t replicate, std::size_t r) const {
    const auto row = row_of(replicate, r);
    double sum = 0;
    for (Eigen::Index e = 0; e < levels_.size(); ++e) sum += levels_[e] * luminance(row, e);
    return sum / spent_[r].samples;
  }

  template <class Row>
  double luminance(const Row& row, Eigen::Index emitter) const {
    if (channels_ == 1) return row[emitter];
    return 0.2126 * row[3 * emitter] + 0.7152 * row[3 * emitter + 1] + 0.0722 * row[3 * emitter + 2];
  }

  void estimate(std::size_t r) {
    std::array<double, kReplicates> reflected{};
    double mean_lx = 0;
    for (std::size_t k = 0; k < kReplicates; ++k) {
      reflected[k] = reflected_lx(k, r);
      mean_lx += reflected[k] / kReplicates;
    }
    spent_[r].direct_lx = matrix_.direct_lux_per_level.row(static_cast<Eigen::Index>(r)).dot(levels_);
    spent_[r].lux = mean_lx + spent_[r].direct_lx;
    spent_[r].error_lx = standard_error_of_mean(reflected);
  }

  void finish() {
    const auto n = static_cast<Eigen::Index>(receivers_.size());
    Eigen::MatrixXd reflected = Eigen::MatrixXd::Zero(n, levels_.size());
    if (channels_ == 3) start_colours();
    for (std::size_t k = 0; k < kReplicates; ++k) {
      Eigen::MatrixXd replicate(n, levels_.size());
      for (Eigen::Index r = 0; r < n; ++r) {
        const auto row = sums_[k].row(r);
        const double samples = spent_[static_cast<std::size_t>(r)].samples;
        for (Eigen::Index e = 0; e < levels_.size(); ++e) {
          replicate(r, e) = luminance(row, e) / samples;
          for (std::size_t c = 0; c < 3 && channels_ == 3; ++c)
            matrix_.rgb_per_level[c](r, e) += row[3 * e + static_cast<Eigen::Index>(c)] / (samples * kReplicates);
        }
      }
      sums_[k].resize(0, 0);
      reflected += replicate / kReplicates;
      matrix_.replicates.emplace_back(
          replicate + (direct_replicates_.empty() ? matrix_.direct_lux_per_level : direct_replicates_[k]));
    }
    matrix_.lux_per_level = matrix_.direct_lux_per_level + reflected;
    if (!direct_replicates_.empty()) {
      const Eigen::VectorXd error_lx = matrix_.standard_error_lux(levels_);
      for (std::size_t r = 0; r < receivers_.size(); ++r) spent_[r].error_lx = error_lx[static_cast<Eigen::Index>(r)];
    }
    if (tails_) own_up_to_bias();
    for (std::size_t r = 0; r < receivers_.size(); ++r)
      matrix_.relative_error = std::max(matrix_.relative_error, relative_error(r));
    if (options_.watch.progress) options_.watch.progress(1.0);
  }

  /// Takes the records' common bias, as the checked paths show it, out of what was taken from them, as far as it stands
  /// out of its own noise; and adds what remains unsure to every replicate, up and down in turn, so that standard
  /// errors contain it.
  void own_up_to_bias() {
    std::vector<double> biases;
    for (std::size_t k = 0; k < kReplicates; ++k)
      if (by_path_lx_[k] > 0) biases.push_back(by_record_lx_[k] / by_path_lx_[k] - 1);
    if (biases.size() < kReplicates) return;
    double mean = 0;
    for (const double b : biases) mean += b / kReplicates;
    const double error = standard_error_of_mean(biases);
    const double bias = mean * std::max(0.0, 1 - 4 * error * error / std::max(mean * mean, 1e-300));
    // Half up and half down by `a` gives a standard error of a · √(16/15) / 4, times Student's factor.
    const double up_and_down = error * 4 / (std::sqrt(16.0 / 15) * student_t_975(kReplicates - 1) / student_t_975(1e9));
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      Spent& spent = spent_[r];
      const double reflected_lx = spent.lux - spent.direct_lx;
      if (!(spent.taken_lx > 0) || !(reflected_lx > 0)) continue;
      const double taken_lx = spent.taken_lx / (kReplicates * static_cast<double>(spent.samples));
      const double share = std::min(1.0, taken_lx / reflected_lx);
      const auto row = static_cast<Eigen::Index>(r);
      const auto reflected = (matrix_.lux_per_level.row(row) - matrix_.direct_lux_per_level.row(row)).eval();
      matrix_.lux_per_level.row(row) -= share * bias / (1 + bias) * reflected;
      for (auto& rgb : matrix_.rgb_per_level) rgb.row(row) *= 1 - share * bias / (1 + bias) * reflected_lx / spent.lux;
      for (std::size_t k = 0; k < kReplicates; ++k)
        matrix_.replicates[k].row(row) -=
            share * (bias / (1 + bias) + (k % 2 == 0 ? up_and_down : -up_and_down)) * reflected;
      spent.error_lx = std::hypot(spent.error_lx, share * error * reflected_lx);
    }
  }

  /// The direct part by primary.
  void start_colours() {
    matrix_.rgb_per_level.assign(3, matrix_.direct_lux_per_level);
    for (std::size_t c = 0; c < 3; ++c)
      for (Eigen::Index e = 0; e < levels_.size(); ++e)
        matrix_.rgb_per_level[c].col(e) *=
            emitters_[static_cast<std::size_t>(e)].colour_rgb[static_cast<Eigen::Index>(c)];
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
  std::vector<Bsdf> bsdfs_;
  std::size_t channels_, columns_;
  std::vector<double> importance_;
  PathSampler sampler_;
  Eigen::VectorXd levels_;
  std::vector<HitPool> pools_;
  std::optional<SharedTails> tails_;
  std::array<double, kReplicates> by_record_lx_{}, by_path_lx_{};  ///< of checked paths, all receivers
  TransportMatrix matrix_;
  std::vector<Spent> spent_;
  std::vector<Eigen::MatrixXd> direct_replicates_;  ///< empty when the direct part is exact
  std::vector<RowMatrix> sums_;  ///< per replicate: reflected light, receivers × emitters, summed over samples
  double brightest_lx_ = 0;
  double done_ = 0;
  std::uint32_t first_samples_ = kFirstSamples;
};

class PathEvaluator final : public Evaluator {
 public:
  PathEvaluator(const RayScene& scene, bool shares_tails) : scene_(scene), shares_tails_(shares_tails) {}
  std::string_view name() const override { return shares_tails_ ? "gather" : "path"; }

  Result<TransportMatrix> evaluate(std::span<const Receiver> receivers, std::span<const Emitter> emitters,
                                   const EvaluateOptions& options) const override {
    if (auto checked = check_evaluation(receivers, emitters, options); !checked)
      return tl::unexpected(std::move(checked.error()));
    return Evaluation(scene_, receivers, emitters, options, shares_tails_).run();
  }

 private:
  const RayScene& scene_;
  bool shares_tails_;
};

}  // namespace

std::unique_ptr<Evaluator> make_path_evaluator(const RayScene& scene) {
  return std::make_unique<PathEvaluator>(scene, false);
}

std::unique_ptr<Evaluator> make_gather_evaluator(const RayScene& scene) {
  return std::make_unique<PathEvaluator>(scene, true);
}

}  // namespace luxrig
