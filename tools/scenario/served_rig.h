#pragma once
/// The simulated rig on loopback ports, in real time, in a thread of this process: its truth is at hand.

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "core/result.h"
#include "sim/faults/faults.h"
#include "sim/wire/rig_server.h"
#include "sim/world/world.h"

namespace luxrig::scenario {

class ServedRig {
 public:
  /// rig must outlive it. fault_seed: of what is lost, doubled and garbled.
  [[nodiscard]] static Result<std::unique_ptr<ServedRig>> open(const Rig& rig, std::unique_ptr<sim::World> world,
                                                               std::uint64_t fault_seed);
  ~ServedRig();
  ServedRig(const ServedRig&) = delete;
  ServedRig& operator=(const ServedRig&) = delete;

  [[nodiscard]] std::map<std::string, int> ports() const { return server_->ports(); }
  /// Writes the ports file for a daemon. desk_ports: where it is to hear a lighting desk, by bus.
  [[nodiscard]] Result<void> write_ports(const std::filesystem::path& file,
                                         const std::map<std::string, int>& desk_ports) const;

  [[nodiscard]] sim::Faults& faults() { return faults_; }
  /// Calls it between two steps of the world.
  template <class Look>
  void with_world(const Look& look) {
    const std::lock_guard lock(mutex_);
    look(*world_);
  }
  /// The longest that the world stood still since the last call.
  [[nodiscard]] Duration longest_gap() { return Duration(longest_gap_ns_.exchange(0)); }

 private:
  ServedRig(std::unique_ptr<sim::World> world, std::uint64_t fault_seed)
      : world_(std::move(world)), faults_(fault_seed) {}
  bool goes_on(const std::stop_token& stop);

  std::unique_ptr<sim::World> world_;
  sim::Faults faults_;
  std::unique_ptr<sim::RigServer> server_;
  int no_control_ = -1;  ///< a port on which nobody listens
  int control_port_ = 0;
  std::mutex mutex_;  ///< of the world
  std::atomic<Duration::rep> longest_gap_ns_{0};
  Time last_turn_{};     ///< of the thread
  std::jthread thread_;  ///< last: it uses the members above
};

}  // namespace luxrig::scenario
