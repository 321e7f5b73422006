/// Bidirectional path tracing with randomised quasi-Monte-Carlo samples, distributed by error.
///
/// Each receiver has 16 replicates: estimates from independent scrambles of one Sobol sequence. Their spread gives the
/// standard error. All replicates of a receiver have the same number of samples, which grows until the error is as
/// wanted.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/parallel.h"
#include "core/transport/direct/direct_light.h"
#include "core/transport/paths/adaptive_sampling.h"
#include "core/transport/paths/irradiance_cache.h"
#include "core/transport/paths/light_vertex_planner.h"
#include "core/transport/paths/path_sampler.h"
#include "core/transport/paths/receiver_lookups.h"
#include "core/transport/paths/record_bias.h"
#include "core/transport/paths/replicate_sums.h"
#include "core/transport/progress.h"
#include "core/transport/replicate_error.h"
#include "core/transport/sky/sky_opening_finder.h"

namespace luxrig {
namespace {

constexpr std::size_t kPathReplicates = ReplicateSums::kReplicates;
/// Samples per filling of the pools of light vertices.
constexpr std::uint32_t kChunk = 512;
/// Hits that each path of a receiver is joined with.
constexpr std::uint32_t kHitsPerPath = 4;
/// Light of sources with size is sampled, too: to a closer error than the total, so that it does not delay it.
constexpr double kDirectMargin = 5;
/// Connections worth less than this share of a path's mean are made only occasionally.
constexpr double kCut = 0.1;
/// With shared tails: initial records per receiver and replicate for a standard error of 1 % and their limits; later
/// one record for a fixed number of paths of the receivers, each with a fixed number of its own paths. Few records that
/// end in one another follow the same few ways repeatedly and are too bright; twice as many records halve that.
constexpr double kFirstRecords = 8, kMinFirst = 6, kMaxFirst = 48;
constexpr std::size_t kMinRecords = 256;
constexpr std::size_t kPathsPerRecord = 4;
constexpr std::uint32_t kRecordPaths = 4, kHitsPerRecordPath = 4;
/// With fewer receivers, own paths gain more than shared noise.
constexpr std::size_t kMinSharing = 24;
/// Upper limit of the share that a bright place sends to a receiver: usually its light takes two surfaces or more, or
/// one that also sends it elsewhere.
constexpr double kMaxSentOn = 0.5;
constexpr std::size_t kMaxRecords = 1u << 15, kMaxRecordBytes = 256u << 20;
/// One in so many paths continues beside its record, to measure the records' bias; fewer once the bias is known to this
/// share of the wanted error.
constexpr std::uint32_t kCheckedPaths = 8, kSeldomCheckedPaths = 64;
constexpr double kBiasPart = 0.3;

Eigen::VectorXd levels_of(const EvaluateOptions& options, std::size_t emitters) {
  Eigen::VectorXd levels = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(emitters));
  for (std::size_t e = 0; e < options.levels.size(); ++e) levels[static_cast<Eigen::Index>(e)] = options.levels[e];
  return levels;
}

/// Amount `a` by which half of the replicates go up and half down for a given standard error: they give a standard
/// error of a · √(16/15) / 4, times Student's factor.
double up_and_down_of(double error) {
  return error * 4 / (std::sqrt(16.0 / 15) * student_t_975(kPathReplicates - 1) / student_t_975(1e9));
}

class PathEvaluation {
 public:
  PathEvaluation(const RayScene& scene, std::span<const Receiver> receivers, std::span<const Emitter> emitters,
                 const EvaluateOptions& options, bool shares_tails)
      : scene_(scene),
        receivers_(receivers),
        emitters_(emitters),
        options_(options),
        colour_of_emitters_(3, static_cast<Eigen::Index>(emitters.size())),
        bsdfs_(bsdfs_of(scene)),
        openings_(
            find_sky_openings(scene, receivers, emitters, options.seed, options.threads, options.watch, matrix_.rays)),
        lamps_(emitters, options.levels, scene.bounds_world_m(), &openings_),
        channels_(options.colour ? 3 : 1),
        columns_(emitters.size() * channels_),
        importance_(emitters.size()),
        images_(scene, lamps_),
        sampler_(scene, lamps_, bsdfs_, images_, importance_),
        levels_(levels_of(options, emitters.size())),
        hits_(lamps_, receivers.size()),
        spent_(receivers.size(), options, std::min(kMaxSentOn, largest_reflectance(scene)),
               shares_tails && receivers.size() >= kMinSharing ? kRecordPaths : 1),
        sums_(0, channels_, levels_) {
    for (std::size_t e = 0; e < emitters.size(); ++e) {
      importance_[e] = lamps_.importance(e);
      colour_of_emitters_.col(static_cast<Eigen::Index>(e)) = emitters[e].colour_rgb;
    }
    if (shares_tails) tails_.emplace(scene_, sampler_, bsdfs_, emitters.size(), kPathReplicates, options.seed);
  }

