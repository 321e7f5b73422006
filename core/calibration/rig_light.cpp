#include "core/calibration/rig_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/calibration/light_sensitivity.h"
#include "core/calibration/next_measurement.h"

namespace luxrig {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr int kTakenAnew = 4;
/// Mounts stand still if none moves by more than this, as a share of its standard deviation before.
constexpr double kStandsStill = 0.02;

}  // namespace

LightPriors usual_priors(const Rig& rig) {
  LightPriors priors;
  priors.log_output = 0.12;
  priors.position_m = 0.05;
  priors.angle_rad = 0.035;
  priors.reflectance = 0.09;
  priors.rest_share = 0.03;
  priors.log_meter.setConstant(static_cast<Index>(rig.luxmeters.size()) + 1, 0.01);
  for (std::size_t m = 0; m < rig.luxmeters.size(); ++m)
    priors.log_meter[static_cast<Index>(m)] = rig.luxmeters[m].tolerance / 2;
  return priors;
}

double error_in_hand_lx(double lux) { return std::hypot(0.009 * lux, 0.05); }

RigLight::RigLight(const Session& session, LightPriors priors, TransportMatrix light,
                   std::vector<Eigen::MatrixXd> paint, LightSensitivity sensitivity)
    : session_(&session),
      priors_(priors),
      light_(std::move(light)),
      paint_(std::move(paint)),
      known_(std::move(sensitivity), std::move(priors)) {}

Result<RigLight> RigLight::of(const Session& session, const LightPriors& priors, const ComputeOptions& options) {
  auto light = compute_transport(session, options);
  if (!light) return tl::unexpected(light.error());
  auto sensitivity = mount_sensitivity(session.rig, *session.rays, *light, priors);
  if (!sensitivity) return tl::unexpected(sensitivity.error());
  auto paint = paint_sensitivity(session.rig, session.scene, *light, options);
  if (!paint) return tl::unexpected(paint.error());
  sensitivity->paint = *paint;
  return RigLight(session, priors, std::move(*light), std::move(*paint), std::move(*sensitivity));
}

Result<void> RigLight::learn(std::span<const LightReading> readings) {
  known_.learn(readings);
  VectorXd step(kMountUnknowns);
  step << VectorXd::Constant(3, priors_.position_m), VectorXd::Constant(3, priors_.angle_rad);
  for (int round = 0; round < kTakenAnew; ++round) {
    std::vector<VectorXd> mounts;
    for (std::size_t f = 0; f < session_->rig.fixtures.size(); ++f) mounts.push_back(known_.mount(f));
    auto there = mount_sensitivity(session_->rig, *session_->rays, light_, priors_, mounts);
    if (!there) return tl::unexpected(there.error());
    there->paint = paint_;
    known_.relinearise(std::move(*there));
    double moved = 0;
    for (std::size_t f = 0; f < mounts.size(); ++f)
      moved = std::max(moved, (known_.mount(f) - mounts[f]).cwiseQuotient(step).cwiseAbs().maxCoeff());
    if (moved < kStandsStill) break;
  }
  return {};
}

Eigen::MatrixXd RigLight::stated_lux() const {
  return light_.lux_per_level.leftCols(static_cast<Index>(session_->rig.fixtures.size()));
}

std::vector<std::size_t> RigLight::places_to_measure(const VectorXd& level, std::size_t count,
                                                     std::span<const std::size_t> but) const {
  const Rig& rig = session_->rig;
  std::vector<LightQuery> queries;
  std::vector<Index> targets;
  std::vector<double> weights;
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    if (!rig.points[p].goal_lx) continue;
    const double lux = std::max(1e-3, known_.at(p, level).lux);
    targets.push_back(static_cast<Index>(queries.size()));
    weights.push_back(1 / (lux * lux));
    queries.push_back({p, level, {}});
  }
  const VectorXd weight = Eigen::Map<const VectorXd>(weights.data(), static_cast<Index>(weights.size()));
  std::vector<MeasurementGroup> groups;
  std::vector<std::size_t> where;
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    if (std::find(but.begin(), but.end(), p) != but.end()) continue;
    MeasurementGroup group;
    group.noise_lx.resize(level.size());
    for (Index j = 0; j < level.size(); ++j) {
      group.rows.push_back(static_cast<Index>(queries.size()));
      queries.push_back({p, VectorXd::Unit(level.size(), j), meter_in_hand(rig)});
      group.noise_lx[j] = error_in_hand_lx(light_.lux_per_level(static_cast<Index>(p), j));
    }
    groups.push_back(std::move(group));
    where.push_back(p);
  }
  std::vector<std::size_t> places;
  for (const std::size_t best : best_groups(known_.covariance(queries), targets, weight, groups, count))
    places.push_back(where[best]);
  return places;
}

}  // namespace luxrig
