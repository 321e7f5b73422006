#pragma once
/// Judges a scenario's expectations while the show runs.

#include <optional>
#include <vector>

#include "tools/scenario/condition.h"
#include "tools/scenario/outcome.h"

namespace luxrig::scenario {

class Judge {
 public:
  /// Both must outlive it.
  Judge(const Scenario& scenario, const Rig& rig);

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
  /// End of an expectation's time; after the show for one without.
  [[nodiscard]] double ends_s(std::size_t e) const;

  const Scenario& scenario_;
  const Rig& rig_;
  std::vector<State> states_;
  std::vector<Judged> judged_;
};

}  // namespace luxrig::scenario
