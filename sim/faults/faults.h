#pragma once
/// Faults by name, per device: a fixture, a luxmeter or a whole bus, named as in the rig file. A scenario or the
/// simulator's control port switches them on and off; the wires and the in-process rig apply them.
///
///   lost       answers (or frames to it) are lost with probability value (default 0.5)
///   silent     receives everything, answers nothing; on a bus or a DMX fixture it also ignores what is sent
///   dead       bus: its socket is closed (TCP refused, UDP unreachable). Device: as silent
///   slow       answers value milliseconds late (default 300)
///   garbled    answers with bytes changed, truncated or too long; a different way each time
///   stuck      meter: keeps the reading from the start of the fault. Axis: it is blocked
///   lying      meter: shows value times its reading (default 0.5)
///   exception  answers with Modbus exception code value (default 4, device failure)
///   unpowered  has no power: no light, no answer; afterwards its registers have their power-on values
///
///   lamp_failure  fixture: its lamp gives no light; a Modbus product with failure bits sets them
///   pressed       bus with a blackout contact (rig file: blackout_input): it is pressed
///
/// On a serial line only, in its answers:
///   checksum        a wrong checksum
///   truncated       the last value bytes are missing (default 2)
///   gap             a pause of value milliseconds in the middle (default 600)
///   noise           value bytes of line noise before it (default 2)
///   wrong_unit      the number of another unit
///   wrong_function  the number of another function
///
/// On a bus that is a USB widget: dead unplugs it, silent makes transfers hang, exception stalls them, garbled stalls
/// control transfers and changes a byte of IN data.
///
///   duplicated CAN frames of an axis or bus, answers of a Modbus unit, DMX packets of a network go out twice, with
///              probability value (default 0.5)
///   reordered  the next DMX packet of a network overtakes one, with probability value (default 0.5)
///
/// On a CAN bus:
///   reset      axis: its electronics restart when this is switched on, as by a watchdog
///   unmappable axis: no PDO can carry its profile speed and accelerations (6081, 6083, 6084); refused with value
///              1: cannot be mapped, 2: would be too long, 3: value out of range (default 1). For set-ups from now on
///   bus_off    CAN bus: Luxrig's controller is off the bus
///
/// An axis of a head is called "NAME (pan axis)" or "NAME (tilt axis)". A dead axis has no power: it runs on by its
/// momentum, and its position is unknown when power returns.

#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig::sim {

enum class FaultKind {
  lost,
  silent,
  dead,
  slow,
  garbled,
  stuck,
  lying,
  exception,
  unpowered,
  checksum,
  truncated,
  gap,
  noise,
  wrong_unit,
  wrong_function,
  duplicated,
  reordered,
  reset,
  unmappable,
  bus_off,
  lamp_failure,
  pressed
};
[[nodiscard]] std::string_view name_of(FaultKind kind);
[[nodiscard]] std::optional<FaultKind> fault_named(std::string_view name);
[[nodiscard]] std::span<const FaultKind> all_faults();
/// One line for each: name, effect, and the value's range and default.
[[nodiscard]] std::string faults_in_words();

/// A fault that is on.
struct FaultOn {
  std::string device;
  FaultKind kind;
  double value;
};

/// What a person may set: `value` has a meaning only if `valued`.
struct FaultRange {
  bool valued = false;
  double least = 0, most = 1, fallback = 1;
  std::string_view does;  ///< in a few words
};
[[nodiscard]] FaultRange range_of(FaultKind kind);

/// Faults of one exchange with a device; by default none.
struct Disturbance {
  bool silent = false;
  bool garbled = false;
  bool duplicated = false, reordered = false;
  std::optional<int> exception;
  std::optional<FaultKind> on_line;  ///< a serial line fault
  double on_line_value = 0;
  Duration delay{};
  std::uint64_t random = 0;  ///< for random choices about it
};

/// May be switched in one thread and read in another.
class Faults {
 public:
  explicit Faults(std::uint64_t seed = 1) : seed_(seed) {}

  /// Switches a fault of a device on (value: as above, default if absent) or off.
  void set(const std::string& device, FaultKind kind, bool on, std::optional<double> value = {});
  /// Cause::invalid, with its remedy, for a device or fault unknown to the rig or a value out of range.
  Result<void> set_named(const Rig& rig, const std::string& device, std::string_view fault, bool on,
                         std::optional<double> value = {});
  void clear();

  /// Changes with each switch, so a frequent reader need not query every device.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// Whether any is on: without one, nothing need be asked for each device.
  [[nodiscard]] bool any() const { return any_; }
  /// All that are on, by device.
  [[nodiscard]] std::vector<FaultOn> all_on() const;
  /// Its value if it is on.
  [[nodiscard]] std::optional<double> find(const std::string& device, FaultKind kind) const;

  /// Effect of the faults of all these devices on one exchange. `counter`: a different number for each exchange.
  [[nodiscard]] Disturbance disturbance(std::span<const std::string> devices, std::uint64_t counter) const;

  /// Reading of a meter whose correct reading is `honest_lx`. Call it at least once per exchange: a stuck meter keeps
  /// the first value passed here.
  [[nodiscard]] double shown_lx(const std::string& meter, double honest_lx);

 private:
  mutable std::mutex mutex_;
  std::uint64_t seed_;
  std::atomic<std::uint64_t> revision_{1};
  std::atomic<bool> any_{false};
  std::map<std::pair<std::string, FaultKind>, double> on_;
  std::map<std::string, double> stuck_at_lx_;
};

}  // namespace luxrig::sim
