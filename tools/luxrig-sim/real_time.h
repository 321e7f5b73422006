#pragma once
/// The simulated rig in real time: steps the world at 100 Hz and serves the wires as packets arrive.

#include <poll.h>

#include <chrono>
#include <ctime>
#include <functional>
#include <mutex>
#include <vector>

#include "sim/wire/rig_server.h"
#include "sim/world/world.h"

namespace luxrig::sim {

/// Returns when goes_on() is false; it is asked at every turn.
inline void serve_in_real_time(World& world, RigServer& server, std::mutex& world_mutex,
                               const std::function<bool()>& goes_on) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  std::vector<pollfd> waiting;
  while (goes_on()) {
    const auto elapsed = Clock::now() - start;
    const Time now = Time{} + std::chrono::duration_cast<Duration>(elapsed);
    {
      const std::lock_guard lock(world_mutex);
      world.advance(now);
      server.serve(now);
    }
    waiting.clear();
    for (const int descriptor : server.descriptors()) waiting.push_back({descriptor, POLLIN, 0});
    const auto rest = kTick - elapsed % kTick;
    const timespec until_tick{0, std::chrono::duration_cast<std::chrono::nanoseconds>(rest).count()};
    ::ppoll(waiting.data(), waiting.size(), &until_tick, nullptr);
  }
}

}  // namespace luxrig::sim
