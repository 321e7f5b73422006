#include "tools/luxrig/calibrate/head_turner.h"

#include <algorithm>
#include <utility>

#include "core/output/head_travel.h"

namespace luxrig {
namespace {

/// Beside a keep-out zone, a head may be dark on its way, and is lit again so long after it.
constexpr double kLitAgain_s = 0.8;
/// Of the ends of a range that a head which is turned by a calibration is not sent to.
constexpr double kRangeInUse_rad = rad_from_deg(15);
constexpr double kLook_s = 0.05;

Rig rig_in_use(Rig rig, const DaemonRig& daemon) {
  rig.fixtures = daemon.fixtures_in_use();
  return rig;
}

}  // namespace

HeadTurner::HeadTurner(const Rig& rig, DaemonRig& daemon, const std::stop_token& stop)
    : rig_(rig), daemon_(daemon), stop_(stop), zones_(rig_in_use(rig, daemon)) {}

HeadSetup HeadTurner::setup(std::size_t fixture, const HeadPriors& priors) const {
  HeadSetup setup = head_setup(rig_, fixture, priors);
  if (daemon_.turns_as_found(fixture)) {
    setup.range.pan_min_rad += kRangeInUse_rad;
    setup.range.pan_max_rad -= kRangeInUse_rad;
    setup.range.tilt_min_rad += kRangeInUse_rad;
    setup.range.tilt_max_rad -= kRangeInUse_rad;
  }
  setup.barred = [this, fixture](const Joints& sent) {
    return zones_.met(fixture, daemon_.in_its_terms(fixture, sent, {})).has_value();
  };
  return setup;
}

Result<HeadTurner::Clock::time_point> HeadTurner::send(std::size_t fixture, const Joints& joints, bool lit) {
  const Joints before = at_.value_or(rig_.fixtures[fixture].joints);
  if (joints.pan_rad != before.pan_rad) from_.pan = joints.pan_rad > before.pan_rad ? 1 : -1;
  if (joints.tilt_rad != before.tilt_rad) from_.tilt = joints.tilt_rad > before.tilt_rad ? 1 : -1;
  if (auto turned = daemon_.aim(fixture, joints, from_, lit ? 1 : 0); !turned) return tl::unexpected(turned.error());
  const auto heads = zones_.heads();
  const bool by_zones = std::find(heads.begin(), heads.end(), fixture) != heads.end();
  const double way_s = stands_still_s(rig_.fixtures[fixture], at_, joints) + (lit && by_zones ? kLitAgain_s : 0);
  at_ = joints;
  return Clock::now() + kObeys + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(way_s));
}

Result<void> HeadTurner::wait_until(Clock::time_point time) {
  for (;;) {
    if (stop_.stop_requested()) return tl::unexpected(Fault{Cause::cancelled, "", "stopped", {}});
    if (Clock::now() - held_at_ > DaemonRig::kHoldAgain) {
      if (auto held = daemon_.hold_again(); !held) return held;
      held_at_ = Clock::now();
    }
    const double left_s = std::chrono::duration<double>(time - Clock::now()).count();
    if (left_s <= 0) return {};
    if (auto watched = daemon_.watch(std::min(left_s, kLook_s), stop_); !watched) return watched;
  }
}

}  // namespace luxrig
