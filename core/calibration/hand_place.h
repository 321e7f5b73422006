#pragma once
/// A luxmeter in a hand: where to hold it next, which lamps to light there one by one, and what follows from the readings.
/// It neither lights nor reads anything itself.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/lamp_steps.h"
#include "core/calibration/light_unknowns.h"
#include "core/calibration/rig_light.h"
#include "core/rig/rig.h"

namespace luxrig {

struct HandPlace {
  std::size_t point = 0;
  std::vector<LampStep> steps;  ///< the dark first, then lamps from their brightest level down
};

/// Levels of use, and the brightest at which each lamp may be alone (brightest_levels()).
struct HandLevels {
  Eigen::VectorXd use;
  std::vector<double> brightest;
};

/// The place after which the light at the goals is known best; none = every point is in `but`, or no lamp says more.
/// Lamps without a curve are read at a few levels where they are bright.
[[nodiscard]] std::optional<HandPlace> next_hand_place(const Rig& rig, const RigLight& light, const HandLevels& levels,
                                                       std::span<const LampCurve> curves,
                                                       std::span<const std::size_t> but);

/// What was read at a place, for LightUnknowns. lux: per step; none = skipped. curves: per fixture; those found are added.
[[nodiscard]] std::vector<LightReading> readings_at(const Rig& rig, const HandPlace& place,
                                                    std::span<const std::optional<double>> lux,
                                                    std::vector<LampCurve>& curves);

/// Which way a luxmeter at a point faces: "facing up", "facing +x, 30° up".
[[nodiscard]] std::string facing_words(const Vec3& normal_world);

}  // namespace luxrig
