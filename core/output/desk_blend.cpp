#include "core/output/desk_blend.h"

#include <algorithm>

#include "core/output/output_program.h"

namespace luxrig {

double DeskBlend::share(Time now) const {
  if (now >= start + duration) return 1;
  if (now <= start) return 0;
  return fade_share(curve, static_cast<double>((now - start).count()) / static_cast<double>(duration.count()));
}

void DeskBlend::apply(Time now, std::span<const std::uint8_t> kept, std::span<double> level) const {
  const double done = share(now);
  for (std::size_t i = 0; i < fixtures.size(); ++i) {
    if (!kept.empty() && kept[fixtures[i]] != 0) continue;
    double& out = level[fixtures[i]];
    double wanted = out;
    if (to_desk && desk_has[i] != 0) wanted = mode == DeskMode::merge ? std::max(out, desk_level[i]) : desk_level[i];
    out = done >= 1 ? wanted : std::clamp(from_level[i] + (wanted - from_level[i]) * done, 0.0, 1.0);
  }
}

void DeskBlend::turn(Time now, std::span<Joints> joints) const {
  const double done = share(now);
  for (std::size_t i = 0; i < fixtures.size(); ++i) {
    Joints& out = joints[fixtures[i]];
    const Joints wanted = to_desk && desk_turns[i] != 0 ? desk_joints[i] : out;
    if (done >= 1) {
      out = wanted;
    } else {
      out = {from_joints[i].pan_rad + (wanted.pan_rad - from_joints[i].pan_rad) * done,
             from_joints[i].tilt_rad + (wanted.tilt_rad - from_joints[i].tilt_rad) * done,
             from_joints[i].beam_rad + (wanted.beam_rad - from_joints[i].beam_rad) * done};
    }
  }
}

}  // namespace luxrig
