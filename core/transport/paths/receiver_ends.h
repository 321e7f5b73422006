#pragma once
/// Where the receivers' paths ended in tail records, and what those records say.

#include <algorithm>

#include "core/transport/paths/path_rounds.h"
#include "core/transport/paths/path_sampler.h"
#include "core/transport/paths/replicate_sums.h"
#include "core/transport/paths/shared_tails.h"

namespace luxrig {

class ReceiverEnds {
 public:
  static constexpr std::size_t kReplicates = ReplicateSums::kReplicates;

  /// sampler, tails   must outlive it
  /// levels           of the emitters, at which lux is told
  ReceiverEnds(const PathSampler& sampler, const SharedTails& tails, std::size_t receivers, Eigen::VectorXd levels)
      : sampler_(sampler),
        tails_(tails),
        levels_(std::move(levels)),
        as_important_(std::ranges::equal(levels_, sampler.importances())),
        ends_(receivers * kReplicates),
        sums_(receivers * kReplicates),
        taken_lx_(receivers * kReplicates, 0.0) {}

  /// Whether the ends of so many more paths may be kept.
  [[nodiscard]] bool have_room(std::size_t paths) const;
  [[nodiscard]] TailEnds& of(std::size_t receiver, std::size_t replicate) {
    return ends_[receiver * kReplicates + replicate];
  }

  /// Looks up the ends of some receivers by the records that there are now. Returns the rays cast, by receiver.
  std::vector<std::uint64_t> look_up(std::span<const std::size_t> receivers, int threads);
  /// At the levels, by the last look, summed over samples [lx].
  [[nodiscard]] double taken_lx(std::size_t receiver, std::size_t replicate) const {
    return taken_lx_[receiver * kReplicates + replicate];
  }

  /// Looks up all ends for the last time, adds what records say to the sums, and lets the ends go. Returns the rays.
  std::uint64_t take(ReplicateSums& sums, std::size_t channels, int threads);
  /// At the importances that paths are chosen by, summed over samples and replicates; after take() [lx].
  [[nodiscard]] double important_lx(std::size_t receiver) const;

  /// How far the records are off, by the last look: relative to each receiver's reflected light, since errors are to be
  /// right for the dim ones, too.
  [[nodiscard]] RecordBias bias(const PathRounds& spent) const;

 private:
  const PathSampler& sampler_;
  const SharedTails& tails_;
  Eigen::VectorXd levels_;
  bool as_important_;                       ///< paths are chosen by the levels themselves: none is 0
  std::vector<TailEnds> ends_;              ///< receivers × replicates
  std::vector<PathSampler::EndsSum> sums_;  ///< likewise
  std::vector<double> taken_lx_;            ///< likewise
};

}  // namespace luxrig
