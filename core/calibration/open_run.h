#pragma once
/// All lamps during opening hours: each a hair brighter or darker than its look, in a pattern of its own, for half an hour.
/// What a meter shows in step with a lamp's pattern is that lamp's light. It neither sets nor reads anything itself.
///
/// The patterns are columns of a Hadamard matrix, so that no lamp's light counts for another's. Light that drifts takes no
/// part: each round of the pattern is compared with its own mean and trend.
///
/// Source: M. Harwit, N. J. A. Sloane, Hadamard Transform Optics (1979), ch. 3.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/lamp_steps.h"
#include "core/calibration/light_unknowns.h"
#include "core/rig/rig.h"

namespace luxrig {

class OpenRun {
 public:
  /// look: levels of the look in force. Fixtures that are off in it, or switched, take no part. rounds: of the pattern.
  OpenRun(const Rig& rig, std::span<const double> look, int rounds);

  /// From one step to the next no lamp changes by more than this share of its level.
  static constexpr double kLargestStep = 0.02;

  /// Levels of all fixtures, one step after the other.
  [[nodiscard]] const std::vector<std::vector<double>>& plan() const { return plan_; }
  /// Steps of a round.
  [[nodiscard]] std::size_t period() const { return period_; }
  /// What the meters showed under the next step. sent: per fixture. readings: per luxmeter; none = not steady, or gone.
  void take(std::span<const double> sent, std::span<const std::optional<SteadyReading>> readings);

  /// Light of each lamp alone at the look's level, at each meter, as far as it stands out from noise. For LightUnknowns;
  /// curves: per fixture.
  [[nodiscard]] std::vector<LightReading> readings(std::span<const LampCurve> curves) const;

 private:
  struct Taken {
    std::vector<double> sent;
    std::vector<std::optional<SteadyReading>> readings;
  };
  /// Light of each lamp of part_ at a meter and its standard error; none = too little was read.
  [[nodiscard]] std::optional<std::vector<LightEstimate>> lights_at(std::size_t luxmeter,
                                                                    std::span<const LampCurve> curves) const;

  const Rig* rig_;
  std::vector<double> look_;
  std::vector<std::size_t> part_;  ///< fixtures that take part
  std::size_t period_ = 0;
  std::vector<std::vector<double>> plan_;
  std::vector<Taken> taken_;
};

}  // namespace luxrig
