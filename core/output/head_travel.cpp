#include "core/output/head_travel.h"

#include <algorithm>
#include <cmath>

#include "core/output/head_move.h"

namespace luxrig {

double travel_s(const Fixture& fixture, const std::optional<Joints>& from, const Joints& to) {
  const auto way_rad = [](double to_rad, std::optional<double> from_rad, double min_rad, double max_rad) {
    return from_rad ? std::abs(to_rad - *from_rad) : std::max(to_rad - min_rad, max_rad - to_rad);
  };
  const JointRange& range = fixture.range;
  const double pan_rad =
      way_rad(to.pan_rad, from ? std::optional(from->pan_rad) : std::nullopt, range.pan_min_rad, range.pan_max_rad);
  const double tilt_rad =
      way_rad(to.tilt_rad, from ? std::optional(from->tilt_rad) : std::nullopt, range.tilt_min_rad, range.tilt_max_rad);
  if (const auto& axes = fixture.axes) {
    return head_move(pan_rad, tilt_rad, {fixture.pan_speed_rad_s, axes->pan.acceleration_rad_s2},
                     {fixture.tilt_speed_rad_s, axes->tilt.acceleration_rad_s2})
        .seconds;
  }
  // The acceleration of heads on DMX is unknown: kHeadDelay_s covers it.
  const double longest_s = std::max(pan_rad / fixture.pan_speed_rad_s, tilt_rad / fixture.tilt_speed_rad_s);
  if (!range.zooms()) return longest_s;
  const double beam_rad =
      way_rad(to.beam_rad, from ? std::optional(from->beam_rad) : std::nullopt, range.beam_min_rad, range.beam_max_rad);
  return std::max(longest_s, beam_rad / fixture.zoom_speed_rad_s);
}

double stands_still_s(const Fixture& fixture, const std::optional<Joints>& from, const Joints& to) {
  constexpr double kSlower = 1 / (1 - 1.0 / 6), kSwings_s = 0.4;
  const double stated_s = travel_s(fixture, from, to);
  return fixture.axes ? stated_s : kSlower * stated_s + kSwings_s;
}

}  // namespace luxrig
