#include "core/calibration/light_peak.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace luxrig {
namespace {

constexpr double kSharpestPeak_rad = rad_from_deg(0.08);
/// Of a log reading, by shape; and what the width of the beam may be off.
constexpr double kShape = 0.03, kPeakWidth = 0.15;
/// What the room throws back, over what is traced: by paint and by further reflections.
constexpr double kReflected = 1, kReflectedError = 0.4;
constexpr double kLeastLux = 0.02;  ///< share of the brightest sample; less tells nothing
constexpr double kLeastShare = 1e-3;
/// Rays of a beam, in even strata; and how near a lit place is taken to be, since it is none.
constexpr int kBeamStrata = 9;
constexpr double kLitPatch_m2 = 0.02;

/// Angles of a beam beside another, across and along its tilt, by its joints.
std::pair<double, double> beside(const Joints& joints, const Joints& centre) {
  const double pan_rad = joints.pan_rad - centre.pan_rad;
  const Vec3 beam(-std::sin(pan_rad) * std::sin(joints.tilt_rad), std::cos(pan_rad) * std::sin(joints.tilt_rad),
                  -std::cos(joints.tilt_rad));
  const double sine = std::sin(centre.tilt_rad), cosine = std::cos(centre.tilt_rad);
  const double across = -std::copysign(1.0, sine) * beam.x(), along = cosine * beam.y() + sine * beam.z();
  const double off = std::hypot(across, along), ahead = sine * beam.y() - cosine * beam.z();
  const double stretch = off > 1e-9 ? std::atan2(off, ahead) / off : 1;
  return {stretch * across, stretch * along};
}

}  // namespace

double pan_share(const Joints& joints) { return std::max(0.1, std::abs(std::sin(joints.tilt_rad))); }

BeamFall fall_of(const IntensityDistribution& intensity, double radius_rad) {
  const auto log_at = [&](double share) {
    const double angle_rad = share * radius_rad;
    return std::log(std::max(intensity.intensity_cd(Vec3(std::sin(angle_rad), 0, -std::cos(angle_rad))),
                             1e-6 * intensity.max_intensity_cd()));
  };
  constexpr double kFrom = 0.8, kTo = 1.2;
  const double fall = 2 * (log_at(kFrom) - log_at(kTo)) / ((kTo * kTo - kFrom * kFrom) * radius_rad * radius_rad);
  return {radius_rad, std::max(fall, 0.2 / (radius_rad * radius_rad))};
}

