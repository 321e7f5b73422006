#include "core/show/show_controller.h"

#include <algorithm>
#include <utility>

#include "core/check.h"
#include "core/output/head_travel.h"
#include "core/rig/register_map/register_map.h"
#include "core/show/controller/show_state.h"

namespace luxrig {

const char* name_of(Phase phase) {
  switch (phase) {
    case Phase::idle:
      return "idle";
    case Phase::moving:
      return "moving";
    case Phase::fading:
      return "fading";
    case Phase::settling:
      return "settling";
    case Phase::measuring:
      return "measuring";
    case Phase::correcting:
      return "correcting";
    case Phase::holding:
      return "holding";
    case Phase::frozen:
      return "frozen";
    case Phase::safe_fading:
      return "safe_fading";
    case Phase::safe:
      return "safe";
  }
  return "unknown";
}

namespace {

/// Per fixture, 1: its product has a bit for a burnt-out lamp.
std::vector<std::uint8_t> fixtures_that_tell_of_lamps(const Rig& rig) {
  std::vector<std::uint8_t> tell(rig.fixtures.size(), 0);
  for (std::size_t f = 0; f < tell.size(); ++f) {
    const auto* patch = std::get_if<ModbusPatch>(&rig.fixtures[f].patch);
    if (patch == nullptr || !patch->map) continue;
    const RegisterMap& map = *patch->map;
    for (const std::size_t level : map.with_role(RegisterRole::level)) {
      const MappedRegister& output = map.registers[level];
      if (output.address != patch->holding_register || (output.table == RegisterTable::coil) != patch->coil) continue;
      for (const std::size_t failure : map.with_role(RegisterRole::failure))
        if (map.concerns(failure, level)) tell[f] = 1;
    }
  }
  return tell;
}

}  // namespace

ShowController::State::State(const Rig& rig_in, const LightModel& model, std::span<const Joints> joints)
    : rig(rig_in),
      estimator(rig, model),
      health(rig),
      readings(rig.luxmeters.size()),
      scale(rig),
      faults(rig),
      head_guard(rig),
      tells_of_lamp(fixtures_that_tell_of_lamps(rig)),
      powerless(rig.fixtures.size(), 0),
      lost(rig.fixtures.size()),
      hands(rig),
      points_in_force(rig.points),
      bypassed(rig) {
  const std::vector<double> dark(rig.fixtures.size(), 0.0);
  for (const Fixture& fixture : rig.fixtures) {
    program.max_level.push_back(rig.max_level(fixture));
  }
  take_points(hung_look(rig));
  program.joints = joints.empty() ? planned.joints : std::vector<Joints>(joints.begin(), joints.end());
  program.switched = switched_fixtures(rig);
  model_joints = program.joints;
  program.dims = head_guard.first_dims();
  fade(Time{}, dark, dark, 0, FadeCurve::linear);
}

/// Commands are obeyed whatever the clock says, but time never goes back.
Time ShowController::State::at_least_last(Time now) { return last = std::max(last, now); }

void ShowController::State::enter(Phase next, Time now) {
  if (phase == next) return;
  phase = next;
  phase_since = now;
}

/// The levels as without a blackout, so that changes under it go on from there. under_ceilings: with the ceilings of
/// power-up applied.
std::vector<double> ShowController::State::present_levels(Time now, bool under_ceilings) const {
  std::vector<double> level(rig.fixtures.size());
  OutputProgram lit = program;
  lit.blackout = false;
  lit.desks.clear();  // Luxrig's own levels, without desks
  if (!under_ceilings) lit.lamp_starts.clear();
  lit.levels_at(now, level);
  return level;
}

void ShowController::State::fade(Time now, std::vector<double> from, std::vector<double> to, double seconds,
                                 FadeCurve curve) {
  // What is lit now, under the limits so far.
  const std::vector<double> lit =
      program.revision == 0 || program.blackout ? std::vector<double>{} : present_levels(now);
  drop_dip();
  guard(now, from, to);
  program.excess_lx.resize(0);
  if (!lit.empty()) {
    const Eigen::Map<const Eigen::VectorXd> level(lit.data(), static_cast<Eigen::Index>(lit.size()));
    program.excess_lx = (program.worst_lux_per_level * level - program.max_lx).cwiseMax(0.0);
    program.excess_since = now;
  }
  program.from_level = std::move(from);
  program.to_level = std::move(to);
  program.start = std::max(now, arrive);
  program.duration = from_seconds(seconds);
  program.curve = curve;
  ++program.revision;
  guard_against_desks(now);
  readings.restart(program.start + program.duration + from_seconds(rig.control.settle_s));
  faults.light_changes(program.start + program.duration);
  progress.drifted = 0;
}

/// Sets the limit rows of the output. A row is one factor for all levels: its assumption for the dim end of a fade
/// would dim the bright end, with a jump when the fade starts. So where the whole way is known to stay within a limit,
/// the row is loosened until it just lets both ends pass. Levels that the rows in force let pass stay allowed until a
/// meter says more.
void ShowController::State::guard(Time now, const std::vector<double>& from, const std::vector<double>& to) {
  constexpr int kSamples = 8;
  constexpr double kOfRounding = 1 + 1e-9, kAllowed = 1 + kBreachSlack;
  const bool nothing_new = readings.sampled_at() <= program.start;  // a correction starts at the instant of its sample
  WorstCase worst = estimator.worst_case(from, to, now);
  const auto lights = static_cast<Eigen::Index>(from.size());
  const Eigen::Map<const Eigen::VectorXd> begin(from.data(), lights), end(to.data(), lights);
  for (std::size_t k = 0; k < worst.points.size(); ++k) {
    auto row = worst.worst_lux_per_level.row(static_cast<Eigen::Index>(k));
    const double max_lx = worst.max_lx[static_cast<Eigen::Index>(k)];
    const double ends_lx = std::max(row.dot(begin), row.dot(end));
    if (ends_lx <= max_lx) continue;
    bool safe = true;
    // The sender of the earlier light knew more than the open-loop margin.
    const auto was = static_cast<Eigen::Index>(in_force.size());
    const bool was_so =
        was == lights && ends_lx <= row.dot(Eigen::Map<const Eigen::VectorXd>(in_force.data(), was)) * kOfRounding;

    for (int s = nothing_new ? 1 : 0; s <= kSamples && safe && !was_so; ++s) {
      Eigen::VectorXd level(lights);
      for (std::size_t j = 0; j < from.size(); ++j)
        level[static_cast<Eigen::Index>(j)] =
            level_on_the_way(from[j], to[j], static_cast<double>(s) / kSamples, program.switched[j] != 0);
      const double worst_case_lx = estimator.max_lux_at_point(worst.points[k], {level.data(), from.size()}, now);
      safe = worst_case_lx <=
             *points_in_force[worst.points[k]].max_lx * kAllowed;  // all light; the row's limit lacks daylight
    }
    if (safe) row *= max_lx / ends_lx * (1 - 1e-9);
  }
  program.worst_lux_per_level = std::move(worst.worst_lux_per_level);
  program.max_lx = std::move(worst.max_lx);
  program.worth = estimator.worth();
  if (!rig.limits.max_watts) return;
  // A limit of power is one more row: watts per level.
  const Eigen::Index row = program.max_lx.size();
  program.worst_lux_per_level.conservativeResize(row + 1, lights);
  program.max_lx.conservativeResize(row + 1);
  for (Eigen::Index j = 0; j < lights; ++j)
    program.worst_lux_per_level(row, j) =
        rig.luminaires[rig.fixtures[static_cast<std::size_t>(j)].luminaire].watts.value_or(0);
  program.max_lx[row] = *rig.limits.max_watts;
}

bool ShowController::State::turns(std::size_t fixture) const {
  return rig.fixtures[fixture].moves && !same_aim(awaited->look.joints[fixture], program.joints[fixture]);
}

/// Call it when the heads that the look turns are dark. The next fade waits until they arrive (`arrive`).
void ShowController::State::take_look(Time now) {
  double wait_s = 0;
  bool any = false, other_light = false;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    // Parking heads are dark: the model of the light stays valid without them.
    const bool parks = !parking.empty() && parking[f] != 0;
    if (rig.fixtures[f].moves && !parks && !parked(f) && !same_aim(awaited->look.joints[f], model_joints[f]))
      other_light = true;
    if (!turns(f)) continue;
    any = true;
    wait_s = std::max(
        wait_s, travel_s(rig.fixtures[f], program.joints[f], awaited->look.joints[f]) + head_delay_s(rig.fixtures[f]));
    program.joints[f] = awaited->look.joints[f];
  }
  take_points(awaited->look);
  // A head that is still turning finishes that way first.
  if (any) arrive = std::max(arrive, now) + from_seconds(wait_s);
  if (other_light) {
    // Gains would still hold, local errors of the model would not; telling them apart takes readings.
    estimator = GainEstimator(rig, awaited->model);
    scale.forget_all();
    faults.forget();
    readings.disbelieve_all();
    model_joints = awaited->look.joints;
  }
  tell_estimator();
  finish_parking();
  awaited.reset();
}

