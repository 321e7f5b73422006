#include "drivers/can/cia402/axis_settings.h"

#include <algorithm>

#include "drivers/can/canopen/pdo_setup.h"
#include "drivers/can/cia402/drive_state.h"

namespace luxrig::cia402 {
namespace {

using canopen::little_endian;
using canopen::PdoDirection;

constexpr int kEverySync = 1;
constexpr std::uint32_t kQuickStopOnAbort = 3, kStayInState = 1;
constexpr std::uint32_t kRampThenOff = 2, kRampThenHold = 6;

}  // namespace

std::uint32_t consumer_entry(const AxisSettings& settings) {
  const auto timeout_ms = std::chrono::duration_cast<std::chrono::milliseconds>(heartbeat_timeout(settings)).count();
  return static_cast<std::uint32_t>(settings.master_node) << 16 | static_cast<std::uint32_t>(timeout_ms);
}

Duration stops_within(const AxisSettings& settings) {
  return from_seconds(static_cast<double>(settings.speed) / settings.acceleration) + 5 * settings.cycle;
}

std::vector<SetupStep> setup_steps(const AxisSettings& s) {
  std::vector<SetupStep> steps;
  const auto write = [&](std::uint16_t index, std::uint8_t sub, std::uint32_t value, int bytes, bool optional = false) {
    steps.push_back({{{index, sub}, little_endian(value, bytes)}, optional});
  };
  const auto pdo = [&](PdoDirection direction, int number, const std::vector<canopen::MappedObject>& mapped) {
    for (auto& request : canopen::pdo_setup(direction, number, s.node, kEverySync, mapped))
      steps.push_back({std::move(request), false});
  };
  const auto heartbeat_ms = std::chrono::duration_cast<std::chrono::milliseconds>(s.heartbeat).count();

  write(0x6040, 0, kQuickStop, 2, true);  // it may be turning; from here on it receives no PDOs
  pdo(PdoDirection::to_node, 1, {{{0x6040, 0}, 16}, {{0x607A, 0}, 32}});
  pdo(PdoDirection::to_node, 2, {{{0x6081, 0}, 32}, {{0x6083, 0}, 32}});
  pdo(PdoDirection::to_node, 3, {{{0x6084, 0}, 32}});
  pdo(PdoDirection::from_node, 1, {{{0x6041, 0}, 16}, {{0x6064, 0}, 32}, {{0x6061, 0}, 8}});
  pdo(PdoDirection::from_node, 2, {{{0x603F, 0}, 16}, {{0x606C, 0}, 32}});

  // When the master dies, the drive makes a quick stop and stays in its communication state.
  write(0x6007, 0, kQuickStopOnAbort, 2);
  write(0x1029, 1, kStayInState, 1, true);
  write(0x605A, 0, s.hold_on_stop ? kRampThenHold : kRampThenOff, 2);
  write(0x6085, 0, s.acceleration, 4);

  write(0x607C, 0, 0, 4);  // the home position's angle is added here, not by the drive: makers differ in its sign
  write(0x607D, 1, static_cast<std::uint32_t>(s.lowest), 4);
  write(0x607D, 2, static_cast<std::uint32_t>(s.highest), 4);
  write(0x6081, 0, s.speed, 4);
  write(0x6083, 0, s.acceleration, 4);
  write(0x6084, 0, s.acceleration, 4);
  if (s.home != HomeRule::never) {
    write(0x6098, 0, static_cast<std::uint32_t>(s.homing_method) & 0xFF, 1);
    write(0x6099, 1, s.homing_speed, 4);
    write(0x6099, 2, std::max(s.homing_speed / 4, 1u), 4);
    write(0x609A, 0, s.acceleration, 4);
  }
  write(0x1017, 0, static_cast<std::uint32_t>(heartbeat_ms), 2);
  write(0x1016, 1, consumer_entry(s), 4);  // last: with it, the node is fully set up
  return steps;
}

}  // namespace luxrig::cia402
