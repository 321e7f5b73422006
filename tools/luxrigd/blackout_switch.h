#pragma once
/// Blackout's own way to the lamps: from whoever asks straight to the threads that send, past the control thread, which
/// may be busy. The controller is told, too, and its program keeps the rig dark from then on.

#include <atomic>
#include <cstdint>
#include <mutex>

namespace luxrig {

class BlackoutSwitch {
 public:
  /// Any thread. Dark from this instant when `on`; lifting waits for lift(). Returns the order's number.
  std::uint64_t order(bool on) {
    const std::lock_guard lock(mutex_);
    const std::uint64_t number = 1 + number_.load(std::memory_order_relaxed);
    wanted_ = on;
    if (on) dark_.store(true, std::memory_order_relaxed);
    number_.store(number, std::memory_order_release);
    return number;
  }
  /// The program that goes out now has no blackout: what order `number` asked for is done, unless somebody has asked
  /// again.
  void lift(std::uint64_t number) {
    const std::lock_guard lock(mutex_);
    if (number == number_.load(std::memory_order_relaxed) && !wanted_) dark_.store(false, std::memory_order_release);
  }
  /// What was asked for last.
  [[nodiscard]] bool wanted() const {
    const std::lock_guard lock(mutex_);
    return wanted_;
  }
  /// Of the newest order; read before dark().
  [[nodiscard]] std::uint64_t number() const { return number_.load(std::memory_order_acquire); }
  [[nodiscard]] bool dark() const { return dark_.load(std::memory_order_acquire); }

 private:
  mutable std::mutex mutex_;
  bool wanted_ = false;
  std::atomic<std::uint64_t> number_{0};
  std::atomic<bool> dark_{false};
};

}  // namespace luxrig
