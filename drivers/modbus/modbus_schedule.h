#pragma once
/// Schedules requests: which runs of neighbouring registers to write, and which meters to read together, at `now`.
/// `now` in, requests out; no socket.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/rig/rig.h"
#include "core/time.h"
#include "drivers/modbus/modbus_units.h"

namespace luxrig::modbus {

/// A dimmer channel and the known content of its register.
struct Channel {
  std::size_t fixture = 0;  ///< index in the rig
  ModbusPatch patch;
  std::optional<RegisterWords> wanted;     ///< empty until the first setpoint
  std::optional<RegisterWords> confirmed;  ///< last value the device acknowledged
  std::optional<Time> tried;               ///< last write, successful or not
};

/// Channels sorted by unit and register; a run of neighbours that are due together is one request.
class WriteSchedule {
 public:
  WriteSchedule(const Rig& rig, std::size_t bus, Duration refresh, const std::map<int, UnitRules>& rules);

  [[nodiscard]] std::vector<Channel>& channels() { return channels_; }
  [[nodiscard]] const std::vector<Channel>& channels() const { return channels_; }

  struct Run {
    std::size_t begin = 0, end = 0;  ///< in channels()
    std::size_t registers = 0;
    [[nodiscard]] std::size_t size() const { return end - begin; }
  };
  [[nodiscard]] Run alone(std::size_t channel) const;
  /// The request that writes the run's wanted values.
  [[nodiscard]] Request request_for(const Run& run) const;
  /// The runs due at `now`: changed (and not tried within kShortestRewrite), or not refreshed for `refresh`. They start
  /// after the last one tried, so a call cut short by its bound continues there. Silent units come last, since their
  /// timeout ends the call; of these, the longest unasked comes first.
  [[nodiscard]] std::vector<Run> due(Time now, const UnitBackoff& units) const;
  void tried(const Run& run, Time now);
  void confirmed(const Run& run);
  /// Every device has acknowledged its wanted value.
  [[nodiscard]] bool all_confirmed() const;
  /// After a lost connection the content of all registers is unknown.
  void forget();
  /// For a unit that rejected function 16, or a register among its neighbours: single writes from now on.
  void write_singly(int unit) { single_.insert(unit); }

  static constexpr Duration kShortestRewrite = std::chrono::milliseconds(50);

 private:
  [[nodiscard]] bool is_due(const Channel& channel, Time now, const UnitBackoff& units) const;

  std::vector<Channel> channels_;
  Duration refresh_{};
  std::map<int, std::size_t> largest_;  ///< registers in one request, by unit
  std::size_t next_ = 0;
  std::set<int> single_;
};

/// Meters sorted by unit, kind and register; neighbours of a unit that are due together are read at once.
class ReadSchedule {
 public:
  ReadSchedule(const Rig& rig, std::size_t bus, Duration poll, const std::map<int, UnitRules>& rules);

  /// Indices in the rig, in the order that Batch uses.
  [[nodiscard]] const std::vector<std::size_t>& meters() const { return meters_; }

  struct Batch {
    std::size_t begin = 0, end = 0;  ///< in meters()
    Request request;
  };
  /// The batches due at `now` or up to an eighth of `poll` later. They start after the last one asked; silent units
  /// come last, as above.
  [[nodiscard]] std::vector<Batch> due(Time now, const UnitBackoff& units) const;
  /// The next read is due `poll` after this one was due, so late calls do not slow a meter in the long run.
  void asked(const Batch& batch, Time now);
  void forget();
  /// For a unit that rejected a read of several registers: single reads from now on.
  void read_singly(int unit) { single_.insert(unit); }

 private:
  std::vector<std::size_t> meters_;
  std::vector<ModbusMeterPatch> patches_;
  std::vector<std::optional<Time>> due_at_;  ///< empty = never asked
  Duration poll_{};
  std::map<int, std::size_t> largest_;
  std::size_t next_ = 0;
  std::set<int> single_;
};

}  // namespace luxrig::modbus