  Result<TransportMatrix> run() {
    const bool reflects = obstacles_in(scene_) && !emitters_.empty() && !receivers_.empty() &&
                          std::any_of(bsdfs_.begin(), bsdfs_.end(), [](const Bsdf& b) { return !b.black(); });
    EvaluateOptions direct_options = options_;
    for (double* wanted : {&direct_options.wanted_relative_error, &direct_options.wanted_rms_error})
      *wanted /= reflects ? kDirectMargin : 1;
    auto direct = direct_light(scene_, receivers_, emitters_, direct_options, reflects ? 0.05 : 1.0, &openings_);
    if (!direct) return tl::unexpected(std::move(direct.error()));
    matrix_.direct_lux_per_level = std::move(direct->lux_per_level);
    direct_replicates_ = std::move(direct->replicates);
    matrix_.rays += direct->rays;
    if (!reflects) {
      matrix_.lux_per_level = matrix_.direct_lux_per_level;
      matrix_.replicates = std::move(direct_replicates_);
      matrix_.relative_error = direct->relative_error;
      matrix_.rms_error = direct->rms_error;
      matrix_.floor_lx = direct->floor_lx;
      if (channels_ == 3) start_colours();
      return std::move(matrix_);
    }
    sums_ = ReplicateSums(receivers_.size(), channels_, levels_);
    if (images_.any()) {
      images_seen_.resize(receivers_.size());
      parallel_for(receivers_.size(), options_.threads, [&](std::size_t r) {
        images_seen_[r] = images_.seen_from(receivers_[r].position_world_m, receivers_[r].normal_world);
      });
    }
    if (tails_) ends_.emplace(sampler_, *tails_, receivers_.size(), levels_);
    done_ = 0.05;
    for (auto round = spent_.first(matrix_.rays); !round.empty();) {
      if (!sample(round)) return tl::unexpected(Fault{Cause::cancelled, "", "stopped while tracing paths", {}});
      if (options_.enough.stop_requested()) break;
      std::vector<std::size_t> others = not_in(round);
      round = spent_.next(matrix_.rays);
      if (!round.empty() || !ends_ || others.empty()) continue;
      // The others were done with fewer records than there are now, and are judged again with all.
      judge(others);
      round = spent_.next(matrix_.rays);
    }
    finish();
    return std::move(matrix_);
  }

 private:
  /// Processes the tasks of a round, a chunk of each at a time.
  bool sample(const std::vector<PathTask>& round) {
    std::size_t parts = 0;
    for (const PathTask& task : round) parts += (task.end - task.begin + kChunk - 1) / kChunk * kPathReplicates;
    CallingThreadProgress progress(options_.watch, done_, spent_.done_after(round, done_), parts);
    for (std::vector<PathTask> left = round; !left.empty();) {
      std::vector<PathTask> chunk = left;
      for (PathTask& task : chunk) task.end = std::min(task.end, task.begin + kChunk);
      sample_chunk(chunk, progress);
      if (options_.watch.stop.stop_requested()) return false;
      for (std::size_t i = 0; i < left.size(); ++i) left[i].begin = spent_[chunk[i].receiver].samples = chunk[i].end;
      std::erase_if(left, [](const PathTask& task) { return task.begin == task.end; });
      if (options_.enough.stop_requested()) break;
    }
    std::vector<std::size_t> sampled;
    for (const PathTask& task : round) sampled.push_back(task.receiver);
    judge(sampled);
    return true;
  }

  /// Recomputes the results of some receivers from everything so far.
  void judge(const std::vector<std::size_t>& receivers) {
    if (ends_) {
      const auto rays = ends_->look_up(receivers, options_.threads);
      for (std::size_t i = 0; i < receivers.size(); ++i) spent_[receivers[i]].rays += rays[i], matrix_.rays += rays[i];
    }
    for (const std::size_t r : receivers) estimate(r);
    if (ends_) judge_records();
    done_ = spent_.done_after({}, done_);
    spent_.find_floor();
  }

