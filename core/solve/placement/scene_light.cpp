#include "core/solve/placement/scene_light.h"

#include <algorithm>

namespace luxrig {
namespace {

/// A step in which intensity hardly changes and rounding hardly counts.
constexpr double kTurn = 1e-4;

}  // namespace

SceneLight::SceneLight(const IncrementalTransport& transport, std::vector<Receiver> receivers, Emitter luminaire,
                       bool indirect, std::function<bool(const Vec3&)> may_hang)
    : transport_(&transport),
      receivers_(std::move(receivers)),
      luminaire_(std::move(luminaire)),
      indirect_(indirect),
      may_hang_(std::move(may_hang)) {}

bool SceneLight::column(const Vec3& place_world_m, Eigen::VectorXd& lux, Eigen::MatrixX3d* lux_per_m) const {
  if (!place_world_m.allFinite() || (may_hang_ && !may_hang_(place_world_m))) return false;
  Emitter hung = luminaire_;
  hung.world_from_lamp.translation_m = place_world_m;
  auto found = indirect_ ? transport_->column(hung) : transport_->direct_column(hung);
  if (!found || !found->total_lux.allFinite()) return false;
  if (lux_per_m) {
    lux_per_m->setZero(points(), 3);
    for (Eigen::Index i = 0; i < points(); ++i)
      if (found->direct_lux[i] > 0)
        lux_per_m->row(i) = derivative(receivers_[static_cast<std::size_t>(i)], hung, found->direct_lux[i]);
  }
  lux = std::move(found->total_lux);
  return true;
}

/// Of E = I(-d) n·d / |d|³ with d from the receiver to the light.
Eigen::RowVector3d SceneLight::derivative(const Receiver& receiver, const Emitter& hung, double lux) const {
  const Vec3 d_m = hung.world_from_lamp.translation_m - receiver.position_world_m;
  const double squared_m2 = d_m.squaredNorm(), height_m = receiver.normal_world.dot(d_m);
  Vec3 of_log = receiver.normal_world / height_m - 3 / squared_m2 * d_m;
  const Mat3 lamp_from_world = hung.world_from_lamp.rotation.transpose();
  const double step_m = kTurn * std::sqrt(squared_m2);
  for (int axis = 0; axis < 3; ++axis) {
    const auto intensity_cd = [&](double side) {
      const Vec3 moved_m = d_m + side * step_m * Vec3::Unit(axis);
      return hung.intensity->intensity_cd(lamp_from_world * -moved_m.normalized());
    };
    const double ahead = intensity_cd(1), behind = intensity_cd(-1);
    if (ahead + behind > 0) of_log[axis] += (ahead - behind) / (step_m * (ahead + behind));
  }
  return lux * of_log.transpose();
}

}  // namespace luxrig