std::optional<LightPeak> light_peak(std::span<const PeakSample> samples, const Joints& centre, const BeamFall& fall,
                                    double noise, double play_rad) {
  using Vector = Eigen::Matrix<double, 7, 1>;
  using Matrix = Eigen::Matrix<double, 7, 7>;
  enum { kLog, kAcross, kAlong, kLogWidth, kPanPlay, kTiltPlay, kRoom };
  double brightest = 0;
  for (const PeakSample& sample : samples) brightest = std::max(brightest, sample.lux);
  if (!(brightest > 0) || samples.size() < 6) return std::nullopt;
  const double share = pan_share(centre), radius_rad = fall.radius_rad;
  Vector expected = Vector::Zero(), deviation;
  expected[kLog] = std::log(3 * brightest);
  expected[kPanPlay] = play_rad * share;
  expected[kTiltPlay] = play_rad;
  expected[kRoom] = kReflected;
  deviation << 3, 2 * radius_rad, 2 * radius_rad, kPeakWidth, play_rad * share, play_rad, kReflectedError;
  Vector x = expected;
  Matrix information;
  double squares = 0;
  int used = 0;
  for (int step = 0; step < 25; ++step) {
    information = Vector(deviation.array().square().inverse()).asDiagonal();
    Vector right = information * (expected - x);
    squares = 0;
    used = 0;
    for (const PeakSample& sample : samples) {
      if (sample.lux < kLeastLux * brightest) continue;
      const double k = fall.per_rad2 * std::exp(x[kLogWidth]);
      const auto [u, v] = beside(sample.sent, centre);
      const double across = u - x[kAcross] - sample.from.pan * x[kPanPlay] / 2;
      const double along = v - x[kAlong] - sample.from.tilt * x[kTiltPlay] / 2;
      const double log_direct = -k / 2 * (across * across + along * along);
      const double direct = std::exp(log_direct);
      const double all = std::max(kLeastShare, direct + std::max(0.0, x[kRoom]) * sample.reflected);
      Vector row;
      row << 0, k * across, k * along, log_direct, k * across * sample.from.pan / 2, k * along * sample.from.tilt / 2,
          0;
      row *= direct / all;
      row[kLog] = 1;
      row[kRoom] = sample.reflected / all;
      const double off = std::log(sample.lux) - (x[kLog] + std::log(all));
      const double floor = kShape * brightest / sample.lux * kLeastLux;
      const double variance = noise * noise + kShape * kShape + floor * floor;
      information += row * row.transpose() / variance;
      right += row * off / variance;
      squares += off * off / variance;
      ++used;
    }
    Vector by = information.ldlt().solve(right);
    // A step that leaves the samples would leave where the model holds.
    const double far = by.segment<2>(kAcross).norm() / radius_rad;
    if (far > 0.7) by *= 0.7 / far;
    x += by;
    if (by.segment<2>(kAcross).norm() < 1e-7 && step > 3) break;
  }
  if (used < 6 || !x.allFinite()) return std::nullopt;
  const Matrix covariance = information.ldlt().solve(Matrix::Identity());
  const double scatter = std::max(1.0, squares / std::max(1, used - 4));
  Vector to_side_across = Vector::Zero(), to_side_along = Vector::Zero();
  to_side_across[kAcross] = to_side_along[kAlong] = 1;
  to_side_across[kPanPlay] = to_side_along[kTiltPlay] = 0.5;
  const double variance =
      scatter * 0.5 * (to_side_across.dot(covariance * to_side_across) + to_side_along.dot(covariance * to_side_along));
  LightPeak peak;
  peak.middle = {centre.pan_rad + x[kAcross] / share, centre.tilt_rad + x[kAlong], centre.beam_rad};
  peak.half_play = {std::max(0.0, x[kPanPlay] / 2 / share), std::max(0.0, x[kTiltPlay] / 2), 0};
  peak.standard_error_rad = std::hypot(kSharpestPeak_rad, std::sqrt(variance));
  peak.off_rad = x.segment<2>(kAcross).norm();
  peak.used = used;
  return peak;
}

double reflected_over_peak(const RayScene& rays, const HeadMeter& meter, const IntensityDistribution& intensity,
                           const Pose& world_from_lamp) {
  const Vec3 from_m = world_from_lamp.translation_m, straight_m = meter.position_world_m - from_m;
  const double cosine = -straight_m.normalized().dot(meter.normal_world);
  if (!(cosine > 0)) return 0;
  double lux = 0;
  for (int a = 0; a < kBeamStrata; ++a)
    for (int b = 0; b < kBeamStrata; ++b) {
      const DirectionSample ray = intensity.sample((a + 0.5) / kBeamStrata, (b + 0.5) / kBeamStrata);
      if (!(ray.density_per_sr > 0)) continue;
      const auto hit = rays.nearest(from_m, world_from_lamp.direction(ray.direction), Vec3::Zero());
      if (!hit) continue;
      const Vec3 to_m = meter.position_world_m - hit->position_world_m, along = to_m.normalized();
      const double leaves = along.dot(hit->normal_world), arrives = -along.dot(meter.normal_world);
      if (!(leaves > 0 && arrives > 0) ||
          rays.occluded(meter.position_world_m, meter.normal_world, hit->position_world_m))
        continue;
      lux += intensity.intensity_cd(ray.direction) / ray.density_per_sr *
             rays.material_of(hit->triangle).luminous_reflectance() / kPi * leaves * arrives /
             (to_m.squaredNorm() + kLitPatch_m2);
    }
  lux /= kBeamStrata * kBeamStrata;
  return lux * straight_m.squaredNorm() / (intensity.max_intensity_cd() * cosine);
}

}  // namespace luxrig
