#pragma once
/// How a camera hangs and looks off another, such as the found one off that of the rig file, as eight numbers.

#include <Eigen/Core>

#include "core/estimation/calibration.h"
#include "core/picture/picture.h"
#include "core/rig/equipment.h"

namespace luxrig {

/// Along world x, y, z [m]; turned about world x, y, z [rad]; logarithm of one field of view over the other; distortion.
inline constexpr Eigen::Index kCameraUnknowns = 8;
using CameraOffset = Eigen::Matrix<double, kCameraUnknowns, 1>;
using CameraCovariance = Eigen::Matrix<double, kCameraUnknowns, kCameraUnknowns>;

[[nodiscard]] CameraOffset offset_between(const Camera& from, const Camera& to);
/// The inverse: as far from its target as before.
[[nodiscard]] Camera offset_by(const Camera& from, const CameraOffset& offset);

/// Pose, field of view and distortion of a camera that was found, off the one of the rig file; the rest of `found` stays.
/// covariance: of where it is.
void put_view(const Camera& stated, const Camera& found, const CameraCovariance& covariance, CalibratedCamera& into);
/// A camera of the rig as it was found to hang.
[[nodiscard]] Camera view_of(const PictureCamera& stated, const CalibratedCamera& found);

}  // namespace luxrig
