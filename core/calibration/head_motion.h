#pragma once
/// How fast a head turns, and how long it takes to stand still, from one luxmeter's series.
///
/// The lit head is sent off the meter by several ways, one joint at a time, and back. Until half of the light is back it
/// takes a + way/v: the speed v is in the slope, whatever the delays of bus and meter in a, which are the same each time.
/// What is left, less the time that a lamp needs which is only switched on there, is what the head needs beside its speed:
/// to obey and to slow down, and, if its light stands still later than that, to swing out.

#include <optional>
#include <span>
#include <vector>

#include "core/calibration/meter_timing.h"
#include "core/estimation/calibration.h"

namespace luxrig {

/// One order that brings light to the meter.
struct LightReturn {
  double way_rad = 0;       ///< of the lamp, in one joint; 0 = it was only switched on
  double half_lit_rad = 0;  ///< so much of the way is left when half of the light is back
  double ordered_s = 0;
  std::vector<TimedLux> samples;  ///< in ascending time, from the dark before the order until the light has stood still
};

/// From the order on, each with its standard error.
struct LightArrival {
  Known half_s, still_s;
};
/// none = the samples show no dark, no light, or no end.
[[nodiscard]] std::optional<LightArrival> light_arrival(const LightReturn& back);

/// 0 ± 0 = not known.
struct HeadMotion {
  Known pan_speed_deg_s, tilt_speed_deg_s;
  Known settling_s;  ///< as CalibratedHead::settling_s
};
/// A speed needs two ways or more; the settling needs switched, too. Per joint, what would be less sure than a third is
/// not known.
[[nodiscard]] HeadMotion head_motion(std::span<const LightReturn> pan, std::span<const LightReturn> tilt,
                                     std::span<const LightReturn> switched);

/// What is known goes to the head; the rest stays.
void put_motion(const HeadMotion& motion, CalibratedHead& head);

}  // namespace luxrig
