#pragma once
/// What is being measured of a daemon's rig, by whichever means.

#include <fmt/format.h>

#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/calibration/hand_place.h"
#include "core/calibration/rig_light.h"
#include "tools/luxrig/calibrate/by_camera.h"
#include "tools/luxrig/calibrate/daemon_rig.h"

namespace luxrig {

/// Share of full light at which the goals' error is told.
inline constexpr double kLevelOfUse = 0.4;

/// A lamp that is off has this level instead of none, where its level is taken to be read.
inline constexpr double kDimmestLevel = 0.01;

struct Measuring {
  const Session& session;
  DaemonRig& daemon;
  RigLight& light;
  HandLevels levels;
  std::vector<LampCurve> curves;  ///< per fixture
  std::stop_token stop;
  const CameraViews& cameras;  ///< that are used: their places are points of `light`, but none to hold a meter at
  bool any = false;            ///< something is measured
  int by_hand = 0;             ///< readings
  MeasuredByCameras seen{};
  std::optional<std::size_t> first_slope{};  ///< in open hours: instrument of the first fixture's slope
  std::vector<std::size_t> slope_of{};       ///< fixtures whose slopes were measured

  [[nodiscard]] std::vector<std::size_t> no_points() const { return cameras.points(); }
};

[[nodiscard]] inline std::string known_words(const GoalError& error) {
  return fmt::format("{:.1f} %, at the worst to {:.1f} %", 100 * error.rms, 100 * error.worst);
}

}  // namespace luxrig
