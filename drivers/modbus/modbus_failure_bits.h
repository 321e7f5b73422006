#pragma once
/// Failure bits of products (lamp failure, too hot), and the fixtures of the bus that they concern. `now` in, requests
/// out; no socket.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/rig/rig.h"
#include "core/time.h"
#include "drivers/modbus/modbus_schedule.h"

namespace luxrig::modbus {

/// Period of the reads: they inform a person and control nothing.
inline constexpr Duration kFailuresEvery = std::chrono::seconds(1);

class FailureBits {
 public:
  /// channels: those of the bus, as in WriteSchedule.
  FailureBits(const std::map<int, UnitRules>& rules, std::span<const Channel> channels);

  /// One for each run of neighbours, within the unit's largest read.
  struct Batch {
    std::size_t begin = 0, end = 0;  ///< indices of bits
    Request request;
  };
  /// Batches due at `now`, without those of silent units.
  [[nodiscard]] std::vector<Batch> due(Time now, const UnitBackoff& units) const;
  void asked(const Batch& batch, Time now);
  /// The answer: 0 or 1 for each bit. requires bits.size() == batch.end - batch.begin.
  void answered(const Batch& batch, std::span<const std::uint16_t> bits);
  /// Forgets the bits of that unit, or of all.
  void forget(int unit);
  void forget();

  /// Names of the set bits of that channel, "lamp-failure2, too-hot"; empty = none known to be set.
  [[nodiscard]] std::string of_channel(std::size_t channel) const;

 private:
  struct Bit {
    int unit = 0, address = 0;
    bool discrete = false;
    std::string name;
    std::vector<std::size_t> channels;  ///< that it concerns
    bool set = false;
    std::optional<Time> asked;
  };
  std::vector<Bit> bits_;  ///< sorted by unit, table and address
  std::map<int, std::size_t> largest_;
};

}  // namespace luxrig::modbus
