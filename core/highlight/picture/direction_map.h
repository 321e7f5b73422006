#pragma once
/// Flat map of the sphere of directions: two discs with areas to scale.

#include "core/geometry.h"

namespace luxrig {

/// Directions from an object as its viewer sees them. The front disc has those towards the viewer's side. The other has
/// those behind the object, seen through it, so that left stays left on both. Lambert's azimuthal projection: equal
/// solid angles have equal areas (J. Snyder, "Map projections: a working manual", 1987, p. 182).
class DirectionMap {
 public:
  struct MapPoint {
    bool behind = false;
    double x = 0, y = 0;  ///< to the right and up, within the unit circle
  };

  /// towards_viewer   need not be unit; not zero (asserted). Up is +Z, or +Y for a viewer straight above or below.
  explicit DirectionMap(const Vec3& towards_viewer);

  [[nodiscard]] MapPoint place_of(const Vec3& direction) const;  ///< need not be unit; not zero
  [[nodiscard]] Vec3 direction_at(const MapPoint& place) const;  ///< unit; a place outside the circle is moved onto it

 private:
  Vec3 right_, up_, front_;
};

}  // namespace luxrig
