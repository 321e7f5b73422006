/// How meter readings are used: corrections, and drift while the light stands still.

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/show/controller/show_state.h"

namespace luxrig {
namespace {

// While the light stands still, meters are sampled once a second (meters and lamp ageing are slow).
constexpr Duration kSampleEvery = std::chrono::seconds(1);
// A drift must be seen in three samples, so that a person walking past a meter moves no light. Lamps drift over hours,
// so more than one correction in ten seconds would only follow noise.
constexpr int kDriftSamples = 3;
constexpr Duration kDriftCorrectionEvery = std::chrono::seconds(10);
// What is known moves a little with the noise of the meters. So many tolerances are a change, and followed at once.
constexpr double kChange = 2;
// Level changes smaller than half a step of a 12-bit dimmer are not worth a fade.
constexpr double kSmallestChange = 1e-4;

}  // namespace

/// Learns from a sample of every living meter. Lost meters take part as soon as they have one, since a believable
/// sample is how a meter that was not believed comes back.
void ShowController::State::take_sample(Time now) {
  if (program.blackout || sharing.shared() || !program.done(now) || too_much_lost() ||
      any_dimmed_for_a_zone(program, now))
    return;  // not the light that was asked for
  look_at_faults(now);
  if (dipped) return;  // nothing is learnt of a light that lasts for seconds
  if (phase == Phase::measuring ? solving.running() : now - readings.sampled_at() < kSampleEvery) return;
  std::vector<LuxReading> sample;
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
    if (in_doubt(i) || bypassed.meter(i)) continue;
    if (readings.has_sample(now, i)) {
      sample.push_back(readings.sample(i));
    } else if (!health.meter_lost(i)) {
      return;
    }
  }
  if (sample.empty()) return;
  for (const Judgement& judgement : estimator.update(now, sample, program.to_level)) {
    health.judged(judgement.luxmeter, now, judgement.why, judgement.stuck);
    if (measuring || phase == Phase::safe) see_beyond_model(now, judgement);
    if (judgement.believed)
      readings.believe(readings.sample(judgement.luxmeter));
    else
      readings.disbelieve(judgement.luxmeter);  // what it taught before stays: limits rely on it
  }
  scale.look(now, estimator, readings.measured(), program.to_level);
  readings.take(now, sample);
  bool all_believed = true;
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i)
    all_believed = all_believed && (readings.measured()[i] || bypassed.meter(i));
  afresh = afresh && !all_believed;

  std::vector<LimitBreach> present;
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    if (!points_in_force[p].max_lx || !estimator.confirmed(p)) continue;
    const double worst_case_lx = estimator.max_lux_at_point(p, program.to_level, now);
    if (worst_case_lx <= *points_in_force[p].max_lx * (1 + kBreachSlack)) continue;
    const auto known = std::find_if(progress.breaches.begin(), progress.breaches.end(),
                                    [&](const LimitBreach& breach) { return breach.point == p; });
    present.push_back({p, worst_case_lx, known == progress.breaches.end() ? now : known->since});
  }
  progress.breaches = std::move(present);
}

/// What a device reports itself is known already.
void ShowController::State::look_at_faults(Time now) {
  if (lost.any() || bypassed.any_lamp()) return faults.forget();
  faults.look(now, estimator, undipped_levels(now));
}

/// Starts solving for the levels that readings and settings by hand require; take_solved() puts them to use.
void ShowController::State::solve(Time now, SolveBeside::For what) {
  solving.start(what, estimator, what == SolveBeside::For::hands ? asked : with_hands(program.to_level), now);
  if (!solving.has_runner()) take_solved(now);
}

/// Drops a solve that is outdated. If it was for settings by hand, that is still to be solved.
void ShowController::State::drop_solving() {
  unsolved = unsolved || solving.what() == SolveBeside::For::hands;
  solving.drop();
}

void ShowController::State::take_solved(Time now) {
  if (!solving.done()) return;
  const bool fades = phase == Phase::fading || phase == Phase::settling || phase == Phase::measuring ||
                     phase == Phase::correcting || phase == Phase::holding;
  const bool for_hands = solving.what() == SolveBeside::For::hands;
  // Lamps that come on by stages finish that first.
  if (for_hands && fades && !program.lamp_starts.empty() && !program.done(now)) return;
  SolveBeside::Solved solved = solving.take();
  const bool holds = solved.holds && cue && !program.blackout;
  if (for_hands) {
    if (!holds || !fades) {
      unsolved = true;  // with the next cue
      if (cue && fades && !program.blackout) {
        unsolved = false;
        solve(now, SolveBeside::For::hands);
      }
      return;
    }
    asked = std::move(solved.correction.level);
    progress.take_aims(solved.correction);
    return go_to_asked(now, present_levels(now, false), hands_fade_s);
  }
  if (!holds || (phase != Phase::measuring && phase != Phase::holding)) return;
  if (solved.what == SolveBeside::For::round) return correct_or_hold(now, std::move(solved.correction));
  look_at_drift(now, solved.correction);
}

