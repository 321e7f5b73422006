#pragma once
/// Which request is due when: what must be written in which runs of neighbouring registers, and which meters are read
/// together. `now` in, requests out; no socket.

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

/// A dimmer channel and what its register is known to hold.
struct Channel {
  std::size_t fixture = 0;  ///< index in the rig
  ModbusPatch patch;
  std::optional<RegisterWords> wanted;     ///< nothing until the first setpoint
  std::optional<RegisterWords> confirmed;  ///< last value the device acknowledged
  std::optional<Time> tried;               ///< last time it was written, with or without success
};

/// Channels in the order of unit and register; a run of neighbours that are due together is one request.
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
  /// What writes the run's wanted values.
  [[nodiscard]] Request request_for(const Run& run) const;
  /// The runs due at `now`, starting behind the last one that was tried, so that a call cut short by its bound goes on
  /// where it stopped; silent units last, since their timeout ends the call, the longest unasked first. Due: changed
  /// (and not tried within kShortestRewrite), or not refreshed for `refresh`.
  [[nodiscard]] std::vector<Run> due(Time now, const UnitBackoff& units) const;
  void tried(const Run& run, Time now);
  void confirmed(const Run& run);
  /// Every device has acknowledged what is wanted of it now.
  [[nodiscard]] bool all_confirmed() const;
  /// After a lost connection nothing is known about any register.
  void forget();
  /// A unit that rejected function 16, or a register among its neighbours, gets single writes from now on.
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

/// Meters in the order of unit, kind and register; neighbours of a unit that are due together are read at once.
class ReadSchedule {
 public:
  ReadSchedule(const Rig& rig, std::size_t bus, Duration poll, const std::map<int, UnitRules>& rules);

  /// Indices in the rig, in the order of Batch.
  [[nodiscard]] const std::vector<std::size_t>& meters() const { return meters_; }

  struct Batch {
    std::size_t begin = 0, end = 0;  ///< in meters()
    Request request;
  };
  /// The batches due at `now` or up to an eighth of `poll` later, starting behind the last one that was asked; those of
  /// silent units last, as above.
  [[nodiscard]] std::vector<Batch> due(Time now, const UnitBackoff& units) const;
  /// The next is due `poll` after this one was, so that calls that are late make no meter slower in the long run.
  void asked(const Batch& batch, Time now);
  void forget();
  /// A unit that rejected a read of several is asked for each by itself from now on.
  void read_singly(int unit) { single_.insert(unit); }

 private:
  std::vector<std::size_t> meters_;
  std::vector<ModbusMeterPatch> patches_;
  std::vector<std::optional<Time>> due_at_;  ///< nothing: never asked
  Duration poll_{};
  std::map<int, std::size_t> largest_;
  std::size_t next_ = 0;
  std::set<int> single_;
};

}  // namespace luxrig::modbus
