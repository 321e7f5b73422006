#pragma once
/// Pictures of what a surface is like, not of its light: each sample of the picture is coloured by whoever asks, and
/// discs and lines are drawn among the surfaces, hidden where they are behind one.

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

/// The three points of a surface that a place on its mesh lies between.
struct SurfaceCorners {
  std::array<std::uint32_t, 3> points;
  std::array<double, 3> weights;  ///< of each, ≥ 0, together 1

  [[nodiscard]] Vec3 normal(const TargetSurface& surface) const;        ///< smooth, unit; zero where the points' cancel
  [[nodiscard]] double value(std::span<const double> of_points) const;  ///< linear between them
};

/// A place that a ray met; nothing on triangles that the surface leaves out, as they have no area.
/// target    that the surface was made of, and the rays' scene
[[nodiscard]] std::optional<SurfaceCorners> corners_at(const Scene& target, const TargetSurface& surface,
                                                       const Hit& hit);

/// Flat, in space. Seen from both sides.
struct Disc {
  Vec3 centre_world_m;
  Vec3 normal;  ///< unit; zero: it faces the eye
  double radius_m = 0;
  /// It counts as so much nearer to the eye than it is: one that lies on a bent surface is not cut by it.
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

/// A picture under work: samples_per_edge² samples a pixel, evenly spaced, each with a colour and how far off what it
/// sees is. The same for any number of threads.
class SurfacePicture {
 public:
  /// What nearest to the eye than near_m is left away, so that one may look into a room through its wall.
  /// requires a picture of 1 to 16384 pixels each way, 1 to 8 samples per edge (asserted)
  SurfacePicture(const Camera& camera, int samples_per_edge, double near_m, const Vec3f& background_rgb);

  /// sRGB of what a sample sees. Called from many threads.
  using ColourOf = std::function<Vec3f(const Hit& hit, const Vec3& towards_eye)>;

  /// Nearest surface of each sample, where it is nearer than what was drawn before. False if stopped.
  bool draw(const RayScene& scene, const ColourOf& colour_of, int threads, const Watch& watch);

  /// Far ones first; what was drawn by draw() hides them, they do not hide one another but by being drawn over.
  void draw(std::span<const Disc> discs);
  void draw(const DrawnLine& line);  ///< also what of it is nearer than near_m

  /// Means over the samples of each pixel.
  [[nodiscard]] ColourPicture resolved() const;

  /// Is this place in the picture, and nothing drawn by draw(scene) before it (lift_m nearer to the eye)?
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
