#include "core/calibration/rig_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/calibration/lamp_steps.h"
#include "core/calibration/light_sensitivity.h"
#include "core/calibration/mount_place.h"
#include "core/calibration/next_measurement.h"

namespace luxrig {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr int kTakenAnew = 4;
/// Mounts stand still if none moves by more than this, as a share of its standard deviation before.
constexpr double kStandsStill = 0.02;
/// The light is traced anew if a mount or paint is farther from where it was traced, in the same measure.
constexpr double kFarFromTraced = 0.3;
constexpr int kTracedAnew = 2;
constexpr double kBrightestPaint = 0.95;
/// A lamp that may not be lit has this level instead of none.
constexpr double kDimmest = 0.01;
/// Lamps are read one by one until no more than this share of what all would teach is left.
constexpr double kWorthAReading = 0.05;

}  // namespace

LightPriors usual_priors(const Rig& rig) {
  LightPriors priors;
  priors.log_output = 0.12;
  priors.dimmer_exponent = 0.5;
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

RigLight::RigLight(const Session& session, LightPriors priors, const ComputeOptions& options, TransportMatrix light,
                   std::vector<Eigen::MatrixXd> paint, LightSensitivity sensitivity)
    : session_(&session),
      priors_(priors),
      options_(options),
      light_(std::move(light)),
      stated_lux_(light_.lux_per_level.leftCols(static_cast<Index>(session.rig.fixtures.size()))),
      paint_(std::move(paint)),
      known_(std::move(sensitivity), std::move(priors)) {
  traced_at_ = found();
}

Result<RigLight> RigLight::of(const Session& session, const LightPriors& priors, const ComputeOptions& options) {
  auto light = compute_transport(session, options);
  if (!light) return tl::unexpected(light.error());
  auto paint = paint_sensitivity(session.rig, session.scene, *light, options);
  if (!paint) return tl::unexpected(paint.error());
  return of_light(session, priors, options, std::move(*light), std::move(*paint));
}

Result<RigLight> RigLight::with_priors(const LightPriors& priors) const {
  return of_light(*session_, priors, options_, light_, paint_);
}

Result<RigLight> RigLight::of_light(const Session& session, const LightPriors& priors, const ComputeOptions& options,
                                    TransportMatrix light, std::vector<Eigen::MatrixXd> paint) {
  auto sensitivity = mount_sensitivity(session.rig, *session.rays, light, priors);
  if (!sensitivity) return tl::unexpected(sensitivity.error());
  sensitivity->paint = paint;
  const auto fixtures = static_cast<Index>(session.rig.fixtures.size());
  LightPriors with_levels = priors;
  if (priors.read_at.size() == 0) {
    const std::vector<double> brightest = brightest_levels(session.rig, light.lux_per_level.leftCols(fixtures));
    with_levels.read_at = Eigen::Map<const VectorXd>(brightest.data(), fixtures).cwiseMax(kDimmest);
  }
  return RigLight(session, std::move(with_levels), options, std::move(light), std::move(paint),
                  std::move(*sensitivity));
}

RigLight::Found RigLight::found() const {
  Found found;
  for (std::size_t f = 0; f < session_->rig.fixtures.size(); ++f) found.mounts.push_back(known_.mount(f));
  found.paint.resize(static_cast<Index>(paint_.size()));
  for (std::size_t m = 0; m < paint_.size(); ++m) found.paint[static_cast<Index>(m)] = known_.paint(m) - 1;
  return found;
}

double RigLight::apart(const Found& a, const Found& b) const {
  VectorXd step(kMountUnknowns);
  step << VectorXd::Constant(3, priors_.position_m), VectorXd::Constant(3, priors_.angle_rad);
  double most = priors_.reflectance > 0 && a.paint.size() > 0
                    ? (a.paint - b.paint).cwiseAbs().maxCoeff() / priors_.reflectance
                    : 0;
  for (std::size_t f = 0; f < a.mounts.size(); ++f)
    most = std::max(most, (a.mounts[f] - b.mounts[f]).cwiseQuotient(step).cwiseAbs().maxCoeff());
  return most;
}

Result<void> RigLight::trace_anew(const Found& at) {
  Rig rig = session_->rig;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    Pose& mount = rig.fixtures[f].world_from_mount;
    mount = displaced(mount, offset_in_room(*session_->rays, mount.translation_m, at.mounts[f].head<3>()),
                      at.mounts[f].tail<3>());
  }
  Scene scene = session_->scene;
  for (std::size_t m = 0; m < scene.materials.size(); ++m)
    scene.materials[m].reflectance_rgb = (scene.materials[m].reflectance_rgb * (1 + at.paint[static_cast<Index>(m)]))
                                             .cwiseMax(0)
                                             .cwiseMin(kBrightestPaint);
  const RayScene rays(std::move(scene));
  auto light = compute_transport(rig, rays, options_);
  if (!light) return tl::unexpected(light.error());
  light_ = std::move(*light);
  traced_at_ = at;
  return {};
}

Result<void> RigLight::take_anew() {
  for (int round = 0; round < kTakenAnew; ++round) {
    const Found at = found();
    auto there = mount_sensitivity(session_->rig, *session_->rays, light_, priors_, at.mounts);
    if (!there) return tl::unexpected(there.error());
    there->paint = paint_;
    there->paint_taken_at = traced_at_.paint;
    known_.relinearise(std::move(*there));
    if (apart(found(), at) < kStandsStill) break;
  }
  return {};
}

