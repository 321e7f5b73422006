#include "core/show/identify.h"

#include <algorithm>
#include <numbers>

#include "core/output/dimming.h"
#include "core/output/output_program.h"

namespace luxrig {
namespace {

constexpr Duration kHalfTurn = std::chrono::milliseconds(500);
constexpr double kMinBright = 0.5;
constexpr double kNod_rad = 5 * std::numbers::pi / 180;

/// `at_rad`, moved by kNod_rad to the side with more room.
double nodded_rad(double at_rad, double min_rad, double max_rad) {
  const double way_rad = max_rad - at_rad >= at_rad - min_rad ? kNod_rad : -kNod_rad;
  return std::clamp(at_rad + way_rad, std::min(min_rad, at_rad), std::max(max_rad, at_rad));
}

}  // namespace

IdentifyPattern::IdentifyPattern(const Rig& rig, std::vector<std::size_t> fixtures,
                                 std::span<const double> present_level, std::span<const Joints> present_joints,
                                 bool may_turn, Time start, Duration how_long)
    : fixtures_(std::move(fixtures)), start_(start), end_(start + how_long) {
  double brightest = 0;
  for (const std::size_t f : fixtures_) {
    const Fixture& fixture = rig.fixtures[f];
    brightest = std::max(brightest, present_level[f]);
    bright_drive_.push_back(drive_for(fixture, std::max(kMinBright, present_level[f])));
    const Joints at = present_joints[f];
    joints_.push_back(at);
    turns_ = turns_ || (may_turn && fixture.moves);
    nod_.push_back(!fixture.moves
                       ? at
                       : Joints{nodded_rad(at.pan_rad, fixture.range.pan_min_rad, fixture.range.pan_max_rad),
                                nodded_rad(at.tilt_rad, fixture.range.tilt_min_rad, fixture.range.tilt_max_rad),
                                at.beam_rad});
  }
  bright_first_ = brightest < kMinBright;
}

IdentifyPattern::IdentifyPattern(std::vector<std::size_t> fixtures, std::vector<double> drive, const Joints& joints,
                                 Time start, Duration how_long)
    : fixtures_(std::move(fixtures)),
      bright_drive_(std::move(drive)),
      joints_(fixtures_.size(), joints),
      nod_(joints_),
      turns_(true),
      still_(true),
      start_(start),
      end_(start + how_long) {}

DeskFrame IdentifyPattern::frame_at(Time now) const {
  DeskFrame frame;
  frame.source = still_ ? "by hand" : "identify";
  frame.presence = over(now) ? DeskPresence::absent : DeskPresence::present;
  const bool first_half = ((now - start_) / kHalfTurn) % 2 == 0;
  for (std::size_t i = 0; i < fixtures_.size(); ++i) {
    DeskCommand command{fixtures_[i], bright_drive_[i], std::nullopt};
    if (turns_) {
      command.joints = first_half ? nod_[i] : joints_[i];
    } else if (first_half != bright_first_) {
      command.drive = 0;
    }
    frame.commands.push_back(command);
  }
  return frame;
}

}  // namespace luxrig
