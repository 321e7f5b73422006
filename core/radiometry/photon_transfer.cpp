#include "core/radiometry/photon_transfer.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr int kTransferRounds = 4;
constexpr double kMinNoise_counts = 0.65;    // including rounding noise; less than this is not noise of its own
constexpr double kKnown = 0.1;               // relative standard error of the slope

struct TransferPoint {
  double light_counts, variance, per_sample;  ///< variance has the relative error `per_sample`
};

}  // namespace

std::optional<PhotonTransfer> photon_transfer(const SampleGroups& groups, int full_scale_counts,
                                              const SampleCurve& curve) {
  const double counts = full_scale_counts;
  std::vector<TransferPoint> points;
  std::size_t quiet = 0;
  const double full = curve.light(groups.saturation) * counts;
  for (const auto& group : groups.groups)
    for (const GroupSample& sample : group) {
      if (!sample.usable || sample.samples < 16) continue;
      const double light = curve.light(sample.mean) * counts;
      const double noise_counts = std::sqrt(sample.variance) * counts;
      // Rounding adds a twelfth of a count squared if samples have noise.
      const double encoded = noise_counts * noise_counts - 1.0 / 12;
      if (light > 0.2 * full) quiet += noise_counts < kMinNoise_counts;
      if (noise_counts < kMinNoise_counts || encoded <= 0) continue;
      const double slope = curve.slope(sample.mean);
      points.push_back({light, slope * slope * encoded, std::sqrt(2.0 / static_cast<double>(sample.samples))});
    }
  if (points.size() < 8 || quiet > points.size() / 4) return std::nullopt;
  double slope = 0, offset = 0, slope_variance = 0;
  for (int round = 0; round < kTransferRounds; ++round) {
    double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
    for (const TransferPoint& p : points) {
      const double expected = round == 0 ? p.variance : std::max(offset + slope * p.light_counts, 0.25 * p.variance);
      // Errors of the model itself (flicker, an uneven curve) are one hundredth.
      const double weight = 1 / (expected * expected * (p.per_sample * p.per_sample + 1e-4));
      w += weight, wx += weight * p.light_counts, wy += weight * p.variance;
      wxx += weight * p.light_counts * p.light_counts, wxy += weight * p.light_counts * p.variance;
    }
    const double determinant = w * wxx - wx * wx;
    if (!(determinant > 0)) return std::nullopt;
    slope = (w * wxy - wx * wy) / determinant;
    offset = (wxx * wy - wx * wxy) / determinant;
    slope_variance = w / determinant;
  }
  PhotonTransfer out;
  if (!(slope > 0)) return std::nullopt;
  out.relative_error = std::sqrt(slope_variance) / slope;
  if (out.relative_error > kKnown) return std::nullopt;
  out.electrons_per_count = 1 / slope;
  out.full_electrons = full / slope;
  out.read_noise_electrons = std::sqrt(std::max(0.0, offset)) / slope;
  return out;
}

}  // namespace luxrig