void ShowController::State::start_cue(Time now, std::vector<double> levels, std::optional<double> fade_s) {
  asked = levels;
  cue = std::move(levels);
  progress.begin();
  // The fade waits until everything is back. Before the first step no failure is known.
  const bool waits = phase == Phase::frozen || phase == Phase::safe_fading || phase == Phase::safe;
  if ((failing && waits) || waits_for_desks(now)) return;
  // Without power-up ceilings: they stay in force, and a fade that started below one would add its rise to theirs.
  std::vector<double> present = present_levels(now, false);
  if (awaited) {
    const std::vector<double> lit_now = present_levels(now);
    std::vector<double> without = present;
    bool any = false, lit = false;
    for (std::size_t f = 0; f < without.size(); ++f) {
      const bool parks = !parking.empty() && parking[f] != 0;
      if (!turns(f) && !parks) continue;
      any = any || !parks;
      if (lit_now[f] <= 0) present[f] = 0;  // a ceiling that opens during the fade must not light it
      lit = lit || present[f] > 0;
      without[f] = 0;
    }
    // The other lamps also fade to levels that keep limits without knowledge from meters, or they would jump there.
    if (any) without = GainEstimator(rig, awaited->model).within_limits(without, now);
    // Only once: the next result may differ by rounding.
    if ((lit || (without != present && phase != Phase::moving)) && !program.blackout) {
      fade(now, std::move(present), std::move(without), rig.control.fade_s, rig.control.fade_curve);
      enter(Phase::moving, now);
      return;
    }
    present = std::move(without);
    if (!fade_s) fade_s = awaited->fade_s;
    take_look(now);
  }
  asked = with_hands(*cue);
  solving.facts_changed();
  drop_solving();
  // Levels held by hand go out at once; the rest follows when it is solved around them.
  if (unsolved && !solving.has_runner()) {
    unsolved = false;
    Correction correction = estimator.correct(asked, now, GainEstimator::For::hands);
    progress.take_aims(correction);
    asked = std::move(correction.level);
  }
  go_to_asked(now, std::move(present), fade_s);
  if (std::exchange(unsolved, false)) solve(now, SolveBeside::For::hands);
}

