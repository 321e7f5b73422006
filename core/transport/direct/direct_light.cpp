#include "core/transport/direct/direct_light.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "core/transport/direct/direct_sources.h"
#include "core/transport/direct/shape_light.h"
#include "core/transport/error_floor.h"
#include "core/transport/progress.h"
#include "core/transport/replicate_error.h"
#include "core/transport/sky/sky_opening_finder.h"

namespace luxrig {

const RayScene* obstacles_in(const RayScene& scene) {
  return scene.bounds_world_m().isEmpty() && !scene.has_panes() ? nullptr : &scene;
}

namespace {

constexpr std::size_t kDirectReplicates = 16;
constexpr std::uint32_t kFirstSamples = 16;  ///< per replicate
constexpr std::uint32_t kMaxSamples = 1u << 26;
/// Shadow edges mostly run along or across a lamp, and so along the strata of the samples: of N strata one is cut, and
/// each replicate finds it lit or dark, with probabilities p and 1-p. If all 16 agree by chance (one time in eight for
/// p anywhere in 0…1), their spread shows nothing. The rule of succession, p = 1/18, gives the error to expect: √(p
/// (1-p) / 16) of a stratum.
constexpr double kDoubtPerStratum = 0.057;
/// From this many samples per replicate on, a result of no light, or no loss, is believed.
constexpr std::uint32_t kSamplesToBelieve = 64;

tl::unexpected<Fault> stopped() {
  return tl::unexpected(Fault{Cause::cancelled, "", "stopped while computing direct light", {}});
}

/// A receiver, and an emitter that may be partly blocked or is a sky.
struct Pair {
  std::size_t receiver, emitter;
  Way way;
  std::uint32_t samples = 0;                               ///< per replicate
  std::array<double, kDirectReplicates> lux{};             ///< sums over samples
  std::array<DirectSum::Part, DirectSum::kParts> parts{};  ///< sums over samples and replicates
  std::uint64_t rays = 0;

  [[nodiscard]] double mean_lux() const {
    double sum = 0;
    for (const double one : lux) sum += one;
    return samples > 0 ? sum / (static_cast<double>(kDirectReplicates) * samples) : 0;
  }
  [[nodiscard]] double doubt_lx() const {
    double doubt = 0;
    for (const DirectSum::Part& part : parts) {
      const double strata = static_cast<double>(part.samples) / kDirectReplicates;
      const bool all_or_nothing = part.lux == 0 || part.lux == part.unobstructed_lux;
      if (way == Way::clear || !(strata > 0) || (all_or_nothing && strata >= kSamplesToBelieve)) continue;
      doubt += kDoubtPerStratum * part.unobstructed_lux / (static_cast<double>(kDirectReplicates) * samples) / strata;
    }
    return doubt;
  }

  /// The replicates' estimates, with the doubt added to their spread in a balanced pattern, different for each pair.
  [[nodiscard]] std::array<double, kDirectReplicates> estimates() const {
    std::array<double, kDirectReplicates> means{};
    const double spread = doubt_lx() * std::sqrt(kDirectReplicates - 1.0);
    std::uint64_t sign = mixed(receiver, emitter);
    for (std::size_t k = 0; k < kDirectReplicates; k += 2, sign >>= 1) {
      means[k] = lux[k] / samples + (sign & 1 ? spread : -spread);
      means[k + 1] = lux[k + 1] / samples - (sign & 1 ? spread : -spread);
    }
    return means;
  }

  /// Standard error [lx at level 1].
  [[nodiscard]] double error_lx() const { return standard_error_of_mean(estimates()); }
};

class Evaluation {
 public:
  Evaluation(const RayScene& scene, std::span<const Receiver> receivers, std::span<const Emitter> emitters,
             const EvaluateOptions& options, double progress_end, const SkyOpenings* openings)
      : scene_(scene),
        receivers_(receivers),
        emitters_(emitters),
        options_(options),
        progress_end_(progress_end),
        sources_(emitters),
        openings_(openings),
        levels_(emitters.size(), 1.0) {
    if (!options.levels.empty()) levels_ = options.levels;
  }

  Result<DirectLight> run() {
    direct_.lux_per_level = Eigen::MatrixXd::Zero(index(receivers_.size()), index(emitters_.size()));
    const double exact_share = sources_.extended().empty() ? 1 : 0.3;
    if (!exact_part(exact_share * progress_end_)) return stopped();
    lux_.resize(receivers_.size());
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      for (std::size_t e = 0; e < emitters_.size(); ++e)
        lux_[r] += levels_[e] * direct_.lux_per_level(index(r), index(e));
    }
    exact_lux_ = lux_;
    done_ = exact_share * progress_end_;
    if (!openings_) find_openings();
    for (auto round = all_pairs(); !round.empty(); round = next_round())
      if (!sample(round)) return stopped();
    finish();
    return std::move(direct_);
  }

