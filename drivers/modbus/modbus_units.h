#pragma once
/// What is known of each unit of a bus: its limits from its register map, and whether it answers.

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
  std::size_t largest_read = kMostReadRegisters, largest_write = kMostWriteRegisters;
  std::shared_ptr<const RegisterMap> map;  ///< null: none of its devices has one
};

/// Every unit that a fixture or a luxmeter of the bus names, and that with its blackout contact. A unit's timeout is its product's longest time to an
/// answer with some slack for adapters; behind a gateway, which has its own reasons to be slow, not below
/// `response_timeout`. Without a register map: `response_timeout`.
[[nodiscard]] std::map<int, UnitRules> unit_rules(const Rig& rig, std::size_t bus,
                                                  std::chrono::milliseconds response_timeout, bool behind_gateway,
                                                  std::optional<int> contact_unit = {});

/// A unit that does not answer is asked again after `first_pause`, then after a second, then ever more seldom, every 2
/// s at most. What is waited for in vain is time that the units that answer do not get, so all silent units of a link
/// share a twentieth of it, and the one that has waited longest comes first (`before`). With some credit at the
/// beginning, a silent unit that is back is found within 2 s and kProbeShare times the sum of the silent units'
/// timeouts: 6 s for one of 200 ms, 42 s for ten; all of them with the first one when they come back together.
class UnitBackoff {
 public:
  static constexpr int kProbeShare = 20;  ///< one part in so many of the link's time
  /// As much may be waited in vain at once, before the share binds.
  static constexpr Duration kProbeCredit = std::chrono::milliseconds(500);

  [[nodiscard]] bool may_ask(int unit, Time now) const;
  /// Whether a comes before b when both are silent.
  [[nodiscard]] bool before(int a, int b) const;
  void answered(int unit);
  /// `waited`: for its answer, in vain.
  void silent(int unit, Time now, Duration first_pause, Duration waited);
  [[nodiscard]] bool is_silent(int unit) const { return silent_.contains(unit); }
  void forget();

 private:
  struct Silence {
    Time retry_at{};
    int times = 0;
  };
  std::map<int, Silence> silent_;
  Time paid_until_{};  ///< what was waited in vain is paid for by then
};

/// What must be written to units before anything else, since they may have restarted: the [[setup]] of their maps.
class UnitSetup {
 public:
  explicit UnitSetup(const std::map<int, UnitRules>& rules);

  struct Write {
    int first_register = 0;
    RegisterWords words;
    bool coil = false;
    std::string name;  ///< of the register
  };
  /// The next one; null when all has been written.
  [[nodiscard]] const Write* next(int unit) const;
  void written(int unit) { ++units_.at(unit).done; }
  void restart(int unit);
  void restart_all();

 private:
  struct Unit {
    std::vector<Write> writes;
    std::size_t done = 0;
  };
  std::map<int, Unit> units_;  ///< only those with something to write
};

}  // namespace luxrig::modbus
