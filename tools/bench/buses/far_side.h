#pragma once
/// The simulated far end of a bus of levels under a stepped clock. If the driver never waits, the caller serves it.
/// Else it has its own thread, and its clock runs on in real time while the driver waits for an answer.

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "drivers/registry.h"
#include "sim/wire/bus_endpoint.h"

namespace luxrig {

class FarSide {
 public:
  /// `rig` outlives it. The world has no deviations: a lamp gives exactly the level that is set.
  static Result<std::unique_ptr<FarSide>> open(const Rig& rig, bool driver_waits, std::uint64_t seed);
  ~FarSide();
  FarSide(const FarSide&) = delete;
  FarSide& operator=(const FarSide&) = delete;

  [[nodiscard]] Redirect redirect() const { return {"127.0.0.1", endpoint_->port(), endpoint_->path()}; }
  [[nodiscard]] sim::Faults& faults() { return faults_; }
  /// Serves the messages that have arrived, at `at` or later, and steps the world. Returns its clock.
  Time step_to(Time at);
  /// The true level of each lamp.
  [[nodiscard]] std::vector<double> levels() const;

 private:
  explicit FarSide(std::uint64_t seed) : faults_(seed) {}
  void run();
  void serve_now();

  sim::Faults faults_;
  std::unique_ptr<sim::World> world_;
  std::unique_ptr<sim::BusEndpoint> endpoint_;
  mutable std::mutex mutex_;
  Time base_{}, now_{};
  std::chrono::steady_clock::time_point base_real_{};
  std::atomic<std::uint64_t> rounds_{0};
  std::atomic<bool> stopping_{false};
  int wake_ = -1;  ///< an eventfd; -1 = no thread
  std::thread thread_;
};

}  // namespace luxrig
