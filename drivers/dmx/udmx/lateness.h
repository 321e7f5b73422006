#pragma once
/// How late a uDMX is with what is asked of it, and whether a person should know. Pure.
///
/// A healthy widget refuses a transfer now and then. The next one mends that, and nobody sees it. Late is what was
/// asked kUdmxLateAfter ago and is not there yet; a person should know when that has been so for kUdmxLateFor in all,
/// within the last kUdmxLateWindow: fades then jerk or stand still. It is over when everything has been in time for
/// kUdmxInTimeFor without a break.

#include <array>
#include <cstdint>
#include <optional>

#include "core/time.h"

namespace luxrig::udmx {

/// A universe takes 33 ms, and waits a cycle of 23 ms for the one before; one refused transfer adds both again.
inline constexpr Duration kUdmxLateAfter = std::chrono::milliseconds(150);
/// One transfer that hangs is cancelled after 500 ms and is sent anew: late for 450 ms.
inline constexpr Duration kUdmxLateFor = std::chrono::milliseconds(600);
inline constexpr Duration kUdmxLateWindow = std::chrono::seconds(5);
inline constexpr Duration kUdmxInTimeFor = std::chrono::seconds(1);

class Lateness {
 public:
  /// At each cycle, in rising time. up_to_date: the widget has what is asked now. What a caller takes longer than
  /// 100 ms between two calls is its own lateness, and does not count.
  void step(Time now, bool up_to_date);
  /// A transfer has begun, with what is asked now.
  void sent();
  /// It has ended. What the widget then has was asked when it began.
  void arrived();
  void went_wrong();

  [[nodiscard]] bool should_be_known() const { return known_; }
  /// Of the window.
  [[nodiscard]] Duration late_for() const;
  [[nodiscard]] std::uint32_t transfers() const;
  [[nodiscard]] std::uint32_t failures() const;

 private:
  static constexpr Duration kPart = std::chrono::milliseconds(100);
  struct Part {
    Duration late{};
    std::uint32_t transfers = 0, failures = 0;
  };
  [[nodiscard]] Part& part() { return parts_[static_cast<std::size_t>(clock_ / kPart) % parts_.size()]; }

  std::optional<Time> last_;
  Duration clock_{};  ///< time under watch
  Duration sent_at_{}, late_at_{};
  std::optional<Duration> behind_since_;
  std::array<Part, kUdmxLateWindow / kPart> parts_{};
  bool known_ = false;
};

}  // namespace luxrig::udmx
