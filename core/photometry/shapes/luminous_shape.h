#pragma once
/// The luminous part of a luminaire, as a surface with size.
///
/// A luminaire of intensity I(ω) [cd] spreads it evenly over its luminous surface as seen from ω. Its luminance is
///   L(ω) = I(ω) / A(ω) [cd/m²],   A(ω) = projected area of the surface [m²],
/// at every place of the surface visible from ω. Integrated over the surface, this gives I(ω) again. So the luminaire
/// is a point from far away (five times the largest size, ±1 % for a diffuser), and has its true size nearby. A
/// Lambertian intensity I0 cosγ on a rectangle or disk gives a surface of uniform luminance. Luminous surfaces only
/// emit; they neither block nor reflect light.

#include "core/geometry.h"

namespace luxrig {

struct LuminousShape {
  enum class Kind {
    point,
    rectangle,  ///< size_m.x by size_m.y in the plane z = 0 of frame lamp, both sides
    disk,       ///< diameter size_m.x in the plane z = 0, both sides
    sphere,     ///< diameter size_m.x
    cylinder    ///< diameter size_m.x, length size_m.z along z, with both ends
  };
  Kind kind = Kind::point;
  Vec3 size_m = Vec3::Zero();  ///< components that the kind does not use are ignored

  friend bool operator==(const LuminousShape&, const LuminousShape&) = default;
};

}  // namespace luxrig
