#pragma once
/// Which request is due when: what must be written, in which runs of neighbouring registers, which meter is next, and
/// which unit is left alone for a while. `now` in, requests out; no socket.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/rig/rig.h"
#include "core/time.h"

namespace luxrig::modbus {

/// A dimmer channel and what its register is known to hold.
struct Channel {
  std::size_t fixture = 0;  ///< index in the rig
  ModbusPatch patch;
  std::optional<std::uint16_t> wanted_raw;     ///< nothing until the first setpoint
  std::optional<std::uint16_t> confirmed_raw;  ///< last value the device acknowledged
  std::optional<Time> tried;                   ///< last time it was written, with or without success
};

/// Units that do not answer are asked once a second, so that each costs its neighbours one timeout a second at most.
class UnitBackoff {
 public:
  [[nodiscard]] bool may_ask(int unit, Time now) const;
  void answered(int unit);
  void silent(int unit, Time now);
  [[nodiscard]] bool is_silent(int unit) const;
  void forget() { retry_at_.clear(); }

 private:
  std::map<int, Time> retry_at_;
};

/// Channels in the order of unit and register; a run of neighbours that are due together is one request.
class WriteSchedule {
 public:
  WriteSchedule(const Rig& rig, std::size_t bus, Duration refresh);

  [[nodiscard]] std::vector<Channel>& channels() { return channels_; }
  [[nodiscard]] const std::vector<Channel>& channels() const { return channels_; }

  struct Run {
    std::size_t begin = 0, end = 0;  ///< in channels()
    [[nodiscard]] std::size_t size() const { return end - begin; }
  };
  /// The runs due at `now`, starting behind the last one that was tried, so that a call cut short by its bound goes on
  /// where it stopped; silent units last, since their timeout ends the call. Due: changed (and not tried within
  /// kShortestRewrite), or not refreshed for `refresh`.
  [[nodiscard]] std::vector<Run> due(Time now, const UnitBackoff& units) const;
  void tried(const Run& run, Time now);
  void confirmed(const Run& run);
  /// After a lost connection nothing is known about any register.
  void forget();
  /// A unit that rejected function 16, or a register among its neighbours, gets single writes from now on.
  void write_singly(int unit) { single_[unit] = true; }

  static constexpr Duration kShortestRewrite = std::chrono::milliseconds(50);

 private:
  [[nodiscard]] bool is_due(const Channel& channel, Time now, const UnitBackoff& units) const;

  std::vector<Channel> channels_;
  Duration refresh_{};
  std::size_t next_ = 0;
  std::map<int, bool> single_;
};

}  // namespace luxrig::modbus
