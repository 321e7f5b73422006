#include "core/transport/paths/replicate_sums.h"

#include <utility>

namespace luxrig {

ReplicateSums::ReplicateSums(std::size_t receivers, std::size_t channels, Eigen::VectorXd levels)
    : channels_(channels),
      levels_(std::move(levels)),
      sums_(kReplicates, RowMatrix::Zero(static_cast<Eigen::Index>(receivers),
                                         static_cast<Eigen::Index>(channels) * levels_.size())) {}

void ReplicateSums::add(std::size_t replicate, std::size_t receiver, std::span<const double> values) {
  sums_[replicate].row(static_cast<Eigen::Index>(receiver)) +=
      Eigen::Map<const Eigen::RowVectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

double ReplicateSums::luminance(const RowMatrix::ConstRowXpr& row, Eigen::Index emitter) const {
  if (channels_ == 1) return row[emitter];
  const Eigen::Index n = levels_.size();
  return 0.2126 * row[emitter] + 0.7152 * row[n + emitter] + 0.0722 * row[2 * n + emitter];
}

double ReplicateSums::sum_lx(std::size_t replicate, std::size_t receiver) const {
  const auto row = std::as_const(sums_[replicate]).row(static_cast<Eigen::Index>(receiver));
  double sum = 0;
  for (Eigen::Index e = 0; e < levels_.size(); ++e) sum += levels_[e] * luminance(row, e);
  return sum;
}

std::array<double, ReplicateSums::kReplicates> ReplicateSums::reflected_lx(std::size_t receiver,
                                                                           std::uint32_t samples) const {
  std::array<double, kReplicates> reflected{};
  for (std::size_t k = 0; k < kReplicates; ++k) reflected[k] = sum_lx(k, receiver) / samples;
  return reflected;
}

double ReplicateSums::mean_reflected_lx(std::size_t receiver, std::uint32_t samples) const {
  double sum = 0;
  for (std::size_t k = 0; k < kReplicates; ++k) sum += sum_lx(k, receiver);
  return sum / (static_cast<double>(kReplicates) * samples);
}

bool ReplicateSums::found(std::size_t receiver) const {
  return (sums_.front().row(static_cast<Eigen::Index>(receiver)).array() != 0).any();
}

Eigen::MatrixXd ReplicateSums::take(std::size_t replicate, std::span<const std::uint32_t> samples,
                                    std::span<Eigen::MatrixXd> rgb_per_level) {
  const RowMatrix& sums = sums_[replicate];
  Eigen::MatrixXd lux(sums.rows(), levels_.size());
  for (Eigen::Index r = 0; r < sums.rows(); ++r) {
    const auto row = sums.row(r);
    const double count = samples[static_cast<std::size_t>(r)];
    for (Eigen::Index e = 0; e < levels_.size(); ++e) {
      lux(r, e) = luminance(row, e) / count;
      for (std::size_t c = 0; c < 3 && channels_ == 3; ++c)
        rgb_per_level[c](r, e) += row[static_cast<Eigen::Index>(c) * levels_.size() + e] / (count * kReplicates);
    }
  }
  sums_[replicate].resize(0, 0);
  return lux;
}

}  // namespace luxrig
