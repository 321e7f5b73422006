#pragma once
/// Who gets how many samples: rounds that go where the error is, until it is as small as wanted or the rays are used
/// up.

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/transport/evaluator.h"

namespace luxrig {

/// How far a receiver has come.
struct ReceiverProgress {
  std::uint32_t samples = 0;  ///< per replicate
  std::uint64_t rays = 0;
  double lux = 0;  ///< under the options' levels
  double direct_lx = 0;
  double reflected_lx = 0;          ///< lux without direct_lx; of a first round's hits alone before there is more
  double error_lx = 0;              ///< standard error of lux by its own replicates
  double shared_error_lx = 0;       ///< what tail records' common bias adds to it
  double taken_lx = 0;              ///< from tail records, summed over samples and replicates
  double scatter = 0;               ///< about relative error² × samples, by the last rounds
  std::uint32_t scatter_of = 0;     ///< samples when it was last told
  double least_scatter = HUGE_VAL;  ///< least so far of error_lx² × samples
  bool found = false;               ///< any reflected light
  bool alone = false;               ///< records' noise has become its own: paths go on by themselves from here on
};

/// Samples that a receiver gets in a round: [begin, end) of each of its replicates.
struct PathTask {
  std::size_t receiver;
  std::uint32_t begin, end;
};

class PathRounds {
 public:
  /// options     must outlive it
  /// sends_on    what a bright place sends on of its light
  /// ways_each   a path goes on by
  PathRounds(std::size_t receivers, const EvaluateOptions& options, double sends_on, double ways_each)
      : options_(options), sends_on_(sends_on), ways_each_(ways_each), progress_(receivers) {}

  [[nodiscard]] ReceiverProgress& operator[](std::size_t receiver) { return progress_[receiver]; }
  [[nodiscard]] const ReceiverProgress& operator[](std::size_t receiver) const { return progress_[receiver]; }

  /// All receivers. rays_cast: so far, by whatever else.
  [[nodiscard]] std::vector<PathTask> first(std::uint64_t rays_cast) const;
  /// The receivers that want more samples: as many as would do by the error so far, up to as many as they have. Under
  /// a wanted rms error, a receiver's samples are as the root of their scatter by their rays (J. Neyman 1934).
  [[nodiscard]] std::vector<PathTask> next(std::uint64_t rays_cast) const;
  /// To be called when the error of a receiver that shares records is known anew: tells whether it still should.
  void judge_sharing(std::size_t receiver);
  /// To be called when the lux of receivers is known anew.
  void find_floor();
  /// What a receiver may yet have to find: its paths were so many, and one more of them could lead to where it is
  /// brightest. The replicates' spread is more than that, unless bright paths are rare: through doors, say. There
  /// spread alone tells nothing of those that nobody has found.
  [[nodiscard]] double unfound_lx(std::size_t receiver, double brightest_lx) const;
  /// Largest lux of a receiver.
  [[nodiscard]] double brightest_lx() const { return brightest_lx_; }
  /// Standard error with that. Where such paths were found, spread holds part of it already: less than the root of the
  /// squares' sum, more than the larger of the two. With third powers 93 to 97 % of the points of `bench transport`'s
  /// rooms are within two of these; the larger alone leaves fewer in varnished rooms, squares more in halls of spots.
  [[nodiscard]] static double with_unfound_lx(double spread_lx, double unfound_lx);
  /// Below which errors are relative to this (error_floor.h).
  [[nodiscard]] double floor_lx() const { return floor_lx_; }

  /// Relative to the receiver's lux or the floor, with what it shares.
  [[nodiscard]] double relative_error(std::size_t receiver) const;
  /// Root mean square of them all.
  [[nodiscard]] double rms_error() const;
  /// Share of the whole work done so far, or after a round: error falls at least with the root of the samples. At least
  /// `before`.
  [[nodiscard]] double done_after(const std::vector<PathTask>& round, double before) const;

 private:
  [[nodiscard]] std::uint64_t rays_left(std::uint64_t rays_cast) const;
  [[nodiscard]] bool by_rms() const { return options_.wanted_rms_error > 0; }
  /// Samples that receivers should have in all, for the wanted rms error.
  [[nodiscard]] std::vector<double> samples_by_rms() const;
  /// Those that want more, by themselves: without a limit of rays.
  [[nodiscard]] std::vector<PathTask> wanting() const;
  /// Estimated error relative to that at which the receiver is done; infinite when nothing is known yet.
  [[nodiscard]] double overshoot(std::size_t receiver) const;

  const EvaluateOptions& options_;
  double sends_on_, ways_each_;
  std::vector<ReceiverProgress> progress_;
  double floor_lx_ = 0, brightest_lx_ = 0;
};

}  // namespace luxrig
