/// A rig file that was read again while the show runs.

#include <algorithm>
#include <utility>

#include "core/check.h"
#include "core/show/controller/show_state.h"

namespace luxrig {

void ShowController::State::exchange_rig(Time now, const Rig& other, const LightModel& model, bool same_light) {
  LUXRIG_CHECK(other.fixtures.size() == rig.fixtures.size() && other.luxmeters.size() == rig.luxmeters.size() &&
                   (!same_light || other.points.size() == rig.points.size()),
               "another rig's outputs");
  hands.exchange_points(rig.points, other.points);
  const std::vector<double> present = present_levels(now);
  rig = other;
  rig_since = now;
  points_in_force = rig.points;
  take_points(hung_look(rig));
  progress.forget_aims();
  awaited.reset();
  drop_solving();
  parking.clear();
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) program.max_level[f] = bypassed.lamp(f) ? 0 : max_of(f);
  if (same_light) {
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f) estimator.set_max_level(f, program.max_level[f]);
  } else {
    estimator = GainEstimator(rig, model);
    scale.forget_all();
    faults.forget();
    readings.disbelieve_all();
    model_joints = program.joints;
  }
  if (rig.safe.scope == SafeScope::all) lost.forget_all();
  tell_estimator();
  in_force = present;  // limits let it pass until the next look is on
  fade(now, present, present, 0, FadeCurve::linear);
}

void ShowController::exchange_rig(Time now, const Rig& rig, const LightModel& model, bool same_light) {
  now = state_->at_least_last(now);
  state_->exchange_rig(now, rig, model, same_light);
}

}  // namespace luxrig
