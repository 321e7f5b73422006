#include "core/transport/candidates/error_histogram.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr double kSmallest = 1e-6;
const double kLogStep = std::log(1.03);

}  // namespace

void ErrorHistogram::add(double relative_error) {
  double bin = 0;
  if (relative_error > kSmallest) bin = 1 + std::floor(std::log(relative_error / kSmallest) / kLogStep);
  ++counts_[static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kBins - 1)))];
}

void ErrorHistogram::add(const ErrorHistogram& other) {
  for (std::size_t i = 0; i < kBins; ++i) counts_[i] += other.counts_[i];
}

double ErrorHistogram::median() const {
  std::uint64_t all = 0, below = 0;
  for (const std::uint64_t count : counts_) all += count;
  for (std::size_t i = 0; i < kBins; ++i) {
    below += counts_[i];
    if (2 * below >= all) return i == 0 ? 0 : kSmallest * std::exp((static_cast<double>(i) - 0.5) * kLogStep);
  }
  return 0;
}

}  // namespace luxrig
