#include "core/calibration/head_fit.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/crs_matrix.h>
#include <ceres/jet.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"

namespace luxrig {
namespace {

/// Loss: beyond so many standard errors a sighting hardly counts. First a wide one, which finds the way from far off.
constexpr double kFarLoss = 100, kLoss = 3;
/// Half the difference of the sums of squares, from which another kind is out of the question.
constexpr double kClearly = 12;
constexpr double kLargestOffset_m = 0.4, kLargestTurn_rad = rad_from_deg(15);
/// A fit explains its sightings if so many are within so many standard errors, or within this angle.
constexpr double kExplained = 0.75, kWithinErrors = 5, kWithin_rad = rad_from_deg(0.15);
constexpr std::size_t kFewestFitted = 8, kFewestHit = 5, kMostMissed = 1;
constexpr double kHit_rad = rad_from_deg(0.1), kHitErrors = 3, kTells_rad = rad_from_deg(0.3);
constexpr double kLargestAimError_rad = rad_from_deg(0.12);

Mat3 mount_of_kind(const Pose& stated, bool upside_down) {
  return upside_down ? Mat3(stated.rotation * Vec3(1, -1, -1).asDiagonal()) : stated.rotation;
}

/// Direction of a sight from the lamp, less the beam's.
struct OffSight {
  Mat3 mount;
  Vec3 place_m;
  HeadSighting sighting;

  template <class T>
  bool operator()(const T* head, const T* camera, T* off) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Vector turn(camera[0], camera[1], camera[2]);
    const Vec3 to_m = sighting.position_world_m - sighting.eye_world_m;
    const Vector ray = rotated<T>(turn, to_m.cast<T>());
    // Where the turned ray meets the surface.
    const T facing = ray.dot(sighting.normal_world.cast<T>());
    const double stated_facing = to_m.dot(sighting.normal_world);
    if (!(facing * stated_facing > T(0))) return behind(off);
    const Vector seen_m = sighting.eye_world_m.cast<T>() + ray * (T(stated_facing) / facing);
    const Vector pivot_m = place_m.cast<T>() + Vector(head[kHeadOffset], head[kHeadOffset + 1], head[kHeadOffset + 2]);
    Vector sight = seen_m - pivot_m;
    if (!(sight.squaredNorm() > T(1e-9))) return behind(off);
    sight.normalize();
    const Vector beam = head_beam<T>(mount, head, sighting.sent, sighting.from);
    const T weight = T(1 / sighting.standard_error_rad);
    for (int axis = 0; axis < 3; ++axis) off[axis] = weight * (sight[axis] - beam[axis]);
    return true;
  }
  /// Where there is no such direction: as far off as can be.
  template <class T>
  bool behind(T* off) const {
    for (int axis = 0; axis < 3; ++axis) off[axis] = T((axis == 0 ? 2 : 0) / sighting.standard_error_rad);
    return true;
  }
};

OffSight off_sight_of(const HeadFit& fit, const HeadSighting& sighting) {
  OffSight off{mount_of_kind(fit.pose.stated, fit.pose.upside_down), fit.pose.stated.translation_m, sighting};
  off.sighting.standard_error_rad = 1;
  return off;
}

/// Parameters of a head about what they are expected to be.
struct HeadPrior {
  HeadVector expected, deviation;

  template <class T>
  bool operator()(const T* head, T* off) const {
    for (int k = 0; k < kHeadParameters; ++k) off[k] = (head[k] - expected[k]) / deviation[k];
    return true;
  }
};

struct CameraPrior {
  Vec3 expected;
  Mat3 whitening;  ///< its square is the information

