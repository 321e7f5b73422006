#pragma once
/// State of each unit of a bus: the limits from its register map, and whether it answers.

#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/rig/register_map/register_value.h"
#include "core/rig/rig.h"
#include "core/time.h"
#include "drivers/modbus/modbus_codec.h"

namespace luxrig::modbus {

struct UnitRules {
  std::chrono::milliseconds timeout{};
  std::chrono::milliseconds gap{};  ///< between two requests
  std::size_t largest_read = kMaxReadRegisters, largest_write = kMaxWriteRegisters;
  std::shared_ptr<const RegisterMap> map;  ///< null = none of its devices has one
};

/// Every unit of the bus's fixtures and luxmeters, and the unit of its blackout contact. A unit's timeout is its
/// product's longest answer time plus slack for adapters. Behind a gateway, which adds its own delays, it is at least
/// `response_timeout`. Without a register map: `response_timeout`.
[[nodiscard]] std::map<int, UnitRules> unit_rules(const Rig& rig, std::size_t bus,
                                                  std::chrono::milliseconds response_timeout, bool behind_gateway,
                                                  std::optional<int> contact_unit = {});

/// Asks a silent unit again after `first_pause`, then after 1 s, then at most every 2 s. Waiting in vain takes time
/// from the units that answer. So all silent units of a link share a twentieth of its time, and the longest unasked
/// comes first (`before`). After some initial credit, a silent unit that is back is found within 2 s plus kProbeShare
/// times the sum of the silent units' timeouts: 6 s for one unit with 200 ms, 42 s for ten. If they come back together,
/// the first one found brings all of them.
class UnitBackoff {
 public:
  static constexpr int kProbeShare = 20;  ///< silent units get 1 / kProbeShare of the link's time
  /// This much may be waited in vain at once before the share limits it.
  static constexpr Duration kProbeCredit = std::chrono::milliseconds(500);

  [[nodiscard]] bool may_ask(int unit, Time now) const;
  /// True if both are silent and a comes first.
  [[nodiscard]] bool before(int a, int b) const;
  void answered(int unit);
  /// `waited`: time spent on its missing answer.
  void silent(int unit, Time now, Duration first_pause, Duration waited);
  [[nodiscard]] bool is_silent(int unit) const { return silent_.contains(unit); }
  void forget();

 private:
  struct Silence {
    Time retry_at{};
    int times = 0;
  };
  std::map<int, Silence> silent_;
  Time paid_until_{};  ///< by then the time waited in vain is paid for
};

/// Registers to write to a unit first, since it may have restarted: the [[setup]] of its map.
class UnitSetup {
 public:
  explicit UnitSetup(const std::map<int, UnitRules>& rules);

  struct Write {
    int first_register = 0;
    RegisterWords words;
    bool coil = false;
    std::string name;  ///< of the register
  };
  /// The next write; null if all are done.
  [[nodiscard]] const Write* next(int unit) const;
  void written(int unit) { ++units_.at(unit).done; }
  void restart(int unit);
  void restart_all();

 private:
  struct Unit {
    std::vector<Write> writes;
    std::size_t done = 0;
  };
  std::map<int, Unit> units_;  ///< only units with something to write
};

}  // namespace luxrig::modbus
