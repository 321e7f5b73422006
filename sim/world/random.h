#pragma once
/// Counter-based random numbers: a value is a pure function of (seed, stream, counter), so the order in which devices
/// are stepped or queried does not matter.
///
/// Source: the finaliser of SplitMix64 (Steele, Lea, Flood 2014) over a Weyl-style combination of the three keys.

#include <cmath>
#include <cstdint>

#include "core/geometry.h"

namespace luxrig::sim {

/// Purpose of a stream of numbers; with the device's index it selects the stream.
enum class Draw : std::uint64_t {
  lamp_output = 1,
  curve_exponent,
  mount_position,
  mount_angle,
  meter_gain,
  meter_noise,
  fault_loss,
  fault_garble,
  picture_noise,
  fault_duplicate,
  fault_reorder,
  drive_exponent,
  dead_band,
  tail,
  warm_up,
  ageing,
  photometry_angle,
  backlash,
  wrong_head,
  wrong_line,
  reflectance,
  object_place,
  cloud,
  visit,
  meter_latency,
  meter_cosine,
  meter_drift,
  camera_place,
  camera_lens,
  camera_response,
  head_speed,
  head_lag
};

[[nodiscard]] inline std::uint64_t mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

[[nodiscard]] inline std::uint64_t random_bits(std::uint64_t seed, Draw draw, std::uint64_t device,
                                               std::uint64_t counter) {
  return mix64(mix64(mix64(mix64(seed) ^ static_cast<std::uint64_t>(draw)) ^ device) ^ counter);
}

/// Uniform in [0, 1), 53 bits.
[[nodiscard]] inline double random_unit(std::uint64_t seed, Draw draw, std::uint64_t device, std::uint64_t counter) {
  return static_cast<double>(random_bits(seed, draw, device, counter) >> 11) * 0x1p-53;
}

/// Uniform in [-1, 1).
[[nodiscard]] inline double random_signed(std::uint64_t seed, Draw draw, std::uint64_t device, std::uint64_t counter) {
  return 2 * random_unit(seed, draw, device, counter) - 1;
}

/// Standard normal by Box–Muller, clamped to ±3 so that no device is absurd.
[[nodiscard]] inline double random_normal(std::uint64_t seed, Draw draw, std::uint64_t device, std::uint64_t counter) {
  const double u = 1 - random_unit(seed, draw, device, 2 * counter);  // (0, 1]
  const double v = random_unit(seed, draw, device, 2 * counter + 1);
  const double z = std::sqrt(-2 * std::log(u)) * std::cos(2 * kPi * v);
  return z < -3 ? -3 : z > 3 ? 3 : z;
}

}  // namespace luxrig::sim
