#include "core/tasks/rig_version.h"

#include <cmath>
#include <numbers>

#include "core/fingerprint.h"

namespace luxrig {
namespace {

/// A light distribution is identified by its flux and by its intensity in this many directions, evenly over the sphere.
constexpr int kDirectionsOfLight = 256;

void add_intensity(Fingerprint& print, const Luminaire& luminaire) {
  print.add(luminaire.lumens);
  if (!luminaire.intensity) return;
  print.add(luminaire.intensity->flux_lm());
  for (int i = 0; i < kDirectionsOfLight; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirectionsOfLight, r = std::sqrt(1 - z * z);
    const double turn_rad = i * std::numbers::pi * (3 - std::sqrt(5.0));
    print.add(luminaire.intensity->intensity_cd({r * std::cos(turn_rad), r * std::sin(turn_rad), z}));
  }
}

std::uint64_t light_of(const Rig& rig, const Scene& scene) {
  Fingerprint print;
  print.add(scene.origin_world_m);
  for (const Vec3f& vertex : scene.vertices_m) print.add(Vec3(vertex.cast<double>()));
  for (const auto& corners : scene.triangles)
    for (const std::uint32_t corner : corners) print.add(std::uint64_t{corner});
  for (const std::uint32_t material : scene.material_of_triangle) print.add(std::uint64_t{material});
  for (const Material& material : scene.materials) {
    print.add(material.reflectance_rgb);
    print.add(material.specular_reflectance);
    print.add(material.roughness);
  }
  for (const Pane& pane : scene.panes) {
    for (const Vec3& corner : pane.corners_world_m) print.add(corner);
    print.add(pane.transmittance);
  }
  for (const Luminaire& luminaire : rig.luminaires) {
    add_intensity(print, luminaire);
    print.add(luminaire.colour_rgb);
    print.add(luminaire.shape.size_m);
    print.add(static_cast<std::uint64_t>(luminaire.shape.kind));
    if (luminaire.tilt)
      for (std::size_t i = 0; i < luminaire.tilt->factor.size(); ++i) {
        print.add(luminaire.tilt->angle_deg[i]);
        print.add(luminaire.tilt->factor[i]);
      }
  }
  for (const Fixture& fixture : rig.fixtures) {
    print.add(fixture.name);
    print.add(std::uint64_t{fixture.luminaire});
    if (fixture.moves) {
      print.add(fixture.world_from_mount);
      print.add(fixture.roll_rad);
    } else {
      print.add(fixture.world_from_lamp());
    }
  }
  for (const Luxmeter& meter : rig.luxmeters) {
    print.add(meter.name);
    print.add(meter.position_world_m);
    print.add(meter.normal_world);
  }
  for (const Point& point : rig.points) {
    print.add(point.name);
    print.add(point.position_world_m);
    print.add(point.normal_world);
  }
  for (const KnownLight& light : rig.known_lights) {
    print.add(std::uint64_t{light.point});
    print.add(std::uint64_t{light.fixture});
    print.add(light.lux);
  }
  if (rig.daylight) {
    print.add(static_cast<std::uint64_t>(rig.daylight->sky));
    print.add(static_cast<std::uint64_t>(rig.daylight->general_type));
    print.add(rig.daylight->horizontal_lx);
    print.add(rig.daylight->sun_normal_lx);
    print.add(rig.daylight->towards_sun_world);
  }
  return print.value();
}

}  // namespace

RigVersion version_of(const Rig& rig, const Scene& scene) {
  Fingerprint goals, limits;
  for (const Point& point : rig.points) {
    goals.add(point.name);
    goals.add(point.goal_lx);
    goals.add(point.goal_lx ? point.weight : 0.0);
    if (point.goal_rgb) goals.add(*point.goal_rgb);
    if (point.goal_lx && point.goal_tolerance) goals.add(*point.goal_tolerance);
    limits.add(point.max_lx);
  }
  for (const Fixture& fixture : rig.fixtures) {
    limits.add(fixture.max_level);
    limits.add(std::uint64_t{fixture.switched});
  }
  limits.add(rig.limits.max_level);
  limits.add(rig.limits.max_watts);
  return {goals.value(), limits.value(), light_of(rig, scene)};
}

}  // namespace luxrig
