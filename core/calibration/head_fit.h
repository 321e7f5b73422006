#pragma once
/// The pose of a head from places that its beam was seen at. Least squares (Ceres) with a robust loss, as one in some
/// sightings may be a reflection, and with priors: how far off its file a head may hang, and how well the camera's turn
/// is known. The covariance is of the same least squares.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/head_pose.h"

namespace luxrig {

/// One place that the middle of the beam was seen at.
struct HeadSighting {
  Joints sent;
  Approach from;
  Vec3 eye_world_m = Vec3::Zero();       ///< of the camera, as stated
  Vec3 position_world_m = Vec3::Zero();  ///< if the camera is turned as stated
  Vec3 normal_world = Vec3::UnitZ();     ///< of the surface there
  double standard_error_rad = 0;         ///< of the beam's direction, per axis; > 0
};

/// How a head may hang or turn that no small correction leads to.
struct HeadKind {
  bool upside_down = false;
  bool pan_other_way = false, tilt_other_way = false;
  double pan_range = 1;  ///< true over stated, of heads that can be set to 540° and 630°
  bool operator==(const HeadKind&) const = default;
  /// In how many ways it differs from the rig file.
  [[nodiscard]] int oddities() const { return upside_down + pan_other_way + tilt_other_way + (pan_range != 1); }
};
/// All of them, as stated first.
[[nodiscard]] std::vector<HeadKind> head_kinds();
/// "hangs upside down, pans the other way"; empty = as stated.
[[nodiscard]] std::string words_of(const HeadKind& kind);

/// How the camera is turned off its stated pose, in world, about its eye: a Gaussian.
struct CameraTurn {
  Vec3 turn_rad = Vec3::Zero();
  Mat3 covariance_rad2 = Mat3::Identity() * 1e-8;  ///< symmetric, positive definite
};

/// Standard deviations.
struct HeadPriors {
  double offset_m = 0.07, turn_rad = rad_from_deg(3), askew_rad = rad_from_deg(2);
  double scale = 0.003;
  double play_rad = rad_from_deg(0.6);  ///< its mean, and its deviation
  CameraTurn camera;
};

inline constexpr int kFitParameters = kHeadParameters + 3;  ///< the camera's turn is the last
using FitMatrix = Eigen::Matrix<double, kFitParameters, kFitParameters>;
using FitRows = Eigen::Matrix<double, 3, kFitParameters>;

struct HeadFit {
  HeadKind kind;
  HeadPose pose;
  Vec3 camera_turn_rad = Vec3::Zero();
  FitMatrix covariance = FitMatrix::Identity();
  double cost = 0;     ///< half of the robust sum of squares, priors included
  double scatter = 1;  ///< of the sightings, over their standard errors; the covariance has its square if above 1
  std::vector<double> off_rad;  ///< per sighting: between beam and sight
};

/// Where a fit of this kind starts.
[[nodiscard]] HeadPose start_of(const Pose& stated, const HeadKind& kind);
/// start: of an earlier fit of this kind, if any.
[[nodiscard]] HeadFit fit_head(const Pose& stated, const HeadKind& kind, std::span<const HeadSighting> sightings,
                               const HeadPriors& priors, const HeadFit* start = nullptr);

/// Difference of the directions of beam and sight from the lamp.
[[nodiscard]] Vec3 off_sight(const HeadFit& fit, const HeadSighting& sighting);
/// Its derivative by the parameters.
[[nodiscard]] FitRows off_sight_rows(const HeadFit& fit, const HeadSighting& sighting);
/// Standard error of that difference without the sighting's own, per axis [rad].
[[nodiscard]] double aim_error_rad(const HeadFit& fit, const HeadSighting& sighting);
/// The same with the camera as it is stated: for a place in the room.
[[nodiscard]] double aim_error_in_room_rad(const HeadFit& fit, const HeadSighting& sighting);

/// Why a fit is not believed, in words; nothing = it is.
/// apart     by how much the cost of the next best kind is above; nothing = all others are out of the question
/// held_out  sightings that were not fitted
[[nodiscard]] std::optional<std::string> why_not_believed(const HeadFit& fit, std::optional<double> apart,
                                                          std::span<const HeadSighting> fitted,
                                                          std::span<const HeadSighting> held_out);
/// Why a fit that is believed does not tell well enough where in the room the beam falls. at: places that it is asked
/// for.
[[nodiscard]] std::optional<std::string> why_too_uncertain(const HeadFit& fit, std::span<const HeadSighting> at);

/// What was found of one head.
struct HeadResult {
  std::optional<std::string> refused;  ///< why; nothing = found
  bool believed = false;               ///< if refused, then only as it is too uncertain
  HeadFit fit;                         ///< not to be used if refused
  std::optional<double> apart;         ///< of the next best kind
  std::vector<HeadSighting> fitted, held_out;
};

/// From its fit to `fitted`: whether it is found, and then its fit to all.
void conclude(const HeadPriors& priors, HeadResult& result);

/// The same camera saw them all, so what each says of its turn holds for the others. Each head is fitted and judged
/// again with what the others say. priors: those that all were fitted with.
void conclude_together(const HeadPriors& priors, std::span<HeadResult> heads);

}  // namespace luxrig