void ShowController::State::go_to_asked(Time now, std::vector<double> present, std::optional<double> fade_s) {
  cue = estimator.within_limits(asked, now);
  if (measuring) keep_measured_limits(now, *cue);
  std::vector<double> sent = *cue;
  lost.put_in(sent, safe_levels());
  for (std::size_t f = 0; f < sent.size(); ++f)
    if (bypassed.lamp(f)) sent[f] = (*cue)[f] = 0;
  if (!start_lamps(now, present, sent))
    fade(now, std::move(present), sent, fade_s.value_or(rig.control.fade_s), rig.control.fade_curve);
  enter(Phase::fading, now);
}

void ShowController::State::freeze(Time now) {
  const std::vector<double> present = present_levels(now);
  program.lamp_starts.clear();
  fade(now, present, present, 0, FadeCurve::linear);
  progress.converged = false;
  enter(Phase::frozen, now);
}

void ShowController::State::resume(Time now) { start_cue(now, asked); }

void ShowController::State::fade_to_safe(Time now) {
  std::vector<double> present = present_levels(now);
  program.lamp_starts.clear();  // the safe look does not wait for stages
  fade(now, std::move(present), limited_safe_levels(now), rig.safe.fade_s, rig.control.fade_curve);
  progress.converged = false;
  progress.breaches.clear();
  safe_is_read = false;
  enter(Phase::safe_fading, now);
}

