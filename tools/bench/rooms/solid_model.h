#pragma once
/// Closed solids with outward normals, collected into a Scene.

#include <span>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "tools/bench/rooms/level_set.h"

namespace luxrig {

/// A gap in a wall, by its ranges along the wall's longer horizontal axis and in height [m].
struct WallGap {
  double from_m, to_m, bottom_m, top_m;
};

/// Upright rectangle for a picture: its middle, and the directions to its right and away from the wall.
struct HangingPlace {
  Vec3 middle_m, right, out;
};

class SolidModel {
 public:
  using MaterialIndex = std::uint32_t;

  [[nodiscard]] MaterialIndex material(const std::string& name, const Vec3& reflectance_rgb,
                                       double specular_reflectance = 0, double roughness = 0.3);
  /// Everything added from now on belongs to a new object of this name.
  void begin_object(const std::string& name);

  void box(const Vec3& low_m, const Vec3& high_m, MaterialIndex material);
  /// A box that stands on base_m (the middle of its underside), turned about the vertical.
  void turned_box(const Vec3& base_m, const Vec3& size_m, double turn_rad, MaterialIndex material);
  /// Boxes that fill low…high except for the gaps, which must be in order and not overlap.
  void wall(const Vec3& low_m, const Vec3& high_m, std::span<const WallGap> gaps, MaterialIndex material);
  /// Four boxes around a rectangular hole, in x and y; those along X take the corners.
  void ring(const double low_m[2], const double high_m[2], const double hole_low_m[2], const double hole_high_m[2],
            double bottom_m, double top_m, MaterialIndex material);
  /// Floor, ceiling and four walls around a room. thickness_m is that of floor and ceiling; walls have nine tenths.
  /// Walls reach into floor, ceiling and each other, so that no seam is a gap.
  /// walls   in the order -X, +X, -Y, +Y
  void shell(const Vec3& inner_low_m, const Vec3& inner_high_m, double thickness_m, MaterialIndex floor,
             MaterialIndex ceiling, const std::array<MaterialIndex, 4>& walls);

  /// A body of revolution on base_m: (radius, height) from bottom to top, radii above 0, closed by flat caps.
  /// flutes, depth   the radius is that of the profile times 1 + depth · cos(flutes · angle)
  void turned_body(const Vec3& base_m, std::span<const Eigen::Vector2d> profile_m, int segments, MaterialIndex material,
                   int flutes = 0, double depth = 0);
  void column(const Vec3& base_m, double radius_m, double height_m, int segments, MaterialIndex material);
  void ball(const Vec3& centre_m, double radius_m, int segments, MaterialIndex material);
  /// A tube along a trefoil knot around the vertical; the knot is 3 · size_m wide.
  void knot(const Vec3& centre_m, double size_m, int along, int around, MaterialIndex material);
  /// A mitred moulding around a rectangle: inner size, width and depth of its profile, which has `profile_points`.
  void moulding(const HangingPlace& place, double width_m, double height_m, double moulding_m, double depth_m,
                int profile_points, MaterialIndex material);

  /// A block with a round arch cut out from below, through its whole depth. The span is along the longer horizontal
  /// axis, less pier_m at both ends. The arch springs at low_m.z(). Its crown is half the span higher, below
  /// high_m.z().
  void arch(const Vec3& low_m, const Vec3& high_m, double pier_m, int segments, MaterialIndex material);
  /// Any closed surface.
  void body(const ClosedMesh& mesh, MaterialIndex material);
  /// A block with a cavity. occupied() and open_above() do not see it.
  void hollow_block(const Vec3& low_m, const Vec3& high_m, const ClosedMesh& cavity, MaterialIndex material);

  /// True within margin_m of a solid's bounding box (for a moulding, of the box of one side).
  [[nodiscard]] bool occupied(const Vec3& point_m, double margin_m) const;
  /// True if no solid's bounding box is less than headroom_m above the point.
  [[nodiscard]] bool open_above(const Vec3& point_m, double headroom_m) const;

  [[nodiscard]] Scene scene() const { return scene_; }

 private:
  /// Adds a closed surface, oriented so that its volume is positive.
  void closed(const std::vector<Vec3>& vertices_m, std::vector<std::array<std::uint32_t, 3>> triangles,
              MaterialIndex material);
  void append(const std::vector<Vec3>& vertices_m, const std::vector<std::array<std::uint32_t, 3>>& triangles,
              MaterialIndex material);
  void occupy(const std::vector<Vec3>& vertices_m);

  Scene scene_;
  std::vector<Eigen::AlignedBox3d> occupied_m_;
};

}  // namespace luxrig
