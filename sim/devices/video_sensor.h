#pragma once
/// A camera sensor with known truth: light in, samples out, encoded as by the camera's electronics.
/// Source: EMVA Standard 1288 (linear model of a sensor).

#include <cstdint>
#include <vector>

namespace luxrig::sim {

enum class Encoding { linear, srgb, bt709, power };

struct SensorTruth {
  double full_well_electrons = 20000;  ///< saturation of a sample
  double read_noise_electrons = 5;
  double dark_share = 0;  ///< of full scale, without light
  int full_scale_counts = 4095;
  Encoding encoding = Encoding::linear;
  double gamma = 1;          ///< Encoding::power: sample = light to 1/gamma
  double bend = 0;           ///< light lost near full: 0.05 = 5 % at full
  double clips_at = 1;       ///< share of full scale at which samples saturate
  double flicker_depth = 0;  ///< of the light: 0.2 = ±20 %
  double flicker_hz = 100;
  std::uint64_t seed = 1;
};

/// scene_electrons_s  of each pixel
/// start_s            start of the exposure; sets the phase of the flicker
/// Returns samples as shares of full scale, in whole counts. Each `number` has its own noise.
[[nodiscard]] std::vector<float> expose(const SensorTruth& truth, const std::vector<double>& scene_electrons_s,
                                        double exposure_s, double start_s, std::uint64_t number);

/// The sample for this light (share of saturation) without noise and rounding.
[[nodiscard]] double sample_of(const SensorTruth& truth, double light);

}  // namespace luxrig::sim
