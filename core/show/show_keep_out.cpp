/// Heads go dark before their beam can meet a keep-out zone, and are lit again when it no longer can.

#include <fmt/format.h>

#include <algorithm>

#include "core/show/show_state.h"

namespace luxrig {
namespace {

constexpr Duration kDimsOver = std::chrono::milliseconds(200), kLightsOver = std::chrono::milliseconds(500);
/// Time for the dark level to reach the lamp, and for the lamp to follow, before a held head may turn.
constexpr Duration kDarkBeforeTurning = std::chrono::milliseconds(100);

/// A desk drives the head while Luxrig is silent, and its aim is not known here.
bool turned_elsewhere(const OutputProgram& program, std::size_t fixture) {
  return std::any_of(program.desks.begin(), program.desks.end(), [fixture](const DeskBlend& desk) {
    const auto found = std::find(desk.fixtures.begin(), desk.fixtures.end(), fixture);
    if (!desk.silent || found == desk.fixtures.end()) return false;
    return !desk.to_desk || desk.desk_turns[static_cast<std::size_t>(found - desk.fixtures.begin())] == 0;
  });
}

}  // namespace

/// At each step, covers what may happen until the next: the aims wanted now, and those at the end of the running fade.
void ShowController::State::guard_heads(Time now) {
  if (guarded.empty()) return;
  std::vector<Joints> wanted(rig.fixtures.size()), at_last(rig.fixtures.size());
  std::vector<double> level(rig.fixtures.size());
  program.wanted_joints_at(now, wanted);
  program.wanted_joints_at(Time::max(), at_last);
  program.wanted_levels_at(now, level);
  for (std::size_t h = 0; h < guarded.size(); ++h) {
    const std::size_t f = guarded[h].fixture;
    if (turned_elsewhere(program, f)) guarded[h].where.lose(now);
    guard_head(now, guarded[h], program.dims[h], wanted[f], at_last[f], level[f] > 0 && !program.blackout);
  }
}

/// wanted: aim now; at_last: aim at the end of the running fade.
void ShowController::State::guard_head(Time now, GuardedHead& head, HeadDim& dim, const Joints& wanted,
                                       const Joints& at_last, bool lit) {
  const std::size_t f = head.fixture;
  if (dim.held && now >= dim.start + dim.duration + kDarkBeforeTurning) {
    dim.held = false;
    ++program.revision;
  }
  const JointBox ahead = JointBox::at(wanted).joined(JointBox::at(at_last));
  const JointBox told = dim.held ? JointBox::at(dim.held_at) : ahead;
  head.where.step(now, told, !health.motion_lost(f));
  JointBox sweep = head.where.box();
  std::optional<Joints> straight_to = head.where.on_line_to();
  if (straight_to && !(ahead == JointBox::at(*straight_to))) {
    sweep = sweep.joined(JointBox::at(*straight_to));
    straight_to.reset();
  }
  if (!straight_to) sweep = sweep.joined(ahead);
  if (!(head.swept && *head.swept == sweep && head.swept_to == straight_to)) {
    head.zone = straight_to ? zones.may_meet_on_line(f, sweep, *straight_to) : zones.may_meet(f, sweep);
    head.swept = sweep;
    head.swept_to = straight_to;
  }
  if (head.zone && dim.to > 0) {
    // At its last ordered aim the beam meets nothing; the head stays there until it is dark.
    const bool gently = lit && head.told.has_value();
    dim = {f,      gently ? dim.share(now) : 0.0, 0, now, gently ? kDimsOver : Duration{},
           gently, head.told.value_or(Joints{})};
    ++program.revision;
  } else if (!head.zone && dim.to < 1) {
    dim = {f, dim.share(now), 1, now, kLightsOver, false, {}};
    ++program.revision;
  }
  if (!dim.held) head.told = wanted;
}

bool ShowController::State::dimmed_for_a_zone(Time now) const {
  return std::any_of(program.dims.begin(), program.dims.end(),
                     [&](const HeadDim& dim) { return program.to_level[dim.fixture] > 0 && dim.share(now) < 1; });
}

void ShowController::State::tell_zones(ShowStatus& status) const {
  for (std::size_t h = 0; h < guarded.size(); ++h) {
    const GuardedHead& head = guarded[h];
    const HeadDim& dim = program.dims[h];
    FixtureStatus& shown = status.fixtures[head.fixture];
    shown.kept_dark = dim.to == 0 && !shown.parked;
    if (shown.kept_dark && head.zone)
      shown.waits_for = fmt::format("its beam to be clear of keep-out zone \"{}\"", zones.name(*head.zone));
    if (!head.told || dim.to > 0) continue;
    // A head that passes through needs no action. One that rests there stays dark until a person acts.
    const std::optional<std::size_t> zone = zones.met(head.fixture, *head.told);
    if (!zone || !(program.to_level[head.fixture] > 0 || shared)) continue;
    if (shown.kept_dark)
      shown.waits_for = fmt::format("another aim: it looks into keep-out zone \"{}\"", zones.name(*zone));
    status.alarms.push_back({false, rig.fixtures[head.fixture].name,
                             fmt::format("{} looks into keep-out zone \"{}\" and stays dark; turn it elsewhere",
                                         rig.fixtures[head.fixture].name, zones.name(*zone)),
                             dim.start});
  }
}

}  // namespace luxrig
