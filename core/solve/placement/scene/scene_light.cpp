#include "core/solve/placement/scene/scene_light.h"

#include <vector>

#include "core/check.h"
#include "core/transport/direct/direct_light.h"

namespace luxrig {
namespace {

/// A step over which intensity hardly changes and rounding hardly matters.
constexpr double kTurn = 1e-4;

/// Error wanted for a luminaire with size that may be partly blocked.
constexpr double kSizeError = 0.003;

}  // namespace

SceneLight::SceneLight(const IncrementalTransport& transport, std::vector<Receiver> receivers, Emitter luminaire,
                       SceneLightOptions options)
    : transport_(&transport),
      receivers_(std::move(receivers)),
      luminaire_(std::move(luminaire)),
      options_(std::move(options)) {
  const bool has_size = luminaire_.shape.kind != LuminousShape::Kind::point;
  LUXRIG_CHECK(!has_size || (options_.rays && !options_.indirect), "a luminaire with size and {}",
               options_.rays ? "reflected light" : "no scene");
}

Result<LuminaireColumn> SceneLight::direct_of(const Emitter& emitter) const {
  if (emitter.shape.kind == LuminousShape::Kind::point) return transport_->direct_column(emitter);
  EvaluateOptions options;
  options.wanted_relative_error = kSizeError;
  options.threads = 1;
  auto light = direct_light(*options_.rays, receivers_, {&emitter, 1}, options);
  if (!light) return tl::unexpected(light.error());
  return LuminaireColumn{light->lux_per_level.col(0), light->lux_per_level.col(0), {}, light->rays};
}

Emitter SceneLight::hung(const LightPose& pose) const {
  Emitter hung = luminaire_;
  hung.world_from_lamp.translation_m = pose.position_world_m;
  if (options_.aimed)
    hung.world_from_lamp.rotation = aimed_rotation(luminaire_.world_from_lamp.rotation, pose.aim_world);
  return hung;
}

bool SceneLight::column(const LightPose& pose, Eigen::VectorXd& lux, Eigen::MatrixXd* slopes) const {
  const Vec3& position_m = pose.position_world_m;
  if (!position_m.allFinite() || (options_.may_hang && !options_.may_hang(position_m))) return false;
  const Emitter emitter = hung(pose);
  auto found = direct_of(emitter);
  if (!found || !found->total_lux.allFinite()) return false;
  Eigen::MatrixXd rises;
  if (slopes) rises = slopes_at(pose, found->direct_lux);
  if (options_.indirect) {
    Eigen::MatrixXd* of_reflected = slopes ? &rises : nullptr;
    if (options_.aimed || !options_.reflected || !options_.reflected->add(position_m, found->total_lux, of_reflected)) {
      found = transport_->column(emitter);
      if (!found || !found->total_lux.allFinite()) return false;
    }
  }
  if (slopes) *slopes = std::move(rises);
  lux = std::move(found->total_lux);
  return true;
}

/// Slopes of E = I(-d) n·d / |d|³ with d from the receiver to the light.
Eigen::MatrixXd SceneLight::slopes_at(const LightPose& pose, const Eigen::VectorXd& direct_lux) const {
  const Mat3 lamp_from_world = hung(pose).world_from_lamp.rotation.transpose();
  std::vector<Mat3> turned;  // behind and ahead of each freedom of the aim
  for (Eigen::Index i = 3; i < freedoms(); ++i)
    for (const double side : {-1.0, 1.0})
      turned.push_back(
          hung(moved(pose, side * kTurn * Eigen::VectorXd::Unit(freedoms(), i))).world_from_lamp.rotation.transpose());
  const auto of_log = [](double ahead, double behind, double step) {
    return ahead + behind > 0 ? (ahead - behind) / (step * (ahead + behind)) : 0;
  };
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(points(), freedoms());
  for (Eigen::Index r = 0; r < points(); ++r) {
    if (!(direct_lux[r] > 0)) continue;
    const Receiver& receiver = receivers_[static_cast<std::size_t>(r)];
    const Vec3 d_m = pose.position_world_m - receiver.position_world_m;
    const double squared_m2 = d_m.squaredNorm(), step_m = kTurn * std::sqrt(squared_m2);
    slopes.row(r).head<3>() = receiver.normal_world / receiver.normal_world.dot(d_m) - 3 / squared_m2 * d_m;
    for (int axis = 0; axis < 3; ++axis) {
      const auto intensity_cd = [&](double side) {
        return luminaire_.intensity->intensity_cd(lamp_from_world *
                                                  -(d_m + side * step_m * Vec3::Unit(axis)).normalized());
      };
      slopes(r, axis) += of_log(intensity_cd(1), intensity_cd(-1), step_m);
    }
    for (Eigen::Index i = 3; i < freedoms(); ++i) {
      const auto intensity_cd = [&](Eigen::Index side) {
        return luminaire_.intensity->intensity_cd(turned[static_cast<std::size_t>(2 * (i - 3) + side)] *
                                                  -d_m.normalized());
      };
      slopes(r, i) += of_log(intensity_cd(1), intensity_cd(0), kTurn);
    }
    slopes.row(r) *= direct_lux[r];
  }
  return slopes;
}

}  // namespace luxrig
