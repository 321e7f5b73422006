#include "core/photometry/sky/daylight_availability.h"

#include <cmath>

#include "core/check.h"
#include "core/geometry.h"

namespace luxrig {

DaylightAvailability daylight_availability(CloudCover cover, double sun_altitude_rad, double orbit_factor) {
  LUXRIG_CHECK(sun_altitude_rad <= kPi / 2 + 1e-9, "sun at {} rad", sun_altitude_rad);
  constexpr double kAboveTheAir_lx = 127'500;
  struct Row {
    double a_lx, b_lx, c, extinction;
  };
  constexpr Row kRows[] = {{800, 15'500, 0.5, 0.21}, {300, 45'000, 1, 0.80}, {300, 21'000, 1, 0}};
  const double sine = std::sin(sun_altitude_rad);
  if (!(sine > 0)) return {};
  const Row& row = kRows[static_cast<int>(cover)];
  DaylightAvailability available;
  available.sky_horizontal_lx = row.a_lx + row.b_lx * std::pow(sine, row.c);
  if (cover != CloudCover::overcast)
    available.sun_normal_lx = kAboveTheAir_lx * orbit_factor * std::exp(-row.extinction / sine);
  return available;
}

double solar_orbit_factor(int day_of_year) { return 1 + 0.034 * std::cos(2 * kPi * (day_of_year - 2) / 365); }

}  // namespace luxrig
