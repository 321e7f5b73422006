#pragma once
/// Blackout's direct path to the lamps: from the caller straight to the threads that send, past the control thread,
/// which may be busy. The controller gets the order too, and its program keeps the rig dark from then on.

#include <atomic>
#include <cstdint>
#include <mutex>

namespace luxrig {

class BlackoutSwitch {
 public:
  /// Any thread. If `on`, output is dark from this instant; otherwise it stays dark until lift(). Returns the order's
  /// number.
  std::uint64_t order(bool on) {
    const std::lock_guard lock(mutex_);
    const std::uint64_t number = 1 + number_.load(std::memory_order_relaxed);
    wanted_ = on;
    if (on) dark_.store(true, std::memory_order_relaxed);
    number_.store(number, std::memory_order_release);
    return number;
  }
  /// Ends the darkness: the program that now goes out has no blackout. `number`: the order that asked for this. Does
  /// nothing if a newer order exists.
  void lift(std::uint64_t number) {
    const std::lock_guard lock(mutex_);
    if (number == number_.load(std::memory_order_relaxed) && !wanted_) dark_.store(false, std::memory_order_release);
  }
  /// Whether the newest order asks for blackout.
  [[nodiscard]] bool wanted() const {
    const std::lock_guard lock(mutex_);
    return wanted_;
  }
  /// Number of the newest order. Read it before dark().
  [[nodiscard]] std::uint64_t number() const { return number_.load(std::memory_order_acquire); }
  [[nodiscard]] bool dark() const { return dark_.load(std::memory_order_acquire); }

 private:
  mutable std::mutex mutex_;
  bool wanted_ = false;
  std::atomic<std::uint64_t> number_{0};
  std::atomic<bool> dark_{false};
};

}  // namespace luxrig
