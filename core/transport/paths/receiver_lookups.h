#pragma once
/// Ends of the receivers' paths in irradiance records, and the light of those records.

#include <algorithm>

#include "core/transport/paths/adaptive_sampling.h"
#include "core/transport/paths/irradiance_cache.h"
#include "core/transport/paths/path_sampler.h"
#include "core/transport/paths/replicate_sums.h"

namespace luxrig {

class ReceiverLookups {
 public:
  static constexpr std::size_t kReplicates = ReplicateSums::kReplicates;

  /// sampler, tails   must outlive it
  /// levels           of the emitters, for the lux
  ReceiverLookups(const PathSampler& sampler, const IrradianceCache& tails, std::size_t receivers,
                  Eigen::VectorXd levels)
      : sampler_(sampler),
        tails_(tails),
        levels_(std::move(levels)),
        as_important_(std::ranges::equal(levels_, sampler.importances())),
        ends_(receivers * kReplicates),
        sums_(receivers * kReplicates),
        taken_lx_(receivers * kReplicates, 0.0) {}

  /// Whether there is room for the ends of this many more paths.
  [[nodiscard]] bool have_room(std::size_t paths) const;
  [[nodiscard]] RecordLookups& of(std::size_t receiver, std::size_t replicate) {
    return ends_[receiver * kReplicates + replicate];
  }

  /// Looks up the ends of some receivers in the present records. Returns the rays cast, by receiver.
  std::vector<std::uint64_t> look_up(std::span<const std::size_t> receivers, int threads);
  /// At the levels, from the last look_up(), summed over samples [lx].
  [[nodiscard]] double taken_lx(std::size_t receiver, std::size_t replicate) const {
    return taken_lx_[receiver * kReplicates + replicate];
  }

  /// Looks up all ends for the last time, adds the records' values to the sums, and frees the ends. Returns the rays.
  std::uint64_t take(ReplicateSums& sums, std::size_t channels, int threads);
  /// At the importances used for choosing paths, summed over samples and replicates; after take() [lx].
  [[nodiscard]] double important_lx(std::size_t receiver) const;

  /// Bias of the records, from the last look_up(): relative to each receiver's reflected light, so that errors are
  /// right for dim receivers, too.
  [[nodiscard]] RecordBias bias(const AdaptiveSampling& spent) const;

 private:
  const PathSampler& sampler_;
  const IrradianceCache& tails_;
  Eigen::VectorXd levels_;
  bool as_important_;                       ///< paths are chosen by the levels themselves: none is 0
  std::vector<RecordLookups> ends_;         ///< receivers × replicates
  std::vector<PathSampler::EndsSum> sums_;  ///< likewise
  std::vector<double> taken_lx_;            ///< likewise
};

}  // namespace luxrig
