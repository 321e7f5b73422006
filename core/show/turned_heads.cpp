#include "core/show/turned_heads.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

/// Less than a step of any axis.
constexpr double kAtHome_rad = 1e-5;

bool is_at(const JointBox& box, const Joints& joints) {
  const auto at = [](double least, double most, double wanted) {
    return std::abs(least - wanted) < kAtHome_rad && std::abs(most - wanted) < kAtHome_rad;
  };
  return at(box.least.pan_rad, box.most.pan_rad, joints.pan_rad) &&
         at(box.least.tilt_rad, box.most.tilt_rad, joints.tilt_rad) &&
         at(box.least.beam_rad, box.most.beam_rad, joints.beam_rad);
}

bool turned_by_a_desk(const OutputProgram& program, std::size_t fixture, Time now) {
  return std::any_of(program.desks.begin(), program.desks.end(), [&](const DeskBlend& desk) {
    const auto found = std::find(desk.fixtures.begin(), desk.fixtures.end(), fixture);
    return found != desk.fixtures.end() && !desk.is_own(now);
  });
}

}  // namespace

void TurnedHeads::turn(const Rig& rig, Time now, const std::vector<std::size_t>& fixtures) {
  const auto found =
      std::find_if(heads_.begin(), heads_.end(), [&](const Head& head) { return head.fixtures == fixtures; });
  if (found != heads_.end()) {
    found->home_since.reset();
  } else {
    heads_.push_back({fixtures, HeadWhereabouts(rig.fixtures[fixtures.front()])});
    heads_.back().where.lose(now);
  }
  turned_.resize(rig.fixtures.size(), 0);
  for (const std::size_t f : fixtures) turned_[f] = 1;
  home_at_ = Time::max();
}

bool TurnedHeads::step(Time now, const OutputProgram& program, const HealthWatch& health) {
  if (heads_.empty()) return false;
  std::vector<Joints> told(program.joints.size()), wanted(told.size()), at_last(told.size());
  program.joints_at(now, told);
  program.wanted_joints_at(now, wanted);
  program.wanted_joints_at(Time::max(), at_last);
  Time home{};
  for (Head& head : heads_) {
    const std::size_t f = head.fixtures.front();
    const JointBox box = JointBox::at(told[f]).joined(JointBox::at(wanted[f])).joined(JointBox::at(at_last[f]));
    head.where.step(now, box, !health.motion_lost(f));
    if (turned_by_a_desk(program, f, now) || head.where.on_line_to() || !is_at(head.where.box(), program.joints[f])) {
      head.home_since.reset();
    } else if (!head.home_since) {
      head.home_since = now;
    }
    home = std::max(home, head.home_since.value_or(Time::max()));
  }
  const bool forgets = home != Time::max() && now >= home + program.limits_released;
  const bool changed = forgets || home != home_at_;
  if (forgets) {
    heads_.clear();
    turned_.clear();
  }
  home_at_ = forgets ? Time{} : home;
  return changed;
}

}  // namespace luxrig