Result<void> RigLight::learn(std::span<const LightReading> readings) {
  known_.learn(readings);
  for (int round = 0;; ++round) {
    if (auto taken = take_anew(); !taken) return taken;
    const Found at = found();
    if (round == kTracedAnew || apart(at, traced_at_) < kFarFromTraced) return {};
    if (auto traced = trace_anew(at); !traced) return traced;
  }
}

GoalError RigLight::error_of_goals(const VectorXd& level) const {
  GoalError error;
  for (std::size_t p = 0; p < session_->rig.points.size(); ++p) {
    if (!session_->rig.points[p].goal_lx) continue;
    const LightEstimate light = known_.at(p, level);
    if (!(light.lux > 0)) continue;
    const double share = light.standard_error_lx / light.lux;
    error.rms += share * share;
    error.worst = std::max(error.worst, share);
    ++error.goals;
  }
  if (error.goals > 0) error.rms = std::sqrt(error.rms / static_cast<double>(error.goals));
  return error;
}

/// What the goals' error is made of: each goal's variance, relative to its light.
struct RigLight::Goals {
  std::vector<LightQuery> queries;
  std::vector<Index> rows;
  VectorXd weight;
};

RigLight::Goals RigLight::goals_under(const VectorXd& level) const {
  Goals goals;
  std::vector<double> weights;
  for (std::size_t p = 0; p < session_->rig.points.size(); ++p) {
    if (!session_->rig.points[p].goal_lx) continue;
    const double lux = std::max(1e-3, known_.at(p, level).lux);
    goals.rows.push_back(static_cast<Index>(goals.queries.size()));
    weights.push_back(1 / (lux * lux));
    goals.queries.push_back({p, level, {}});
  }
  goals.weight = Eigen::Map<const VectorXd>(weights.data(), static_cast<Index>(weights.size()));
  return goals;
}

LightQuery RigLight::asked_in_hand(std::size_t point, std::size_t fixture) const {
  return {point, VectorXd::Unit(light_.lux_per_level.cols(), static_cast<Index>(fixture)),
          meter_in_hand(session_->rig)};
}

std::vector<std::size_t> RigLight::places_to_measure(const VectorXd& level, std::size_t count,
                                                     std::span<const std::size_t> but) const {
  Goals goals = goals_under(level);
  std::vector<MeasurementGroup> groups;
  std::vector<std::size_t> where;
  for (std::size_t p = 0; p < session_->rig.points.size(); ++p) {
    if (std::find(but.begin(), but.end(), p) != but.end()) continue;
    MeasurementGroup group;
    group.noise_lx.resize(level.size());
    for (Index j = 0; j < level.size(); ++j) {
      group.rows.push_back(static_cast<Index>(goals.queries.size()));
      goals.queries.push_back(asked_in_hand(p, static_cast<std::size_t>(j)));
      group.noise_lx[j] = error_in_hand_lx(light_.lux_per_level(static_cast<Index>(p), j));
    }
    groups.push_back(std::move(group));
    where.push_back(p);
  }
  std::vector<std::size_t> places;
  for (const std::size_t best : best_groups(known_.covariance(goals.queries), goals.rows, goals.weight, groups, count))
    places.push_back(where[best]);
  return places;
}

std::vector<std::size_t> RigLight::lamps_to_read(std::size_t point, const VectorXd& level,
                                                 std::span<const double> brightest) const {
  Goals goals = goals_under(level);
  std::vector<MeasurementGroup> singles;
  std::vector<std::size_t> lamps;
  MeasurementGroup all;
  for (std::size_t f = 0; f < brightest.size(); ++f) {
    if (!(brightest[f] > 0)) continue;
    MeasurementGroup single;
    single.rows = {static_cast<Index>(goals.queries.size())};
    goals.queries.push_back(asked_in_hand(point, f));
    // Of light at level 1, as the query; it is read at a level below.
    const double lux = light_.lux_per_level(static_cast<Index>(point), static_cast<Index>(f));
    single.noise_lx = VectorXd::Constant(1, error_in_hand_lx(lux * brightest[f]) / brightest[f]);
    all.rows.push_back(single.rows.front());
    singles.push_back(std::move(single));
    lamps.push_back(f);
  }
  if (lamps.empty()) return lamps;
  all.noise_lx.resize(static_cast<Index>(singles.size()));
  for (std::size_t k = 0; k < singles.size(); ++k) all.noise_lx[static_cast<Index>(k)] = singles[k].noise_lx[0];

  Eigen::MatrixXd covariance = known_.covariance(goals.queries);
  const auto goal_variance = [&] {
    double sum = 0;
    for (Index t = 0; t < goals.weight.size(); ++t)
      sum += goals.weight[t] *
             covariance(goals.rows[static_cast<std::size_t>(t)], goals.rows[static_cast<std::size_t>(t)]);
    return sum;
  };
  const double with_all = error_after(covariance, goals.rows, goals.weight, all);
  const double worth = kWorthAReading * (goal_variance() - with_all);
  std::vector<std::size_t> chosen;
  for (const std::size_t next : best_groups(covariance, goals.rows, goals.weight, singles, singles.size())) {
    if (goal_variance() - with_all <= worth) break;
    take(singles[next], covariance);
    chosen.push_back(lamps[next]);
  }
  return chosen;
}

}  // namespace luxrig
