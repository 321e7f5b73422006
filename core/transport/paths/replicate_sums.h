#pragma once
/// Sums of reflected light over a receiver's samples, by replicate, emitter and primary, and results derived from them.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/paths/record_bias.h"

namespace luxrig {

class ReplicateSums {
 public:
  static constexpr std::size_t kReplicates = RecordBias::kReplicates;

  /// channels     1 = luminance; 3 = linear Rec. 709, primary by primary
  /// levels       per emitter
  ReplicateSums(std::size_t receivers, std::size_t channels, Eigen::VectorXd levels);

  /// values   channels × emitters, summed over some samples
  void add(std::size_t replicate, std::size_t receiver, std::span<const double> values);

  /// At the levels, in one replicate, summed over samples [lx].
  [[nodiscard]] double sum_lx(std::size_t replicate, std::size_t receiver) const;
  /// At the levels, per replicate, as mean over this many samples [lx].
  [[nodiscard]] std::array<double, kReplicates> reflected_lx(std::size_t receiver, std::uint32_t samples) const;
  [[nodiscard]] double mean_reflected_lx(std::size_t receiver, std::uint32_t samples) const;
  /// Whether the first replicate has any light.
  [[nodiscard]] bool found(std::size_t receiver) const;

  /// One replicate's lux per level, receivers × emitters; frees its sums. samples: per receiver.
  /// rgb_per_level   its part of the mean is added here, by primary; unused with one channel
  [[nodiscard]] Eigen::MatrixXd take(std::size_t replicate, std::span<const std::uint32_t> samples,
                                     std::span<Eigen::MatrixXd> rgb_per_level);

 private:
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  [[nodiscard]] double luminance(const RowMatrix::ConstRowXpr& row, Eigen::Index emitter) const;

  std::size_t channels_;
  Eigen::VectorXd levels_;
  std::vector<RowMatrix> sums_;  ///< per replicate: receivers × columns
};

}  // namespace luxrig
