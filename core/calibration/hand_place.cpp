#include "core/calibration/hand_place.h"

#include <fmt/format.h>

#include <cmath>

#include "core/check.h"
#include "core/output/dimming.h"

namespace luxrig {
namespace {

using Eigen::Index;

/// Shares of the brightest level at which a curve is read by hand, below it: typing takes longer than settling.
constexpr double kSharesByHand[] = {0.4, 0.12};
/// A curve is read where its lamp gives this much at its brightest, so that the least share still shows [lx].
constexpr double kEnoughForACurve_lx = 20;
/// Of a reading against another at the same place, which the hand has not left.
constexpr double kSamePlace = 0.003, kDigit_lx = 0.05;
/// Below this, a direction is up, down or level [deg].
constexpr double kStraight_deg = 5;

SteadyReading without_dark(double lux, double dark_lx) {
  return {lux - dark_lx, std::hypot(kSamePlace * lux, kDigit_lx)};
}

}  // namespace

std::optional<HandPlace> next_hand_place(const Rig& rig, const RigLight& light, const HandLevels& levels,
                                         std::span<const LampCurve> curves, std::span<const std::size_t> but) {
  LUXRIG_CHECK(levels.brightest.size() == rig.fixtures.size() && curves.size() == rig.fixtures.size(),
               "{} levels and {} curves of {} fixtures", levels.brightest.size(), curves.size(), rig.fixtures.size());
  const auto best = light.places_to_measure(levels.use, 1, but);
  if (best.empty()) return std::nullopt;
  HandPlace place;
  place.point = best.front();
  place.steps.push_back({0, 0});
  for (const std::size_t f : light.lamps_to_read(place.point, levels.use, levels.brightest)) {
    const double brightest = levels.brightest[f];
    place.steps.push_back({f, brightest});
    const double lux =
        light.known().at(place.point, brightest * Eigen::VectorXd::Unit(levels.use.size(), static_cast<Index>(f))).lux;
    if (rig.fixtures[f].switched || !curves[f].of_level.empty() || lux < kEnoughForACurve_lx) continue;
    for (const double share : kSharesByHand) place.steps.push_back({f, share * brightest});
  }
  if (place.steps.size() < 2) return std::nullopt;
  return place;
}

std::vector<LightReading> readings_at(const Rig& rig, const HandPlace& place,
                                      std::span<const std::optional<double>> lux, std::vector<LampCurve>& curves) {
  LUXRIG_CHECK(lux.size() == place.steps.size() && curves.size() == rig.fixtures.size(), "{} readings of {} steps",
               lux.size(), place.steps.size());
  std::vector<LightReading> readings;
  const double dark_lx = lux.front().value_or(0);
  for (std::size_t first = 1; first < place.steps.size();) {
    const std::size_t f = place.steps[first].fixture;
    std::size_t end = first;
    std::vector<ReadAtLevel> read;
    for (; end < place.steps.size() && place.steps[end].fixture == f; ++end)
      if (lux[end]) read.push_back({place.steps[end].level, without_dark(*lux[end], dark_lx)});
    if (curves[f].of_level.empty()) curves[f] = curve_of(read);
    if (lux[first]) {
      LightReading reading;
      reading.receiver = place.point;
      reading.meter = meter_in_hand(rig);
      reading.lux = std::max(0.0, *lux[first] - dark_lx);
      reading.standard_error_lx = error_in_hand_lx(*lux[first]);
      reading.level = share_at_level(curves[f].of_level, place.steps[first].level) *
                      Eigen::VectorXd::Unit(static_cast<Index>(rig.fixtures.size()), static_cast<Index>(f));
      readings.push_back(std::move(reading));
    }
    first = end;
  }
  return readings;
}

std::string facing_words(const Vec3& normal_world) {
  const double up_deg = deg_from_rad(std::atan2(normal_world.z(), normal_world.head<2>().norm()));
  if (up_deg > 90 - kStraight_deg) return "facing up";
  if (up_deg < kStraight_deg - 90) return "facing down";
  // By the nearest axis, and how far off it.
  const double around_deg = deg_from_rad(std::atan2(normal_world.y(), normal_world.x()));
  constexpr const char* kAxes[] = {"+x", "+y", "-x", "-y"};
  const int quarter = static_cast<int>(std::lround(around_deg / 90));
  const double off_deg = around_deg - 90.0 * quarter;
  const int axis = (quarter + 4) % 4;
  std::string words = fmt::format("facing {}", kAxes[axis]);
  if (std::abs(off_deg) >= kStraight_deg)
    words += fmt::format(", {:.0f}° towards {}", std::abs(off_deg), kAxes[(axis + (off_deg > 0 ? 1 : 3)) % 4]);
  if (std::abs(up_deg) >= kStraight_deg)
    words += fmt::format(", {:.0f}° {}", std::abs(up_deg), up_deg > 0 ? "up" : "down");
  return words;
}

}  // namespace luxrig
