#include "drivers/can/cia402/report_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/can/cia402/drive_state.h"

namespace luxrig::cia402 {
namespace {

// The servo keeps a profile's speed and acceleration, with some overshoot.
constexpr double kSpeedMargin = 1.25, kAccelerationMargin = 1.5;
constexpr double kRounding_s = 0.005;  ///< as a distance at full speed: backlash, and following error being caught up
constexpr double kPlaceSlack_s = 0.02;

bool same_state(const DriveReport& a, const DriveReport& b) {
  return state_of(a.statusword) == state_of(b.statusword) && a.mode == b.mode;
}

}  // namespace

ReportCheck::ReportCheck(const AxisSettings& settings)
    : speed_(settings.speed), acceleration_(settings.acceleration), cycle_(settings.cycle) {}

void ReportCheck::forget() {
  last_.reset();
  unconfirmed_.reset();
  last_speed_ = 0;
  contradictions_ = 0;
  believe();
}

double ReportCheck::reach(Time now) const {
  // A report may come up to a cycle late, so add a cycle's distance at either end.
  const double seconds = to_seconds(now - at_ + 2 * cycle_);
  const double speed = std::min(kSpeedMargin * speed_, last_speed_ + kAccelerationMargin * acceleration_ * seconds);
  return speed * seconds + kRounding_s * speed_ + 2;
}

std::optional<DriveReport> ReportCheck::take(Time now, std::span<const std::uint8_t> payload, bool positions_follow) {
  if (payload.size() != kBytes) {
    contradicted(now, fmt::format("a status of {} bytes in place of {}", payload.size(), kBytes));
    return std::nullopt;
  }
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(payload[i]); };
  const DriveReport report{static_cast<std::uint16_t>(byte(0) | byte(1) << 8),
                           static_cast<std::int32_t>(byte(2) | byte(3) << 8 | byte(4) << 16 | byte(5) << 24),
                           static_cast<std::int8_t>(payload[6])};
  if (state_of(report.statusword) == DriveState::unknown) {
    contradicted(now, fmt::format("the statusword {:04X} is of no state", report.statusword));
    return std::nullopt;
  }
  const double way = last_ ? std::abs(static_cast<double>(report.position) - last_->position) : 0;
  if (last_ && positions_follow && way > reach(now)) {
    contradicted(now, fmt::format("its position went from {} to {} counts at once", last_->position, report.position));
    if (!doubted()) return std::nullopt;
    last_ = report;  // compare the next with the newest, until some agree
    at_ = now;
    last_speed_ = 0;
    return std::nullopt;
  }
  if (!last_ || !same_state(*last_, report)) {
    if (!unconfirmed_ || !same_state(*unconfirmed_, report)) {
      if (unconfirmed_) contradicted(now, "its state or mode is another with every word");
      unconfirmed_ = report;
      return std::nullopt;
    }
  } else if (unconfirmed_) {
    contradicted(now, "its state or mode changed for one word");
  }
  unconfirmed_.reset();
  // Two reports at once, a repeated one or a late one are no sign that it stands or slows down.
  const double slowed = last_speed_ - kAccelerationMargin * acceleration_ * to_seconds(cycle_);
  const double seen = way / to_seconds(cycle_);
  last_speed_ = last_ && positions_follow ? std::min(std::max({seen, slowed, 0.0}), kSpeedMargin * speed_) : 0;
  last_ = report;
  at_ = now;
  ++in_a_row_;
  return report;
}

void ReportCheck::contradicted(Time now, std::string how) {
  in_a_row_ = 0;
  if (contradictions_ == 0 || now - first_contradiction_ > kContradictionsWithin) {
    contradictions_ = 0;
    first_contradiction_ = now;
  }
  if (++contradictions_ > kMaxContradictions && !doubted()) doubt(now, std::move(how));
}

void ReportCheck::doubt(Time now, std::string why) {
  in_a_row_ = 0;
  why_ = std::move(why);
  believed_position_ = last_ ? std::optional<double>(last_->position) : std::nullopt;
  // It may have gained speed since, until it receives the stop.
  const double seconds = to_seconds(now - at_ + 2 * cycle_);
  const double fastest = std::min(speed_, last_speed_ + acceleration_ * seconds);
  way_to_stop_ = fastest * seconds + fastest * fastest / (2 * acceleration_);
}

bool ReportCheck::kept_its_place() const {
  return !believed_position_ || !last_ ||
         std::abs(last_->position - *believed_position_) <= way_to_stop_ + kPlaceSlack_s * speed_;
}

void ReportCheck::believe() {
  why_.clear();
  in_a_row_ = contradictions_ = 0;
  believed_position_.reset();
}

}  // namespace luxrig::cia402
