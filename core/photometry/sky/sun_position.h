#pragma once
/// Position of the sun, by date, time and place.

#include "core/geometry.h"

namespace luxrig {

/// Gregorian date and universal time (UTC).
struct UtcTime {
  int year = 2000, month = 1, day = 1;
  double hours = 12;  ///< 0…24; values beyond count into neighbouring days
};

struct SunPosition {
  double azimuth_rad = 0;   ///< from north, clockwise seen from above, 0…2π
  double altitude_rad = 0;  ///< above the horizon, without refraction (0.03° at 30°, 0.5° at the horizon)
};

/// Position of the sun's centre, to 0.01° from 1900 to 2100.
/// latitude_rad, longitude_rad   north and east positive
/// source                        J. Meeus, Astronomical Algorithms, 2nd ed., ch. 12, 13 and 25 (low accuracy), parallax
///                               of 8.794″; universal time in place of dynamical time (a minute: 0.001°)
[[nodiscard]] SunPosition sun_position(const UtcTime& time, double latitude_rad, double longitude_rad);

/// Unit vector towards a sky position in frame world.
/// north_turn_rad   angle of north from +Y, counter-clockwise seen from above
[[nodiscard]] Vec3 towards_sky_world(double azimuth_rad, double altitude_rad, double north_turn_rad = 0);

}  // namespace luxrig
