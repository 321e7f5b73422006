#pragma once
/// A simulated far end of one bus, served by its own thread: a driver may block while it waits for an answer.

#include <poll.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/registry.h"
#include "sim/faults/faults.h"
#include "sim/wire/bus_endpoint.h"
#include "sim/world/world.h"

namespace luxrig {

class FarEnd {
 public:
  /// Meters see 100 lx from each fixture at full level. The world has no deviations: outputs follow their settings
  /// exactly.
  /// runs_on: how far its clock may go on by itself after step_to(), for drivers that wait for answers.
  explicit FarEnd(const Rig& rig, Duration runs_on = std::chrono::hours(1)) : rig_(rig), runs_on_(runs_on) {
    const auto rows = static_cast<Eigen::Index>(rig.points.size() + rig.luxmeters.size());
    const Eigen::MatrixXd light = Eigen::MatrixXd::Constant(rows, static_cast<Eigen::Index>(rig.fixtures.size()), 100);
    auto world = sim::World::make(rig, sim::Deviations::none(), light);
    if (!world) throw std::runtime_error(world.error().detail);
    world_ = std::move(*world);
    auto endpoint = sim::open_endpoint({rig_, 0, *world_, faults_}, 0);
    if (!endpoint) throw std::runtime_error(endpoint.error().detail);
    endpoint_ = std::move(*endpoint);
    redirect_ = Redirect{"127.0.0.1", endpoint_->port(), endpoint_->path()};
    thread_ = std::thread([this] { run(); });
  }
  ~FarEnd() {
    stopping_ = true;
    thread_.join();
  }
  FarEnd(const FarEnd&) = delete;
  FarEnd& operator=(const FarEnd&) = delete;

  [[nodiscard]] int port() const { return redirect_.port; }
  /// The address for a driver.
  [[nodiscard]] const Redirect& redirect() const { return redirect_; }
  sim::Faults& faults() { return faults_; }

  /// Sets the far end's clock to `now`; from there it runs in real time, and never goes back. Returns once everything
  /// that had arrived has been served.
  void step_to(Time now) {
    {
      const std::lock_guard lock(mutex_);
      base_ = now;
      base_real_ = std::chrono::steady_clock::now();
    }
    serve_what_arrived();
  }
  /// Returns once everything that had arrived has been served.
  void serve_what_arrived() const {
    const std::uint64_t wanted = rounds_ + 2;
    while (rounds_ < wanted) std::this_thread::yield();
  }
  /// Answers that may have been late because the machine held up this far end, since its start. Drivers wait 180 ms and
  /// more for an answer, which takes at most three rounds. A driver that misses no more answers than these may be
  /// right.
  [[nodiscard]] std::uint64_t answers_held_up() const { return answers_held_up_; }
  [[nodiscard]] std::vector<double> drives() const {
    const std::lock_guard lock(mutex_);
    return world_->drives();
  }
  [[nodiscard]] std::vector<Joints> joints() const {
    const std::lock_guard lock(mutex_);
    return world_->joints();
  }
  [[nodiscard]] double meter_lx(std::size_t luxmeter) const {
    const std::lock_guard lock(mutex_);
    return world_->meter_reading_lx(luxmeter);
  }

 private:
  void run() {
    auto last_round = std::chrono::steady_clock::now();
    while (!stopping_) {
      std::vector<pollfd> waits;
      {
        const std::lock_guard lock(mutex_);
        const auto since = std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - base_real_);
        now_ = std::max(now_, base_ + std::min(since, runs_on_));
        endpoint_->serve(now_);
        world_->advance(now_);
        std::vector<int> descriptors;
        endpoint_->descriptors(descriptors);
        const auto served = std::chrono::steady_clock::now();
        if (served - last_round > std::chrono::milliseconds(50))
          answers_held_up_ += 1 + static_cast<std::uint64_t>((served - last_round) / std::chrono::milliseconds(180));
        last_round = served;
        for (const int fd : descriptors) waits.push_back({fd, POLLIN, 0});
      }
      ++rounds_;
      ::poll(waits.data(), waits.size(), 1);
    }
  }

  Rig rig_;
  Duration runs_on_;
  sim::Faults faults_;
  std::unique_ptr<sim::World> world_;
  std::unique_ptr<sim::BusEndpoint> endpoint_;
  Redirect redirect_;
  mutable std::mutex mutex_;
  Time base_{}, now_{};
  std::chrono::steady_clock::time_point base_real_ = std::chrono::steady_clock::now();
  std::atomic<std::uint64_t> rounds_{0}, answers_held_up_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace luxrig
