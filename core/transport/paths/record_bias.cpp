#include "core/transport/paths/record_bias.h"

#include <cmath>

#include "core/transport/replicate_error.h"

namespace luxrig {
namespace {

constexpr double kUsualBias = 0.01;

}  // namespace

std::optional<RecordBias::Estimate> RecordBias::measured() const {
  std::array<double, kReplicates> biases{};
  double mean = 0;
  for (std::size_t k = 0; k < kReplicates; ++k) {
    if (!(by_path_[k] > 0)) return std::nullopt;
    biases[k] = by_record_[k] / by_path_[k] - 1;
    mean += biases[k] / kReplicates;
  }
  return Estimate{mean, standard_error_of_mean(biases)};
}

std::optional<RecordBias::Estimate> RecordBias::believed() const {
  const auto found = measured();
  if (!found) return std::nullopt;
  const double trust = 1 / (1 + found->error * found->error / (kUsualBias * kUsualBias));
  return Estimate{trust * found->mean, std::sqrt(trust) * found->error};
}

}  // namespace luxrig
