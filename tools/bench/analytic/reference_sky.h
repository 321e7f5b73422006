#pragma once
/// The fifteen skies of CIE S 011/E:2003 (ISO 15469), written a second time so that the answers of `luxrig bench
/// analytic` do not come from the code under test.

#include "core/geometry.h"

namespace luxrig {

/// A general sky of type 1 … 15 with zenith luminance `zenith_cd_m2`, without the sun's disk.
class ReferenceSky {
 public:
  ReferenceSky(int type, const Vec3& towards_sun_world, double zenith_cd_m2);
  [[nodiscard]] double luminance_cd_m2(const Vec3& direction_world) const;
  [[nodiscard]] double horizontal_illuminance_lx() const { return horizontal_lx_; }
  [[nodiscard]] const Vec3& towards_sun_world() const { return sun_; }

 private:
  struct Parameters {
    double a, b, c, d, e;
  };
  static const Parameters kTypes[15];
  Parameters type_;
  Vec3 sun_;
  double scale_cd_m2_ = 1, horizontal_lx_ = 0;
};

}  // namespace luxrig
