#include "core/photometry/beam.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/check.h"

namespace luxrig {
namespace {

Vec3 direction(double gamma_rad, double c_rad) {
  return {std::sin(gamma_rad) * std::cos(c_rad), std::sin(gamma_rad) * std::sin(c_rad), -std::cos(gamma_rad)};
}

double half_cone_rad(const IntensityDistribution& of) { return std::min(kPi, 0.5 * of.emission_cone_rad()); }

double angle_in_plane(const IntensityDistribution& of, double c_rad, double min_cd) {
  constexpr int kSteps = 3600;  // to either side
  const double half = half_cone_rad(of);
  const auto intensity = [&](double angle) { return of.intensity_cd(direction(angle, c_rad)); };
  const auto angle_of = [&](int step) { return half * step / kSteps; };
  int peak = 0;
  double most = -1;
  for (int step = -kSteps; step <= kSteps; ++step) {
    const double here = intensity(angle_of(step));
    if (here > most || (here == most && std::abs(step) < std::abs(peak))) {
      most = here;
      peak = step;
    }
  }
  if (most < min_cd) return 0;
  double spread = 0;
  for (const int side : {-1, 1}) {
    int step = peak;
    while (std::abs(step + side) <= kSteps && intensity(angle_of(step + side)) >= min_cd) step += side;
    double inside = angle_of(step);
    if (std::abs(step + side) <= kSteps) {
      double outside = angle_of(step + side);
      for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (inside + outside);
        (intensity(middle) >= min_cd ? inside : outside) = middle;
      }
    }
    spread += side * inside;
  }
  return std::min(spread, 2 * kPi);
}

}  // namespace

PlaneAngles angles_to_share(const IntensityDistribution& of, double share) {
  LUXRIG_CHECK(share > 0 && share <= 1, "share {}", share);
  const double min_cd = share * of.max_intensity_cd();
  return {angle_in_plane(of, 0, min_cd), angle_in_plane(of, 0.5 * kPi, min_cd)};
}

double cone_of_flux_rad(const IntensityDistribution& of, double share) {
  LUXRIG_CHECK(share > 0 && share <= 1, "share {}", share);
  constexpr int kRings = 1440, kSpokes = 96;
  constexpr double kNode = 0.5773502691896258;  // of the 2-point Gauss rule
  const double half = half_cone_rad(of);
  const auto ring = [&](double gamma) {
    double sum = 0;
    for (int i = 0; i < kSpokes; ++i) sum += of.intensity_cd(direction(gamma, 2 * kPi * (i + 0.5) / kSpokes));
    return sum * (2 * kPi / kSpokes) * std::sin(gamma);
  };
  std::vector<double> reached{0};  // flux inside the outer edge of each ring
  for (int i = 0; i < kRings; ++i) {
    const double width = half / kRings;
    const double middle = (i + 0.5) * width;
    reached.push_back(reached.back() +
                      0.5 * width * (ring(middle - 0.5 * kNode * width) + ring(middle + 0.5 * kNode * width)));
  }
  // Share of the flux found by the rule, so that all of it can be reached.
  const double wanted = share * reached.back();
  const auto above = std::lower_bound(reached.begin() + 1, reached.end() - 1, wanted);
  const auto i = static_cast<std::size_t>(above - reached.begin());
  const double part = reached[i] > reached[i - 1] ? (wanted - reached[i - 1]) / (reached[i] - reached[i - 1]) : 0;
  return 2 * half * (static_cast<double>(i - 1) + part) / kRings;
}

}  // namespace luxrig
