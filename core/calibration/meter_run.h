#pragma once
/// One lamp after the other at a few levels, read by the luxmeters that hang: what to set next, and what follows from it.
/// It neither sets nor reads anything itself, so it is the same on a stepped clock, in a program and in a test.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/lamp_steps.h"
#include "core/calibration/light_unknowns.h"
#include "core/calibration/rig_light.h"
#include "core/estimation/calibration.h"
#include "core/rig/rig.h"

namespace luxrig {

class MeterRun {
 public:
  /// brightest: brightest_levels(). Lamps at 0 are not measured. stated_lux: RigLight::stated_lux(); levels at which no
  /// luxmeter would see light are left out.
  MeterRun(const Rig& rig, std::span<const double> brightest, const Eigen::MatrixXd& stated_lux);

  /// Lights to set one after the other.
  [[nodiscard]] const std::vector<LampStep>& plan() const { return plan_; }
  /// What the meters showed under the next of them. level: of its fixture, as sent. readings: per luxmeter; none = not
  /// steady, or gone.
  void take(double level, std::span<const std::optional<SteadyReading>> readings);

  /// Per fixture; not measured of lamps that no meter sees well enough.
  [[nodiscard]] const std::vector<LampCurve>& curves() const { return curves_; }
  /// For LightUnknowns: each lamp's brightest step. Call it when all is measured.
  [[nodiscard]] std::vector<LightReading> readings() const;

 private:
  struct Taken {
    double level = 0;  ///< of that fixture, as sent
    std::vector<std::optional<SteadyReading>> readings;
  };
  /// Of the steps of one lamp, by the meter that sees it best.
  [[nodiscard]] LampCurve curve_of_steps(std::size_t first, std::size_t end) const;
  /// Of this step without the dark, by the last dark before it; none = not read.
  [[nodiscard]] std::optional<SteadyReading> above_dark(std::size_t step, std::size_t luxmeter) const;

  const Rig* rig_;
  std::vector<LampStep> plan_;
  std::vector<Taken> taken_;
  std::vector<LampCurve> curves_;
};

/// What was found, as a value. curves: per fixture. made: as in Calibration.
[[nodiscard]] Calibration calibration_of(const Session& session, const RigLight& light,
                                         std::span<const LampCurve> curves, std::string made);

}  // namespace luxrig
