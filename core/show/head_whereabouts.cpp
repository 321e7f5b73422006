#include "core/show/head_whereabouts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/output/head_move.h"

namespace luxrig {
namespace {

/// Moves both bounds towards the ordered range; they take in at once any part of it outside them.
void close_in(double& least, double& most, double told_least, double told_most, double way) {
  least = std::min(told_least, least + way);
  most = std::max(told_most, most - way);
}

}  // namespace

HeadWhereabouts::HeadWhereabouts(const Fixture& fixture)
    : travel_{{fixture.range.pan_min_rad, fixture.range.tilt_min_rad, fixture.range.beam_min_rad},
              {fixture.range.pan_max_rad, fixture.range.tilt_max_rad, fixture.range.beam_max_rad}},
      box_(travel_),
      speed_{fixture.pan_speed_rad_s, fixture.tilt_speed_rad_s, fixture.zoom_speed_rad_s},
      axes_(fixture.axes),
      reset_(from_seconds(fixture.reset_s)),
      obeys_within_(from_seconds(head_delay_s(fixture))) {}

void HeadWhereabouts::lose(Time now) {
  box_ = travel_;
  told_.clear();
  line_to_.reset();
  obeys_since_.reset();
  last_ = now;
}

void HeadWhereabouts::step(Time now, const JointBox& told, bool obeys) {
  if (axes_) return step_axes(now, told, obeys);
  if (!obeys) {
    obeys_since_.reset();
    told_.clear();
    box_ = box_.joined(told);
    lost_ = true;
    last_ = now;
    return;
  }
  if (!obeys_since_) {
    obeys_since_ = now + (std::exchange(lost_, false) ? reset_ : Duration{});
    last_ = now;
  }
  if (!told_.empty() && told_.back().box == told) {
    told_.back().at = now;
  } else {
    told_.push_back({now, told});
  }
  while (told_.size() > 1 && told_.front().at + obeys_within_ < now) told_.pop_front();
  JointBox window = told_.front().box;
  for (const Told& one : told_) window = window.joined(one.box);
  const Time begin = std::max(last_, *obeys_since_ + obeys_within_);
  const double passed_s = std::max(0.0, to_seconds(now - begin));
  close_in(box_.least.pan_rad, box_.most.pan_rad, window.least.pan_rad, window.most.pan_rad, speed_.pan_rad * passed_s);
  close_in(box_.least.tilt_rad, box_.most.tilt_rad, window.least.tilt_rad, window.most.tilt_rad,
           speed_.tilt_rad * passed_s);
  close_in(box_.least.beam_rad, box_.most.beam_rad, window.least.beam_rad, window.most.beam_rad,
           speed_.beam_rad * passed_s);
  last_ = now;
}

void HeadWhereabouts::step_axes(Time now, const JointBox& told, bool obeys) {
  const bool one_posture = told.least == told.most;
  const bool anew = !line_to_ || !one_posture || !(told.least == *line_to_);
  if (!obeys || anew) {
    // It starts from anywhere that it can have got to.
    if (line_to_) box_ = box_.joined(JointBox::at(*line_to_));
    line_to_.reset();
    if (!one_posture) box_ = box_.joined(told);
  }
  if (!obeys) {
    box_ = box_.joined(told);
    lost_ = true;
    return;
  }
  if (anew && one_posture) {
    const Joints to = told.least;
    const auto way = [](double at, double least, double most) {
      return std::max(std::abs(at - least), std::abs(at - most));
    };
    // The joints turn in step, so the longest way of each takes the longest time.
    const HeadMove move =
        head_move(way(to.pan_rad, box_.least.pan_rad, box_.most.pan_rad),
                  way(to.tilt_rad, box_.least.tilt_rad, box_.most.tilt_rad),
                  {speed_.pan_rad, axes_->pan.acceleration_rad_s2}, {speed_.tilt_rad, axes_->tilt.acceleration_rad_s2});
    line_to_ = to;
    arrives_ = now + from_seconds(move.seconds) + obeys_within_ + (std::exchange(lost_, false) ? reset_ : Duration{});
  }
  if (line_to_ && now >= arrives_) box_ = JointBox::at(*line_to_);
}

}  // namespace luxrig
