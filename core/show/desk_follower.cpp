#include "core/show/desk_follower.h"

#include <algorithm>

#include "core/check.h"
#include "core/output/dimming.h"
#include "core/output/output_program.h"

namespace luxrig {

const char* name_of(DeskPhase phase) {
  switch (phase) {
    case DeskPhase::listening:
      return "listening";
    case DeskPhase::own:
      return "own";
    case DeskPhase::waiting:
      return "waiting";
    case DeskPhase::following:
      return "following";
  }
  return "unknown";
}

DeskFollower::DeskFollower(DeskFollowerSettings settings) : settings_(std::move(settings)) {
  const std::size_t count = settings_.fixtures.size();
  LUXRIG_CHECK(settings_.dimmer_curve.size() == count && settings_.joints.size() == count,
               "{} fixtures, {} curves, {} joints", count, settings_.dimmer_curve.size(), settings_.joints.size());
  blend_.fixtures = settings_.fixtures;
  blend_.mode = settings_.rules.mode;
  blend_.curve = settings_.curve;
  blend_.from_level.assign(count, 0);
  blend_.desk_level.assign(count, 0);
  blend_.desk_has.assign(count, 0);
  blend_.from_joints = blend_.desk_joints = own_joints_ = settings_.joints;
  blend_.desk_turns.assign(count, 0);
  blend_.silent = settings_.rules.mode != DeskMode::merge;
  joints_known_.assign(count, 0);
}

void DeskFollower::enter(Time now, DeskPhase phase) {
  if (phase_ == phase) return;
  phase_ = phase;
  since_ = now;
}

void DeskFollower::begin(Time now, bool to_desk, Duration duration, const PresentLight& present) {
  for (std::size_t i = 0; i < settings_.fixtures.size(); ++i) {
    blend_.from_level[i] = present.level[settings_.fixtures[i]];
    blend_.from_joints[i] = present.joints[settings_.fixtures[i]];
  }
  blend_.to_desk = to_desk;
  blend_.start = now;
  blend_.duration = duration;
  blend_.silent = false;
}

void DeskFollower::begin_own(Time now, const PresentLight& present) {
  const bool lit = std::any_of(settings_.fixtures.begin(), settings_.fixtures.end(),
                               [&](std::size_t f) { return present.level[f] > 0; });
  if (blend_.silent && lit) {
    begin(now, false, settings_.fade, present);
    std::fill(blend_.from_level.begin(), blend_.from_level.end(), 0.0);
  }
  have_light(now);
}

void DeskFollower::have_light(Time now) {
  blend_.silent = false;
  enter(now, DeskPhase::own);
}

bool DeskFollower::hear(Time now, const DeskFrame& frame, const PresentLight& present) {
  // Before the values: a fade starts at the light that goes out now, not at the desk's new values.
  presence_ = frame.presence;
  source_ = frame.source;
  const bool moved = follow_presence(now, present);
  const bool changed = frame.presence == DeskPresence::present && take_values(frame, present);
  return moved || changed;
}

bool DeskFollower::follow_presence(Time now, const PresentLight& present) {
  const HandBack rule = settings_.rules.hand_back;
  switch (phase_) {
    case DeskPhase::listening:
      if (presence_ == DeskPresence::unknown) return false;
      if (presence_ == DeskPresence::present) {
        // No light is known to go out yet, unless Luxrig has begun (merge).
        begin(now, true, Duration{}, present);
        enter(now, DeskPhase::following);
      } else {
        begin_own(now, present);
      }
      return true;
    case DeskPhase::own:
      if (presence_ != DeskPresence::present) return false;
      if (rule == HandBack::when_asked) {
        enter(now, DeskPhase::waiting);
        return true;
      }
      begin(now, true, rule == HandBack::fade ? settings_.fade : Duration{}, present);
      enter(now, DeskPhase::following);
      return true;
    case DeskPhase::waiting:
      if (presence_ == DeskPresence::present) return false;
      enter(now, DeskPhase::own);
      return true;
    case DeskPhase::following:
      if (presence_ == DeskPresence::present) return false;
      begin(now, false, settings_.fade, present);
      enter(now, DeskPhase::own);
      return true;
  }
  return false;
}

bool DeskFollower::take_values(const DeskFrame& frame, const PresentLight& present) {
  const std::vector<double> level_before = blend_.desk_level;
  const std::vector<Joints> joints_before = blend_.desk_joints;
  const std::vector<std::uint8_t> has_before = blend_.desk_has, turns_before = blend_.desk_turns;
  std::fill(blend_.desk_has.begin(), blend_.desk_has.end(), std::uint8_t{0});
  for (const DeskCommand& command : frame.commands) {
    const auto found = std::lower_bound(settings_.fixtures.begin(), settings_.fixtures.end(), command.fixture);
    if (found == settings_.fixtures.end() || *found != command.fixture) continue;
    const auto i = static_cast<std::size_t>(found - settings_.fixtures.begin());
    blend_.desk_has[i] = 1;
    blend_.desk_level[i] = level_from_drive(settings_.dimmer_curve[i], command.drive);
    if (!settings_.measured_curve.empty())
      blend_.desk_level[i] = share_at_level(settings_.measured_curve[i], blend_.desk_level[i]);
    if (!settings_.desk_may_turn || !command.joints) continue;
    const Joints own = present.own_joints[command.fixture];
    if (settings_.rules.mode != DeskMode::merge) {
      blend_.desk_turns[i] = 1;
    } else if (joints_known_[i] != 0 && !(*command.joints == blend_.desk_joints[i])) {
      blend_.desk_turns[i] = 1;  // the latest change was the desk's
    } else if (!(own == own_joints_[i])) {
      blend_.desk_turns[i] = 0;  // Luxrig's
    }
    own_joints_[i] = own;
    blend_.desk_joints[i] = *command.joints;
    joints_known_[i] = 1;
  }
  return blend_.desk_level != level_before || blend_.desk_has != has_before || blend_.desk_turns != turns_before ||
         !(blend_.desk_joints == joints_before);
}

bool DeskFollower::hand_back(Time now, const PresentLight& present) {
  if (phase_ != DeskPhase::waiting) return false;
  begin(now, true, settings_.fade, present);
  enter(now, DeskPhase::following);
  return true;
}

bool DeskFollower::step(Time now) {
  const bool silent = settings_.rules.mode == DeskMode::standby && phase_ == DeskPhase::following &&
                      now >= blend_.start + blend_.duration;
  if (phase_ == DeskPhase::listening || silent == blend_.silent) return false;
  blend_.silent = silent;
  return true;
}

}  // namespace luxrig
