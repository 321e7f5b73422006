#pragma once
/// All lamps during opening hours: each as in its look or a hair darker, in a pattern of its own, for half an hour.
/// What a meter shows in step with a lamp's pattern is that lamp's light. It neither sets nor reads anything itself.
///
/// From one step to the next the light at no place changes by more than 2 %, whatever a dimmer's law is within what
/// dimmers do: the light over the drive is a power of at most kSteepest above a dead band of at most kWidestDeadBand. So
/// the drive changes by less, by whole steps of what is on the wire. A lamp whose one step is more takes no part.
///
/// What a change of the drive tells is the slope of the lamp's law times its light. The slope is not known better than
/// kSlopeError, so each reading has a factor that all readings of its lamp share (Showing::of_lamp). The meters' readings
/// of all the light together tell the rest, where no daylight is in them.
///
/// The patterns are columns of a Hadamard matrix, so that no lamp's light counts for another's. Light that drifts takes no
/// part: each round of the pattern is compared with its own mean and trend.
///
/// Source: M. Harwit, N. J. A. Sloane, Hadamard Transform Optics (1979), ch. 3.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/lamp_steps.h"
#include "core/calibration/light_unknowns.h"
#include "core/rig/rig.h"

namespace luxrig {

class OpenRun {
 public:
  /// look: levels of the look in force. Fixtures that are off in it, or switched, take no part. rounds: of the pattern.
  OpenRun(const Rig& rig, std::span<const double> look, int rounds);

  /// From one step to the next the light of no lamp changes by more than this share of what it was.
  static constexpr double kLargestStep = 0.02;
  /// What dimmers do: exponent of the light over the drive, and drive below which there is none.
  static constexpr double kSteepest = 2.5, kWidestDeadBand = 0.05;
  /// Standard deviation of the logarithm of a lamp's slope, relative light over relative level.
  static constexpr double kSlopeError = 0.4;

  /// Fixtures that are lit and dim, and cannot change by so little. Text: why, for a person.
  struct LeftOut {
    std::size_t fixture = 0;
    std::string why;
  };
  [[nodiscard]] const std::vector<LeftOut>& left_out() const { return left_out_; }
  /// Fixtures that take part.
  [[nodiscard]] const std::vector<std::size_t>& part() const { return part_; }

  /// Levels of all fixtures, one step after the other.
  [[nodiscard]] const std::vector<std::vector<double>>& plan() const { return plan_; }
  [[nodiscard]] const std::vector<double>& look() const { return look_; }
  [[nodiscard]] std::size_t steps_taken() const { return taken_.size(); }
  /// Steps of a round.
  [[nodiscard]] std::size_t period() const { return period_; }
  /// From these levels to those, as sent, the light changes by no more than kLargestStep. A limit may take a little of a
  /// step. If it takes more, end the run: the next one begins from what is left.
  [[nodiscard]] bool is_small_step(std::span<const double> before, std::span<const double> after) const;
  /// What the meters showed under the next step. sent: per fixture. readings: per luxmeter; none = not steady, or gone.
  void take(std::span<const double> sent, std::span<const std::optional<SteadyReading>> readings);

  /// For LightUnknowns: light of each lamp alone at the look's level, at each meter, as far as it stands out from noise;
  /// then the light of all of them, unless there is daylight. first_slope: of LightPriors::log_meter, the instruments
  /// that stand for the slopes, one per fixture of the rig. Slopes and light are over the maker's curve.
  [[nodiscard]] std::vector<LightReading> readings(std::size_t first_slope) const;

 private:
  struct Taken {
    std::vector<double> sent;
    std::vector<std::optional<SteadyReading>> readings;
  };
  void choose_levels(std::size_t fixture);
  /// Light of each lamp of part_ at a meter and its standard error; none = too little was read.
  [[nodiscard]] std::optional<std::vector<LightEstimate>> lights_at(std::size_t luxmeter) const;
  /// Light of all lamps at a meter, and the levels that it is of; none = too little was read, or it is not only theirs.
  [[nodiscard]] std::optional<LightEstimate> all_light_at(std::size_t luxmeter, Eigen::VectorXd& sent) const;

  const Rig* rig_;
  std::vector<double> look_;
  std::vector<std::size_t> part_;
  std::vector<double> dimmer_, brighter_;  ///< levels per fixture of part_
  std::vector<LeftOut> left_out_;
  std::size_t period_ = 0;
  std::vector<std::vector<double>> plan_;
  std::vector<Taken> taken_;
};

}  // namespace luxrig
