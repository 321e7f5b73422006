#pragma once
/// All lamps, read by the luxmeters that hang: what to set next, and what follows from it. First each lamp alone; brighter,
/// where what it gives leaves room below a limit; then dimmed ones, together where the meters tell them apart
/// (curve_groups.h). It neither sets nor reads anything itself, so it is the same on a stepped clock, in a program and in
/// a test.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/curve_groups.h"
#include "core/calibration/lamp_steps.h"
#include "core/calibration/light_unknowns.h"
#include "core/calibration/rig_light.h"
#include "core/estimation/calibration.h"
#include "core/rig/rig.h"

namespace luxrig {

class MeterRun {
 public:
  /// brightest: brightest_levels(). Lamps at 0 are not measured. stated_lux: RigLight::stated_lux().
  MeterRun(const Rig& rig, std::span<const double> brightest, Eigen::MatrixXd stated_lux);

  /// Lights to set one after the other, each as the lamps that are lit. It grows once all of them are taken: by lamps that
  /// a meter has missed, by lamps that may be brighter, then by dimmed ones, in groups that follow from what each gives
  /// alone. Whoever has taken all of a plan that has not grown is done.
  [[nodiscard]] const std::vector<std::vector<LampStep>>& plan() const { return plan_; }
  /// What the meters showed under the next of them. sent: levels of all fixtures. readings: per luxmeter; none = not steady,
  /// or gone.
  void take(std::span<const double> sent, std::span<const std::optional<SteadyReading>> readings);

  /// Per fixture, the brightest level at which it was read alone; of a lamp that was not, as given.
  [[nodiscard]] const std::vector<double>& brightest() const { return brightest_; }
  /// Per fixture; not measured of lamps that no meter sees well enough.
  [[nodiscard]] const std::vector<LampCurve>& curves() const { return curves_; }
  /// For LightUnknowns: each lamp alone at its brightest. Call it when all is measured.
  [[nodiscard]] std::vector<LightReading> readings() const;

 private:
  struct Taken {
    std::vector<double> sent;
    std::vector<std::optional<SteadyReading>> readings;
  };
  /// Adds a light, and darkness before it if the last is long ago.
  void add(std::vector<LampStep> lit);
  /// A meter that was disturbed, or late, is asked once more if it should see a lamp as well as any.
  void plan_again();
  /// Lamps that a limit kept dim before it was known how bright they are.
  void plan_brighter();
  /// A lamp that no meter has read at its brighter level stays at the one before.
  void settle_brighter();
  /// The most that it gives at its brightest of its stated light at that level, by its readings; none = they do not tell.
  [[nodiscard]] std::optional<double> over_stated(std::size_t fixture) const;
  /// The most light that it gives at its brightest at this point.
  [[nodiscard]] double most_lux(std::size_t point, std::size_t fixture) const;
  /// How many times as bright as at its brightest limits would let it be; infinite without one.
  [[nodiscard]] double room_below_limits(std::size_t fixture) const;
  /// The level that its readings allow, however steep its dimmer; none = they do not tell.
  [[nodiscard]] std::optional<double> brighter_level(std::size_t fixture) const;
  /// The luxmeter that shows it best; none = none does well.
  [[nodiscard]] std::optional<std::size_t> best_meter(std::size_t fixture) const;
  void plan_curves();
  void find_curves();
  /// At its brightest, by the last such light that this meter has read; none = not read.
  [[nodiscard]] std::optional<SteadyReading> light_alone(std::size_t fixture, std::size_t luxmeter) const;
  [[nodiscard]] double level_alone(std::size_t fixture) const;  ///< as sent; 0 = not lit
  /// Of this light without the dark, by the last dark before it; none = not read.
  [[nodiscard]] std::optional<SteadyReading> above_dark(std::size_t light, std::size_t luxmeter) const;

  const Rig* rig_;
  std::vector<double> brightest_;
  Eigen::MatrixXd stated_lux_;
  std::vector<std::vector<LampStep>> plan_;
  std::vector<std::vector<std::size_t>> alone_at_;  ///< per fixture: of plan_
  enum class Stage { alone, again, brighter, dimmed } stage_ = Stage::alone;
  int times_brighter_ = 0;
  std::size_t first_of_curves_ = 0;  ///< of plan_
  LightAlone alone_;
  std::vector<Taken> taken_;
  std::vector<LampCurve> curves_;
};

/// What was found, as a value. curves: per fixture. made: as in Calibration.
[[nodiscard]] Calibration calibration_of(const Session& session, const RigLight& light,
                                         std::span<const LampCurve> curves, std::string made);

}  // namespace luxrig