  template <class T>
  bool operator()(const T* camera, T* off) const {
    const Eigen::Matrix<T, 3, 1> turn(camera[0], camera[1], camera[2]);
    const Eigen::Matrix<T, 3, 1> white = whitening.cast<T>() * (turn - expected.cast<T>());
    for (int k = 0; k < 3; ++k) off[k] = white[k];
    return true;
  }
};

HeadPrior prior_of(const HeadKind& kind, const HeadPriors& priors) {
  HeadPrior prior{HeadVector::Zero(), HeadVector::Constant(priors.scale)};
  prior.deviation.segment<3>(kHeadOffset).setConstant(priors.offset_m);
  prior.deviation.segment<3>(kHeadTurn).setConstant(priors.turn_rad);
  prior.deviation.segment<2>(kHeadAskew).setConstant(priors.askew_rad);
  prior.deviation.segment<2>(kHeadPanPlay).setConstant(priors.play_rad);
  prior.expected[kHeadPanScale] = (kind.pan_other_way ? -1 : 1) * kind.pan_range;
  prior.expected[kHeadTiltScale] = kind.tilt_other_way ? -1 : 1;
  prior.expected.segment<2>(kHeadPanPlay).setConstant(priors.play_rad);
  return prior;
}

/// Of a symmetric positive definite matrix.
Mat3 inverse(const Mat3& of) {
  const Mat3 inverted = of.ldlt().solve(Mat3::Identity());
  return 0.5 * (inverted + inverted.transpose());
}

Mat3 whitening_of(const Mat3& covariance) {
  const Eigen::LLT<Mat3> root(covariance);
  LUXRIG_CHECK(root.info() == Eigen::Success, "the camera's covariance is not positive definite");
  return root.matrixL().solve(Mat3::Identity());
}

void add_terms(ceres::Problem& problem, const HeadKind& kind, std::span<const HeadSighting> sightings,
               const HeadPriors& priors, double loss, HeadFit& fit) {
  double* head = fit.pose.parameters.data();
  double* camera = fit.camera_turn_rad.data();
  const Mat3 mount = mount_of_kind(fit.pose.stated, kind.upside_down);
  for (const HeadSighting& sighting : sightings)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OffSight, 3, kHeadParameters, 3>(
                                 new OffSight{mount, fit.pose.stated.translation_m, sighting}),
                             new ceres::CauchyLoss(loss), head, camera);
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<HeadPrior, kHeadParameters, kHeadParameters>(
                               new HeadPrior(prior_of(kind, priors))),
                           nullptr, head);
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<CameraPrior, 3, 3>(
                               new CameraPrior{priors.camera.turn_rad, whitening_of(priors.camera.covariance_rad2)}),
                           nullptr, camera);
}

/// The inverse of the information at the solution, with the robust weights that it was found by.
FitMatrix covariance_of(ceres::Problem& problem) {
  ceres::CRSMatrix sparse;
  if (!problem.Evaluate({}, nullptr, nullptr, nullptr, &sparse)) return FitMatrix::Identity();
  FitMatrix information = FitMatrix::Zero();
  Eigen::Matrix<double, 1, kFitParameters> row;
  for (int r = 0; r < sparse.num_rows; ++r) {
    row.setZero();
    for (int k = sparse.rows[static_cast<std::size_t>(r)]; k < sparse.rows[static_cast<std::size_t>(r) + 1]; ++k)
      row[sparse.cols[static_cast<std::size_t>(k)]] = sparse.values[static_cast<std::size_t>(k)];
    information.noalias() += row.transpose() * row;
  }
  return information.llt().solve(FitMatrix::Identity());
}

/// By the median, so that a reflection does not count.
double scatter_of(const std::vector<double>& off_rad, std::span<const HeadSighting> sightings) {
  if (off_rad.size() <= kHeadParameters / 2) return 1;
  std::vector<double> off;
  for (std::size_t k = 0; k < off_rad.size(); ++k) off.push_back(off_rad[k] / sightings[k].standard_error_rad);
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  constexpr double kMedianOfTwoAxes = 1.1774;  // of a Rayleigh distribution
  const double free = 1 - 0.5 * kHeadParameters / static_cast<double>(off.size());
  return *middle / kMedianOfTwoAxes / std::sqrt(std::max(free, 0.25));
}

double error_by(const FitRows& rows, const FitMatrix& covariance) {
  return std::sqrt(std::max(0.0, (rows * covariance * rows.transpose()).trace() / 2));
}

}  // namespace

std::vector<HeadKind> head_kinds() {
  std::vector<HeadKind> kinds;
  for (const double pan_range : {1.0, 540.0 / 630.0, 630.0 / 540.0})
    for (const bool upside_down : {false, true})
      for (const bool pan : {false, true})
        for (const bool tilt : {false, true}) kinds.push_back({upside_down, pan, tilt, pan_range});
  std::stable_sort(kinds.begin(), kinds.end(),
                   [](const HeadKind& a, const HeadKind& b) { return a.oddities() < b.oddities(); });
  return kinds;
}

