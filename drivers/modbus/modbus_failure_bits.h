#pragma once
/// Bits by which products say that something is wrong (lamp failure, too hot), and whom of the bus's fixtures that
/// concerns. `now` in, requests out; no socket.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/rig/rig.h"
#include "core/time.h"
#include "drivers/modbus/modbus_schedule.h"

namespace luxrig::modbus {

/// Asked so often: a person is told, nothing is controlled by them.
inline constexpr Duration kFailuresEvery = std::chrono::seconds(1);

class FailureBits {
 public:
  /// channels: of the bus, as in WriteSchedule.
  FailureBits(const std::map<int, UnitRules>& rules, std::span<const Channel> channels);

  /// One for each run of neighbours, no larger than the unit's map allows.
  struct Batch {
    std::size_t begin = 0, end = 0;  ///< of the bits
    Request request;
  };
  /// Those due at `now`; of silent units none.
  [[nodiscard]] std::vector<Batch> due(Time now, const UnitBackoff& units) const;
  void asked(const Batch& batch, Time now);
  /// What was answered: 0 or 1 for each bit. requires bits.size() == batch.end - batch.begin.
  void answered(const Batch& batch, std::span<const std::uint16_t> bits);
  /// Nothing is known any more of that unit, or of any.
  void forget(int unit);
  void forget();

  /// Names of the bits that are set and concern that channel, "lamp-failure2, too-hot"; empty: none is known to be.
  [[nodiscard]] std::string of_channel(std::size_t channel) const;

 private:
  struct Bit {
    int unit = 0, address = 0;
    bool discrete = false;
    std::string name;
    std::vector<std::size_t> channels;  ///< whom it concerns
    bool set = false;
    std::optional<Time> asked;
  };
  std::vector<Bit> bits_;  ///< in the order of unit, table and address
  std::map<int, std::size_t> largest_;
};

}  // namespace luxrig::modbus