 private:
  static Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

  bool exact_part(double progress_end) {
    const RayScene* obstacles = obstacles_in(scene_);
    std::vector<std::uint64_t> rays(receivers_.size(), 0);
    std::vector<std::vector<Pair>> pairs(receivers_.size());
    CallingThreadProgress progress(options_.watch, 0, progress_end, receivers_.size());
    parallel_for(receivers_.size(), options_.threads, [&](std::size_t r) {
      if (options_.watch.stop.stop_requested()) return;
      const Receiver& receiver = receivers_[r];
      DirectSources::Scratch scratch;
      rays[r] = sources_.add_points(obstacles, receiver, scratch, [&](std::size_t e, double lux) {
        direct_.lux_per_level(index(r), index(e)) = lux;
      });
      for (const std::size_t e : sources_.extended()) {
        if (options_.watch.stop.stop_requested()) return;
        if (!sources_.may_light(e, receiver)) continue;
        const Way way = way_between(scene_, receiver, emitters_[e], rays[r]);
        if (way == Way::blocked) continue;
        if (way == Way::clear && emitters_[e].sky && receiver.normal_world == Vec3::UnitZ()) {
          direct_.lux_per_level(index(r), index(e)) = emitters_[e].sky->horizontal_illuminance_lx();
        } else if (way == Way::clear && !emitters_[e].sky) {
          direct_.lux_per_level(index(r), index(e)) =
              shape_light(receiver.position_world_m, receiver.normal_world, emitters_[e]).lux;
        } else {
          pairs[r].push_back({.receiver = r, .emitter = e, .way = way});
        }
      }
      progress.one_done();
    });
    if (options_.watch.stop.stop_requested()) return false;
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      direct_.rays += rays[r];
      pairs_of_.push_back(pairs_.size());
      pairs_.insert(pairs_.end(), pairs[r].begin(), pairs[r].end());
    }
    pairs_of_.push_back(pairs_.size());
    return true;
  }

