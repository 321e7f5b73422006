#pragma once
/// One thread per bus: evaluates the output program at the bus's rate, writes, reads meters, reports health. A slow bus
/// delays no other.

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "drivers/driver.h"
#include "tools/luxrigd/cycle_statistics.h"
#include "tools/luxrigd/lateness.h"
#include "tools/luxrigd/program_mailbox.h"

namespace luxrig {

class BusThread {
 public:
  /// The rig and the mailbox must outlive the thread.
  /// first_desk: where the parts of its driver's input begin in OutputProgram::desks.
  BusThread(const Rig& rig, std::size_t bus, std::unique_ptr<Driver> driver, ProgramMailbox& programs,
            std::size_t first_desk = 0);
  ~BusThread();  ///< stops, and lets the driver say goodbye

  void start();
  void stop();

  /// Readings since the last call, and the newest health report.
  std::vector<LuxReading> take_readings();
  [[nodiscard]] std::vector<Health> health() const;
  /// What a DMX bus carries, a fifth of a second old at most.
  [[nodiscard]] std::vector<CarriedUniverse> carried() const;
  [[nodiscard]] std::size_t bus() const { return bus_; }
  /// What desks want now, a frame for each part of its driver's input; empty without one, or before it was listened to.
  [[nodiscard]] std::vector<DeskFrame> desk_frames() const;
  [[nodiscard]] std::size_t first_desk() const { return first_desk_; }
  [[nodiscard]] const CycleStatistics& statistics() const { return statistics_; }
  [[nodiscard]] const Lateness& lateness() const { return lateness_; }
  [[nodiscard]] bool realtime() const { return realtime_; }
  [[nodiscard]] bool writes() const { return writes_; }

 private:
  void run(const std::stop_token& stop);
  void write(Time at);
  void listen(Time at);
  void read(Time at);
  void publish_health(Time at);

  const Rig& rig_;
  std::size_t bus_;
  std::unique_ptr<Driver> driver_;
  ProgramMailbox& programs_;
  DriverBounds bounds_;
  std::size_t first_desk_, desks_ = 0;
  CycleStatistics statistics_;
  Lateness lateness_;
  bool writes_ = false;
  std::atomic<bool> realtime_{false};

  std::vector<double> levels_;                ///< of all fixtures
  std::vector<Joints> joints_;                ///< of all fixtures
  std::vector<LevelCommand> level_commands_;  ///< of the fixtures whose lamp is on this bus
  std::vector<AimCommand> aim_commands_;      ///< of those that this bus turns
  OutputProgram program_;

  mutable std::mutex mutex_;  ///< guards what follows; the thread only tries it
  std::vector<LuxReading> readings_;
  std::vector<Health> health_;
  std::vector<CarriedUniverse> carried_;
  std::vector<DeskFrame> desk_frames_;
  std::vector<LuxReading> unsent_readings_;  ///< the thread's own, until the mutex is free

  std::jthread thread_;
};

}  // namespace luxrig
