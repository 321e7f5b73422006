#include "core/show/head_guard.h"

#include <fmt/format.h>

#include <algorithm>

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

HeadGuard::HeadGuard(const Rig& rig) : zones_(rig) {
  for (const std::size_t f : zones_.heads()) heads_.push_back({f, HeadWhereabouts(rig.fixtures[f])});
}

std::vector<HeadDim> HeadGuard::first_dims() const {
  std::vector<HeadDim> dims;
  for (const Head& head : heads_) dims.push_back({head.fixture, 0, 0, {}, {}, false, {}});
  return dims;
}

void HeadGuard::step(Time now, OutputProgram& program, const HealthWatch& health) {
  if (heads_.empty()) return;
  const std::size_t fixtures = program.joints.size();
  std::vector<Joints> wanted(fixtures), at_last(fixtures);
  std::vector<double> level(fixtures);
  program.wanted_joints_at(now, wanted);
  program.wanted_joints_at(Time::max(), at_last);
  program.wanted_levels_at(now, level);
  for (std::size_t h = 0; h < heads_.size(); ++h) {
    const std::size_t f = heads_[h].fixture;
    if (turned_elsewhere(program, f)) heads_[h].where.lose(now);
    const Order order{wanted[f], at_last[f], level[f] > 0 && !program.blackout, !health.motion_lost(f)};
    if (step(now, heads_[h], program.dims[h], order)) ++program.revision;
  }
}

bool HeadGuard::step(Time now, Head& head, HeadDim& dim, const Order& order) const {
  const std::size_t f = head.fixture;
  bool changed = false;
  if (dim.held && now >= dim.start + dim.duration + kDarkBeforeTurning) {
    dim.held = false;
    changed = true;
  }
  const JointBox ahead = JointBox::at(order.wanted).joined(JointBox::at(order.at_last));
  const JointBox told = dim.held ? JointBox::at(dim.held_at) : ahead;
  head.where.step(now, told, order.obeys);
  JointBox sweep = head.where.box();
  std::optional<Joints> straight_to = head.where.on_line_to();
  if (straight_to && !(ahead == JointBox::at(*straight_to))) {
    sweep = sweep.joined(JointBox::at(*straight_to));
    straight_to.reset();
  }
  if (!straight_to) sweep = sweep.joined(ahead);
  if (!(head.swept && *head.swept == sweep && head.swept_to == straight_to)) {
    head.zone = straight_to ? zones_.may_meet_on_line(f, sweep, *straight_to) : zones_.may_meet(f, sweep);
    head.swept = sweep;
    head.swept_to = straight_to;
  }
  if (head.zone && dim.to > 0) {
    // At its last ordered aim the beam meets nothing; the head stays there until it is dark.
    const bool gently = order.lit && head.told.has_value();
    dim = {f,      gently ? dim.share(now) : 0.0, 0, now, gently ? kDimsOver : Duration{},
           gently, head.told.value_or(Joints{})};
    changed = true;
  } else if (!head.zone && dim.to < 1) {
    dim = {f, dim.share(now), 1, now, kLightsOver, false, {}};
    changed = true;
  }
  if (!dim.held) head.told = order.wanted;
  return changed;
}

bool any_dimmed_for_a_zone(const OutputProgram& program, Time now) {
  return std::any_of(program.dims.begin(), program.dims.end(),
                     [&](const HeadDim& dim) { return program.to_level[dim.fixture] > 0 && dim.share(now) < 1; });
}

void HeadGuard::tell(ShowStatus& status, const Rig& rig, const OutputProgram& program, bool shared) const {
  for (std::size_t h = 0; h < heads_.size(); ++h) {
    const Head& head = heads_[h];
    const HeadDim& dim = program.dims[h];
    FixtureStatus& shown = status.fixtures[head.fixture];
    shown.kept_dark = dim.to == 0 && !shown.parked;
    if (shown.kept_dark && head.zone)
      shown.waits_for = fmt::format("its beam to be clear of keep-out zone \"{}\"", zones_.name(*head.zone));
    if (!head.told || dim.to > 0) continue;
    // A head that passes through needs no action. One that rests there stays dark until a person acts.
    const std::optional<std::size_t> zone = zones_.met(head.fixture, *head.told);
    if (!zone || !(program.to_level[head.fixture] > 0 || shared)) continue;
    if (shown.kept_dark)
      shown.waits_for = fmt::format("another aim: it looks into keep-out zone \"{}\"", zones_.name(*zone));
    status.alarms.push_back({false, rig.fixtures[head.fixture].name,
                             fmt::format("{} looks into keep-out zone \"{}\" and stays dark; turn it elsewhere",
                                         rig.fixtures[head.fixture].name, zones_.name(*zone)),
                             dim.start});
  }
}

}  // namespace luxrig
