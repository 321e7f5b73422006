#pragma once
/// What a drive says of itself in TPDO 1 (statusword 6041, position 6064, mode display 6061), and whether it can be so.
/// A CRC catches what the line spoils; what is caught here is a node that says something wrong: words of no state, PDOs
/// of another length, positions that no speed and acceleration lead to in that time, changes taken back at once. A
/// report like that is dropped; when several come within half a second, nothing the drive says is believed until it
/// has made sense for a while. Pure.

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
  static constexpr std::size_t kBytes = 7;  ///< as the PDO is mapped
  static constexpr int kMostContradictions = 2;
  static constexpr Duration kContradictionsWithin = std::chrono::milliseconds(500);
  static constexpr int kSettledAfter = 15;  ///< reports in a row

  explicit ReportCheck(const AxisSettings& settings);

  void forget();  ///< the drive begins anew
  /// A TPDO 1's bytes. Nothing when they are not to be believed, or not yet: a new state or mode needs a second word
  /// that says the same. positions_follow: one from the other; false while the drive may set its count (homing).
  [[nodiscard]] std::optional<DriveReport> take(Time now, std::span<const std::uint8_t> payload, bool positions_follow);

  /// Nothing that it says can be relied on.
  [[nodiscard]] bool doubted() const { return !why_.empty(); }
  [[nodiscard]] const std::string& why() const { return why_; }
  void doubt(Time now, std::string why);
  /// requires doubted(): it has made sense for a while.
  [[nodiscard]] bool settled() const { return in_a_row_ >= kSettledAfter; }
  void unsettle() { in_a_row_ = 0; }
  /// requires doubted(): it is where an axis that was told to stop can be, by what was believed before.
  [[nodiscard]] bool kept_its_place() const;
  void believe();

 private:
  void contradicted(Time now, std::string how);
  /// As far as it can have come since the last report, in counts.
  [[nodiscard]] double reach(Time now) const;

  double speed_, acceleration_;  ///< counts/s, counts/s²
  Duration cycle_;
  std::optional<DriveReport> last_;
  Time at_{};
  double last_speed_ = 0;                   ///< counts/s, between the last two
  std::optional<DriveReport> unconfirmed_;  ///< of another state or mode than the last
  int in_a_row_ = 0;
  int contradictions_ = 0;
  Time first_contradiction_{};
  std::string why_;
  std::optional<double> believed_position_;  ///< the last before the doubt began
  double way_to_stop_ = 0;                   ///< counts from there
};

}  // namespace luxrig::cia402
