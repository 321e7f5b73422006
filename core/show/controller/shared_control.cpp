#include "core/show/controller/shared_control.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

/// Drivers report within 4 s of their start whether a desk is there. sACN takes 2.5 s, the longest silence of a source
/// that is not lost, plus 1.5 s in which a newly heard source has no control yet. Art-Net takes 4 s, the slowest
/// refresh. A bus that cannot report (not open yet) must not keep the rest of the rig dark for longer.
constexpr Duration kListensAtMost = std::chrono::seconds(5);

/// Calls back with the light that goes out now, as without a blackout: that does not concern desks.
template <class Call>
bool with_present_light(OutputProgram& program, Time now, Call call) {
  const bool dark = std::exchange(program.blackout, false);
  std::vector<double> level(program.to_level.size());
  std::vector<Joints> joints(program.joints.size());
  program.levels_at(now, level);
  program.joints_at(now, joints);
  program.blackout = dark;
  return call(PresentLight{level, joints, program.joints});
}

}  // namespace

void SharedControl::put(OutputProgram& program, std::size_t index) {
  program.desks[index] = followers_[index].blend();
  ++program.revision;
}

std::size_t SharedControl::add(OutputProgram& program, DeskFollowerSettings settings, const std::string& name) {
  followers_.emplace_back(std::move(settings));
  names_.push_back(name);
  program.desks.emplace_back();
  put(program, followers_.size() - 1);
  return followers_.size() - 1;
}

void SharedControl::hear(OutputProgram& program, Time now, std::size_t index, const DeskFrame& frame) {
  LUXRIG_CHECK(index < followers_.size(), "desk {} of {}", index, followers_.size());
  const bool changed = with_present_light(
      program, now, [&](const PresentLight& present) { return followers_[index].hear(now, frame, present); });
  if (changed) put(program, index);
}

void SharedControl::have_light(OutputProgram& program, Time now, const std::vector<std::uint8_t>& silent) {
  for (std::size_t d = 0; d < followers_.size(); ++d) {
    const std::vector<std::size_t>& fixtures = followers_[d].blend().fixtures;
    if (std::any_of(fixtures.begin(), fixtures.end(),
                    [&](std::size_t f) { return f < silent.size() && silent[f] != 0; }))
      continue;  // a desk may drive them: listen first, as always
    followers_[d].have_light(now);
    put(program, d);
  }
}

void SharedControl::hand_back(OutputProgram& program, Time now) {
  for (std::size_t d = 0; d < followers_.size(); ++d) {
    const bool changed = with_present_light(
        program, now, [&](const PresentLight& present) { return followers_[d].hand_back(now, present); });
    if (changed) put(program, d);
  }
}

SharedControl::Change SharedControl::step(OutputProgram& program, Time now, bool turns_back) {
  for (const Identification& one : identified_) {
    if (!one.pattern.over(now) || followers_[one.desk].phase() != DeskPhase::own)
      hear(program, now, one.desk, one.pattern.frame_at(now));
  }
  for (std::size_t d = 0; d < followers_.size(); ++d) {
    if (followers_[d].step(now)) put(program, d);
  }
  // A desk shares control, or the light is not ours at all.
  const bool is =
      turns_back || program.desk_has_a_say(now) ||
      std::any_of(program.desks.begin(), program.desks.end(), [](const DeskBlend& desk) { return desk.silent; });
  return {std::exchange(shared_, is), is};
}

bool SharedControl::listens_in_silence() const {
  return std::any_of(followers_.begin(), followers_.end(), [](const DeskFollower& desk) {
    return desk.phase() == DeskPhase::listening && desk.blend().silent;
  });
}

bool SharedControl::listens_still(Time now) {
  if (!listens_in_silence()) return false;
  if (!listens_until_) listens_until_ = now + kListensAtMost;
  return now < *listens_until_;
}

bool SharedControl::prolong(Time now, const std::vector<std::size_t>& fixtures, Time until) {
  for (Identification& one : identified_) {
    if (one.pattern.fixtures() != fixtures || one.pattern.over(now)) continue;
    one.pattern.prolong(until);
    return true;
  }
  return false;
}

void SharedControl::identify(OutputProgram& program, Time now, DeskFollowerSettings settings, IdentifyPattern pattern) {
  auto one = std::find_if(identified_.begin(), identified_.end(),
                          [&](const Identification& other) { return other.pattern.fixtures() == pattern.fixtures(); });
  if (one == identified_.end()) {
    const std::size_t desk = add(program, std::move(settings), "");
    one = identified_.insert(one, {desk, std::move(pattern)});
  } else {
    one->pattern = std::move(pattern);
  }
  hear(program, now, one->desk, one->pattern.frame_at(now));
}

std::size_t SharedControl::release(OutputProgram& program, Time now, std::span<const std::size_t> fixtures) {
  std::size_t ended = 0;
  for (Identification& one : identified_) {
    const std::vector<std::size_t>& its = one.pattern.fixtures();
    if (!one.pattern.holds_still() || one.pattern.over(now) ||
        std::find_first_of(its.begin(), its.end(), fixtures.begin(), fixtures.end()) == its.end())
      continue;
    one.pattern.end(now);
    hear(program, now, one.desk, one.pattern.frame_at(now));
    ++ended;
  }
  return ended;
}

std::string SharedControl::who(const Rig& rig, const OutputProgram& program, Time now) const {
  std::string blinking, aimed;
  for (const Identification& one : identified_) {
    if (one.pattern.over(now)) continue;
    std::string& names = one.pattern.holds_still() ? aimed : blinking;
    names += (names.empty() ? "" : ", ") + rig.fixtures[one.pattern.fixtures().front()].name;
  }
  if (!blinking.empty()) return blinking + " shows which one it is";
  if (!aimed.empty()) return aimed + " is aimed by hand";
  if (program.turned_until > now && !program.desk_has_a_say(now)) return "a head that was aimed by hand turns back";
  return program.desk_has_a_say(now) || !listens_in_silence() ? "a desk has a say in the light"
                                                              : "listening for a desk";
}

void SharedControl::tell(ShowStatus& status, Time now) const {
  for (const Identification& one : identified_)
    for (const std::size_t f : one.pattern.fixtures())
      (one.pattern.holds_still() ? status.fixtures[f].aimed_by_hand : status.fixtures[f].identified) =
          !one.pattern.over(now);
  for (std::size_t d = 0; d < followers_.size(); ++d) {
    if (names_[d].empty()) continue;
    const DeskFollower& desk = followers_[d];
    const bool there = desk.presence() == DeskPresence::present;
    status.desks.push_back(
        {names_[d], desk.mode(), desk.phase(), desk.since(), desk.source(), there, desk.blend().silent});
    if (desk.phase() == DeskPhase::own && !there && !desk.source().empty()) {
      status.alarms.push_back(
          {false, names_[d],
           fmt::format("desk \"{}\" is lost: {} is Luxrig's again; look after the desk or its cable", desk.source(),
                       names_[d]),
           desk.since()});
    } else if (desk.phase() == DeskPhase::waiting) {
      status.alarms.push_back(
          {false, names_[d],
           fmt::format("desk \"{}\" is back and waits to get {}: luxrig hand-back", desk.source(), names_[d]),
           desk.since()});
    }
  }
}

}  // namespace luxrig
