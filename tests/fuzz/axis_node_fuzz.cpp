/// The simulated axis with any frames from a master: it must take every frame, send only its own, keep its joint
/// between the end stops, and know no position after a reset. Input: for each frame the identifier (2 bytes), its size
/// and the delay until the next, then its bytes.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "sim/wire/can/axis_node.h"

namespace {

using namespace luxrig;

// Identifiers that a node listens to come up more often than one in two thousand.
constexpr std::uint32_t kOfTheNode[] = {0x605, 0x205, 0x305, 0x405, 0x505, 0x000, 0x080, 0x77F};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  sim::AxisTruth truth;
  truth.stop_min_deg = -50;
  truth.stop_max_deg = 60;
  truth.switch_min_deg = -45;
  truth.switch_max_deg = 55;
  sim::AxisNode node(5, truth, 0, 200);
  Time now{};
  node.set_power(now, true);
  int steps = 0;
  for (std::size_t at = 0; at + 4 <= size && steps < 3000;) {
    const std::uint32_t id = (data[at] & 0x80) != 0 ? kOfTheNode[data[at + 1] % 8]
                                                    : static_cast<std::uint32_t>(data[at] << 8 | data[at + 1]) & 0x7FF;
    const std::size_t count = std::min<std::size_t>({data[at + 2] % 9u, 8u, size - at - 4});
    const int wait_ms = data[at + 3] % 64 == 63 ? 400 : data[at + 3] % 64;
    const bool stuck = (data[at + 3] & 0x80) != 0;
    at += 4;
    node.receive(now, sim::bus_frame(id, {data + at, count}));
    const bool reset =
        id == 0 && count == 2 && (data[at] == 0x81 || data[at] == 0x82) && (data[at + 1] == 0 || data[at + 1] == 5);
    if (reset && (node.drive().homed() || node.drive().position() != 0)) std::abort();
    at += count;
    for (int i = 0; i < wait_ms; ++i, ++steps) {
      now += std::chrono::milliseconds(1);
      node.step(now, stuck);
      const double joint = node.drive().joint_deg();
      if (!std::isfinite(joint) || joint < -50.1 || joint > 60.1) std::abort();
    }
    for (const sim::BusFrame& frame : node.take_sent()) {
      if (frame.size > 8) std::abort();
    }
  }
  return 0;
}
