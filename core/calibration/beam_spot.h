#pragma once
/// Where a lamp's beam falls, from a picture with its light and one without. A pixel's difference is light on a surface
/// of known place and paint. Seen from the lamp it is an intensity, I = E d² / cosθ, so that neither the slant nor the
/// distance of the surface pulls the middle of the beam. The middle is the mean direction of what is above a share of
/// the peak, weighted by how far it is above: what is cut there has no weight, so its edge has no noise.

#include <tl/expected.hpp>
#include <vector>

#include "core/calibration/seen_surface.h"
#include "core/picture/picture.h"

namespace luxrig {

/// Why a picture shows no beam that could be measured.
enum class NoBeam {
  dark,     ///< nothing stands out of the noise
  small,    ///< of too few pixels
  cut,      ///< part of it lies outside the picture, behind an edge, or on paint that shows no light
  several,  ///< two that compare: one may be a reflection
  clipped,  ///< brighter than the camera can tell
  stays     ///< there without the lamp too
};
[[nodiscard]] const char* words_of(NoBeam why);

struct SpotPixel {
  std::size_t pixel = 0;  ///< of the picture
  float lux = 0;          ///< without the dark
};

/// The pixels of one beam.
struct BeamSpot {
  const SeenSurface* surface = nullptr;
  std::vector<SpotPixel> pixels;
};

/// surface must outlive the spot; both pictures have its size (asserted).
/// pivot_world_m   about where the lamp is; a decimetre off is near enough
[[nodiscard]] tl::expected<BeamSpot, NoBeam> beam_spot(const SeenSurface& surface, const Picture& lit,
                                                       const Picture& dark, const Vec3& pivot_world_m);

/// Whether the spot is gone in a dark picture that was taken after: otherwise it is somebody else's light.
[[nodiscard]] bool vanished(const BeamSpot& spot, const Picture& dark_before, const Picture& dark_after);

/// The middle of a beam.
struct SpotCentre {
  Vec3 position_world_m = Vec3::Zero();  ///< on the plane that has most of its light
  Vec3 normal_world = Vec3::UnitZ();     ///< of that plane
  double standard_error_rad = 0;         ///< of its direction from the lamp, on each of both axes
  double radius_rad = 0;                 ///< root mean square distance of its light from the middle
};
/// pivot_world_m: where the lamp is, as well as is known.
[[nodiscard]] SpotCentre centre_of(const BeamSpot& spot, const Vec3& pivot_world_m);

}  // namespace luxrig
