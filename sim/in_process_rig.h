#pragma once
/// A whole rig without wires: the controller's device interfaces directly on a World, under any clock that the caller
/// steps. Faults as over the wire (sim/faults/faults.h), on fixtures, luxmeters and buses.
///
///   InProcessRig devices(rig, std::move(world));
///   for (Time now{}; now < end; now += 10ms) { devices.write(now, …); devices.read(now); … devices.health(now) … }

#include <deque>
#include <memory>

#include "core/output/devices.h"
#include "core/rig/rig.h"
#include "sim/faults/faults.h"
#include "sim/lamp_faults.h"
#include "sim/world/world.h"

namespace luxrig::sim {

struct InProcessOptions {
  Time start{};              ///< the controller's time at the start of the world's clock
  Duration write_latency{};  ///< from write() or move() to the fixture
  Duration read_latency{};   ///< from a meter's sample to read()
  std::uint64_t fault_seed = 1;  ///< of what is lost, doubled and garbled
  /// Silence after which health() calls a device that can answer faulted.
  Duration fault_after = std::chrono::milliseconds(500);
};

/// Serves all buses of the rig at once. If a bus is `dead`, write() returns a fault for a command to it, but still
/// sends commands to the other buses. read() returns a fault if no meter is left on a living bus.
/// Devices on DMX do not answer, so a failed fixture there is not noticed, as in reality; one on Modbus shows in
/// health().
class InProcessRig final : public LevelOutput, public Mover, public LuxReader {
 public:
  /// requires a world made for this rig; keeps a copy of the rig.
  InProcessRig(Rig rig, std::unique_ptr<World> world, const InProcessOptions& options = {});

  /// Each call first advances the world to `now`; an earlier time leaves it unchanged.
  Result<void> write(Time now, std::span<const LevelCommand> commands) override;
  Result<void> move(Time now, std::span<const AimCommand> commands) override;
  Result<std::vector<LuxReading>> read(Time now) override;

  /// Every bus, then the Modbus fixtures, the pan axes of heads with axes, and the luxmeters, in the rig's order.
  [[nodiscard]] std::vector<Health> health(Time now);

  void advance(Time now);
  /// World::stride, after what was sent has arrived.
  void stride(Time now);
  [[nodiscard]] World& world() { return *world_; }
  [[nodiscard]] Faults& faults() { return faults_; }

 private:
  struct Pending {
    Time due;
    std::size_t fixture;
    std::optional<double> drive;
    std::optional<Joints> joints;
  };
  struct Answer {
    Time due;
    LuxReading reading;
  };
  struct Device {
    Health health;
    std::size_t bus = 0;
    bool answers = false;
    Time silent_since{};  ///< first failed exchange, while it fails
    bool failing = false;
    std::string failure;
  };

  [[nodiscard]] bool bus_is_dead(std::size_t bus) const;
  Disturbance disturb(std::size_t bus, const std::string& device);
  void went_well(Device& device, Time now);
  void went_wrong(Device& device, Time now, const std::string& why);
  void apply_until(Time now);
  template <class Command, class Queue>
  Result<void> send(Time now, std::span<const Command> commands, std::vector<Device>& devices, const Queue& queue);

  Rig rig_;
  std::unique_ptr<World> world_;
  InProcessOptions options_;
  Faults faults_;
  LampFaults lamp_faults_;
  std::deque<Pending> pending_;
  std::deque<Answer> answers_;
  std::vector<Time> taken_;  ///< per luxmeter, last sample taken
  std::vector<Device> buses_, fixtures_, luxmeters_;
  std::vector<Device> heads_;  ///< per fixture, its axes
  std::uint64_t exchanges_ = 0;
};

}  // namespace luxrig::sim
