#pragma once
/// Turns a daemon's heads for measuring: where they may be sent, and when they are there.

#include <chrono>
#include <optional>
#include <stop_token>

#include "core/calibration/head_places.h"
#include "core/output/keep_out.h"
#include "tools/luxrig/calibrate/daemon_rig.h"

namespace luxrig {

class HeadTurner {
 public:
  using Clock = std::chrono::steady_clock;
  /// All lamps are held dark then. rig: as in its file.
  HeadTurner(const Rig& rig, DaemonRig& daemon, const std::stop_token& stop);

  /// With the keep-out zones and the range that the daemon's calibration leaves.
  [[nodiscard]] HeadSetup setup(std::size_t fixture, const HeadPriors& priors) const;
  /// The next head: it may look anywhere.
  void begin() { at_.reset(); }
  /// Returns when it will be there, and lit if it shall be.
  [[nodiscard]] Result<Clock::time_point> send(std::size_t fixture, const Joints& joints, bool lit);
  /// Reads luxmeters meanwhile, and keeps what is held.
  [[nodiscard]] Result<void> wait_until(Clock::time_point time);
  /// From an order to the light, or the movement, on the slowest bus; and a lamp's own lag.
  static constexpr std::chrono::milliseconds kObeys{300};

 private:
  const Rig& rig_;
  DaemonRig& daemon_;
  std::stop_token stop_;
  KeepOutZones zones_;        ///< as the daemon keeps them
  std::optional<Joints> at_;  ///< sent last
  Approach from_;
  Clock::time_point held_at_ = Clock::now();
};

}  // namespace luxrig
