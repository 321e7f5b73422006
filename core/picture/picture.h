#pragma once
/// Pictures of a lit scene. Every pixel is sampled independently with the evaluators' estimators (exact direct light of
/// points, paths joined with traced light, tails shared through records on surfaces). There is no smoothing over
/// pixels, so a pixel's lux is a measurement with known noise.

#include <functional>
#include <optional>
#include <vector>

#include "core/run.h"
#include "core/transport/evaluator.h"

namespace luxrig {

struct Camera {
  Vec3 eye_world_m = Vec3::Zero();
  Vec3 target_world_m = Vec3::UnitY();
  double vertical_fov_rad = 1.0;  ///< 0 … π; without distortion
  int width_px = 960, height_px = 600;
  double roll_rad = 0;  ///< turn about the axis it looks along; positive: its right side goes down
  /// Radial, about the picture's middle: what a straight lens shows at r, in units of the distance ahead, is where
  /// r = s / (1 + distortion · s²) for the distance s in the picture. Negative: a barrel.
  /// Source: A. Fitzgibbon, Simultaneous linear estimation of multiple view geometry and lens distortion (2001).
  double distortion = 0;
};

/// Direction of the ray through a point of the picture; x and y in pixels from the top left corner. Without roll, up is
/// +Z, or +Y if the camera looks straight up or down.
[[nodiscard]] Vec3 ray_direction(const Camera& camera, double x_px, double y_px);

/// Position of a place in the picture, and the scale there.
struct PixelPlace {
  double x_px = 0, y_px = 0;  ///< from the top left corner
  double px_per_m = 0;
};
/// Empty for a place behind the camera or outside its picture.
[[nodiscard]] std::optional<PixelPlace> pixel_of(const Camera& camera, const Vec3& place_world_m);

/// Its progress callback is not used: see after_pass.
struct PictureOptions : Run {
  int max_passes = 64;                  ///< samples per pixel
  double wanted_relative_error = 0.02;  ///< stops when the picture's noise (Picture::relative_error) is this low
  /// Called after each pass with the progress (0…1) and the noise so far; false ends the picture. A caller with a clock
  /// can keep a time budget.
  std::function<bool(double done, double relative_error)> after_pass;
};

/// Rows from the top, pixels from the left.
struct Picture {
  int width_px = 0, height_px = 0;
  std::vector<Vec3f> luminance_cd_m2;  ///< linear Rec. 709, towards the camera; the sky where no surface is seen
  std::vector<float> illuminance_lx;   ///< of the surface seen, on the side seen; negative where no surface is seen
  int passes = 0;
  /// Root mean square, over all pixels that see a surface, of the standard error of a pixel's lux, relative to that lux
  /// (or to a twentieth of the mean if that is more).
  double relative_error = 0;
};

/// levels: one per emitter, ≥ 0. Cause::invalid for bad sizes or numbers, Cause::cancelled when stopped.
[[nodiscard]] Result<Picture> render_picture(const RayScene& scene, std::span<const Emitter> emitters,
                                             std::span<const double> levels, const Camera& camera,
                                             const PictureOptions& options);

/// The room from straight above, without anything above the cut: +X to the right, +Y up in the picture.
struct PlanView {
  int width_px = 0, height_px = 0;
  double metres_per_px = 0;
  double left_x_world_m = 0, top_y_world_m = 0;  ///< of the picture's top left corner
  std::vector<float> shade;                      ///< 0 black … 1 white: walls at the cut dark, open floor light
};

/// longest_edge_px sets the scale. cut_z_world_m defaults to 1.2 m above the lowest point, but at most 0.6 of the
/// height of what is shown: the scene, or its part within the box. An empty scene gives a white picture of one pixel.
[[nodiscard]] PlanView render_plan_view(const RayScene& scene, int longest_edge_px,
                                        std::optional<double> cut_z_world_m = std::nullopt, int threads = 0,
                                        const std::optional<Eigen::AlignedBox3d>& shown_world_m = std::nullopt);

}  // namespace luxrig
