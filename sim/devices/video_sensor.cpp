#include "sim/devices/video_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/world/random.h"

namespace luxrig::sim {
namespace {

double encoded(const SensorTruth& truth, double light) {
  if (truth.encoding == Encoding::linear) return light;
  const double x = std::max(0.0, light);
  switch (truth.encoding) {
    case Encoding::linear:
      break;
    case Encoding::srgb:
      return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    case Encoding::bt709:
      return x < 0.018 ? 4.5 * x : 1.099 * std::pow(x, 0.45) - 0.099;
    case Encoding::power:
      return std::pow(x, 1 / truth.gamma);
  }
  return light;
}

}  // namespace

double sample_of(const SensorTruth& truth, double light) {
  const double bent = light - truth.bend * light * light;
  return truth.dark_share + (1 - truth.dark_share) * encoded(truth, bent);
}

std::vector<float> expose(const SensorTruth& truth, const std::vector<double>& scene_electrons_s, double exposure_s,
                          double start_s, std::uint64_t number) {
  // The mean of 1 + depth sin(2 pi f t) over the exposure.
  double light = 1;
  if (truth.flicker_depth > 0) {
    const double omega = 2 * std::numbers::pi * truth.flicker_hz;
    light += truth.flicker_depth * (std::cos(omega * start_s) - std::cos(omega * (start_s + exposure_s))) /
             (omega * exposure_s);
  }
  const double counts = truth.full_scale_counts;
  std::vector<float> samples;
  samples.reserve(scene_electrons_s.size());
  std::uint64_t draw = number << 32;
  for (const double electrons_s : scene_electrons_s) {
    const double electrons = std::min(electrons_s * light * exposure_s, 4 * truth.full_well_electrons);
    const double noise = std::sqrt(electrons + truth.read_noise_electrons * truth.read_noise_electrons) *
                         random_normal(truth.seed, Draw::picture_noise, 1, draw++);
    const double sample = sample_of(truth, (electrons + noise) / truth.full_well_electrons);
    samples.push_back(static_cast<float>(std::round(std::clamp(sample, 0.0, truth.clips_at) * counts) / counts));
  }
  return samples;
}

}  // namespace luxrig::sim
