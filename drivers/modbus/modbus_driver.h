#pragma once
/// Dimmers and luxmeters behind any Modbus link: life cycle, request schedule, errors and recovery. See README.md.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/driver.h"
#include "drivers/io/deadline.h"
#include "drivers/life.h"
#include "drivers/modbus/modbus_contact.h"
#include "drivers/modbus/modbus_failure_bits.h"
#include "drivers/modbus/modbus_link.h"
#include "drivers/modbus/modbus_schedule.h"
#include "drivers/modbus/modbus_units.h"

namespace luxrig {

struct ModbusTiming {
  std::chrono::milliseconds response_timeout{200};
  Duration refresh{}, poll{};
  bool behind_gateway = false;  ///< a gateway between link and units adds its own delays
  std::optional<modbus::ContactPatch> contact{};
};

class ModbusDriver final : public Driver, public LevelOutput, public LuxReader {
 public:
  ModbusDriver(std::unique_ptr<modbus::Link> link, const ModbusTiming& timing, const Rig& rig, std::size_t bus);

  [[nodiscard]] DriverBounds bounds() const override;
  Result<void> activate(Time now) override;
  void deactivate(Time now) override;
  [[nodiscard]] std::vector<Health> health(Time) const override;
  LevelOutput* level_output() override { return channel_lives_.empty() ? nullptr : this; }
  LuxReader* lux_reader() override { return meters_.empty() && !contact_ ? nullptr : this; }
  Result<void> write(Time now, std::span<const LevelCommand> commands) override;
  [[nodiscard]] bool settled() const override { return writes_.all_confirmed(); }
  Result<std::vector<LuxReading>> read(Time now) override;
  [[nodiscard]] std::optional<Contact> contact(Time now) const override;

 private:
  struct Meter {
    std::size_t luxmeter = 0;
    ModbusMeterPatch patch;
    double range_lx = 0;
    LifeRecord life;
  };
  /// Result of one exchange, for the call that made it.
  enum class Outcome {
    done,     ///< answered without error
    refused,  ///< answered with an exception, or garbled: the fault is in fault_
    skipped,  ///< not asked: the unit rests or waits for its set-up
    over      ///< the call should end: a timeout has used up its bound, or the link is lost
  };

  [[nodiscard]] Fault inactive() const;
  [[nodiscard]] Duration asked_every() const;
  [[nodiscard]] Duration silence_allowed() const;
  /// Counts the time since the previous call as silence of the line, up to the period of calls plus slack. If this
  /// computer ran late, it was not listening in the rest.
  void count_silence(Time now);
  Result<void> set_wanted(std::span<const LevelCommand> commands);

  bool ensure_connected(Time now);
  bool connect(Time now);
  void disconnect();
  void bus_fault(Time now, const Fault& fault);
  void all_faulted(Time now, const Fault& fault);
  void reconnect_later(Time now);

  void answered(Time now, int unit);
  void unit_faulted(Time now, int unit, const Fault& fault);
  void unit_silent(Time now, int unit, const Fault& fault);
  /// One request, repeated once if it was garbled on the wire; sets values_ or fault_.
  Outcome ask(Time now, const modbus::Request& request, const Deadline& start_until);
  /// Writes the set-up registers of the unit's map.
  Outcome set_up(Time now, int unit, const Deadline& start_until);
  Outcome write_run(Time now, const modbus::WriteSchedule::Run& run, const Deadline& start_until);
  Outcome read_batch(Time now, const modbus::ReadSchedule::Batch& batch, const Deadline& start_until,
                     std::vector<LuxReading>& readings);
  Outcome read_failures(Time now, const modbus::FailureBits::Batch& batch, const Deadline& start_until);
  void read_contact(Time now, const Deadline& start_until);
  void take_reading(Time now, Meter& meter, std::span<const std::uint16_t> words, std::vector<LuxReading>& readings);

  std::unique_ptr<modbus::Link> link_;
  ModbusTiming timing_;
  std::map<int, modbus::UnitRules> rules_;
  modbus::WriteSchedule writes_;
  modbus::ReadSchedule reads_;
  modbus::FailureBits failures_;
  std::optional<modbus::ContactWatch> contact_;
  modbus::UnitBackoff units_silent_;
  modbus::UnitSetup setup_;
  std::map<int, Deadline> resting_;        ///< units that need a gap between requests
  std::vector<LifeRecord> channel_lives_;  ///< parallel to writes_.channels()
  std::vector<Meter> meters_;              ///< parallel to reads_.meters()
  LifeRecord life_;
  std::vector<std::uint16_t> values_;
  Fault fault_;
  Time last_answer_{}, answer_at_last_close_{};
  std::optional<Time> called_at_;
  Duration silence_{};   ///< since the last answer, as count_silence() counts
  int misses_ = 0;       ///< requests without an answer since then
  bool missed_ = false;  ///< one in this call
  Time connect_at_{};
  Duration backoff_{};
};

}  // namespace luxrig
