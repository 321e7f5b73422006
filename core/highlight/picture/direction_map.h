#pragma once
/// The sphere of directions on paper: two discs of equal area to scale.

#include "core/geometry.h"

namespace luxrig {

/// Directions from an object, as one who looks at it sees them: on the front disc those towards the viewer's side, on
/// the other those behind the object, seen through it, so that left stays left on both. Lambert's azimuthal
/// projection: equal solid angles have equal areas (J. Snyder, "Map projections: a working manual", 1987, p. 182).
class DirectionMap {
 public:
  struct Place {
    bool behind = false;
    double x = 0, y = 0;  ///< to the right and up, within the unit circle
  };

  /// towards_viewer   need not be unit; not zero (asserted). Up is +Z, or +Y for a viewer straight above or below.
  explicit DirectionMap(const Vec3& towards_viewer);

  [[nodiscard]] Place place_of(const Vec3& direction) const;  ///< need not be unit; not zero
  [[nodiscard]] Vec3 direction_at(const Place& place) const;  ///< unit; a place outside the circle counts as on it

 private:
  Vec3 right_, up_, front_;
};

}  // namespace luxrig
