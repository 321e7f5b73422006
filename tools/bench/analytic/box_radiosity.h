#pragma once
/// Radiosity of an empty box with a point source, made independently: patches, exact form factors from points, no
/// sampling and no rays. `luxrig bench analytic` judges evaluators by it.

#include <array>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

struct BoxRoom {
  Vec3 size_m;                        ///< one corner is at the origin
  std::array<double, 6> reflectance;  ///< of the faces x = 0, x = size, y = 0, y = size, z = 0, z = size
  double flux_lm;                     ///< of an isotropic source
  Vec3 source_m;
};

/// Reflected illuminance [lx] at points on the walls. The walls have patches of constant radiosity, per_edge² to a
/// face. The result is extrapolated from these and from twice as many per edge. With 8 it is good to 2e-4 away from the
/// box's edges, as its test shows, and to some per cent in the corners.
class BoxRadiosity {
 public:
  BoxRadiosity(const BoxRoom& room, int per_edge);
  [[nodiscard]] double reflected_lx(const Vec3& position_m, const Vec3& normal) const;
  [[nodiscard]] double direct_lx(const Vec3& position_m, const Vec3& normal) const;

 private:
  struct Patch {
    Vec3 corner_m, u_m, v_m, centre_m, normal;
    double reflectance;
  };
  struct Level {
    std::vector<std::vector<Patch>> parts;  ///< per patch, since direct light varies more than reflected
    Eigen::VectorXd reflected_lx;
  };
  [[nodiscard]] Level solved(int per_edge) const;
  [[nodiscard]] double gathered_lx(const Level& level, const Vec3& position_m, const Vec3& normal) const;
  [[nodiscard]] static double form_factor(const Vec3& position_m, const Vec3& normal, const Patch& patch);

  BoxRoom room_;
  Level coarse_, fine_;
};

}  // namespace luxrig
