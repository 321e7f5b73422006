#include "tools/scenario/stepped_bus.h"

#include "tools/scenario/desk.h"

namespace luxrig::scenario {
namespace {

constexpr Duration kReadPeriod = std::chrono::milliseconds(100);

}  // namespace

SteppedBus::SteppedBus(const Rig& rig, std::size_t bus, sim::InProcessRig& devices, Wires& wires, bool first,
                       bool reads)
    : devices_(devices),
      wires_(wires),
      bus_(bus),
      first_(first),
      reads_(reads),
      rules_(desk_rules(rig.buses[bus])),
      name_(rig.buses[bus].name) {
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Fixture& fixture = rig.fixtures[f];
    if (fixture.bus == bus) fixtures_.push_back(f);
    moves_ = moves_ || (fixture.moves && fixture.motion_bus() == bus);
  }
}

DriverBounds SteppedBus::bounds() const {
  DriverBounds bounds;
  bounds.write_period = kTick;
  bounds.read_period = kReadPeriod;
  return bounds;
}

std::span<const DeskFrame> SteppedBus::listen(Time) {
  frame_.commands.clear();
  for (const std::size_t f : fixtures_)
    if (wires_.desk[f]) frame_.commands.push_back(*wires_.desk[f]);
  frame_.presence = frame_.commands.empty() ? DeskPresence::absent : DeskPresence::present;
  if (!frame_.commands.empty()) frame_.source = "desk";
  return {&frame_, 1};
}

Result<void> SteppedBus::write(Time now, std::span<const LevelCommand> commands) {
  wires_.sent[bus_] = true;
  std::vector<LevelCommand> sent(commands.begin(), commands.end());
  // In standby the desk drives the lamps itself.
  for (LevelCommand& command : sent)
    if (const auto& desk = wires_.desk[command.fixture]; silent_ && desk) command.drive = desk->drive;
  for (const LevelCommand& command : sent) wires_.drive[command.fixture] = command.drive;
  return devices_.write(now, sent);
}

Result<void> SteppedBus::move(Time now, std::span<const AimCommand> commands) {
  std::vector<AimCommand> sent(commands.begin(), commands.end());
  for (AimCommand& command : sent)
    if (const auto& desk = wires_.desk[command.fixture]; silent_ && desk && desk->joints)
      command.joints = *desk->joints;
  return devices_.move(now, sent);
}

Result<std::vector<LuxReading>> SteppedBus::read(Time now) {
  auto readings = devices_.read(now);
  if (readings)
    for (const LuxReading& reading : *readings) wires_.reading_lx[reading.luxmeter] = reading.lux;
  return readings;
}

}  // namespace luxrig::scenario
