#include "core/calibration/light_sensitivity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/calibration/mount_place.h"
#include "core/check.h"
#include "core/tasks/rig_transport.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Share by which a material's reflectance is raised: about what it is not known by, so that noise counts little.
constexpr double kPaintStep = 0.1;
constexpr double kMostReflectance = 0.95;
/// Of reflected light, so many times as much is left unexplained as of direct light: its model stands on all that is in
/// the room, and on paint that is one colour for all of a material.
constexpr double kReflectedDoubt = 3;

/// The lamp as it is, at each of the displacements of one fixture, one after the other:
/// as found; ± each unknown; both signs of each pair of unknowns.
struct Displacements {
  std::vector<VectorXd> off;
  VectorXd step{kMountUnknowns};

  Displacements(const VectorXd& at, const LightPriors& priors) {
    step.head(3).setConstant(std::max(1e-4, priors.position_m));
    step.tail(3).setConstant(std::max(1e-4, priors.angle_rad));
    off.push_back(at);
    for (Index a = 0; a < kMountUnknowns; ++a)
      for (const double sign : {1.0, -1.0}) off.push_back(at + sign * step[a] * VectorXd::Unit(kMountUnknowns, a));
    for (Index a = 0; a < kMountUnknowns; ++a)
      for (Index b = 0; b < a; ++b)
        for (const double sign : {1.0, -1.0})
          off.push_back(at + step[a] * VectorXd::Unit(kMountUnknowns, a) +
                        sign * step[b] * VectorXd::Unit(kMountUnknowns, b));
  }
};

/// First and second differences of `lux` (receivers × displacements) at the first of them.
void differences(const MatrixXd& lux, const VectorXd& step, MatrixXd& slope, MatrixXd& bend) {
  slope.resize(lux.rows(), kMountUnknowns);
  bend.resize(lux.rows(), kMountUnknowns * kMountUnknowns);
  const auto raised = [](Index a) { return 1 + 2 * a; };
  for (Index a = 0; a < kMountUnknowns; ++a) {
    const auto up = lux.col(raised(a)), down = lux.col(raised(a) + 1);
    slope.col(a) = (up - down) / (2 * step[a]);
    bend.col(a * kMountUnknowns + a) = (up - 2 * lux.col(0) + down) / (step[a] * step[a]);
  }
  Index pair = 1 + 2 * kMountUnknowns;
  for (Index a = 0; a < kMountUnknowns; ++a)
    for (Index b = 0; b < a; ++b, pair += 2) {
      // f(a+b) - f(a-b) = 2 step_b (f_b + step_a f_ab) + third order
      const VectorXd mixed = ((lux.col(pair) - lux.col(pair + 1)) / (2 * step[b]) - slope.col(b)) / step[a];
      bend.col(a * kMountUnknowns + b) = mixed;
      bend.col(b * kMountUnknowns + a) = mixed;
    }
}

/// The first point that is where this one is: a camera sees places that are points of the rig.
std::size_t place_of(const Rig& rig, std::size_t point) {
  constexpr double kSame_m = 1e-6;
  for (std::size_t p = 0; p < point; ++p)
    if ((rig.points[p].position_world_m - rig.points[point].position_world_m).norm() < kSame_m &&
        (rig.points[p].normal_world - rig.points[point].normal_world).norm() < kSame_m)
      return p;
  return point;
}

}  // namespace

Result<LightSensitivity> mount_sensitivity(const Rig& rig, const RayScene& rays, const TransportMatrix& light,
                                           const LightPriors& priors, std::span<const VectorXd> mounts) {
  const auto fixtures = static_cast<Index>(rig.fixtures.size());
  const std::vector<Receiver> receivers = receivers_of(rig);
  LUXRIG_CHECK(
      light.lux_per_level.rows() == static_cast<Index>(receivers.size()) && light.lux_per_level.cols() >= fixtures,
      "light {} × {}", light.lux_per_level.rows(), light.lux_per_level.cols());
  LUXRIG_CHECK(mounts.empty() || static_cast<Index>(mounts.size()) == fixtures, "{} mounts", mounts.size());
  LightSensitivity sensitivity;
  sensitivity.lux = light.lux_per_level.leftCols(fixtures);
  for (std::size_t p = 0; p < rig.points.size(); ++p) sensitivity.place.push_back(place_of(rig, p));
  for (std::size_t m = 0; m < rig.luxmeters.size(); ++m)
    sensitivity.place.push_back(rig.luxmeters[m].point ? sensitivity.place[*rig.luxmeters[m].point]
                                                       : rig.points.size() + m);
  sensitivity.mount.resize(rig.fixtures.size());
  sensitivity.bend.resize(rig.fixtures.size());
  const auto direct = make_direct_evaluator(rays);
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Fixture& fixture = rig.fixtures[f];
    const VectorXd at = mounts.empty() ? VectorXd(VectorXd::Zero(kMountUnknowns)) : mounts[f];
    const Displacements moves(at, priors);
    std::vector<Emitter> emitters;
    for (const VectorXd& off : moves.off) {
      const Vec3 offset_m = offset_in_room(rays, fixture.world_from_mount.translation_m, off.head<3>());
      emitters.push_back(emitter_of(rig.luminaires[fixture.luminaire],
                                    world_from_lamp(displaced(fixture.world_from_mount, offset_m, off.tail<3>()),
                                                    fixture.joints, fixture.roll_rad),
                                    fixture.joints.beam_rad));
    }
    const auto lux = direct->evaluate(receivers, emitters, {});
    if (!lux) return tl::unexpected(lux.error());
    differences(lux->lux_per_level, moves.step, sensitivity.mount[f], sensitivity.bend[f]);
    const auto j = static_cast<Index>(f);
    if (!mounts.empty())
      sensitivity.lux.col(j) =
          (sensitivity.lux.col(j) - light.direct_lux_per_level.col(j)).cwiseMax(0) + lux->lux_per_level.col(0);
  }
  const MatrixXd reflected = (light.lux_per_level - light.direct_lux_per_level).leftCols(fixtures).cwiseMax(0);
  sensitivity.doubtful = sensitivity.lux + (kReflectedDoubt - 1) * reflected;
  return sensitivity;
}

Result<std::vector<MatrixXd>> paint_sensitivity(const Rig& rig, const Scene& scene, const TransportMatrix& light,
                                                const ComputeOptions& options) {
  const auto fixtures = static_cast<Index>(rig.fixtures.size());
  std::vector<MatrixXd> paint;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    MatrixXd& change = paint.emplace_back(MatrixXd::Zero(light.lux_per_level.rows(), fixtures));
    const double before = scene.materials[m].luminous_reflectance();
    if (!(before > 0)) continue;
    Scene painted = scene;
    Vec3& reflectance = painted.materials[m].reflectance_rgb;
    const double room = kMostReflectance / reflectance.maxCoeff() - 1;
    const double step = room >= kPaintStep ? kPaintStep : -kPaintStep;
    reflectance *= 1 + step;
    const RayScene rays(std::move(painted));
    const auto anew = compute_transport(rig, rays, options);
    if (!anew) return tl::unexpected(anew.error());
    change = (anew->lux_per_level.leftCols(fixtures) - light.lux_per_level.leftCols(fixtures)) / step;
  }
  return paint;
}

}  // namespace luxrig
