#pragma once
/// Judges a scenario's expectations while the show runs.

#include <optional>
#include <vector>

#include "tools/scenario/condition.h"
#include "tools/scenario/outcome.h"

namespace luxrig::scenario {

class Judge {
 public:
  /// Both must outlive it. slack_s: how far the instants of the show may be off (Slack::window_s).
  Judge(const Scenario& scenario, const Rig& rig, double slack_s = 0);

  void happened(std::size_t event, double at_s);
  /// Call at every instant, after the events of that instant.
  void look(double at_s, const Instant& instant);
  /// The verdicts; at_s: the end of the show.
  [[nodiscard]] std::vector<Judged> end(double at_s);

 private:
  struct State {
    std::optional<double> begins_s;  ///< none: its event has not happened
    bool over = false;               ///< judged
    bool known = false;              ///< its subject had a value at some instant of its time
    std::string last;                ///< value at the last look in its time
  };
  void fail(std::size_t e, double at_s, std::string found);
  /// Beginning and end of the time in which an expectation is judged; the end is after the show for one without. With
  /// slack, what has to hold all the time is judged in a shorter one, and what has to be reached in a longer one.
  [[nodiscard]] double from_s(std::size_t e) const;
  [[nodiscard]] double ends_s(std::size_t e) const;
  [[nodiscard]] double shrink_s(std::size_t e) const;  ///< how much shorter at either end

  const Scenario& scenario_;
  const Rig& rig_;
  double slack_s_;
  std::vector<State> states_;
  std::vector<Judged> judged_;
};

}  // namespace luxrig::scenario
