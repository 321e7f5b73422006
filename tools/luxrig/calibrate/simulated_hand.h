#pragma once
/// Somebody with a luxmeter in a simulated room: reads its true light as well as a hand does.

#include <random>
#include <stop_token>
#include <string>

#include "core/rig/rig.h"
#include "tools/http/client.h"
#include "tools/luxrig/calibrate/hand_answer.h"

namespace luxrig {

class SimulatedHand {
 public:
  /// The same simulated rig, the same meter: world seeds its gain and noise.
  SimulatedHand(HttpPeer sim_control, const std::string& world);

  /// A reading there once the light stands still. A fault if the simulator does not answer, or knows no such point.
  [[nodiscard]] Result<HandAnswer> read(const Point& point, const std::stop_token& stop);

 private:
  HttpPeer control_;
  std::mt19937_64 random_;
  double gain_;
};

}  // namespace luxrig
