#pragma once
/// Faults that no device reports, found by readings that do not fit together: a lamp that went dark, a meter that is
/// covered, two that were exchanged, a lamp that was knocked (core/estimation/change_cause.h). It only says what it finds,
/// with the evidence; it changes no light and no estimate.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/estimation/change_cause.h"
#include "core/estimation/gain_estimator.h"
#include "core/show/show_controller.h"

namespace luxrig {

class FaultWatch {
 public:
  explicit FaultWatch(const Rig& rig);

  /// The light changes until `settled`. What meters show from then on counts, once the slowest has followed.
  void light_changes(Time settled);
  /// Every reading, believed or not.
  void hear(const LuxReading& reading);
  /// Call it under steady light, as often as you like. levels: per fixture.
  void look(Time now, const GainEstimator& estimator, const std::vector<double>& levels);
  /// Adds the alarm, if something is found.
  void tell(ShowStatus& status) const;
  /// All readings so far are of another light, another rig, or are taken as right.
  void forget();

  struct Finding {
    std::vector<ChangeCause> causes;  ///< one, or those between which the meters cannot decide
    std::string text;                 ///< with the evidence, and what to do
    Time since{};
  };
  [[nodiscard]] const std::optional<Finding>& found() const { return found_; }

 private:
  /// Reading over what the model states, while nothing is wrong.
  struct Usual {
    double ratio = 0, variance = 0;
    int samples = 0;
    std::vector<double> recent{};  ///< the last few ratios, oldest first
    bool fresh = false;            ///< the last of them is of this look
    double since_sum = 0;          ///< of ratios since something changed
    int since_samples = 0;
    void learn(double now);
    [[nodiscard]] bool known() const;
    [[nodiscard]] double deviation() const;
    [[nodiscard]] bool differs() const;
  };
  /// Means of what was heard since the last look, and whether any is not usual.
  [[nodiscard]] bool take_heard(const GainEstimator& estimator, const std::vector<double>& levels);
  /// Error of a meter's usual reading under these levels, as lamps have changed since it was learnt [lx].
  [[nodiscard]] double error_of_levels(const GainEstimator& estimator, std::size_t luxmeter,
                                       const std::vector<double>& levels) const;
  [[nodiscard]] LightChange change(const GainEstimator& estimator, const std::vector<double>& levels) const;
  void judge(Time now, const LightChange& change);
  [[nodiscard]] std::string words(const ChangeCause& cause) const;
  [[nodiscard]] std::string evidence(const LightChange& change) const;

  std::vector<std::string> fixtures_, meters_;
  std::vector<Usual> usual_;       ///< per luxmeter
  std::vector<double> learnt_at_;  ///< levels when it began to be learnt
  std::vector<double> last_levels_;
  struct Heard {
    double sum_lx = 0;
    int count = 0;
    Time last{};
  };
  std::vector<Heard> heard_;  ///< per luxmeter, since the last look
  Time steady_from_{}, looked_at_{};
  bool changed_ = false;  ///< some meter reads something else than usual
  Time changed_since_{};
  int quiet_ = 0;                       ///< samples in a row without a difference
  std::vector<ChangeCause> candidate_;  ///< of the last sample
  int same_ = 0;                        ///< samples in a row with that
  std::optional<Finding> found_;
};

}  // namespace luxrig
