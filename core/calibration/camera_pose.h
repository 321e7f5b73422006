#pragma once
/// Where a camera really is and looks, from a picture of a known room: edges of the scene (corners of walls, outlines of
/// objects, joints of materials) are looked for in the picture near where the camera of the rig file would show them.
///
/// First the turn, roll and field of view under which most edges lie on changes of brightness; then all of pose, field of
/// view and distortion by least squares of the distances between edges as seen and as shown, across each edge, with
/// outliers weighed down (Tukey). A quarter of the edges is kept out of the fit, to test it.
///
/// Source: T. Drummond, R. Cipolla, Real-time visual tracking of complex structures (2002).

#include <cstddef>

#include "core/calibration/camera_offset.h"
#include "core/picture/picture.h"
#include "core/result.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

struct FoundCamera {
  Camera camera;
  std::size_t edges = 0;     ///< places on edges that the picture shows
  double stated_off_px = 0;  ///< median distance of those from where the stated camera would show them, across the edge
  double off_px = 0;         ///< the same with the found camera, of edges that the fit did not use
  double standard_error_px = 0;  ///< of where the found camera shows a place; median over the picture
  /// Of its offset, by the scatter of the edges. Biases that edges share are not in it: where few edges are near, place
  /// and field of view trade against each other, and each was seen 4 of these off while the picture was 0.1 px off.
  CameraCovariance covariance = CameraCovariance::Zero();
};

/// picture: with most of the room lit, of the stated camera's size (asserted). The truth is within 2° and 10 cm of what
/// is stated, the field of view within 3 %, distortion within 0.05.
/// Cause::invalid, in words, if the picture does not determine it.
[[nodiscard]] Result<FoundCamera> find_camera(const RayScene& rays, const Camera& stated, const Picture& picture);

}  // namespace luxrig