  [[nodiscard]] std::vector<std::size_t> not_in(const std::vector<PathTask>& round) const {
    std::vector<bool> in(receivers_.size(), false);
    for (const PathTask& task : round) in[task.receiver] = true;
    std::vector<std::size_t> others;
    for (std::size_t r = 0; r < in.size(); ++r)
      if (!in[r]) others.push_back(r);
    return others;
  }

  void sample_chunk(const std::vector<PathTask>& chunk, CallingThreadProgress& progress) {
    plans_.clear();
    for (const PathTask& task : chunk) plans_.push_back(hits_.plan(task.receiver, kHitsPerPath, task.end - task.begin));
    fill_pools(chunk);
    join_hits(chunk);
    const bool shares_now = tails_ && (chunk.size() >= kMinSharing || tails_->records(0).size() > 0);
    if (shares_now) grow_tails(chunk);
    trace_paths(chunk, shares_now, progress);
  }

  void trace_paths(const std::vector<PathTask>& chunk, bool shares_now, CallingThreadProgress& progress) {
    std::vector<std::uint64_t> rays(chunk.size() * kPathReplicates, 0);
    std::vector<TailShare> told(rays.size());
    std::size_t paths = 0;
    for (const PathTask& task : chunk) paths += kPathReplicates * (task.end - task.begin);
    const bool keeps_ends = shares_now && ends_->have_room(paths);
    const std::uint32_t checked = bias_is_known() ? kSeldomCheckedPaths : kCheckedPaths;
    parallel_for(rays.size(), options_.threads, [&](std::size_t task) {
      // A replicate's records and hits stay in the cache while all receivers use them.
      const std::size_t k = task / chunk.size(), i_chunk = task % chunk.size();
      const auto& [r, begin, end] = chunk[i_chunk];
      const SobolSequence samples(mixed(mixed(options_.seed, r), k));
      PathScratch scratch;
      std::vector<double> values(columns_, 0.0);
      TailShare tails;
      if (shares_now && !spent_[r].alone) tails.records = &tails_->records(k);
      if (keeps_ends) tails.ends = &ends_->of(r, k);
      const auto start = start_at(r);
      for (std::uint32_t i = begin; i < end; ++i) {
        if (options_.watch.stop.stop_requested()) return;
        tails.check = i % checked == r % checked;
        rays[task] += sampler_.add_path(start, samples, i, pools_[k], plans_[i_chunk], cut_lx(r), scratch,
                                        {values, channels_}, &tails);
      }
      told[task] = tails;
      sums_.add(k, r, values);
      progress.one_done();
    });
    for (std::size_t task = 0; task < rays.size(); ++task) {
      ReceiverProgress& spent = spent_[chunk[task % chunk.size()].receiver];
      spent.rays += rays[task];
      spent.taken_lx += told[task].taken_lx;
      matrix_.rays += rays[task];
    }
  }

  [[nodiscard]] PathSampler::Vertex start_at(std::size_t r) const {
    auto start = PathSampler::at(receivers_[r]);
    if (!images_seen_.empty()) start.images = &images_seen_[r];
    return start;
  }

  /// A receiver's connections worth less are made only occasionally.
  double cut_lx(std::size_t r) const { return kCut * spent_[r].reflected_lx; }

  /// Fills the pools with as many light vertices as the plans need.
  void fill_pools(const std::vector<PathTask>& chunk) {
    std::vector<std::uint32_t> paths;
    for (const PathTask& task : chunk) paths.push_back(task.end - task.begin);
    const auto counts = LightVertexPlanner::pool_counts(lamps_, plans_, paths);
    const LightTracer lights(scene_, lamps_, bsdfs_, &images_);
    pools_.resize(kPathReplicates);
    std::vector<std::uint64_t> rays(kPathReplicates, 0);
    parallel_for(kPathReplicates, options_.threads, [&](std::size_t k) {
      EmitterSampler::Weights weights;
      if (!options_.watch.stop.stop_requested())
        rays[k] = pools_[k].refill(lights, mixed(mixed(options_.seed, 0x11647), k), counts, weights);
    });
    for (const std::uint64_t n : rays) matrix_.rays += n;
  }