/// After a sample: another round if it would bring a metered goal nearer, or if a limit is in question.
void ShowController::State::correct_or_hold(Time now, Correction correction) {
  double change = 0;
  for (std::size_t i = 0; i < correction.level.size(); ++i) {
    change = std::max(change, std::abs(correction.level[i] - program.to_level[i]));
  }
  const bool wanted = possible_gain(correction) > rig.control.tolerance;
  const bool known = rig.daylight || known_gain(correction) > rig.control.tolerance;
  const bool worth_it = change > kSmallestChange && (wanted || !progress.breaches.empty());
  const bool in_rounds = phase == Phase::measuring ? progress.round < rig.control.rounds : true;
  progress.take_aims(correction);
  progress.converged = all_metered_goals_arrived();
  if (!worth_it || (!in_rounds && progress.breaches.empty())) {
    enter(Phase::holding, now);
    return;
  }
  for (std::size_t i = 0; i < cue->size(); ++i) {
    if (lost[i] || bypassed.lamp(i)) {
      correction.level[i] = program.to_level[i];
      continue;
    }
    // A lamp that limits dimmed for a lost lamp comes back with it.
    const bool same = std::abs(correction.level[i] - program.to_level[i]) <= kSmallestChange;
    (*cue)[i] = correction.level[i];
    if (!same || !lost.any()) asked[i] = correction.level[i];
  }
  if (hands.all().empty() && !bypassed.any_lamp()) hands.correct(asked);
  ++progress.round;
  if (phase == Phase::holding && !known)
    progress.patience = std::min<Duration>(2 * progress.patience, CorrectionProgress::kMostPatience);
  progress.corrected_at = now;
  fade(now, present_levels(now), std::move(correction.level), rig.control.correction_fade_s, rig.control.fade_curve);
  enter(Phase::correcting, now);
}

void ShowController::State::watch_drift(Time now) {
  if (readings.sampled_at() != now) return;
  progress.converged = all_metered_goals_arrived();
  if (solving.running()) return;
  // A correction by readings that nobody understands may do harm, and would blur them. In a daylit room it is the day.
  if (!rig.daylight && faults.examines(now) && progress.breaches.empty()) return;
  // Of the samples before the next correction, only the last ones decide.
  const Duration apart = now - std::exchange(progress.sampled_at, now);
  if (progress.breaches.empty() && now - progress.corrected_at + kDriftSamples * apart < kDriftCorrectionEvery) return;
  solve(now, progress.breaches.empty() ? SolveBeside::For::drift : SolveBeside::For::round);
}

void ShowController::State::look_at_drift(Time now, const Correction& correction) {
  progress.drifted = possible_gain(correction) > rig.control.tolerance ? progress.drifted + 1 : 0;
  if (progress.drifted >= kDriftSamples && now - progress.corrected_at >= wait_before(correction))
    solve(now, SolveBeside::For::round);
}

/// Since the last correction. In a daylit room readings change by themselves: there they are followed.
Duration ShowController::State::wait_before(const Correction& correction) const {
  const double tolerances = known_gain(correction) / rig.control.tolerance;
  if (rig.daylight || tolerances > kChange) return kDriftCorrectionEvery;
  const double share = std::clamp((kChange - tolerances) / (kChange - 1), 0.0, 1.0);
  return kDriftCorrectionEvery +
         std::chrono::duration_cast<Duration>(share * (progress.patience - kDriftCorrectionEvery));
}

/// A meter that contradicts only its own past may have been right then, or may be right now. Trusting it now could
/// drive the light up (a coat over it), so a person must ask for that by applying the plan again. Only in the safe
/// look, where no limit relies on what it taught. Never for a meter whose value stood still while the light changed.
void ShowController::State::doubt_the_past(Time now) {
  if (!afresh || readings.sampled_at() != now) return;
  for (std::size_t i = 0; i < rig.luxmeters.size(); ++i) {
    if (!health.meter_implausible(i) || !readings.changed(i)) continue;
    estimator.forget(i);
    solving.facts_changed();
    scale.forget(i);
  }
}

}  // namespace luxrig
