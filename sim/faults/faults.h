#pragma once
/// What can be made to go wrong, by name, per device: a fixture, a luxmeter or a whole bus, named as in the rig file.
/// A scenario or the simulator's control port switches them on and off; the wires and the in-process rig obey.
///
///   lost       answers (or frames to it) go missing with probability value (default 0.5)
///   silent     gets everything, answers nothing; on a bus or a DMX fixture: what is sent has no effect either
///   dead       bus: its socket is closed (TCP refused, UDP unreachable). Device: as silent
///   slow       answers value milliseconds late (default 300)
///   garbled    answers with bytes changed, cut short or too long; a different way each time
///   stuck      meter: shows for ever what it showed when this began. Axis: something blocks it
///   lying      meter: shows value times what it should (default 0.5)
///   exception  answers with Modbus exception code value (default 4, device failure)
///   unpowered  has no power: no light, no answer; afterwards its registers are as they are when power comes
///
///   lamp_failure  fixture: its lamp gives no light; on Modbus a product with failure bits says so in them
///   pressed       bus with a blackout contact (rig file: blackout_input): somebody presses it
///
/// On a serial line only, of its answers:
///   checksum        a wrong checksum
///   truncated       the last value bytes are missing (default 2)
///   gap             a pause of value milliseconds in the middle (default 600)
///   noise           value bytes of line noise before it (default 2)
///   wrong_unit      the number of another unit
///   wrong_function  the number of another function
///
/// On a bus that is a USB widget: dead unplugs it, silent makes transfers hang, exception stalls them, garbled stalls
/// control transfers and spoils a byte of what comes in.
///
///   duplicated CAN frames of an axis or bus, answers of a Modbus unit, DMX packets of a network go out twice, with
///              probability value (default 0.5)
///   reordered  DMX packets of a network are overtaken by the next, with probability value (default 0.5)
///
/// On a CAN bus:
///   reset      axis: its electronics begin anew when this is switched on, as by a watchdog
///   unmappable axis: no PDO can carry its profile speed and accelerations (6081, 6083, 6084); refused with value
///              1: cannot be mapped, 2: would be too long, 3: value out of range (default 1). For set-ups from now on
///   bus_off    CAN bus: Luxrig's controller is off the bus
///
/// An axis of a head is called "NAME (pan axis)" or "NAME (tilt axis)"; dead, it has no power: it turns on by its
/// momentum, and knows no position when power is back.

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
/// A line for each: its name, what happens, and of its value the range and the default.
[[nodiscard]] std::string faults_in_words();

/// How one exchange with a device goes wrong; all default = it goes well.
struct Disturbance {
  bool silent = false;
  bool garbled = false;
  bool duplicated = false, reordered = false;
  std::optional<int> exception;
  std::optional<FaultKind> on_line;  ///< one of those of a serial line
  double on_line_value = 0;
  Duration delay{};
  std::uint64_t random = 0;  ///< for whatever is to be done at random about it
};

/// May be switched from one thread and obeyed on another.
class Faults {
 public:
  explicit Faults(std::uint64_t seed = 1) : seed_(seed) {}

  /// Switches a fault of a device on (value: as above, default when absent) or off.
  void set(const std::string& device, FaultKind kind, bool on, std::optional<double> value = {});
  /// Cause::invalid, with what would mend it, for a device or fault the rig does not know or a value out of range.
  Result<void> set_named(const Rig& rig, const std::string& device, std::string_view fault, bool on,
                         std::optional<double> value = {});
  void clear();

  /// Another number after each change: who looks often need not ask about every device.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// Its value when it is on.
  [[nodiscard]] std::optional<double> find(const std::string& device, FaultKind kind) const;

  /// What the faults of any of these devices do to one exchange. `counter`: a different number for each exchange.
  [[nodiscard]] Disturbance disturbance(std::span<const std::string> devices, std::uint64_t counter) const;

  /// What a meter shows that would honestly show `honest_lx`. Call it at least at every exchange: a stuck meter keeps
  /// the first value it is asked about.
  [[nodiscard]] double shown_lx(const std::string& meter, double honest_lx);

 private:
  mutable std::mutex mutex_;
  std::uint64_t seed_;
  std::atomic<std::uint64_t> revision_{1};
  std::map<std::pair<std::string, FaultKind>, double> on_;
  std::map<std::string, double> stuck_at_lx_;
};

}  // namespace luxrig::sim
