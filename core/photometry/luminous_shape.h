#pragma once
/// The part of a luminaire that shines, as a surface with size.
///
/// A luminaire of intensity I(ω) [cd] spreads it evenly over its luminous surface as seen from ω: its luminance is
///   L(ω) = I(ω) / A(ω) [cd/m²],   A(ω) = projected area of the surface [m²],
/// at every place of the surface that ω can see. Integrated over the surface this gives I(ω) back, so that far away
/// (five times the largest size, ±1 % for a diffuser) the luminaire is a point; near by it is what it is. A Lambertian
/// intensity I0 cosγ on a rectangle or disk gives a surface of one luminance. Luminous surfaces emit; they neither
/// block light nor reflect it.

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
  Vec3 size_m = Vec3::Zero();  ///< what the kind does not name is not looked at

  friend bool operator==(const LuminousShape&, const LuminousShape&) = default;
};

}  // namespace luxrig
