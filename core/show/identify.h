#pragma once
/// Shows which lamp is which: a fixture blinks, or a head nods, for a while; then everything is as before. Or a head
/// that somebody aims by hand holds still for a while. It acts as a desk of our own that controls one housing
/// (desk_follower.h). So limits hold, no meter is believed for that time, and the way back needs no memory of the state
/// before.

#include <algorithm>
#include <span>
#include <vector>

#include "core/output/devices.h"
#include "core/output/keep_out.h"
#include "core/rig/rig.h"

namespace luxrig {

class IdentifyPattern {
 public:
  /// present_level, present_joints: per fixture of the rig, at `start`. may_turn: whether a head may turn while lit.
  IdentifyPattern(const Rig& rig, std::vector<std::size_t> fixtures, std::span<const double> present_level,
                  std::span<const Joints> present_joints, bool may_turn, Time start, Duration how_long);

  /// Holds still instead. drive: per fixture.
  IdentifyPattern(std::vector<std::size_t> fixtures, std::vector<double> drive, const Joints& joints, Time start,
                  Duration how_long);

  /// The frame at `now`: fixtures are dark or bright by turns of half a second, dark first if they were bright. A head
  /// that may turn stays bright and nods by 5°, away from the nearer end of its travel. Absent once it is over.
  [[nodiscard]] DeskFrame frame_at(Time now) const;
  /// Every posture that the first of its fixtures takes while it nods.
  [[nodiscard]] JointBox nodding() const { return JointBox::at(joints_.front()).joined(JointBox::at(nod_.front())); }
  [[nodiscard]] bool holds_still() const { return still_; }
  void end(Time now) { end_ = std::min(end_, now); }
  void prolong(Time end) { end_ = std::max(end_, end); }
  [[nodiscard]] bool over(Time now) const { return now >= end_; }
  [[nodiscard]] const std::vector<std::size_t>& fixtures() const { return fixtures_; }

 private:
  std::vector<std::size_t> fixtures_;
  std::vector<double> bright_drive_;  ///< per fixture
  std::vector<Joints> joints_, nod_;  ///< per fixture: aim at the start, and the other end of the nod
  bool bright_first_ = true, turns_ = false, still_ = false;
  Time start_{}, end_{};
};

}  // namespace luxrig