  /// Joins the receivers with light vertices, and learns which lamps matter to which receiver.
  void join_hits(const std::vector<PathTask>& chunk) {
    if (options_.watch.stop.stop_requested()) return;
    const std::size_t groups = lamps_.groups();
    std::vector<std::uint64_t> rays(chunk.size(), 0);
    parallel_for(chunk.size(), options_.threads, [&](std::size_t i) {
      const auto& [r, begin, end] = chunk[i];
      const std::uint32_t samples = end - begin;
      ReceiverProgress& spent = spent_[r];
      std::vector<LightVertexRange> stretches;
      std::vector<double> squares(groups);
      std::vector<double> values(columns_);
      for (std::size_t k = 0; k < kPathReplicates; ++k) {
        const std::uint64_t key = mixed(mixed(mixed(options_.seed, r), k), 0x101a + begin);
        draw_stretches(plans_[i], pools_[k], samples, key, stretches);
        std::fill(values.begin(), values.end(), 0.0);
        std::fill(squares.begin(), squares.end(), 0.0);
        rays[i] += sampler_.join_start(start_at(r), pools_[k], plans_[i], stretches, cut_lx(r), mixed(key, groups),
                                       {values, channels_}, squares);
        hits_.learn(r, squares, stretches);
        sums_.add(k, r, values);
      }
      if (begin == 0) spent.reflected_lx = sums_.mean_reflected_lx(r, end);
    });
    for (std::size_t i = 0; i < chunk.size(); ++i) {
      spent_[chunk[i].receiver].rays += rays[i];
      matrix_.rays += rays[i];
    }
  }

  /// Adds records for a chunk: many at first, so that all receivers have one near wherever they look; then as many as
  /// keep their noise and distance in step with the receivers' own noise.
  void grow_tails(const std::vector<PathTask>& chunk) {
    std::vector<Receiver> from;
    std::vector<LightVertexPlan> plans;
    std::vector<double> cuts_lx;
    std::size_t paths = 0;
    for (const PathTask& task : chunk) {
      if (spent_[task.receiver].alone) continue;
      from.push_back(receivers_[task.receiver]);
      plans.push_back(hits_.plan(task.receiver, kHitsPerRecordPath, kRecordPaths));
      cuts_lx.push_back(cut_lx(task.receiver));
      paths += task.end - task.begin;
    }
    if (from.empty()) return;  // all continue by themselves
    const std::size_t wanted = tails_->records(0).size() == 0
                                   ? std::max(kMinRecords, first_records_each() * chunk.size())
                                   : paths / (chunk.size() < kMinSharing ? kPathsPerRecord / 2 : kPathsPerRecord);
    const std::size_t memory_allows = kMaxRecordBytes / (kPathReplicates * 2 * 3 * sizeof(float) * emitters_.size());
    const std::size_t room = std::min(kMaxRecords, memory_allows) - std::min(kMaxRecords, tails_->records(0).size());
    matrix_.rays += tails_->grow(from, std::min(wanted, room), kRecordPaths, pools_, plans, cuts_lx, options_.threads,
                                 options_.watch);
    // Where everything shines, records have no place: paths end by themselves and find as much as one does.
    if (tails_->records(0).size() == 0)
      for (const PathTask& task : chunk) spent_[task.receiver].alone = true;
  }

  /// Initial records per receiver: their bias should fall with the wanted error.
  std::size_t first_records_each() const {
    const double records = kFirstRecords * std::pow(0.01 / options_.wanted_standard_error(), 1.5);
    return static_cast<std::size_t>(std::clamp(records, kMinFirst, kMaxFirst));
  }

  void estimate(std::size_t r) {
    auto reflected = sums_.reflected_lx(r, spent_[r].samples);
    for (std::size_t k = 0; k < kPathReplicates && ends_; ++k)
      reflected[k] += ends_->taken_lx(r, k) / spent_[r].samples;
    double mean_lx = 0;
    for (const double lux : reflected) mean_lx += lux / kPathReplicates;
    spent_[r].found = sums_.found(r) || mean_lx > 0;
    spent_[r].direct_lx = matrix_.direct_lux_per_level.row(static_cast<Eigen::Index>(r)).dot(levels_);
    spent_[r].reflected_lx = mean_lx;
    spent_[r].lux = mean_lx + spent_[r].direct_lx;
    spent_[r].error_lx = standard_error_of_mean(reflected);
    spent_.judge_sharing(r);
  }

