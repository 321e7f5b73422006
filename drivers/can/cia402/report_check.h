#pragma once
/// Checks a drive's reports in TPDO 1 (statusword 6041, position 6064, mode display 6061) for plausibility. A CRC
/// catches line errors; this check catches a node that reports nonsense: words of no state, PDOs of another length,
/// positions that no speed and acceleration can reach in that time, changes taken back at once. It drops such a report.
/// After several within half a second it trusts no report of the drive until they have made sense for a while. Pure.

#include <optional>
#include <span>
#include <string>

#include "core/time.h"
#include "drivers/can/cia402/axis_settings.h"

namespace luxrig::cia402 {

struct DriveReport {
  std::uint16_t statusword = 0;
  std::int32_t position = 0;  ///< counts
  int mode = 0;
};

class ReportCheck {
 public:
  static constexpr std::size_t kBytes = 7;  ///< of the mapped PDO
  static constexpr int kMaxContradictions = 2;
  static constexpr Duration kContradictionsWithin = std::chrono::milliseconds(500);
  static constexpr int kSettledAfter = 15;  ///< reports in a row

  explicit ReportCheck(const AxisSettings& settings);

  void forget();  ///< the drive starts over
  /// Takes a TPDO 1's bytes. Empty if they are not believed, or not yet: a new state or mode needs a second report that
  /// agrees. positions_follow: successive positions are related; false while the drive may set its count (homing).
  [[nodiscard]] std::optional<DriveReport> take(Time now, std::span<const std::uint8_t> payload, bool positions_follow);

  /// No report of the drive can be trusted.
  [[nodiscard]] bool doubted() const { return !why_.empty(); }
  [[nodiscard]] const std::string& why() const { return why_; }
  void doubt(Time now, std::string why);
  /// requires doubted(). Its reports have made sense for a while.
  [[nodiscard]] bool settled() const { return in_a_row_ >= kSettledAfter; }
  void unsettle() { in_a_row_ = 0; }
  /// requires doubted(). It is where an axis that was ordered to stop can be, given the last believed report.
  [[nodiscard]] bool kept_its_place() const;
  void believe();

 private:
  void contradicted(Time now, std::string how);
  /// Greatest distance it can have moved since the last report, in counts.
  [[nodiscard]] double reach(Time now) const;

  double speed_, acceleration_;  ///< counts/s, counts/s²
  Duration cycle_;
  std::optional<DriveReport> last_;
  Time at_{};
  double last_speed_ = 0;                   ///< counts/s, between the last two reports
  std::optional<DriveReport> unconfirmed_;  ///< with another state or mode than the last report
  int in_a_row_ = 0;
  int contradictions_ = 0;
  Time first_contradiction_{};
  std::string why_;
  std::optional<double> believed_position_;  ///< the last one before the doubt began
  double way_to_stop_ = 0;                   ///< counts, from that position
};

}  // namespace luxrig::cia402
