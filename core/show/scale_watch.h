#pragma once
/// Errors that no meter shows by itself: all meters are off together against the model, or drift against their own
/// earlier readings at the same levels.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/estimation/gain_estimator.h"
#include "core/show/show_controller.h"

namespace luxrig {

class ScaleWatch {
 public:
  /// Per luxmeter: its last believed sample, if there is one.
  using Measured = std::span<const std::optional<LuxReading>>;

  explicit ScaleWatch(const Rig& rig);

  /// Looks at a sample.
  /// levels   per fixture: those that the meters read
  void look(Time now, const GainEstimator& estimator, Measured measured, const std::vector<double>& levels);

  struct Doubt {
    double log_share = 0;  ///< below 0: meters read too little
    std::string reason;    ///< empty if there is no doubt
  };
  /// The largest doubt at a point.
  /// meter   the luxmeter there, if there is one
  [[nodiscard]] Doubt doubt_at(std::optional<std::size_t> meter, Measured measured) const;
  /// Adds the alarms to the status.
  void tell(ShowStatus& status, Measured measured) const;

  /// Drifting meters start again from their next reading: a person has applied the plan, and accepts the light.
  void forget_drift();
  void forget(std::size_t luxmeter) { drifts_[luxmeter] = {}; }
  void forget_all() { drifts_.assign(drifts_.size(), {}); }

 private:
  /// A meter's reading over what the model states, when it was first believed and now, as logarithms.
  struct Drift {
    bool anchored = false;
    double log_ratio = 0;
    std::vector<double> levels;  ///< per fixture, at that time
    Time since{};
    double log_change = 0;
    int seen = 0;  ///< samples in a row beyond what known causes explain
    Time known_since{};
  };
  [[nodiscard]] bool drifts_away(std::size_t luxmeter) const;
  [[nodiscard]] std::optional<double> drift_together(Measured measured) const;
  [[nodiscard]] std::string off_together_text() const;
  [[nodiscard]] std::string drift_text(std::size_t luxmeter) const;

  std::vector<std::string> names_;      ///< per luxmeter
  std::vector<Drift> drifts_;           ///< per luxmeter
  std::optional<double> off_together_;  ///< logarithm of all readings over the model, if surely not 0
  Time off_together_since_{};
};

}  // namespace luxrig