  void finish() {
    const auto n = static_cast<Eigen::Index>(receivers_.size());
    Eigen::MatrixXd reflected = Eigen::MatrixXd::Zero(n, levels_.size());
    if (channels_ == 3) start_colours();
    if (ends_) {
      matrix_.rays += ends_->take(sums_, channels_, options_.threads);
      for (std::size_t r = 0; r < receivers_.size(); ++r) estimate(r);
      judge_records();
      spent_.find_floor();
    }
    std::vector<std::uint32_t> samples;
    for (std::size_t r = 0; r < receivers_.size(); ++r) samples.push_back(spent_[r].samples);
    for (std::size_t k = 0; k < kPathReplicates; ++k) {
      const Eigen::MatrixXd replicate = sums_.take(k, samples, matrix_.rgb_per_level);
      reflected += replicate / kPathReplicates;
      matrix_.replicates.emplace_back(
          replicate + (direct_replicates_.empty() ? matrix_.direct_lux_per_level : direct_replicates_[k]));
    }
    matrix_.lux_per_level = matrix_.direct_lux_per_level + reflected;
    if (!direct_replicates_.empty()) {
      const Eigen::VectorXd error_lx = matrix_.standard_error_lux(levels_);
      for (std::size_t r = 0; r < receivers_.size(); ++r) spent_[r].error_lx = error_lx[static_cast<Eigen::Index>(r)];
    }
    if (tails_) own_up_to_bias();
    own_up_to_unfound();
    matrix_.floor_lx = spent_.floor_lx();
    for (std::size_t r = 0; r < receivers_.size(); ++r)
      matrix_.relative_error = std::max(matrix_.relative_error, spent_.relative_error(r));
    matrix_.rms_error = spent_.rms_error();
    if (options_.watch.progress) options_.watch.progress(1.0);
  }

  bool bias_is_known() const {
    const auto bias = record_bias_.measured();
    return bias && bias->error < kBiasPart * options_.wanted_standard_error();
  }

  /// Finds the records' bias, and the part of it that no receiver can know.
  void judge_records() {
    record_bias_ = ends_->bias(spent_);
    const auto believed = record_bias_.believed();
    for (std::size_t r = 0; r < receivers_.size() && believed; ++r)
      spent_[r].shared_error_lx = share_of_records(r) * believed->error * spent_[r].reflected_lx;
  }

  /// Share of records in a receiver's reflected light.
  [[nodiscard]] double share_of_records(std::size_t r) const {
    const ReceiverProgress& spent = spent_[r];
    const double taken_lx = (spent.taken_lx + ends_->important_lx(r)) /
                            (kPathReplicates * std::max(1.0, static_cast<double>(spent.samples)));
    return spent.reflected_lx > 0 ? std::clamp(taken_lx / spent.reflected_lx, 0.0, 1.0) : 0;
  }

  /// Subtracts the records' common bias, as the checked paths show it, from the light taken from them. Adds the
  /// remaining uncertainty to every replicate, up and down in turn, so that standard errors contain it.
  void own_up_to_bias() {
    const auto believed = record_bias_.believed();
    if (!believed) return;
    const auto [bias, error] = *believed;
    std::vector<Eigen::MatrixXd> direct_rgb;
    for (std::size_t c = 0; c < matrix_.rgb_per_level.size(); ++c) direct_rgb.push_back(direct_of_primary(c));
    const double up_and_down = up_and_down_of(error);
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      const double share = share_of_records(r);
      if (!(share > 0)) continue;
      const auto row = static_cast<Eigen::Index>(r);
      const auto reflected = (matrix_.lux_per_level.row(row) - matrix_.direct_lux_per_level.row(row)).eval();
      matrix_.lux_per_level.row(row) -= share * bias / (1 + bias) * reflected;
      for (std::size_t c = 0; c < matrix_.rgb_per_level.size(); ++c)
        matrix_.rgb_per_level[c].row(row) -=
            share * bias / (1 + bias) * (matrix_.rgb_per_level[c].row(row) - direct_rgb[c].row(row));
      for (std::size_t k = 0; k < kPathReplicates; ++k)
        matrix_.replicates[k].row(row) -=
            share * (bias / (1 + bias) + (k % 2 == 0 ? up_and_down : -up_and_down)) * reflected;
    }
  }

