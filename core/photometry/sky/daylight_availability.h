#pragma once
/// Typical daylight outdoors, as a mean of many days, for use without measurements.

namespace luxrig {

enum class CloudCover { clear, partly, overcast };

struct DaylightAvailability {
  double sky_horizontal_lx = 0;  ///< of the sky without the sun, on an unobstructed horizontal plane
  double sun_normal_lx = 0;      ///< of the sun, on a plane facing it; 0 under an overcast sky
};

/// Mean values for an altitude of the sun; at a given moment, half or twice as much is common. Both are zero if the sun
/// is at or below the horizon.
///   sky = A + B sin^C h [klx];   sun = 127.5 klx · f · e^(−c / sin h)
/// sun_altitude_rad   above the horizon, at most π/2
/// orbit_factor       f, see solar_orbit_factor(); 1 = mean of the year
/// source             IES, Recommended Practice for the Calculation of Daylight Availability, J. IES 13 (1984) 381–392:
///                    A, B, C = 0.8, 15.5, 0.5 clear; 0.3, 45, 1 partly cloudy; 0.3, 21, 1 overcast; c = 0.21 clear,
///                    0.80 partly cloudy
[[nodiscard]] DaylightAvailability daylight_availability(CloudCover cover, double sun_altitude_rad,
                                                         double orbit_factor = 1);

/// Sunlight above the atmosphere over its mean of the year, by the earth's distance: 1 + 0.034 cos(2π (day − 2)/365).
/// day_of_year   1…366
[[nodiscard]] double solar_orbit_factor(int day_of_year);

}  // namespace luxrig
