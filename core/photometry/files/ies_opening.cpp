#include <algorithm>
#include <cmath>

#include "core/photometry/files/ies.h"

namespace luxrig {
namespace {

using Kind = LuminousShape::Kind;

int sign_of(double x) { return x < 0 ? -1 : x > 0 ? 1 : 0; }

bool alike(double a, double b) { return std::abs(a - b) <= 1e-3 * std::max(a, b); }

/// Diameter of a round outline with two diameters, or of the disk with its area.
double diameter(double a, double b, std::string& note) {
  if (alike(a, b)) return a;
  note = "its luminous opening is an ellipse: taken as the disk of the same area";
  return std::sqrt(a * b);
}

}  // namespace

LuminousOpening luminous_opening(const IesFile& file) {
  const double l = std::abs(file.length_m);
  const double w = std::abs(file.width_m);
  const double h = std::abs(file.height_m);
  const int ls = sign_of(file.length_m);
  const int ws = sign_of(file.width_m);
  const int hs = sign_of(file.height_m);
  LuminousOpening opening;
  const auto shape = [&](Kind kind, double x, double y, double z) { opening.shape = {kind, Vec3(x, y, z)}; };

  const bool one_diameter = ls == 0 && ws < 0;  // 1986…1995: a circle has only a width
  if (ls > 0 && ws > 0 && hs >= 0) {
    shape(Kind::rectangle, l, w, 0);
    if (hs > 0) opening.note = "its luminous opening is a box: taken as the rectangle below";
  } else if (one_diameter || (ls < 0 && ws < 0)) {
    const double d = one_diameter ? w : diameter(l, w, opening.note);
    if (hs == 0) shape(Kind::disk, d, 0, 0);
    if (hs > 0) shape(Kind::cylinder, d, 0, h);
    if (hs < 0) {
      shape(Kind::sphere, std::cbrt(d * d * h), 0, 0);
      if (!alike(d, h)) opening.note = "its luminous opening is an ellipsoid: taken as the sphere of the same volume";
    }
  } else if (hs < 0 && ls > 0 && ws <= 0) {  // lies along the length; 1995 states its diameter only as the height
    shape(Kind::rectangle, l, ws < 0 ? w : h, 0);
    opening.note = "its luminous opening is a lying cylinder: taken as the rectangle of its outline";
  } else if (hs < 0 && ws > 0 && ls <= 0) {
    shape(Kind::rectangle, ls < 0 ? l : h, w, 0);
    opening.note = "its luminous opening is a lying cylinder: taken as the rectangle of its outline";
  } else if (ls != 0 && ws != 0) {  // one of them negative: an ellipse in 1986 and 1995
    shape(hs > 0 ? Kind::cylinder : Kind::disk, std::sqrt(l * w), 0, h);
    opening.note = "its luminous opening is an ellipse: taken as the disk of the same area";
  } else if (l != 0 || w != 0 || h != 0) {
    opening.note = "its luminous opening stands upright: taken as a point";
  }
  return opening;
}

}  // namespace luxrig