  void find_openings() {
    openings_ = &found_;
    const bool sky =
        std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& p) { return emitters_[p.emitter].sky != nullptr; });
    if (sky && obstacles_in(scene_))
      found_ = find_sky_openings(scene_, receivers_, emitters_, options_.seed, options_.threads, options_.watch,
                                 direct_.rays);
  }

  std::vector<std::size_t> all_pairs() const {
    std::vector<std::size_t> all(pairs_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
  }

  bool sample(const std::vector<std::size_t>& round) {
    const double end = round.size() == pairs_.size() ? 0.5 * (done_ + progress_end_) : 0.9 * progress_end_;
    CallingThreadProgress progress(options_.watch, done_, std::max(done_, end), round.size());
    parallel_for(round.size(), options_.threads, [&](std::size_t i) {
      Pair& pair = pairs_[round[i]];
      if (pair.samples > 0 && options_.enough.stop_requested()) return;
      const std::uint32_t begin = pair.samples, last = begin == 0 ? kFirstSamples : 2 * begin;
      DirectSources::Scratch scratch;
      for (std::size_t k = 0; k < kDirectReplicates; ++k) {
        if (options_.watch.stop.stop_requested()) return;
        const SobolSequence samples(mixed(mixed(mixed(options_.seed, pair.receiver), pair.emitter + 0x5a1a), k));
        // In stretches, which limits memory and the delay of a stop.
        for (std::uint32_t from = begin; from < last; from += std::min(last - from, 4096u)) {
          if (options_.watch.stop.stop_requested()) return;
          const DirectSum sum = sample_direct(scene_, receivers_[pair.receiver], emitters_[pair.emitter], pair.way,
                                              *openings_, samples, from, from + std::min(last - from, 4096u), scratch);
          for (std::size_t part = 0; part < DirectSum::kParts; ++part) {
            pair.lux[k] += sum.parts[part].lux;
            pair.parts[part].lux += sum.parts[part].lux;
            pair.parts[part].unobstructed_lux += sum.parts[part].unobstructed_lux;
            pair.parts[part].samples += sum.parts[part].samples;
          }
          pair.rays += sum.rays;
        }
      }
      pair.samples = last;
      progress.one_done();
    });
    if (options_.watch.stop.stop_requested()) return false;
    done_ = std::max(done_, end);
    rays_sampled_ = 0;
    for (const Pair& pair : pairs_) rays_sampled_ += pair.rays;
    lux_ = exact_lux_;
    for (const Pair& pair : pairs_) lux_[pair.receiver] += levels_[pair.emitter] * pair.mean_lux();
    floor_lx_ = error_floor_lx(options_, lux_);
    return true;
  }

  /// Standard error of a receiver's illuminance [lx] under the options' levels: its pairs are independent.
  double error_lx(std::size_t r) const {
    double squared = 0;
    for (std::size_t i = pairs_of_[r]; i < pairs_of_[r + 1]; ++i) {
      const double error = levels_[pairs_[i].emitter] * pairs_[i].error_lx();
      squared += error * error;
    }
    return std::sqrt(squared);
  }

  double relative_error(std::size_t r) const {
    const double scale_lx = std::max(lux_[r], floor_lx_);
    return scale_lx > 0 ? error_lx(r) / scale_lx : 0;
  }

  /// The pairs whose samples are to be doubled: for each receiver that is not done, those with the larger part of its
  /// error.
  std::vector<std::size_t> next_round() const {
    std::vector<std::size_t> round;
    if (options_.enough.stop_requested()) return round;
    std::uint64_t left =
        options_.max_rays > direct_.rays + rays_sampled_ ? options_.max_rays - direct_.rays - rays_sampled_ : 0;
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      // If everything is dark so far, any doubt is too much.
      const bool dark = lux_[r] == 0 && floor_lx_ == 0;
      const bool wants = dark ? error_lx(r) > 0 : relative_error(r) > options_.wanted_standard_error();
      if (!wants) continue;
      double most = 0;
      for (std::size_t i = pairs_of_[r]; i < pairs_of_[r + 1]; ++i)
        most = std::max(most, levels_[pairs_[i].emitter] * pairs_[i].error_lx());
      for (std::size_t i = pairs_of_[r]; i < pairs_of_[r + 1]; ++i) {
        const Pair& pair = pairs_[i];
        if (levels_[pair.emitter] * pair.error_lx() < 0.5 * most || pair.samples >= kMaxSamples) continue;
        if (pair.rays > left) continue;
        left -= pair.rays;
        round.push_back(i);
      }
    }
    return round;
  }

  void finish() {
    direct_.rays += rays_sampled_;
    if (!pairs_.empty()) {
      direct_.replicates.assign(kDirectReplicates, direct_.lux_per_level);
      for (const Pair& pair : pairs_) {
        const auto estimates = pair.estimates();
        for (std::size_t k = 0; k < kDirectReplicates; ++k)
          direct_.replicates[k](index(pair.receiver), index(pair.emitter)) = estimates[k];
        direct_.lux_per_level(index(pair.receiver), index(pair.emitter)) = pair.mean_lux();
      }
      double squares = 0;
      for (std::size_t r = 0; r < receivers_.size(); ++r) {
        direct_.relative_error = std::max(direct_.relative_error, relative_error(r));
        squares += relative_error(r) * relative_error(r);
      }
      direct_.rms_error = std::sqrt(squares / static_cast<double>(receivers_.size()));
      direct_.floor_lx = floor_lx_;
    }
    if (options_.watch.progress) options_.watch.progress(progress_end_);
  }

  const RayScene& scene_;
  std::span<const Receiver> receivers_;
  std::span<const Emitter> emitters_;
  const EvaluateOptions& options_;
  double progress_end_;
  DirectSources sources_;
  const SkyOpenings* openings_;
  SkyOpenings found_;
  std::vector<double> levels_;
  DirectLight direct_;
  std::vector<Pair> pairs_;              ///< by receiver
  std::vector<std::size_t> pairs_of_;    ///< per receiver, plus the end
  std::vector<double> exact_lux_, lux_;  ///< per receiver, under the levels
  double floor_lx_ = 0, done_ = 0;
  std::uint64_t rays_sampled_ = 0;
};

}  // namespace

Result<DirectLight> direct_light(const RayScene& scene, std::span<const Receiver> receivers,
                                 std::span<const Emitter> emitters, const EvaluateOptions& options, double progress_end,
                                 const SkyOpenings* openings) {
  return Evaluation(scene, receivers, emitters, options, progress_end, openings).run();
}

Result<DirectLight> direct_light(const RayScene& scene, std::span<const Receiver> receivers,
                                 const EmitterSampler& lamps, std::size_t emitters, int threads, const Watch& watch,
                                 double progress_end) {
  const RayScene* obstacles = obstacles_in(scene);
  DirectLight direct;
  direct.lux_per_level =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(receivers.size()), static_cast<Eigen::Index>(emitters));
  std::vector<std::uint64_t> rays(receivers.size(), 0);
  CallingThreadProgress progress(watch, 0, progress_end, receivers.size());
  parallel_for(receivers.size(), threads, [&](std::size_t r) {
    if (watch.stop.stop_requested()) return;
    rays[r] = lamps.light(obstacles, receivers[r].position_world_m, receivers[r].normal_world,
                          [&](std::size_t e, double lux) {
                            direct.lux_per_level(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(e)) = lux;
                          });
    progress.one_done();
  });
  if (watch.stop.stop_requested()) return stopped();
  for (const std::uint64_t n : rays) direct.rays += n;
  progress.report_end();
  return direct;
}

}  // namespace luxrig
