#pragma once
/// Spreads receivers evenly over surfaces of any scene, made-up or from a file.

#include <cstdint>
#include <string>
#include <vector>

#include "core/transport/candidates/air_regions.h"

namespace luxrig {

/// The part of a scene's surface for the receivers.
struct SurfacePart {
  std::vector<std::string> objects;      ///< by name; empty = all
  Eigen::AlignedBox3d box_world_m;       ///< within it
  Vec3 facing_world = Vec3::UnitZ();     ///< unit
  double within_rad = rad_from_deg(20);  ///< largest angle between normal and `facing_world`; kPi = any
  bool either_side = false;              ///< the file's triangles may face either way: flip them to `facing_world`
  double headroom_m = 0.05;              ///< free space above, if the surface faces up
  double elbow_room_m = 0.03;            ///< free space in front, and to four sides along the surface
};

class SurfaceSpread {
 public:
  /// air_world_m   a point in the air: receivers must be in the same air, by the closed surfaces. Keeps both
  ///               references.
  SurfaceSpread(const Scene& scene, const RayScene& rays, const Vec3& air_world_m);

  [[nodiscard]] bool in_air(const Vec3& point_world_m) const;

  /// `count` receivers 1 mm off the part, as far apart as possible: random places, thinned by weighted sample
  /// elimination (C. Yuksel 2015). The same for the same seed. Fewer if too few of the tried places are free.
  [[nodiscard]] std::vector<Receiver> over(const SurfacePart& part, std::size_t count, std::uint64_t seed) const;

 private:
  [[nodiscard]] bool is_free(const Receiver& receiver, const SurfacePart& part) const;

  const Scene& scene_;
  const RayScene& rays_;
  AirRegions regions_;
  std::uint64_t air_;
};

}  // namespace luxrig
