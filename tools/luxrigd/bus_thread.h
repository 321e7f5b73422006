#pragma once
/// One thread per bus: evaluates the output program at the bus's rate, writes, reads meters, reports health. A slow bus
/// delays no other.

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "drivers/driver.h"
#include "tools/luxrigd/blackout_switch.h"
#include "tools/luxrigd/cycle_statistics.h"
#include "tools/luxrigd/guardian/last_look.h"
#include "tools/luxrigd/guardian/smooth_return.h"
#include "tools/luxrigd/lateness.h"
#include "tools/luxrigd/program_mailbox.h"

namespace luxrig {

/// What else says what goes out. Must outlive the thread; either may be none.
struct OutputOrders {
  const BlackoutSwitch* blackout = nullptr;
  LastLookMemory* guarded = nullptr;  ///< while the guardian has the light, nothing is sent
  std::function<void()> pressed{};    ///< called when the bus's blackout contact is; must not block
};

class BusThread {
 public:
  /// The rig and the mailbox must outlive the thread.
  /// first_desk: where the parts of its driver's input begin in OutputProgram::desks.
  BusThread(const Rig& rig, std::size_t bus, std::unique_ptr<Driver> driver, ProgramMailbox& programs,
            std::size_t first_desk = 0, OutputOrders orders = {});
  ~BusThread();  ///< stops, and lets the driver say goodbye

  void start();
  void stop();
  /// What its thread does in its turn; called by whoever steps time instead of start().
  void turn(Time at);

  /// The next frame goes out now instead of in its turn.
  void wake();
  /// The newest order of the blackout switch that every lamp here has been told.
  [[nodiscard]] std::uint64_t dark_order() const { return dark_order_.load(std::memory_order_acquire); }
  /// It has lamps.
  [[nodiscard]] bool lights() const { return driver_->level_output() != nullptr && !level_commands_.empty(); }

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
  /// Its blackout contact; nothing: it has none.
  [[nodiscard]] std::optional<Contact> contact() const {
    return has_contact_ ? std::optional(contact_.load()) : std::nullopt;
  }

 private:
  void run(const std::stop_token& stop);
  void pause_until(Time wake_at);
  [[nodiscard]] bool is_to_be_dark() const;
  void write(Time at);
  void listen(Time at);
  void read(Time at);
  void look_at_contact(Time at);
  void publish_health(Time at);

  const Rig& rig_;
  std::size_t bus_;
  std::unique_ptr<Driver> driver_;
  ProgramMailbox& programs_;
  OutputOrders orders_;
  DriverBounds bounds_;
  int wake_fd_ = -1;
  std::atomic<std::uint64_t> dark_order_{0};
  std::size_t first_desk_, desks_ = 0;
  CycleStatistics statistics_;
  Lateness lateness_;
  bool writes_ = false, active_ = false;
  Time next_read_{}, next_health_{};
  std::atomic<bool> realtime_{false};
  bool has_contact_ = false;
  std::atomic<Contact> contact_{Contact::unknown};

  std::vector<double> levels_;                ///< of all fixtures
  std::vector<Joints> joints_;                ///< of all fixtures
  std::vector<LevelCommand> level_commands_;  ///< of the fixtures whose lamp is on this bus
  std::vector<AimCommand> aim_commands_;      ///< of those that this bus turns
  OutputProgram program_;
  SmoothReturn return_;

  mutable std::mutex mutex_;  ///< guards what follows; the thread only tries it
  std::vector<LuxReading> readings_;
  std::vector<Health> health_;
  std::vector<CarriedUniverse> carried_;
  std::vector<DeskFrame> desk_frames_;
  std::vector<LuxReading> unsent_readings_;  ///< the thread's own, until the mutex is free

  std::jthread thread_;
};

}  // namespace luxrig