std::string words_of(const HeadKind& kind) {
  std::string words;
  const auto add = [&](bool holds, std::string_view text) {
    if (holds) words += (words.empty() ? "" : ", ") + std::string(text);
  };
  add(kind.upside_down, "hangs upside down");
  add(kind.pan_other_way, "pans the other way");
  add(kind.tilt_other_way, "tilts the other way");
  add(kind.pan_range < 1, "pans by 540° where the file has 630°");
  add(kind.pan_range > 1, "pans by 630° where the file has 540°");
  return words;
}

HeadPose start_of(const Pose& stated, const HeadKind& kind) {
  HeadPose pose{stated, kind.upside_down, HeadPose::as_stated()};
  pose.parameters[kHeadPanScale] = (kind.pan_other_way ? -1 : 1) * kind.pan_range;
  pose.parameters[kHeadTiltScale] = kind.tilt_other_way ? -1 : 1;
  return pose;
}

HeadFit fit_head(const Pose& stated, const HeadKind& kind, std::span<const HeadSighting> sightings,
                 const HeadPriors& priors, const HeadFit* start) {
  HeadFit fit;
  fit.kind = kind;
  fit.pose = start ? start->pose : start_of(stated, kind);
  fit.camera_turn_rad = start ? start->camera_turn_rad : priors.camera.turn_rad;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 60;
  options.function_tolerance = 1e-9;
  for (const double loss : {kFarLoss, kLoss}) {
    ceres::Problem problem;
    add_terms(problem, kind, sightings, priors, loss, fit);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    fit.cost = summary.IsSolutionUsable() ? summary.final_cost : std::numeric_limits<double>::infinity();
    if (loss == kLoss) fit.covariance = covariance_of(problem);
  }
  for (const HeadSighting& sighting : sightings) fit.off_rad.push_back(off_sight(fit, sighting).norm());
  fit.scatter = scatter_of(fit.off_rad, sightings);
  fit.covariance *= std::max(1.0, fit.scatter * fit.scatter);
  return fit;
}

Vec3 off_sight(const HeadFit& fit, const HeadSighting& sighting) {
  Vec3 off;
  off_sight_of(fit, sighting)(fit.pose.parameters.data(), fit.camera_turn_rad.data(), off.data());
  return off;
}

FitRows off_sight_rows(const HeadFit& fit, const HeadSighting& sighting) {
  using Jet = ceres::Jet<double, kFitParameters>;
  Jet head[kHeadParameters], camera[3], off[3];
  for (int k = 0; k < kHeadParameters; ++k) head[k] = Jet(fit.pose.parameters[k], k);
  for (int k = 0; k < 3; ++k) camera[k] = Jet(fit.camera_turn_rad[k], kHeadParameters + k);
  FitRows rows;
  off_sight_of(fit, sighting)(head, camera, off);
  for (int axis = 0; axis < 3; ++axis) rows.row(axis) = off[axis].v.transpose();
  return rows;
}

double aim_error_rad(const HeadFit& fit, const HeadSighting& sighting) {
  return error_by(off_sight_rows(fit, sighting), fit.covariance);
}

double aim_error_in_room_rad(const HeadFit& fit, const HeadSighting& sighting) {
  FitRows rows = off_sight_rows(fit, sighting);
  rows.rightCols<3>().setZero();
  return error_by(rows, fit.covariance);
}

