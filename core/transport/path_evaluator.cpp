/// Bidirectional path tracing with randomised quasi-Monte-Carlo samples, spent where the error is.
///
/// Each receiver has 16 replicates: estimates from independent scrambles of one Sobol sequence. Their spread gives the
/// standard error. All replicates of a receiver have the same number of samples, which doubles until the error is as
/// small as wanted.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/transport/direct_light.h"
#include "core/transport/path_sampler.h"
#include "core/transport/progress.h"
#include "core/transport/receiver_hits.h"
#include "core/transport/record_bias.h"
#include "core/transport/replicate_error.h"
#include "core/transport/shared_tails.h"
#include "core/transport/sky_opening_finder.h"

namespace luxrig {
namespace {

constexpr std::size_t kReplicates = RecordBias::kReplicates;
/// First number of samples per replicate: 128 paths say roughly how bright it is, which later rounds build on.
constexpr std::uint32_t kFirstSamples = 8;
/// Where nothing reflected was found at all, an error of zero proves nothing yet; it is believed from here on.
constexpr std::uint32_t kSamplesToBelieveNothing = 256;
constexpr std::uint32_t kMostSamples = 1u << 30;
/// Rounds end at so many steps between as many samples as before and twice as many, a little beyond what is needed.
constexpr int kStepsToDouble = 8;
constexpr double kStepMargin = 1.05;
/// Samples that are taken from one filling of the pools of light hits.
constexpr std::uint32_t kChunk = 512;
/// Hits that a receiver is joined with, for each of its paths.
constexpr std::uint32_t kHitsPerPath = 4;
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
constexpr std::size_t kFirstRecords = 8;
constexpr std::size_t kFewestRecords = 256;
constexpr std::size_t kPathsPerRecord = 4;
constexpr std::uint32_t kRecordPaths = 4, kHitsPerRecordPath = 4;
/// Fewer receivers than this have more to gain from paths of their own than from shared noise.
constexpr std::size_t kFewestSharing = 24;
/// A receiver that sees few records does not err less by more paths that end in them: when error² × samples has grown
/// so much, it goes on without.
constexpr double kMostScatter = 3;
constexpr std::uint32_t kSamplesToTellScatter = 32;
constexpr std::size_t kMostRecords = 1u << 15;
constexpr std::size_t kMostRecordBytes = 256u << 20;
/// Every so many paths one goes on beside its record, to tell how far records are off; fewer once that is known to this
/// part of the error that is left to the receivers.
constexpr std::uint32_t kCheckedPaths = 8, kSeldomCheckedPaths = 64;
constexpr double kBiasPart = 0.3;

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// How far a receiver has come.
struct Spent {
  std::uint32_t samples = 0;  ///< per replicate
  std::uint64_t rays = 0;
  double lux = 0;  ///< under the options' levels
  double direct_lx = 0;
  double reflected_lx = 0;          ///< lux without direct_lx; of a first round's hits alone before there is more
  double error_lx = 0;              ///< standard error of lux
  double taken_lx = 0;              ///< from tail records, summed over samples and replicates
  double least_scatter = HUGE_VAL;  ///< least so far of error² × samples
  bool alone = false;               ///< records' noise has become its own: paths go on by themselves from here on
};

class Evaluation {
 public:
  Evaluation(const RayScene& scene, std::span<const Receiver> receivers, std::span<const Emitter> emitters,
             const EvaluateOptions& options, bool shares_tails)
      : scene_(scene),
        receivers_(receivers),
        emitters_(emitters),
        options_(options),
        bsdfs_(bsdfs_of(scene)),
        openings_(
            find_sky_openings(scene, receivers, emitters, options.seed, options.threads, options.watch, matrix_.rays)),
        lamps_(emitters, options.levels, scene.bounds_world_m(), &openings_),
        channels_(options.colour ? 3 : 1),
        columns_(emitters.size() * channels_),
        importance_(emitters.size()),
        sampler_(scene, lamps_, bsdfs_, importance_),
        hits_(lamps_, receivers.size()) {
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
    auto direct = direct_light(scene_, receivers_, emitters_, direct_options, reflects ? 0.05 : 1.0, &openings_);
    if (!direct) return tl::unexpected(std::move(direct.error()));
    matrix_.direct_lux_per_level = std::move(direct->lux_per_level);
    direct_replicates_ = std::move(direct->replicates);
    matrix_.rays += direct->rays;
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
  /// Samples that a receiver gets in a round: [begin, end) of each of its replicates.
  struct Task {
    std::size_t receiver;
    std::uint32_t begin, end;
  };

  std::vector<Task> first_round() {
    // A path has seldom more than 4 vertices, each with a ray to reach it, one to a lamp and one to a light hit.
    const std::uint64_t rays_per_sample = 12 * receivers_.size() * kReplicates;
    const std::uint64_t rays_left = options_.max_rays > matrix_.rays ? options_.max_rays - matrix_.rays : 0;
    std::uint32_t samples = kFirstSamples;
    while (samples > 1 && rays_per_sample * samples > rays_left) samples /= 2;
    std::vector<Task> all;
    for (std::size_t r = 0; r < receivers_.size(); ++r) all.push_back({r, 0, samples});
    return all;
  }

  /// The receivers that want more samples: as many as would do by the error so far, up to as many as they have.
  std::vector<Task> next_round() {
    std::vector<Task> wanting;
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      const std::uint32_t have = spent_[r].samples;
      const double over = overshoot(r);
      if (!(over > 1) || have >= kMostSamples) continue;
      const double parts = std::ceil(kStepsToDouble * (over * over * kStepMargin - 1));
      const double share = std::clamp(parts, 1.0, static_cast<double>(kStepsToDouble)) / kStepsToDouble;
      wanting.push_back({r, have, have + std::max(1u, static_cast<std::uint32_t>(have * share))});
    }
    // As many as the remaining rays allow, the worst first.
    std::stable_sort(wanting.begin(), wanting.end(),
                     [&](const Task& a, const Task& b) { return overshoot(a.receiver) > overshoot(b.receiver); });
    std::uint64_t rays_left = options_.max_rays > matrix_.rays ? options_.max_rays - matrix_.rays : 0;
    std::erase_if(wanting, [&](const Task& task) {
      const std::uint64_t rays = spent_[task.receiver].rays * (task.end - task.begin) / task.begin;
      if (rays > rays_left) return true;
      rays_left -= rays;
      return false;
    });
    std::sort(wanting.begin(), wanting.end(), [](const Task& a, const Task& b) { return a.receiver < b.receiver; });
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

  /// Works through the tasks of a round, a chunk of each at a time.
  bool sample(const std::vector<Task>& round) {
    std::size_t parts = 0;
    for (const Task& task : round) parts += (task.end - task.begin + kChunk - 1) / kChunk * kReplicates;
    CallingThreadProgress progress(options_.watch, done_, done_after(round), parts);
    for (std::vector<Task> left = round; !left.empty();) {
      std::vector<Task> chunk = left;
      for (Task& task : chunk) task.end = std::min(task.end, task.begin + kChunk);
      sample_chunk(chunk, progress);
      for (std::size_t i = 0; i < left.size(); ++i) left[i].begin = chunk[i].end;
      std::erase_if(left, [](const Task& task) { return task.begin == task.end; });
    }
    if (options_.watch.stop.stop_requested()) return false;
    for (const Task& task : round) {
      spent_[task.receiver].samples = task.end;
      estimate(task.receiver);
    }
    done_ = done_after({});
    brightest_lx_ = 0;
    for (const Spent& spent : spent_) brightest_lx_ = std::max(brightest_lx_, spent.lux);
    return true;
  }

  void sample_chunk(const std::vector<Task>& chunk, CallingThreadProgress& progress) {
    plans_.clear();
    for (const Task& task : chunk) plans_.push_back(hits_.plan(task.receiver, kHitsPerPath, task.end - task.begin));
    fill_pools(chunk);
    join_hits(chunk);
    const bool shares_now = tails_ && (chunk.size() >= kFewestSharing || tails_->records().size() > 0);
    if (shares_now) grow_tails(chunk);
    trace_paths(chunk, shares_now, progress);
  }

  void trace_paths(const std::vector<Task>& chunk, bool shares_now, CallingThreadProgress& progress) {
    std::vector<std::uint64_t> rays(chunk.size() * kReplicates, 0);
    std::vector<TailShare> told(rays.size());
    const std::uint32_t checked = bias_is_known() ? kSeldomCheckedPaths : kCheckedPaths;
    parallel_for(rays.size(), options_.threads, [&](std::size_t task) {
      const auto& [r, begin, end] = chunk[task / kReplicates];
      const std::size_t k = task % kReplicates;
      const SobolSequence samples(mixed(mixed(options_.seed, r), k));
      PathScratch scratch;
      std::vector<double> values(columns_, 0.0);
      TailShare tails;
      if (shares_now && !spent_[r].alone) tails.records = &tails_->records();
      tails.replicate = k;
      const auto start = PathSampler::at(receivers_[r]);
      for (std::uint32_t i = begin; i < end; ++i) {
        if (options_.watch.stop.stop_requested()) return;
        tails.check = i % checked == r % checked;
        rays[task] += sampler_.add_path(start, samples, i, pools_[k], plans_[task / kReplicates], cut_lx(r), scratch,
                                        {values, channels_}, &tails);
      }
      told[task] = tails;
      add_sums(k, r, values);
      progress.one_done();
    });
    std::vector<double> reflected_lx;
    for (const Task& task : chunk) reflected_lx.push_back(mean_reflected_lx(task));
    for (std::size_t task = 0; task < rays.size(); ++task) {
      Spent& spent = spent_[chunk[task / kReplicates].receiver];
      spent.rays += rays[task];
      spent.taken_lx += told[task].taken_lx;
      matrix_.rays += rays[task];
      // Relative to each receiver's light: errors are to be right for the dim ones, too.
      if (!(reflected_lx[task / kReplicates] > 0)) continue;
      record_bias_.add(task % kReplicates, told[task].by_record_lx / reflected_lx[task / kReplicates],
                       told[task].by_path_lx / reflected_lx[task / kReplicates]);
    }
  }

  void add_sums(std::size_t replicate, std::size_t r, const std::vector<double>& values) {
    sums_[replicate].row(static_cast<Eigen::Index>(r)) +=
        Eigen::Map<const Eigen::RowVectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  }

  /// Connections of a receiver's paths that are worth less are made only now and then.
  double cut_lx(std::size_t r) const { return kCut * spent_[r].reflected_lx; }

  /// Fills the pools with light hits, as many as the plans ask for.
  void fill_pools(const std::vector<Task>& chunk) {
    std::vector<std::uint32_t> paths;
    for (const Task& task : chunk) paths.push_back(task.end - task.begin);
    const auto counts = ReceiverHits::pool_counts(lamps_, plans_, paths);
    const LightHits lights(scene_, lamps_, bsdfs_);
    pools_.resize(kReplicates);
    std::vector<std::uint64_t> rays(kReplicates, 0);
    parallel_for(kReplicates, options_.threads, [&](std::size_t k) {
      Lamps::Weights weights;
      if (!options_.watch.stop.stop_requested())
        rays[k] = pools_[k].refill(lights, mixed(mixed(options_.seed, 0x11647), k), counts, weights);
    });
    for (const std::uint64_t n : rays) matrix_.rays += n;
  }

  /// Joins the receivers with light hits, and learns from it which lamps matter to whom.
  void join_hits(const std::vector<Task>& chunk) {
    if (options_.watch.stop.stop_requested()) return;
    const std::size_t groups = lamps_.groups();
    std::vector<std::uint64_t> rays(chunk.size(), 0);
    parallel_for(chunk.size(), options_.threads, [&](std::size_t i) {
      const auto& [r, begin, end] = chunk[i];
      const std::uint32_t samples = end - begin;
      Spent& spent = spent_[r];
      std::vector<HitStretch> stretches;
      std::vector<double> squares(groups);
      std::vector<double> values(columns_);
      for (std::size_t k = 0; k < kReplicates; ++k) {
        const std::uint64_t key = mixed(mixed(mixed(options_.seed, r), k), 0x101a + begin);
        draw_stretches(plans_[i], pools_[k], samples, key, stretches);
        std::fill(values.begin(), values.end(), 0.0);
        std::fill(squares.begin(), squares.end(), 0.0);
        rays[i] += sampler_.join_start(PathSampler::at(receivers_[r]), pools_[k], plans_[i], stretches, cut_lx(r),
                                       mixed(key, groups), {values, channels_}, squares);
        hits_.learn(r, squares, stretches);
        add_sums(k, r, values);
      }
      if (begin == 0) spent.reflected_lx = mean_reflected_lx(chunk[i]);
    });
    for (std::size_t i = 0; i < chunk.size(); ++i) {
      spent_[chunk[i].receiver].rays += rays[i];
      matrix_.rays += rays[i];
    }
  }

  /// Adds records for a chunk: many at first, that all receivers have one near wherever they look, then as many as
  /// keeps their noise and distance in step with the receivers' own noise.
  void grow_tails(const std::vector<Task>& chunk) {
    std::vector<Receiver> from;
    std::vector<HitPlan> plans;
    std::vector<double> cuts_lx;
    std::size_t paths = 0;
    for (const Task& task : chunk) {
      if (spent_[task.receiver].alone) continue;
      from.push_back(receivers_[task.receiver]);
      plans.push_back(hits_.plan(task.receiver, kHitsPerRecordPath, kRecordPaths));
      cuts_lx.push_back(cut_lx(task.receiver));
      paths += task.end - task.begin;
    }
    const std::size_t wanted = tails_->records().size() == 0
                                   ? std::max(kFewestRecords, kFirstRecords * chunk.size())
                                   : paths / (chunk.size() < kFewestSharing ? kPathsPerRecord / 2 : kPathsPerRecord);
    const std::size_t memory_allows = kMostRecordBytes / (kReplicates * 3 * sizeof(float) * emitters_.size());
    const std::size_t room = std::min(kMostRecords, memory_allows) - std::min(kMostRecords, tails_->records().size());
    matrix_.rays += tails_->grow(from, std::min(wanted, room), kRecordPaths, pools_, plans, cuts_lx, options_.threads,
                                 options_.watch);
  }

  /// Reflected lux at the levels in one replicate, summed over samples.
  double sum_lx(std::size_t replicate, std::size_t r) const {
    const auto row = row_of(replicate, r);
    double sum = 0;
    for (Eigen::Index e = 0; e < levels_.size(); ++e) sum += levels_[e] * luminance(row, e);
    return sum;
  }

  template <class Row>
  double luminance(const Row& row, Eigen::Index emitter) const {
    if (channels_ == 1) return row[emitter];
    const Eigen::Index n = levels_.size();
    return 0.2126 * row[emitter] + 0.7152 * row[n + emitter] + 0.0722 * row[2 * n + emitter];
  }

  /// Over all replicates, the task included.
  double mean_reflected_lx(const Task& task) const {
    double sum = 0;
    for (std::size_t k = 0; k < kReplicates; ++k) sum += sum_lx(k, task.receiver);
    return sum / (static_cast<double>(kReplicates) * task.end);
  }

  void estimate(std::size_t r) {
    std::array<double, kReplicates> reflected{};
    double mean_lx = 0;
    for (std::size_t k = 0; k < kReplicates; ++k) {
      reflected[k] = sum_lx(k, r) / spent_[r].samples;
      mean_lx += reflected[k] / kReplicates;
    }
    spent_[r].direct_lx = matrix_.direct_lux_per_level.row(static_cast<Eigen::Index>(r)).dot(levels_);
    spent_[r].reflected_lx = mean_lx;
    spent_[r].lux = mean_lx + spent_[r].direct_lx;
    spent_[r].error_lx = standard_error_of_mean(reflected);
    const double scatter = spent_[r].error_lx * spent_[r].error_lx * spent_[r].samples;
    if (!tails_ || spent_[r].samples < kSamplesToTellScatter) return;
    spent_[r].least_scatter = std::min(spent_[r].least_scatter, scatter);
    spent_[r].alone = spent_[r].alone || scatter > kMostScatter * spent_[r].least_scatter;
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
            matrix_.rgb_per_level[c](r, e) +=
                row[static_cast<Eigen::Index>(c) * levels_.size() + e] / (samples * kReplicates);
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

  bool bias_is_known() const {
    const auto bias = record_bias_.measured();
    return bias && bias->error < kBiasPart * options_.wanted_relative_error / kStopMargin;
  }

  /// Takes the records' common bias, as the checked paths show it, out of what was taken from them; and adds what
  /// remains unsure to every replicate, up and down in turn, so that standard errors contain it.
  void own_up_to_bias() {
    const auto believed = record_bias_.believed();
    if (!believed) return;
    const auto [bias, error] = *believed;
    // Half up and half down by `a` gives a standard error of a · √(16/15) / 4, times Student's factor.
    const double up_and_down = error * 4 / (std::sqrt(16.0 / 15) * student_t_975(kReplicates - 1) / student_t_975(1e9));
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      Spent& spent = spent_[r];
      const double reflected_lx = spent.reflected_lx;
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
  double done_after(const std::vector<Task>& round) const {
    double spent = 0, left = 0;
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      spent += spent_[r].samples;
      const double factor = std::min(overshoot(r), 1e3);
      if (factor > 1) left += spent_[r].samples * std::max(1.0, factor * factor - 1);
    }
    double part = 0;
    for (const Task& task : round) part += task.end - task.begin;
    if (spent == 0) return round.empty() ? done_ : 0.1;
    return std::clamp((spent + part) / (spent + std::max(left, part)), done_, 1.0);
  }

  const RayScene& scene_;
  std::span<const Receiver> receivers_;
  std::span<const Emitter> emitters_;
  const EvaluateOptions& options_;
  TransportMatrix matrix_;
  std::vector<Bsdf> bsdfs_;
  SkyOpenings openings_;
  Lamps lamps_;
  std::size_t channels_, columns_;
  std::vector<double> importance_;
  PathSampler sampler_;
  Eigen::VectorXd levels_;
  ReceiverHits hits_;
  std::vector<HitPool> pools_;  ///< by replicate
  std::vector<HitPlan> plans_;  ///< by task of the chunk
  std::optional<SharedTails> tails_;
  RecordBias record_bias_;
  std::vector<Spent> spent_;
  std::vector<Eigen::MatrixXd> direct_replicates_;  ///< empty when the direct part is exact
  std::vector<RowMatrix> sums_;  ///< per replicate: reflected light, receivers × emitters, summed over samples
  double brightest_lx_ = 0;
  double done_ = 0;
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
