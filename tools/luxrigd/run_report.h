#pragma once
/// Report of a run at the terminal, and its table as JSON.

#include <filesystem>
#include <optional>
#include <string>

#include "core/rig/rig.h"
#include "core/show/alarm_log.h"
#include "core/show/show_controller.h"
#include "tools/luxrigd/teller.h"
#include "tools/process/clock.h"
#include "tools/process/sim_process.h"

namespace luxrig {

class RunReport {
 public:
  /// The teller must outlive it.
  RunReport(Teller& teller, const Rig& rig, Time process_start) : teller_(teller), rig_(&rig), start_(process_start) {}

  /// The rig of each status from here on. It must outlive this object, or the next call.
  void use(const Rig& rig) { rig_ = &rig; }

  /// One line, with the seconds since the process began.
  void say(const std::string& line) const;
  /// Prints lines unchanged.
  void print(const std::string& text) const { teller_.tell(text); }
  /// Prints changes since the last call: phase, first readings, rounds, alarms.
  void follow(const ShowStatus& status, Time now);
  /// Table with point, goal, predicted, measured, error, limit, and truth if known.
  [[nodiscard]] std::string table(const ShowStatus& status, const std::optional<SimTruth>& truth) const;
  /// The same as JSON; `converged_s`: seconds from process start to the end of the correction.
  [[nodiscard]] std::string json(const ShowStatus& status, const std::optional<SimTruth>& truth,
                                 double converged_s) const;

 private:
  void say_readings(const ShowStatus& status) const;

  Teller& teller_;
  const Rig* rig_;
  Time start_;
  Phase phase_ = Phase::idle;
  int round_ = -1;
  AlarmLog alarms_;
};

}  // namespace luxrig
