#pragma once
/// Pictures of surface properties, not of light: the caller colours each sample. Discs and lines are drawn among the
/// surfaces and hidden behind them.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/highlight/surface/target_surface.h"
#include "core/picture/picture.h"
#include "core/run.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

/// Rows from the top, pixels from the left; sRGB 0…1.
struct ColourPicture {
  int width_px = 0, height_px = 0;
  std::vector<Vec3f> rgb;
};

/// The three points of a surface around a place on its mesh, with weights.
struct SurfaceCorners {
  std::array<std::uint32_t, 3> points;
  std::array<double, 3> weights;  ///< of each, ≥ 0; their sum is 1

  [[nodiscard]] Vec3 normal(const TargetSurface& surface) const;        ///< smooth, unit; zero where normals cancel
  [[nodiscard]] double value(std::span<const double> of_points) const;  ///< linear between them
};

/// Corners around a ray's hit; empty on triangles that the surface leaves out because they have no area.
/// target    the scene of both the surface and the rays
[[nodiscard]] std::optional<SurfaceCorners> corners_at(const Scene& target, const TargetSurface& surface,
                                                       const Hit& hit);

/// A flat disc in space, seen from both sides.
struct Disc {
  Vec3 centre_world_m;
  Vec3 normal;  ///< unit; zero = it faces the eye
  double radius_m = 0;
  /// It counts as this much nearer to the eye, so that a curved surface under it does not cut it.
  double lift_m = 0;
  Vec3f rgb = Vec3f::Zero();
  double opacity = 1;  ///< 0…1
};

struct DrawnLine {
  Vec3 from_world_m, to_world_m;
  double width_px = 2;
  Vec3f rgb = Vec3f::Zero();
  double hidden_opacity = 0;  ///< where it is behind something
  double lift_m = 0;          ///< as of a Disc
};

/// A picture in progress: samples_per_edge² evenly spaced samples a pixel, each with a colour and a distance. The
/// result does not depend on the number of threads.
class SurfacePicture {
 public:
  /// Everything nearer to the eye than near_m is left out, so that one can look into a room through its wall.
  /// Asserted: 1 to 16384 pixels each way, 1 to 8 samples per edge.
  SurfacePicture(const Camera& camera, int samples_per_edge, double near_m, const Vec3f& background_rgb);

  /// sRGB of the hit of a sample. Called from many threads.
  using ColourOf = std::function<Vec3f(const Hit& hit, const Vec3& towards_eye)>;

  /// Draws the nearest surface of each sample if it is nearer than earlier drawings. False if stopped.
  bool draw(const RayScene& scene, const ColourOf& colour_of, int threads, const Watch& watch);

  /// Farthest first. Surfaces drawn by draw() hide them; discs only overdraw one another.
  void draw(std::span<const Disc> discs);
  void draw(const DrawnLine& line);  ///< including the part nearer than near_m

  /// Mean of the samples of each pixel.
  [[nodiscard]] ColourPicture resolved() const;

  /// Whether this place is in the picture with no surface drawn in front of it (lift_m nearer to the eye).
  [[nodiscard]] bool shows(const Vec3& place_world_m, double lift_m) const;

 private:
  struct Sample {
    float distance_m;
    Vec3f rgb;
  };
  struct Area {
    int left, right, top, bottom;  // in samples; right and bottom excluded
  };
  [[nodiscard]] Area area_of(const Vec3& centre_world_m, double radius_m) const;
  [[nodiscard]] Vec3 ray_of(int x, int y) const;
  Sample& at(int x, int y);

  Camera camera_;
  int per_edge_, width_, height_;  // of the samples
  double near_m_;
  std::vector<Sample> samples_;
};

}  // namespace luxrig
