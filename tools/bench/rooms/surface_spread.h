#pragma once
/// Receivers spread evenly over surfaces of any scene: made-up or read from a file.

#include <cstdint>
#include <string>
#include <vector>

#include "core/transport/candidates/air_regions.h"

namespace luxrig {

/// Which part of a scene's surface receivers are to be on.
struct SurfacePart {
  std::vector<std::string> objects;      ///< by name; empty = all
  Eigen::AlignedBox3d box_world_m;       ///< within it
  Vec3 facing_world = Vec3::UnitZ();     ///< unit
  double within_rad = rad_from_deg(20);  ///< of the normal from `facing_world`; kPi = any
  bool either_side = false;              ///< the file's triangles may look either way: turned to `facing_world`
  double headroom_m = 0.05;              ///< free above, where the surface looks up
  double elbow_room_m = 0.03;            ///< free in front, and to four sides along the surface
};

class SurfaceSpread {
 public:
  /// air_world_m   a point in the air: receivers must be in the same, as far as closed surfaces tell. Keeps both.
  SurfaceSpread(const Scene& scene, const RayScene& rays, const Vec3& air_world_m);

  [[nodiscard]] bool in_air(const Vec3& point_world_m) const;

  /// `count` receivers 1 mm off the part, as far from each other as they come: random places, thinned by weighted
  /// sample elimination (C. Yuksel 2015). The same for a seed. Fewer where so few of the places tried are free.
  [[nodiscard]] std::vector<Receiver> over(const SurfacePart& part, std::size_t count, std::uint64_t seed) const;

 private:
  [[nodiscard]] bool is_free(const Receiver& receiver, const SurfacePart& part) const;

  const Scene& scene_;
  const RayScene& rays_;
  AirRegions regions_;
  std::uint64_t air_;
};

}  // namespace luxrig