std::optional<std::string> why_not_believed(const HeadFit& fit, std::optional<double> apart,
                                            std::span<const HeadSighting> fitted,
                                            std::span<const HeadSighting> held_out) {
  if (fitted.size() < kFewestFitted)
    return fmt::format("its beam was seen at {} places; {} are needed", fitted.size(), kFewestFitted);
  std::size_t explained = 0;
  for (const HeadSighting& sighting : fitted)
    explained += off_sight(fit, sighting).norm() < std::max(kWithinErrors * sighting.standard_error_rad, kWithin_rad);
  if (static_cast<double>(explained) < kExplained * static_cast<double>(fitted.size()))
    return fmt::format(
        "no pose near the file's explains what was seen: {} of {} places. It may be patched as another head, or not "
        "turn",
        explained, fitted.size());
  if (apart && *apart < kClearly)
    return fmt::format("two ways of hanging or turning explain what was seen: {:.1f} apart; {:.0f} are needed", *apart,
                       kClearly);
  const double offset_m = fit.pose.parameters.segment<3>(kHeadOffset).norm();
  const double turn_rad = fit.pose.parameters.segment<3>(kHeadTurn).norm();
  if (!(offset_m < kLargestOffset_m && turn_rad < kLargestTurn_rad))
    return fmt::format("it would hang {:.2f} m and {:.0f}° from where the file has it", offset_m,
                       deg_from_rad(turn_rad));
  std::size_t tells = 0, hit = 0;
  double most_rad = 0;
  for (const HeadSighting& sighting : held_out) {
    const double off_rad = off_sight(fit, sighting).norm();
    const double error_rad =
        std::hypot(std::max(1.0, fit.scatter) * sighting.standard_error_rad, aim_error_rad(fit, sighting));
    if (kHitErrors * error_rad > kTells_rad) continue;  // it would be hit by any pose
    ++tells;
    if (off_rad < std::max(kHit_rad, kHitErrors * error_rad)) ++hit;
    most_rad = std::max(most_rad, off_rad);
  }
  // One may be a reflection; a wrong pose misses most.
  if (hit < kFewestHit || tells - hit > kMostMissed)
    return fmt::format("of {} places kept for the test, {} were hit, the farthest missed by {:.2f}°", tells, hit,
                       deg_from_rad(most_rad));
  return std::nullopt;
}

std::optional<std::string> why_too_uncertain(const HeadFit& fit, std::span<const HeadSighting> at) {
  double most_rad = 0;
  for (const HeadSighting& sighting : at) most_rad = std::max(most_rad, aim_error_in_room_rad(fit, sighting));
  if (most_rad < kLargestAimError_rad) return std::nullopt;
  return fmt::format("its beam is known to {:.2f}° only; {:.2f}° are needed", deg_from_rad(most_rad),
                     deg_from_rad(kLargestAimError_rad));
}

void conclude(const HeadPriors& priors, HeadResult& result) {
  result.refused = why_not_believed(result.fit, result.apart, result.fitted, result.held_out);
  result.believed = !result.refused;
  if (!result.believed) return;
  std::vector<HeadSighting> all = result.fitted;
  all.insert(all.end(), result.held_out.begin(), result.held_out.end());
  result.fit = fit_head(result.fit.pose.stated, result.fit.kind, all, priors, &result.fit);
  result.refused = why_too_uncertain(result.fit, all);
}

void conclude_together(const HeadPriors& priors, std::span<HeadResult> heads) {
  const Mat3 known = inverse(priors.camera.covariance_rad2);
  const Vec3 known_turn = known * priors.camera.turn_rad;
  // What each adds to that.
  std::vector<std::pair<Mat3, Vec3>> adds;
  for (const HeadResult& head : heads) {
    adds.emplace_back(Mat3::Zero(), Vec3::Zero());
    if (!head.believed) continue;
    const Mat3 with = inverse(head.fit.covariance.bottomRightCorner<3, 3>());
    if (Eigen::SelfAdjointEigenSolver<Mat3>(with - known).eigenvalues().minCoeff() < 0) continue;  // it says nothing
    adds.back() = {with - known, with * head.fit.camera_turn_rad - known_turn};
  }
  for (std::size_t h = 0; h < heads.size(); ++h) {
    if (heads[h].fitted.empty()) continue;
    Mat3 information = known;
    Vec3 turn = known_turn;
    for (std::size_t other = 0; other < heads.size(); ++other) {
      if (other == h) continue;
      information += adds[other].first;
      turn += adds[other].second;
    }
    HeadPriors by_others = priors;
    by_others.camera.covariance_rad2 = inverse(information);
    by_others.camera.turn_rad = by_others.camera.covariance_rad2 * turn;
    HeadResult& head = heads[h];
    head.fit = fit_head(head.fit.pose.stated, head.fit.kind, head.fitted, by_others, &head.fit);
    conclude(by_others, head);
  }
}

}  // namespace luxrig
