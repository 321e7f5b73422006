/// A lamp is dimmed for a moment, so that the meters tell which of several faults there is (core/show/fault_watch.h).
/// It only ever takes light away, and goes out like every other change: within limits, under a blackout, by the safe look.

#include <algorithm>
#include <utility>

#include "core/show/controller/show_state.h"

namespace luxrig {
namespace {

/// Slow enough to go unnoticed by most.
constexpr double kDipFade_s = 1;
/// A lamp at less than this has no light to lose.
constexpr double kDarkest = 0.02;

}  // namespace

/// Lamps that the show alone decides on, and that dim.
std::vector<std::uint8_t> ShowController::State::may_be_dipped() const {
  std::vector<std::uint8_t> may(rig.fixtures.size(), 0);
  for (std::size_t f = 0; f < may.size(); ++f)
    may[f] = program.to_level[f] > kDarkest && !rig.fixtures[f].switched && !lost[f] && !bypassed.lamp(f) &&
             !parked(f) && !health.lamp_silent(f) && !health.lamp_failing(f);
  for (const ByHand& held : hands.all())
    if (held.what == ByHand::What::level) may[held.index] = 0;
  for (const HeadDim& dim : program.dims) may[dim.fixture] = 0;
  return may;
}

/// Limits may hold lamps below their targets.
std::vector<double> ShowController::State::undipped_levels(Time now) const {
  std::vector<double> level(rig.fixtures.size());
  program.levels_at(now, level);
  if (dipped && program.to_level[dipped->fixture] > 0)
    level[dipped->fixture] *= dipped->level / program.to_level[dipped->fixture];
  return level;
}

void ShowController::State::dip_to(Time now, double level) {
  const std::optional<Dipped> kept = std::exchange(dipped, std::nullopt);
  std::vector<double> to = program.to_level;
  to[kept->fixture] = level;
  fade(now, present_levels(now), std::move(to), kDipFade_s, rig.control.fade_curve);
  dipped = kept;
}

void ShowController::State::drop_dip() {
  if (!dipped) return;
  program.to_level[dipped->fixture] = dipped->level;
  dipped.reset();
  faults.dip_ends();
}

void ShowController::State::step_dip(Time now) {
  const bool calm = phase == Phase::holding && !program.blackout && !sharing.shared() && progress.breaches.empty() &&
                    !lost.any() && !bypassed.any_lamp();
  if (!dipped) {
    if (!calm || !program.done(now) || solving.running()) return;
    const auto dip = faults.lamp_to_dip(now, may_be_dipped());
    if (!dip) return;
    if (!rig.control.fault_dips) return faults.dip_is_barred(*dip);
    dipped = Dipped{dip->fixture, program.to_level[dip->fixture], false};
    faults.dip_begins(*dip);
    return dip_to(now, dip->level_share * dipped->level);
  }
  if (!dipped->comes_back && (!calm || may_be_dipped()[dipped->fixture] == 0 || faults.dip_is_read())) {
    dipped->comes_back = true;
    faults.dip_ends();
    return dip_to(now, dipped->level);
  }
  if (dipped->comes_back && program.done(now)) dipped.reset();
}

}  // namespace luxrig