  /// Adds to every replicate, up and down, the light of each emitter that paths may have missed, as far as it exceeds
  /// the replicates' spread; the mean stays. One more path would bring the light of one bright place. In the sum under
  /// the levels that is less than one such place per emitter, so there the patterns cancel the excess.
  void own_up_to_unfound() {
    const Eigen::Index emitters = matrix_.emitters();
    const auto replicates = static_cast<Eigen::Index>(kPathReplicates);
    // Walsh functions: half up and half down, each orthogonal to all others. The first is used for the bias.
    Eigen::MatrixXd up_and_down(emitters, replicates);
    for (Eigen::Index e = 0; e < emitters; ++e)
      for (Eigen::Index k = 0; k < replicates; ++k) {
        const auto pattern = static_cast<unsigned>(2 + e % (replicates - 2));
        up_and_down(e, k) = std::popcount(pattern & static_cast<unsigned>(k)) % 2 != 0 ? -1 : 1;
      }
    const Eigen::VectorXd brightest_lx = matrix_.lux_per_level.colwise().maxCoeff();
    const auto more_than_spread = [](double unfound_lx, const Eigen::RowVectorXd& lux) {
      const double spread_lx = standard_error_of_mean({lux.data(), kPathReplicates}),
                   both_lx = AdaptiveSampling::with_unfound_lx(spread_lx, unfound_lx);
      return std::sqrt(std::max(0.0, (both_lx - spread_lx) * (both_lx + spread_lx)));
    };
    parallel_for(receivers_.size(), options_.threads, [&](std::size_t r) {
      const auto row = static_cast<Eigen::Index>(r);
      Eigen::MatrixXd lux(emitters, replicates), by_lx = up_and_down;
      for (Eigen::Index k = 0; k < replicates; ++k)
        lux.col(k) = matrix_.replicates[static_cast<std::size_t>(k)].row(row).transpose();
      for (Eigen::Index e = 0; e < emitters; ++e)
        by_lx.row(e) *= more_than_spread(spent_.unfound_lx(r, brightest_lx[e]), lux.row(e));
      const Eigen::RowVectorXd all_by_lx = levels_.transpose() * by_lx;
      const double sum_lx = all_by_lx.norm() / std::sqrt(static_cast<double>(replicates)),
                   wanted_lx = more_than_spread(spent_.unfound_lx(r, spent_.brightest_lx()), levels_.transpose() * lux);
      const Eigen::VectorXd shares = levels_.cwiseAbs2().cwiseProduct(by_lx.rowwise().squaredNorm());
      for (Eigen::Index e = 0; e < emitters && sum_lx > wanted_lx; ++e)
        if (shares[e] > 0)
          by_lx.row(e) -= shares[e] / (shares.sum() * levels_[e]) * (1 - wanted_lx / sum_lx) * all_by_lx;
      for (Eigen::Index k = 0; k < replicates; ++k)
        matrix_.replicates[static_cast<std::size_t>(k)].row(row) += up_and_down_of(1) * by_lx.col(k).transpose();
    });
  }

  /// The direct part by primary.
  [[nodiscard]] Eigen::MatrixXd direct_of_primary(std::size_t c) const {
    return matrix_.direct_lux_per_level * colour_of_emitters_.row(static_cast<Eigen::Index>(c)).asDiagonal();
  }
  void start_colours() {
    for (std::size_t c = 0; c < 3; ++c) matrix_.rgb_per_level.push_back(direct_of_primary(c));
  }

  const RayScene& scene_;
  std::span<const Receiver> receivers_;
  std::span<const Emitter> emitters_;
  const EvaluateOptions& options_;
  TransportMatrix matrix_;
  Eigen::Matrix3Xd colour_of_emitters_;  ///< linear Rec. 709
  std::vector<Bsdf> bsdfs_;
  SkyOpenings openings_;
  EmitterSampler lamps_;
  std::size_t channels_, columns_;
  std::vector<double> importance_;
  MirrorImages images_;
  std::vector<ImageChoice> images_seen_;  ///< by receiver; empty if there are none
  PathSampler sampler_;
  Eigen::VectorXd levels_;
  LightVertexPlanner hits_;
  std::vector<LightVertexPool> pools_;  ///< by replicate
  std::vector<LightVertexPlan> plans_;  ///< by task of the chunk
  std::optional<IrradianceCache> tails_;
  std::optional<ReceiverLookups> ends_;  ///< only with tails
  RecordBias record_bias_;
  AdaptiveSampling spent_;
  std::vector<Eigen::MatrixXd> direct_replicates_;  ///< empty when the direct part is exact
  ReplicateSums sums_;
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
    return PathEvaluation(scene_, receivers, emitters, options, shares_tails_).run();
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
