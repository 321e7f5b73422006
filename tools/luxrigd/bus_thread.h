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

/// Sources that decide the output besides the program. Both pointers must outlive the thread; either may be null.
struct OutputOrders {
  const BlackoutSwitch* blackout = nullptr;
  LastLookMemory* guarded = nullptr;  ///< nothing is sent while the guardian has the light
  std::function<void()> pressed{};    ///< called when the bus's blackout contact is pressed; must not block
};

class BusThread {
 public:
  /// The rig and the mailbox must outlive the thread.
  /// first_desk: index in OutputProgram::desks of the first part of its driver's input.
  BusThread(const Rig& rig, std::size_t bus, std::unique_ptr<Driver> driver, ProgramMailbox& programs,
            std::size_t first_desk = 0, OutputOrders orders = {});
  ~BusThread();  ///< stops, then deactivates the driver

  void start();
  void stop();
  /// One cycle of its thread. Whoever steps time calls this instead of start().
  void turn(Time at);

  /// Sends the next frame at once instead of at its time.
  void wake();
  /// Newest order of the blackout switch that has reached every lamp on this bus.
  [[nodiscard]] std::uint64_t dark_order() const { return dark_order_.load(std::memory_order_acquire); }
  /// Whether the bus drives lamps.
  [[nodiscard]] bool lights() const { return driver_->level_output() != nullptr && !level_commands_.empty(); }

  /// Readings since the last call, and the newest health report.
  std::vector<LuxReading> take_readings();
  [[nodiscard]] std::vector<Health> health() const;
  /// Content of a DMX bus, at most a fifth of a second old.
  [[nodiscard]] std::vector<CarriedUniverse> carried() const;
  [[nodiscard]] std::size_t bus() const { return bus_; }
  /// Newest desk frames, one per part of the driver's input. Empty without an input, or before the first listen.
  [[nodiscard]] std::vector<DeskFrame> desk_frames() const;
  [[nodiscard]] std::size_t first_desk() const { return first_desk_; }
  [[nodiscard]] const CycleStatistics& statistics() const { return statistics_; }
  [[nodiscard]] const Lateness& lateness() const { return lateness_; }
  [[nodiscard]] bool realtime() const { return realtime_; }
  [[nodiscard]] bool writes() const { return writes_; }
  /// Its blackout contact; nullopt if it has none.
  [[nodiscard]] std::optional<Contact> contact() const {
    return has_contact_ ? std::optional(contact_.load()) : std::nullopt;
  }

 private:
  void run(const std::stop_token& stop);
  void pause_until(Time wake_at);
  [[nodiscard]] bool is_to_be_dark() const;
  void write(Time at);
  void aim(Time at);
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
  std::vector<LevelCommand> level_commands_;  ///< fixtures whose lamp is on this bus
  std::vector<AimCommand> aim_commands_;      ///< fixtures that this bus turns or zooms
  /// Per aim command.
  struct Sender {
    JointSender joints{};
    std::optional<Time> whence_known{};  ///< by then it has been beside its first aim, wherever it was before
  };
  std::vector<Sender> senders_;
  OutputProgram program_;
  SmoothReturn return_;

  mutable std::mutex mutex_;  ///< guards the four below; the thread only tries to lock it
  std::vector<LuxReading> readings_;
  std::vector<Health> health_;
  std::vector<CarriedUniverse> carried_;
  std::vector<DeskFrame> desk_frames_;
  std::vector<LuxReading> unsent_readings_;  ///< used by the thread alone, until it gets the mutex

  std::jthread thread_;
};

}  // namespace luxrig
