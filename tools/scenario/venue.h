#pragma once
/// Where a show takes place: what differs between a stepped clock in this process and real time over the wire.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "sim/faults/faults.h"
#include "sim/world/world.h"
#include "tools/scenario/condition.h"

namespace luxrig::scenario {

/// How inexactly a venue sees the show. Rules and expectations get so much more room there. All 0: exactly.
struct Slack {
  double time_s = 0;     ///< between an order and what is seen of it, in light and status
  double frames_s = 0;   ///< frames of so long may arrive at once
  double silence_s = 0;  ///< a bus may be silent for so long without the daemon's fault
  double window_s = 0;   ///< the time of an expectation may be off by so much at either end
  double level = 0;      ///< levels on the wire are rounded by so much
};

/// How a daemon ended.
struct Ended {
  int code = 0;               ///< of its process
  bool in_safe_look = false;  ///< it says that it has reached it
};

class Venue {
 public:
  virtual ~Venue() = default;
  [[nodiscard]] virtual Slack slack() const { return {}; }
  /// Since the beginning of the show; the same through one tick.
  [[nodiscard]] virtual double seconds() const = 0;

  // ---- the daemon ----

  /// Starts one. first: returns when the solved plan is applied, and time begins (unless the show starts dark). Later
  /// ones go on from what the last one remembered, and may take until runs().
  [[nodiscard]] virtual Result<void> start(bool first) = 0;
  /// It can be commanded and gives its status.
  [[nodiscard]] virtual bool runs() const = 0;
  /// The newest; of a daemon that has gone, its last until the next one starts.
  [[nodiscard]] virtual const ShowStatus& status() const = 0;
  /// Something has the light if the daemon dies.
  [[nodiscard]] virtual bool guarded() const { return false; }
  /// Sends it a command; answered is called here or in a later advance(), once. plan_json: of apply.
  virtual void command(const Event& event, const std::string& plan_json,
                       std::function<void(const Result<void>&)> answered) = 0;
  /// Asks it to end in order.
  virtual void stop() = 0;
  /// After stop(): nullopt while it runs.
  [[nodiscard]] virtual std::optional<Ended> ended() = 0;
  /// It is no more, at once; with its guardian, if it has one.
  virtual void kill(bool with_guardian) = 0;
  /// Fault: there is none.
  [[nodiscard]] virtual Result<void> kill_guardian() = 0;

  // ---- the rig ----

  /// A lighting desk sends this for the fixture from now on; nullopt: no longer.
  virtual void desk(std::size_t fixture, const std::optional<DeskCommand>& command) = 0;
  [[nodiscard]] virtual sim::Faults& faults() = 0;
  /// The wall clock jumps. Fault: it is not ours to move.
  [[nodiscard]] virtual Result<void> step_wall_clock(double by_s) = 0;
  /// Changes the simulated world between two of its steps.
  virtual void in_room(const std::function<void(sim::World&)>& change) = 0;

  // ---- time ----

  /// Goes on by a tick. Fault: the run cannot go on, for a reason that is not the show's.
  [[nodiscard]] virtual Result<void> advance() = 0;
  /// Light, readings, levels and heads as they are now; sets `sent` of each bus that was written to since the last time.
  virtual void see(Instant& instant, std::vector<bool>& sent) = 0;
};

}  // namespace luxrig::scenario
