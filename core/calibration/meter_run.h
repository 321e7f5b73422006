#pragma once
/// One lamp after the other at a few levels, read by the luxmeters that hang: what to set next, and what follows from it.
/// It neither sets nor reads anything itself, so it is the same on a stepped clock, in a program and in a test.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/light_unknowns.h"
#include "core/calibration/rig_light.h"
#include "core/estimation/calibration.h"
#include "core/rig/rig.h"

namespace luxrig {

/// Mean of a luxmeter's readings under steady light.
struct SteadyReading {
  double lux = 0, standard_error_lx = 0;
};

class MeterRun {
 public:
  struct Step {
    std::vector<double> level;  ///< per fixture, as asked for; limits may leave less
    std::string what;           ///< for a person
  };

  /// stated_lux: RigLight::stated_lux(). It bounds the levels that are asked for, so that limits hold with lamps a third
  /// stronger than stated.
  MeterRun(const Rig& rig, const Eigen::MatrixXd& stated_lux);

  /// The light that is to be measured now; none = all is.
  [[nodiscard]] std::optional<Step> next() const;
  [[nodiscard]] std::size_t steps() const { return plan_.size(); }
  [[nodiscard]] std::size_t done() const { return taken_.size(); }
  /// What the meters showed under `next()`. level: per fixture, as sent. readings: per luxmeter; none = not steady, or gone.
  void take(std::span<const double> level, std::span<const std::optional<SteadyReading>> readings);

  /// Share of full light by level, of the lamps that a meter sees well enough; else empty. Of a lamp that a limit keeps
  /// below full level, the maker's curve holds above.
  [[nodiscard]] const MeasuredCurve& curve(std::size_t fixture) const { return curves_[fixture].of_level; }
  [[nodiscard]] double curve_error(std::size_t fixture) const { return curves_[fixture].error; }
  /// For LightUnknowns: each lamp's brightest step. Call it when all is measured.
  [[nodiscard]] std::vector<LightReading> readings() const;

 private:
  struct Asked {
    std::size_t fixture = 0;
    double level = 0;  ///< 0 = all are dark
  };
  struct Taken {
    double level = 0;  ///< of that fixture, as sent
    std::vector<std::optional<SteadyReading>> readings;
  };
  struct Curve {
    MeasuredCurve of_level;
    double error = 0;
  };
  void find_curves();
  /// Of this step without the dark, by the last dark before it; none = not read, or not above its error.
  [[nodiscard]] std::optional<SteadyReading> above_dark(std::size_t step, std::size_t luxmeter) const;

  const Rig* rig_;
  std::vector<Asked> plan_;
  std::vector<Taken> taken_;
  std::vector<Curve> curves_;
};

/// What was found, as a value. made: as in Calibration.
[[nodiscard]] Calibration calibration_of(const Session& session, const RigLight& light, const MeterRun& run,
                                         std::string made);

}  // namespace luxrig