void ShowController::State::look_at_failures(Time now) {
  // With after_loss, a power cut shorter than the patience would let all its lamps come on at once.
  const bool waits = !rig.startup.after_loss && limits_bear_waiting(now);
  health.step(now, {waits ? kPatience : Duration{}, kPatience});
  const bool was_failing = failing;
  watch_measuring(now);
  failing =
      too_much_lost() || (rig.safe.on_meter_loss && (measuring ? health.any_meter_gone() : health.any_meter_lost()));
  if (was_failing && !failing) healthy_since = now;
  if (failing) {
    if (std::string cause = health.cause(too_much_lost()); !cause.empty()) failure = std::move(cause);
  }
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
    if (health.meter_lost(i)) readings.disbelieve(i);
  }
  progress.converged = progress.converged && all_metered_goals_arrived();
  watch_losses(now);
}

void ShowController::State::advance(Time now) {
  const bool back = !failing && now - healthy_since >= kHealthyFor;
  switch (phase) {
    case Phase::idle:
      return begin_after_listening(now);
    case Phase::frozen:
      if (back && cue) return resume(now);
      if (now - phase_since >= from_seconds(rig.safe.hold_s)) fade_to_safe(now);
      return;
    case Phase::safe_fading:
      if (back && cue && !asked_safe) return resume(now);
      if (!program.done(now)) return;
      in_force.clear();
      enter(Phase::safe, now);
      return;
    case Phase::safe:
      doubt_the_past(now);
      if (back && cue && !asked_safe) resume(now);
      return;
    default:
      break;
  }
  if (failing) return freeze(now);
  if (phase == Phase::moving && (program.done(now) || program.blackout)) {
    if (program.blackout)
      for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
        if (turns(f)) program.from_level[f] = program.to_level[f] = 0;
    return start_cue(now, *cue);
  }
  if (sharing.shared()) return;  // a desk's light says nothing about the plan's
  if (program.blackout) return;  // nothing to measure in the dark; lifting it fades again
  switch (phase) {
    case Phase::fading:
    case Phase::correcting:
      if (!program.done(now)) return;
      in_force.clear();
      enter(Phase::settling, now);
      return;
    case Phase::settling:
      if (now >= program.start + program.duration + from_seconds(rig.control.settle_s)) enter(Phase::measuring, now);
      return;
    case Phase::measuring: {
      bool any_living = false;
      for (std::size_t i = 0; i < rig.luxmeters.size(); ++i)
        any_living = any_living || (!health.meter_lost(i) && !in_doubt(i));
      if (!any_living) return enter(Phase::holding, now);  // no meter to go by: open loop
      if (readings.sampled_at() == now) solve(now, SolveBeside::For::round);
      return;
    }
    default:
      watch_drift(now);
  }
}

ShowController::ShowController(const Rig& rig, LightModel model, std::span<const Joints> joints)
    : state_(std::make_unique<State>(rig, model, joints)) {}
ShowController::~ShowController() = default;
ShowController::ShowController(ShowController&&) noexcept = default;

std::vector<double> ShowController::State::wanted_levels(std::span<const double> levels) const {
  LUXRIG_CHECK(levels.size() == rig.fixtures.size(), "{} levels for {} fixtures", levels.size(), rig.fixtures.size());
  std::vector<double> wanted(levels.begin(), levels.end());
  for (std::size_t i = 0; i < wanted.size(); ++i)
    wanted[i] = wanted[i] > 0 ? std::min(wanted[i], max_of(i)) : 0.0;  // NaN is dark
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (program.switched[i] != 0) wanted[i] = std::min(switched_level(wanted[i]), max_of(i));
  return wanted;
}

