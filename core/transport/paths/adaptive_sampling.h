#pragma once
/// Distributes samples to receivers in rounds that go where the error is, until it is as small as wanted or the rays
/// are used up.

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/transport/evaluator.h"

namespace luxrig {

/// Progress of one receiver.
struct ReceiverProgress {
  std::uint32_t samples = 0;  ///< per replicate
  std::uint64_t rays = 0;
  double lux = 0;  ///< under the options' levels
  double direct_lx = 0;
  double reflected_lx = 0;        ///< lux without direct_lx; at first from the first round's hits alone
  double error_lx = 0;            ///< standard error of lux from its own replicates
  double shared_error_lx = 0;     ///< error added by the irradiance records' common bias
  double taken_lx = 0;            ///< from irradiance records, summed over samples and replicates
  double scatter = 0;             ///< approximate relative error² × samples, from the last rounds
  std::uint32_t scatter_of = 0;   ///< samples when it was last updated
  double min_scatter = HUGE_VAL;  ///< least error_lx² × samples so far
  bool found = false;             ///< any reflected light
  bool alone = false;             ///< records' noise dominates: from now on its paths do not use records
};

/// Samples of a receiver in a round: [begin, end) of each of its replicates.
struct PathTask {
  std::size_t receiver;
  std::uint32_t begin, end;
};

class AdaptiveSampling {
 public:
  /// options     must outlive it
  /// sends_on    share of its light that a bright place sends to a receiver
  /// ways_each   ways by which a path continues
  AdaptiveSampling(std::size_t receivers, const EvaluateOptions& options, double sends_on, double ways_each)
      : options_(options), sends_on_(sends_on), ways_each_(ways_each), progress_(receivers) {}

  [[nodiscard]] ReceiverProgress& operator[](std::size_t receiver) { return progress_[receiver]; }
  [[nodiscard]] const ReceiverProgress& operator[](std::size_t receiver) const { return progress_[receiver]; }

  /// All receivers. rays_cast: so far, by all other work.
  [[nodiscard]] std::vector<PathTask> first(std::uint64_t rays_cast) const;
  /// Receivers that need more samples: as many as the error so far requires, at most doubling. With a wanted rms error,
  /// a receiver's samples are proportional to the root of scatter / rays (J. Neyman 1934).
  [[nodiscard]] std::vector<PathTask> next(std::uint64_t rays_cast) const;
  /// Call after updating the error of a receiver that shares records: decides whether it still should.
  void judge_sharing(std::size_t receiver);
  /// Call after updating the lux of receivers.
  void find_floor();
  /// Light that a receiver may still miss: with its number of paths, one more could lead to the brightest place. The
  /// replicates' spread is usually larger, unless bright paths are rare, as through doors: before any is found, the
  /// spread shows nothing of them.
  [[nodiscard]] double unfound_lx(std::size_t receiver, double brightest_lx) const;
  /// Largest lux of a receiver.
  [[nodiscard]] double brightest_lx() const { return brightest_lx_; }
  /// Standard error including that. Once such paths were found, the spread already contains part of it, so the sum is
  /// between the larger of the two and the root of the sum of squares. With third powers, 93 to 97 % of the points of
  /// `bench transport`'s rooms are within two of these; the larger alone covers fewer in varnished rooms, squares more
  /// in halls of spots.
  [[nodiscard]] static double with_unfound_lx(double spread_lx, double unfound_lx);
  /// Errors of receivers below this are relative to it (error_floor.h).
  [[nodiscard]] double floor_lx() const { return floor_lx_; }

  /// Relative to the receiver's lux or the floor, including shared error.
  [[nodiscard]] double relative_error(std::size_t receiver) const;
  /// Root mean square over all receivers.
  [[nodiscard]] double rms_error() const;
  /// Share of the total work that is done, now or after a round: error falls at least with the root of the samples. At
  /// least `before`.
  [[nodiscard]] double done_after(const std::vector<PathTask>& round, double before) const;

 private:
  [[nodiscard]] std::uint64_t rays_left(std::uint64_t rays_cast) const;
  [[nodiscard]] bool by_rms() const { return options_.wanted_rms_error > 0; }
  /// Total samples per receiver for the wanted rms error.
  [[nodiscard]] std::vector<double> samples_by_rms() const;
  /// Receivers that need more samples, ignoring the limit of rays.
  [[nodiscard]] std::vector<PathTask> wanting() const;
  /// Estimated error over that at which the receiver is done; infinite if nothing is known yet.
  [[nodiscard]] double overshoot(std::size_t receiver) const;

  const EvaluateOptions& options_;
  double sends_on_, ways_each_;
  std::vector<ReceiverProgress> progress_;
  double floor_lx_ = 0, brightest_lx_ = 0;
};

}  // namespace luxrig
