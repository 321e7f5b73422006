#include "core/tasks/rig_transport.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/check.h"
#include "core/photometry/sky/sky.h"
#include "core/rig/zoom.h"

namespace luxrig {
namespace {

/// Angle between the lamp's own up and the world's.
double tilt_off_upright_rad(const Pose& world_from_lamp) {
  const Vec3 up_world = world_from_lamp.rotation.col(2);
  return std::atan2(std::hypot(up_world.x(), up_world.y()), up_world.z());
}

}  // namespace

Emitter emitter_of(const Luminaire& luminaire, const Pose& world_from_lamp, double beam_rad) {
  Emitter emitter{intensity_at_beam(luminaire, beam_rad), world_from_lamp, luminaire.shape, luminaire.colour_rgb};
  if (luminaire.tilt) {
    const double factor = luminaire.tilt->over_upright(tilt_off_upright_rad(world_from_lamp));
    if (factor != 1) emitter.intensity = scaled_to_flux(emitter.intensity, factor * emitter.intensity->flux_lm());
  }
  return emitter;
}

std::vector<Emitter> emitters_of(const Rig& rig, std::span<const Joints> joints) {
  LUXRIG_CHECK(joints.empty() || joints.size() == rig.fixtures.size(), "{} joints for {} fixtures", joints.size(),
               rig.fixtures.size());
  std::vector<Emitter> emitters;
  emitters.reserve(rig.fixtures.size());
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Fixture& fixture = rig.fixtures[f];
    const Joints& at = joints.empty() ? fixture.joints : joints[f];
    emitters.push_back(emitter_of(rig.luminaires.at(fixture.luminaire), fixture.world_from_lamp(at), at.beam_rad));
  }
  return emitters;
}

std::vector<Emitter> daylight_emitters_of(const Rig& rig) {
  std::vector<Emitter> emitters;
  if (!rig.daylight) return emitters;
  const Daylight& daylight = *rig.daylight;
  const auto add = [&](Sky sky) {
    Emitter emitter;
    emitter.sky = std::move(sky);
    emitters.push_back(std::move(emitter));
  };
  Vec3 sun = daylight.towards_sun_world;
  sun.z() = std::max(sun.z(), 1e-6);
  sun.normalize();
  switch (daylight.sky) {
    case Daylight::SkyKind::none:
      break;
    case Daylight::SkyKind::uniform:
      add(make_uniform_sky(daylight.horizontal_lx));
      break;
    case Daylight::SkyKind::overcast:
      add(make_overcast_sky(daylight.horizontal_lx));
      break;
    case Daylight::SkyKind::clear:
      add(make_clear_sky(sun, daylight.horizontal_lx));
      break;
    case Daylight::SkyKind::general:
      add(make_general_sky(daylight.general_type, sun, daylight.horizontal_lx));
      break;
  }
  if (daylight.sun_normal_lx > 0 && daylight.towards_sun_world.z() > 0) add(make_sun(sun, daylight.sun_normal_lx));
  return emitters;
}

std::vector<Emitter> all_emitters_of(const Rig& rig, std::span<const Joints> joints) {
  std::vector<Emitter> emitters = emitters_of(rig, joints);
  for (Emitter& emitter : daylight_emitters_of(rig)) emitters.push_back(std::move(emitter));
  return emitters;
}

Eigen::VectorXd levels_with_daylight(const TransportMatrix& transport, const Eigen::VectorXd& levels) {
  LUXRIG_CHECK(levels.size() <= transport.emitters(), "{} levels for {} emitters", levels.size(), transport.emitters());
  Eigen::VectorXd all = Eigen::VectorXd::Ones(transport.emitters());
  all.head(levels.size()) = levels;
  return all;
}

Eigen::VectorXd daylight_lux(const Rig& rig, const TransportMatrix& transport) {
  const auto fixtures = static_cast<Eigen::Index>(rig.fixtures.size());
  return transport.lux(levels_with_daylight(transport, Eigen::VectorXd::Zero(fixtures)));
}

std::vector<Receiver> receivers_of(const Rig& rig) {
  std::vector<Receiver> receivers;
  receivers.reserve(rig.points.size() + rig.luxmeters.size());
  for (const Point& point : rig.points) receivers.push_back({point.position_world_m, point.normal_world});
  for (const Luxmeter& meter : rig.luxmeters) receivers.push_back({meter.position_world_m, meter.normal_world});
  return receivers;
}

void set_error_floor(const Rig& rig, EvaluateOptions& options) {
  constexpr double kShare = 0.1;
  double smallest_lx = std::numeric_limits<double>::infinity();
  for (const Point& point : rig.points)
    for (const auto& lux : {point.goal_lx, point.max_lx})
      if (lux && *lux > 0) smallest_lx = std::min(smallest_lx, *lux);
  const bool any = std::isfinite(smallest_lx);
  options.floor_lx = any ? kShare * smallest_lx : 0;
  options.floor_of_mean = any ? 0 : kShare;
}

}  // namespace luxrig
