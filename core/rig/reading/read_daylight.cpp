#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/photometry/sky/daylight_availability.h"
#include "core/photometry/sky/sky.h"
#include "core/photometry/sky/sun_position.h"
#include "core/rig/reading/moment.h"
#include "core/rig/reading/rig_reader.h"

namespace luxrig {
namespace {

using SkyKind = Daylight::SkyKind;

constexpr std::array kByAngles = {"sun_azimuth_deg", "sun_elevation_deg"};
constexpr std::array kByPlace = {"latitude_deg", "longitude_deg", "time"};
constexpr const char* kHowToGiveTheSun =
    "add sun_azimuth_deg and sun_elevation_deg, or latitude_deg, longitude_deg and time";

/// A weaker sun counts as none.
constexpr double kMinSun_lx = 1e-3;

struct SunOfMoment {
  SunPosition position;
  double orbit_factor = 1;
};

bool has_any(const Section& s, std::span<const char* const> keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return s.has(key); });
}

/// Reports the missing keys of a group that needs all of them once one is given.
void require_all(Section& s, std::span<const char* const> keys) {
  const char* given = *std::find_if(keys.begin(), keys.end(), [&](const char* key) { return s.has(key); });
  for (const char* key : keys)
    if (!s.has(key)) s.require(key, fmt::format("which {} needs", given));
}

std::optional<SunOfMoment> sun_by_angles(Section& s) {
  SunOfMoment sun;
  const bool azimuth = s.read_deg("sun_azimuth_deg", sun.position.azimuth_rad);
  const bool altitude = s.read_deg("sun_elevation_deg", sun.position.altitude_rad);
  return azimuth && altitude ? std::optional(sun) : std::nullopt;
}

std::optional<SunOfMoment> sun_by_place(Section& s) {
  double latitude_rad = 0, longitude_rad = 0;
  std::string text;
  const bool latitude = s.read_deg("latitude_deg", latitude_rad);
  const bool longitude = s.read_deg("longitude_deg", longitude_rad);
  if (!s.read("time", text)) return std::nullopt;
  const auto time = utc_time(text);
  if (!time) {
    s.problems().add(
        s.place_of("time"), fmt::format("time {} {}", in_quotes(text), time.error()),
        "write it as \"2026-06-21T12:00:00+02:00\": date, time, offset from UTC (or Z), years 1900 to 2100");
    return std::nullopt;
  }
  if (!latitude || !longitude) return std::nullopt;
  return SunOfMoment{sun_position(*time, latitude_rad, longitude_rad), solar_orbit_factor(day_of_year(*time))};
}

CloudCover cover_of(const Daylight& daylight) {
  switch (daylight.sky) {
    case SkyKind::clear:
      return CloudCover::clear;
    case SkyKind::general:  // the standard's groups: 1…5 overcast, 6…10 partly cloudy, 11…15 clear
      return daylight.general_type <= 5    ? CloudCover::overcast
             : daylight.general_type <= 10 ? CloudCover::partly
                                           : CloudCover::clear;
    default:
      return CloudCover::overcast;
  }
}

bool brighter_near_the_sun(const Daylight& daylight) {
  if (daylight.sky != SkyKind::clear && daylight.sky != SkyKind::general) return false;
  const int type = daylight.sky == SkyKind::clear ? 12 : daylight.general_type;
  const GeneralSkyParameters p = general_sky_parameters(type);
  return p.c != 0 || p.e != 0;
}

}  // namespace

void RigReader::read_daylight() {
  each(root, "daylight", [&](Section& s) {
    Daylight daylight;
    daylight.in_file = s.in_file();
    std::size_t kind = 0;  // of the schema's choices, which begin after SkyKind::none
    const bool sky_known = s.read_choice("sky", kind);
    if (sky_known) daylight.sky = static_cast<SkyKind>(kind + 1);
    bool type_known = true;
    if (sky_known && daylight.sky != SkyKind::general) {
      s.refuse("sky_type", "sky_type has no effect: only with sky = \"general\"", "remove it, or write that sky");
    } else if (sky_known && !s.has("sky_type")) {
      s.require("sky_type", "which sky = \"general\" needs");
      type_known = false;
    } else if (s.has("sky_type")) {
      type_known = s.read("sky_type", daylight.general_type);
    }

    const bool by_angles = has_any(s, kByAngles), by_place = has_any(s, kByPlace);
    std::optional<SunOfMoment> sun;
    if (by_angles && by_place) {
      const auto* at = std::find_if(kByPlace.begin(), kByPlace.end(), [&](const char* key) { return s.has(key); });
      problems.add(s.place_of(*at), "the sun's position is given both by angles and by place and time",
                   "keep sun_azimuth_deg and sun_elevation_deg, or latitude_deg, longitude_deg and time");
    } else if (by_angles) {
      require_all(s, kByAngles);
      sun = sun_by_angles(s);
    } else if (by_place) {
      require_all(s, kByPlace);
      sun = sun_by_place(s);
    }
    const double north_turn_rad = rad_from_deg(s.number("north_deg"));
    const bool sun_shines = s.yes_no("sun");
    const bool sky_given = s.read("horizontal_lx", daylight.horizontal_lx);
    const bool sun_given = s.read("sun_normal_lx", daylight.sun_normal_lx);
    if (!sun_shines) s.refuse("sun_normal_lx", "sun_normal_lx has no effect with sun = false", "remove one of the two");
    if (!by_angles && !by_place) {
      for (const char* key : {"north_deg", "sun_normal_lx"})
        s.refuse(key, fmt::format("{} has no effect without the sun's position", key), kHowToGiveTheSun);
      if (!s.has("horizontal_lx")) {
        problems.add(s.in_file(), "[daylight] does not say how bright the sky is",
                     fmt::format("add horizontal_lx, or {}", std::string_view(kHowToGiveTheSun).substr(4)));
      } else if (sky_known && type_known && brighter_near_the_sun(daylight)) {
        problems.add(s.in_file(), "this sky is brighter near the sun, and nothing says where that stands",
                     kHowToGiveTheSun);
      }
    }
    if (!sun) {
      rig.daylight = daylight;
      return;
    }
    daylight.towards_sun_world =
        towards_sky_world(sun->position.azimuth_rad, sun->position.altitude_rad, north_turn_rad);
    const DaylightAvailability mean =
        daylight_availability(cover_of(daylight), sun->position.altitude_rad, sun->orbit_factor);
    if (!sky_given) daylight.horizontal_lx = mean.sky_horizontal_lx;
    if (!sun_given) daylight.sun_normal_lx = mean.sun_normal_lx;
    if (!sun_shines || daylight.sun_normal_lx < kMinSun_lx || daylight.towards_sun_world.z() <= 0) {
      daylight.sun_normal_lx = 0;
    }
    if (daylight.horizontal_lx <= 0) daylight.sky = SkyKind::none;
    if (sun->position.altitude_rad <= 0) {
      rig.notes.push_back(
          {problems.file(), s.in_file().line, s.in_file().column,
           fmt::format("the sun stands {:.1f}° below the horizon: {}", -deg_from_rad(sun->position.altitude_rad),
                       sky_given ? "the sky shines alone" : "there is no daylight"),
           "check time, place and offset, if that is not meant"});
    }
    rig.daylight = daylight;
  });
}

}  // namespace luxrig
