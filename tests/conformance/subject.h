#pragma once
/// What the suite of all drivers knows of the one under test: the driver, what it is connected to, and a clock that
/// both follow. What is asked of it, or is there for it to see, is one number, its drive: the level of all lamps of a
/// bus, where heads on axes look, the light before a camera.

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
  Result<void> last;                            ///< of cycle()
  Duration worst_over_bound = Duration::min();  ///< of all calls until now

  [[nodiscard]] Health bus() const { return driver->health(now).at(0); }

  /// What the driver is for, once: a write, a move, a picture.
  virtual Result<void> call(double drive) = 0;
  /// One cycle of the control loop: calls, and the time that it takes.
  virtual void cycle(double drive) = 0;
  [[nodiscard]] virtual Duration period() const = 0;
  /// Cycles until a peer that obeys at once has obeyed.
  virtual void settle(double drive, int obeys_within = 8) {
    for (int i = 0; i < obeys_within; ++i) cycle(drive);
  }
  /// Where the peer is, or what it has been seen to be.
  [[nodiscard]] virtual bool at(double drive) const = 0;
  /// At one of the two and nothing else; heads may be on their way.
  [[nodiscard]] virtual bool at_either(double before, double current) const = 0;
  /// The peer has been left as it was agreed for a driver that stops; `drive` was asked last.
  virtual bool left_as_agreed(double drive) = 0;

  /// Something goes wrong at the far end, or nothing any more.
  virtual void set_fault(sim::FaultKind fault) = 0;
  virtual void clear_faults() = 0;

  /// How many of the peer's answers may have been late, as the machine kept it from its work.
  [[nodiscard]] virtual std::uint64_t answers_held_up() const { return 0; }
  /// The peer is as it was before the driver was.
  [[nodiscard]] virtual bool untouched() = 0;
  /// Things that one cycle may have to send to.
  [[nodiscard]] virtual double outputs() const { return 1; }

  /// Everything else that the driver can: expectations of its own.
  virtual void try_other_capabilities() {}
  /// What it should have refused (Cause::invalid) and did not; empty: good. The peer has not noticed anything.
  [[nodiscard]] virtual std::vector<std::string> bad_requests_taken() = 0;
};

struct Kind {
  std::string name;
  std::function<std::unique_ptr<Subject>()> connected;
  /// Of which nobody is at the other end.
  std::function<std::unique_ptr<Driver>()> alone;
  bool sends_by_itself = true;  ///< in a rhythm, to a peer that wants to hear it
  /// What comes out of a few calls under a stepped clock.
  std::function<std::vector<std::vector<std::uint8_t>>()> record;
  /// Of an option with a letter too many, in line 33; `known` is what it is without.
  std::function<std::vector<Problem>(std::string& known)> problems_of_misspelt_option;
  int option_column = 4;
};

/// Every line of the registry, then cameras.
[[nodiscard]] std::vector<Kind> bus_kinds();
[[nodiscard]] std::vector<Kind> camera_kinds();

}  // namespace luxrig
