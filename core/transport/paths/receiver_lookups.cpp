#include "core/transport/paths/receiver_lookups.h"

#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxEnds = (256u << 20) / sizeof(RecordLookup);

}  // namespace

bool ReceiverLookups::have_room(std::size_t paths) const {
  std::size_t kept = 0;
  for (const RecordLookups& ends : ends_) kept += ends.ends.size();
  return kept + paths <= kMaxEnds;
}

std::vector<std::uint64_t> ReceiverLookups::look_up(std::span<const std::size_t> receivers, int threads) {
  parallel_for(receivers.size() * kReplicates, threads, [&](std::size_t task) {
    // A replicate's records stay in the cache while all receivers use them.
    const std::size_t k = task / receivers.size(), at = receivers[task % receivers.size()] * kReplicates + k;
    if (as_important_) {  // then only their sum is needed, not each emitter
      sums_[at] = sampler_.add_ends(ends_[at], tails_.records(k), {});
      taken_lx_[at] = sums_[at].taken_lx;
      return;
    }
    Eigen::VectorXd lux = Eigen::VectorXd::Zero(levels_.size());
    sums_[at] =
        sampler_.add_ends(ends_[at], tails_.records(k), {{lux.data(), static_cast<std::size_t>(lux.size())}, 1});
    taken_lx_[at] = lux.dot(levels_);
  });
  std::vector<std::uint64_t> rays(receivers.size(), 0);
  for (std::size_t i = 0; i < receivers.size(); ++i)
    for (std::size_t k = 0; k < kReplicates; ++k) rays[i] += sums_[receivers[i] * kReplicates + k].rays;
  return rays;
}

std::uint64_t ReceiverLookups::take(ReplicateSums& sums, std::size_t channels, int threads) {
  parallel_for(ends_.size(), threads, [&](std::size_t at) {
    std::vector<double> values(channels * static_cast<std::size_t>(levels_.size()), 0.0);
    sums_[at] = sampler_.add_ends(ends_[at], tails_.records(at % kReplicates), {values, channels});
    sums.add(at % kReplicates, at / kReplicates, values);
    taken_lx_[at] = 0;
    ends_[at] = {};
  });
  std::uint64_t rays = 0;
  for (const PathSampler::EndsSum& sum : sums_) rays += sum.rays;
  return rays;
}

double ReceiverLookups::important_lx(std::size_t receiver) const {
  double lux = 0;
  for (std::size_t k = 0; k < kReplicates; ++k) lux += sums_[receiver * kReplicates + k].taken_lx;
  return lux;
}

RecordBias ReceiverLookups::bias(const AdaptiveSampling& spent) const {
  RecordBias bias;
  for (std::size_t at = 0; at < sums_.size(); ++at) {
    const double reflected_lx = spent[at / kReplicates].reflected_lx;
    if (reflected_lx > 0)
      bias.add(at % kReplicates, sums_[at].checked_lx / reflected_lx, sums_[at].by_path_lx / reflected_lx);
  }
  return bias;
}

}  // namespace luxrig
