#include "core/tasks/any_aim.h"

#include <algorithm>
#include <cmath>

#include "core/rig/zoom.h"

namespace luxrig {
namespace {

/// Nearer than this, distance alone says nothing.
constexpr double kNearestHead_m = 0.05;
constexpr int kRadii = 24;

struct Whiteness {
  double most = 0, mean = 0, mirror = 0;
};

Whiteness whiteness_of(const Scene& scene) {
  Whiteness white;
  double area_m2 = 0, reflecting_m2 = 0;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const auto& [a, b, c] = scene.triangles[t];
    const Vec3 from_m = scene.vertex_world_m(a);
    const double triangle_m2 = 0.5 * (scene.vertex_world_m(b) - from_m).cross(scene.vertex_world_m(c) - from_m).norm();
    const Material& material = scene.materials[scene.material_of_triangle[t]];
    const double matt = material.luminous_reflectance();
    const double all = std::min(kMaxReflectance, matt + material.specular_reflectance);
    area_m2 += triangle_m2;
    reflecting_m2 += triangle_m2 * all;
    white.most = std::max(white.most, all);
    white.mirror = std::max(white.mirror, material.specular_reflectance);
  }
  if (area_m2 > 0) white.mean = reflecting_m2 / area_m2;
  return white;
}

/// Of a receiver whose normal leans so far from the lamp, which may be a little elsewhere.
double largest_cosine(double cosine, double distance_m) {
  const double stray_rad = distance_m > kHangsOff_m ? std::asin(kHangsOff_m / distance_m) : kPi / 2;
  return std::max(0.0, std::cos(std::max(0.0, std::acos(std::clamp(cosine, -1.0, 1.0)) - stray_rad)));
}

double most_lux(const Point& point, const Fixture& head, const IntensityDistribution& intensity,
                const Whiteness& white) {
  const Vec3 to_m = point.position_world_m - head.world_from_mount.translation_m;
  const double distance_m = to_m.norm(), near_m = std::max(kNearestHead_m, distance_m - kHangsOff_m);
  const double peak_cd = intensity.max_intensity_cd(), flux_lm = intensity.flux_lm();
  const double cosine =
      distance_m > 0 ? largest_cosine(-to_m.dot(point.normal_world.normalized()) / distance_m, distance_m) : 1;
  // A mirror throws the beam from elsewhere, so its angle is not known.
  const double straight_lx = peak_cd / (near_m * near_m) * (cosine + white.mirror);
  double reflected_lx = HUGE_VAL;
  for (int k = 1; k < kRadii; ++k) {
    const double radius_m = near_m * k / kRadii;
    reflected_lx = std::min(reflected_lx, white.most * peak_cd / std::pow(near_m - radius_m, 2) +
                                              white.most / (1 - white.mean) * flux_lm / (kPi * radius_m * radius_m));
  }
  return straight_lx + reflected_lx;
}

}  // namespace

Eigen::MatrixXd any_aim_lux_per_level(const Rig& rig, const Scene& scene) {
  const auto points = static_cast<Eigen::Index>(rig.points.size());
  const auto fixtures = static_cast<Eigen::Index>(rig.fixtures.size());
  Eigen::MatrixXd most = Eigen::MatrixXd::Zero(points, fixtures);
  const Whiteness white = whiteness_of(scene);
  for (Eigen::Index f = 0; f < fixtures; ++f) {
    const Fixture& head = rig.fixtures[static_cast<std::size_t>(f)];
    if (!head.moves) continue;
    const Luminaire& luminaire = rig.luminaires[head.luminaire];
    const Intensity narrowest = intensity_at_beam(luminaire, head.range.zooms() ? head.range.beam_min_rad : 0);
    for (Eigen::Index p = 0; p < points; ++p)
      most(p, f) = most_lux(rig.points[static_cast<std::size_t>(p)], head, *narrowest, white);
  }
  return most;
}

}  // namespace luxrig
