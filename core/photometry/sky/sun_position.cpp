#include "core/photometry/sky/sun_position.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

/// Meeus (7.1), Gregorian.
double julian_day(const UtcTime& time) {
  int year = time.year;
  int month = time.month;
  if (month <= 2) {
    --year;
    month += 12;
  }
  const double century = std::floor(year / 100.0);
  return std::floor(365.25 * (year + 4716)) + std::floor(30.6001 * (month + 1)) + time.day + 2 - century +
         std::floor(century / 4) - 1524.5 + time.hours / 24;
}

}  // namespace

SunPosition sun_position(const UtcTime& time, double latitude_rad, double longitude_rad) {
  const double days = julian_day(time) - 2451545.0;
  const double t = days / 36525;
  // Chapter 25: geometric mean longitude and anomaly, equation of the centre, apparent longitude.
  const double mean_longitude_deg = 280.46646 + t * (36000.76983 + t * 0.0003032);
  const double anomaly = rad_from_deg(357.52911 + t * (35999.05029 - t * 0.0001537));
  const double centre_deg = (1.914602 - t * (0.004817 + t * 0.000014)) * std::sin(anomaly) +
                            (0.019993 - t * 0.000101) * std::sin(2 * anomaly) + 0.000289 * std::sin(3 * anomaly);
  const double node = rad_from_deg(125.04 - 1934.136 * t);
  const double longitude = rad_from_deg(mean_longitude_deg + centre_deg - 0.00569 - 0.00478 * std::sin(node));
  const double obliquity = rad_from_deg(
      23.0 + (26.0 + (21.448 - t * (46.8150 + t * (0.00059 - t * 0.001813))) / 60) / 60 + 0.00256 * std::cos(node));
  const double right_ascension = std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
  const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));
  // Chapter 12: apparent sidereal time at Greenwich.
  const double sidereal_deg = 280.46061837 + 360.98564736629 * days + t * t * (0.000387933 - t / 38710000) -
                              0.00478 * std::sin(node) * std::cos(obliquity);
  const double hour_angle = rad_from_deg(std::remainder(sidereal_deg, 360.0)) + longitude_rad - right_ascension;
  // Chapter 13, azimuth counted from north.
  const double sine = std::sin(latitude_rad) * std::sin(declination) +
                      std::cos(latitude_rad) * std::cos(declination) * std::cos(hour_angle);
  const double altitude = std::asin(std::clamp(sine, -1.0, 1.0));
  const double azimuth = std::atan2(-std::sin(hour_angle) * std::cos(declination),
                                    std::cos(latitude_rad) * std::sin(declination) -
                                        std::sin(latitude_rad) * std::cos(declination) * std::cos(hour_angle));
  const double parallax = rad_from_deg(8.794 / 3600) * std::cos(altitude);
  return {azimuth < 0 ? azimuth + 2 * kPi : azimuth, altitude - parallax};
}

Vec3 towards_sky_world(double azimuth_rad, double altitude_rad, double north_turn_rad) {
  const double from_y = azimuth_rad - north_turn_rad;  // clockwise
  return {std::cos(altitude_rad) * std::sin(from_y), std::cos(altitude_rad) * std::cos(from_y), std::sin(altitude_rad)};
}

}  // namespace luxrig