void ShowController::apply(Time now, std::span<const double> levels) {
  Look look = state_->planned;
  look.levels.assign(levels.begin(), levels.end());
  look.joints = state_->model_joints;
  look.solved_levels.clear();
  apply(now, std::move(look), {});
}

void ShowController::apply(Time now, Look look, LightModel model, std::optional<double> fade_s) {
  State& state = *state_;
  now = state.at_least_last(now);
  LUXRIG_CHECK(look.joints.size() == state.rig.fixtures.size() && look.goal_lx.size() == state.rig.points.size(),
               "a look of another rig");
  state.unpark();
  std::vector<double> wanted = state.wanted_levels(look.levels);
  state.asked_safe = false;
  state.afresh = true;
  state.beyond_model = 1;
  state.measured_beyond.reset();
  state.scale.forget_drift();
  state.faults.forget();
  state.first_turn(now, look.joints);
  state.take_levels_of_plan(now, wanted, look);
  state.awaited = {std::move(look), std::move(model), fade_s};
  state.start_cue(now, std::move(wanted));
}

void ShowController::blackout(Time now, bool on) {
  State& state = *state_;
  now = state.at_least_last(now);
  if (state.program.blackout == on) return;
  state.drop_dip();
  state.program.blackout = on;
  ++state.program.revision;
  state.progress.converged = false;
  if (on || state.phase == Phase::idle) return;
  const bool to_safe = state.phase == Phase::safe_fading || state.phase == Phase::safe;
  state.fade(now, std::vector<double>(state.rig.fixtures.size(), 0.0), state.program.to_level,
             to_safe ? state.rig.safe.fade_s : state.rig.control.fade_s, state.rig.control.fade_curve);
  if (to_safe) {
    state.enter(Phase::safe_fading, now);
  } else if (state.phase != Phase::frozen && state.phase != Phase::moving) {
    state.enter(Phase::fading, now);
  }
}

void ShowController::go_safe(Time now) {
  State& state = *state_;
  now = state.at_least_last(now);
  state.cue.reset();
  state.awaited.reset();
  state.asked_safe = true;
  if (state.phase != Phase::safe && state.phase != Phase::safe_fading) state.fade_to_safe(now);
}

void ShowController::reading(Time now, const LuxReading& reading) {
  State& state = *state_;
  if (now < state.last || reading.luxmeter >= state.rig.luxmeters.size()) return;
  if (!std::isfinite(reading.lux) || reading.lux < 0) return state.health.garbled(reading.luxmeter, now);
  if (!state.readings.hear(now, reading, state.health.meter_lost(reading.luxmeter))) return;
  state.health.heard(reading.luxmeter, reading.taken);
  if (!state.bypassed.meter(reading.luxmeter)) state.faults.hear(reading);
}

void ShowController::health(Time now, std::span<const Health> devices) {
  if (now < state_->last) return;
  state_->health.report(devices);
}

void ShowController::step(Time now) {
  State& state = *state_;
  if (now < state.last) return;
  state.last = now;
  if (!state.rig_since) state.rig_since = now;
  state.release_what_is_over(now);
  state.step_desks(now);
  state.take_sample(now);
  state.look_at_failures(now);
  state.take_solved(now);
  state.step_dip(now);
  state.advance(now);
  state.watch_power(now);
  state.close_bypassed(now);
  state.head_guard.step(now, state.program, state.health);
  state.remember_levels(now);
}

void ShowController::solve_beside(Beside beside) {
  state_->faults.use(beside);
  state_->solving.use(std::move(beside));
}

std::vector<double> ShowController::safe_look(Time now) const {
  std::vector<double> level = state_->limited_safe_levels(now);
  for (const HeadDim& dim : state_->program.dims) {
    if (dim.to == 0) level[dim.fixture] = 0;
  }
  return level;
}

const OutputProgram& ShowController::program() const { return state_->program; }

Phase ShowController::phase() const { return state_->phase; }

ShowStatus ShowController::status(Time now) const { return state_->status(now); }

}  // namespace luxrig
