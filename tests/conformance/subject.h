#pragma once
/// The driver under test, its peer, and a clock that both follow. Everything asked of a driver or visible to it is one
/// number, its drive: the level of all lamps of a bus, the aim of heads on axes, or the light before a camera.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/driver.h"
#include "sim/faults/faults.h"

namespace luxrig {

class Subject {
 public:
  virtual ~Subject() = default;

  std::unique_ptr<Driver> driver;
  DriverBounds bounds;
  Time now = Time{} + std::chrono::seconds(1);
  Result<void> last;                            ///< of the last cycle()
  Duration worst_over_bound = Duration::min();  ///< of all calls so far

  [[nodiscard]] Health bus() const { return driver->health(now).at(0); }

  /// The driver's main call, once: a write, a move, a picture.
  virtual Result<void> call(double drive) = 0;
  /// One cycle of the control loop: calls, and the time that it takes.
  virtual void cycle(double drive) = 0;
  [[nodiscard]] virtual Duration period() const = 0;
  /// Runs cycles until a peer that obeys at once has obeyed.
  virtual void settle(double drive, int obeys_within = 8) {
    for (int i = 0; i < obeys_within; ++i) cycle(drive);
  }
  /// True if the peer is at this drive, or was seen at it.
  [[nodiscard]] virtual bool at(double drive) const = 0;
  /// True if the peer is at one of the two; heads may also be between them.
  [[nodiscard]] virtual bool at_either(double before, double current) const = 0;
  /// True if the peer is as agreed for a driver that stops. `drive` was asked last.
  virtual bool left_as_agreed(double drive) = 0;

  /// Sets a fault at the far end, or clears all faults.
  virtual void set_fault(sim::FaultKind fault) = 0;
  virtual void clear_faults() = 0;

  /// Number of the peer's answers that may have been late because the machine held it up.
  [[nodiscard]] virtual std::uint64_t answers_held_up() const { return 0; }
  /// True if the peer is as it was before the driver.
  [[nodiscard]] virtual bool untouched() = 0;
  /// Outputs that one cycle may have to serve.
  [[nodiscard]] virtual double outputs() const { return 1; }

  /// Tests the driver's other capabilities with expectations of its own.
  virtual void try_other_capabilities() {}
  /// Requests that the driver should have refused (Cause::invalid) but accepted; empty if all is good. The peer must
  /// not notice any of them.
  [[nodiscard]] virtual std::vector<std::string> bad_requests_taken() = 0;
};

struct Kind {
  std::string name;
  std::function<std::unique_ptr<Subject>()> connected;
  /// A driver without a peer.
  std::function<std::unique_ptr<Driver>()> alone;
  bool sends_by_itself = true;  ///< at a fixed rate, to a peer that expects it
  /// Output of a few calls under a stepped clock.
  std::function<std::vector<std::vector<std::uint8_t>>()> record;
  /// Problems of an option with one letter too many in line 33; `known` receives the correct name.
  std::function<std::vector<Problem>(std::string& known)> problems_of_misspelt_option;
  int option_column = 4;
};

/// Every driver of the registry, then cameras.
[[nodiscard]] std::vector<Kind> bus_kinds();
[[nodiscard]] std::vector<Kind> camera_kinds();

}  // namespace luxrig
