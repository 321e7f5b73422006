/// Any answers of nodes, through every decoder of the canopen driver: SDO answers, heartbeats, emergency messages, PDOs
/// and error frames, to an axis that has one order. The axis must offer no other set-point, exceed no limit, take the
/// torque off no axis that may still be turning, and speak only with its own node. Input: for each frame its kind, its
/// size, its bytes; a cycle after each.
#include <algorithm>
#include <cstdlib>

#include "drivers/can/bus_state.h"
#include "drivers/can/cia402/axis.h"

namespace {

using namespace luxrig;

constexpr std::uint32_t kIds[] = {0x585, 0x705, 0x185, 0x285, 0x085, 0x586, 0x000, 0x080};
constexpr cia402::SetPoint kOrder{1234, 567, 890};

std::optional<Time> stopping_since;  ///< no control word since has let it turn

void check(Time now, const can::CanFrame& frame, const cia402::Axis& axis) {
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint32_t>(frame.data[at] | frame.data[at + 1] << 8 | frame.data[at + 2] << 16) |
           static_cast<std::uint32_t>(frame.data[at + 3]) << 24;
  };
  switch (frame.id) {
    case 0x000:
      if (frame.size != 2 || frame.data[1] != 5) std::abort();
      break;
    case 0x205: {
      if (frame.size != 6) std::abort();
      const int control = frame.data[0] | frame.data[1] << 8;
      // In homing, this bit starts the search for home; in profile position, it offers the target.
      if ((control & 0x0F) == 0x0F) stopping_since.reset();
      if ((control & 0x0F) != 0x0F && !stopping_since) stopping_since = now;
      if ((control & 0x0F) != 0x0F && control != 0x0002 &&
          now - *stopping_since < cia402::stops_within(axis.settings()))
        std::abort();
      const bool offers = (control & 0x30) == 0x30;
      if (offers && (!axis.ready() || word(2) != static_cast<std::uint32_t>(kOrder.position))) std::abort();
      break;
    }
    case 0x305:
      if (frame.size != 8 || word(0) != kOrder.speed || word(4) != kOrder.acceleration) std::abort();
      break;
    case 0x405:
      if (frame.size != 4 || word(0) != kOrder.acceleration) std::abort();
      break;
    case 0x605:
      if (frame.size != 8) std::abort();
      break;
    default:
      std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cia402::AxisSettings settings;
  settings.node = 5;
  settings.lowest = -100000;
  settings.highest = 100000;
  cia402::Axis axis(settings);
  can::BusState state;
  Time now{};
  axis.activate(now);
  stopping_since.reset();
  for (std::size_t at = 0; at + 2 <= size;) {
    const std::uint8_t kind = data[at], count = std::min<std::uint8_t>(data[at + 1] % 9, 8);
    at += 2;
    const std::size_t have = std::min<std::size_t>(count, size - at);
    can::CanFrame frame = can::data_frame(kIds[kind % 8], {data + at, have});
    at += have;
    frame.error = (kind & 0x40) != 0;
    if (frame.error) frame.id = kind * 4u;
    if (const auto again = can::from_bytes(can::to_bytes(frame)); !again || again->id != frame.id) std::abort();
    state.heard(frame);
    axis.receive(now, frame);
    if (axis.ready()) axis.order(kOrder);
    now += std::chrono::milliseconds((kind & 0x80) != 0 ? 400 : 20);
    cia402::Frames sent;
    axis.step(now, (kind & 0x20) != 0, true, (kind & 0x10) == 0, sent);
    for (const can::CanFrame& out : sent) check(now, out, axis);
    if (axis.trouble().size() > 500) std::abort();
  }
  return 0;
}
