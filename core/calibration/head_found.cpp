#include "core/calibration/head_found.h"

#include <cmath>

namespace luxrig {

void put_head(const HeadFit& fit, CalibratedFixture& fixture) {
  const HeadVector& found = fit.pose.parameters;
  const HeadVector error = fit.covariance.diagonal().head<kHeadParameters>().cwiseMax(0.0).cwiseSqrt();
  const auto known = [&](int at) { return Known{found[at], error[at]}; };
  // Angles are small, so that their errors are those of their tangents.
  const auto angle_deg = [&](int at) { return Known{deg_from_rad(std::atan(found[at])), deg_from_rad(error[at])}; };
  const auto play_deg = [&](int at) { return Known{deg_from_rad(found[at]), deg_from_rad(error[at])}; };
  fixture.offset_m = found.segment<3>(kHeadOffset);
  fixture.offset_error_m = error.segment<3>(kHeadOffset);
  fixture.turn_deg = found.segment<3>(kHeadTurn) * (180 / kPi);
  fixture.turn_error_deg = error.segment<3>(kHeadTurn) * (180 / kPi);
  CalibratedHead& head = fixture.head.emplace();
  head.upside_down = fit.pose.upside_down;
  head.pan_scale = known(kHeadPanScale);
  head.tilt_scale = known(kHeadTiltScale);
  head.askew_deg = angle_deg(kHeadAskew);
  head.tilt_zero_deg = angle_deg(kHeadAskew + 1);
  head.pan_backlash_deg = play_deg(kHeadPanPlay);
  head.tilt_backlash_deg = play_deg(kHeadTiltPlay);
}

}  // namespace luxrig
