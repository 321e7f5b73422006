#pragma once
/// How late a uDMX is with its levels, and whether to report it. Pure.
///
/// A healthy widget refuses a transfer now and then. The next one mends that without visible effect. The widget is late
/// if levels requested kUdmxLateAfter ago have not arrived. It is reported after kUdmxLateFor of lateness in total
/// within the last kUdmxLateWindow: fades then jerk or stop. The report ends after kUdmxInTimeFor without lateness.

#include <array>
#include <cstdint>
#include <optional>

#include "core/time.h"

namespace luxrig::udmx {

/// A universe takes 33 ms and waits up to a cycle of 23 ms for the one before; one refused transfer adds both again.
inline constexpr Duration kUdmxLateAfter = std::chrono::milliseconds(150);
/// One hanging transfer is cancelled after 500 ms and sent again: late for 450 ms.
inline constexpr Duration kUdmxLateFor = std::chrono::milliseconds(600);
inline constexpr Duration kUdmxLateWindow = std::chrono::seconds(5);
inline constexpr Duration kUdmxInTimeFor = std::chrono::seconds(1);

class Lateness {
 public:
  /// Call at each cycle, in rising time. up_to_date: the widget has the levels requested now. Of the time between two
  /// calls, 100 ms at most counts; the rest is the caller's own lateness.
  void step(Time now, bool up_to_date);
  /// A transfer with the present levels has begun.
  void sent();
  /// It has ended. The widget then has the levels requested at its start.
  void arrived();
  void went_wrong();

  [[nodiscard]] bool should_be_known() const { return known_; }
  /// Within the window.
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
  Duration clock_{};  ///< time observed
  Duration sent_at_{}, late_at_{};
  std::optional<Duration> behind_since_;
  std::array<Part, kUdmxLateWindow / kPart> parts_{};
  bool known_ = false;
};

}  // namespace luxrig::udmx
