#pragma once
/// A bus of the simulated rig without wires, as a driver of the daemon. It notes what goes through it, and a lighting
/// desk can send to it.

#include <optional>
#include <string>
#include <vector>

#include "drivers/driver.h"
#include "sim/in_process_rig.h"

namespace luxrig::scenario {

/// The period of all buses, and of the control loop.
inline constexpr Duration kTick = std::chrono::milliseconds(20);

/// What goes over the wires between daemon and devices.
struct Wires {
  std::vector<double> drive;                      ///< per fixture, as last sent
  std::vector<std::optional<double>> reading_lx;  ///< per luxmeter, as last read
  std::vector<bool> sent;                         ///< per bus, since the last look
  /// Per fixture: what a lighting desk sends for it now; none: no desk does.
  std::vector<std::optional<DeskCommand>> desk;
};

/// One bus of the simulated rig.
class SteppedBus final : public Driver, public LevelOutput, public Mover, public LuxReader, public LevelInput {
 public:
  /// first: it reports the health of all. reads: it reads the luxmeters of all.
  SteppedBus(const Rig& rig, std::size_t bus, sim::InProcessRig& devices, Wires& wires, bool first, bool reads);

  [[nodiscard]] DriverBounds bounds() const override;
  Result<void> activate(Time) override { return {}; }
  void deactivate(Time) override {}
  [[nodiscard]] std::vector<Health> health(Time now) const override {
    return first_ ? devices_.health(now) : std::vector<Health>{};
  }
  LevelOutput* level_output() override { return fixtures_.empty() ? nullptr : this; }
  Mover* mover() override { return moves_ ? this : nullptr; }
  LuxReader* lux_reader() override { return reads_ ? this : nullptr; }
  LevelInput* level_input() override { return rules_ ? this : nullptr; }

  [[nodiscard]] DeskRules rules() const override { return *rules_; }
  [[nodiscard]] std::vector<DeskPart> parts() const override { return {{name_, fixtures_}}; }
  [[nodiscard]] std::span<const DeskFrame> listen(Time now) override;
  void set_silent(Time, std::size_t, bool silent) override { silent_ = silent; }

  Result<void> write(Time now, std::span<const LevelCommand> commands) override;
  Result<void> move(Time now, std::span<const AimCommand> commands) override;
  Result<std::vector<LuxReading>> read(Time now) override;

 private:
  sim::InProcessRig& devices_;
  Wires& wires_;
  std::size_t bus_;
  bool first_, reads_, moves_ = false, silent_ = false;
  std::optional<DeskRules> rules_;
  std::string name_;
  std::vector<std::size_t> fixtures_;
  DeskFrame frame_;
};

}  // namespace luxrig::scenario
