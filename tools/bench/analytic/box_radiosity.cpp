#include "tools/bench/analytic/box_radiosity.h"

#include <cmath>

namespace luxrig {

BoxRadiosity::BoxRadiosity(const BoxRoom& room, int per_edge)
    : room_(room), coarse_(solved(per_edge)), fine_(solved(2 * per_edge)) {}

BoxRadiosity::Level BoxRadiosity::solved(int per_edge) const {
  constexpr int kParts = 4;
  std::vector<Patch> patches;
  Level level;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      const Vec3 u = Vec3::Unit((axis + 1) % 3) * room_.size_m[(axis + 1) % 3] / per_edge;
      const Vec3 v = Vec3::Unit((axis + 2) % 3) * room_.size_m[(axis + 2) % 3] / per_edge;
      const Vec3 normal = (side ? -1.0 : 1.0) * Vec3::Unit(axis);
      const double reflectance = room_.reflectance[static_cast<std::size_t>(2 * axis + side)];
      const auto patch = [&](const Vec3& corner, const Vec3& a, const Vec3& b) {
        return Patch{corner, a, b, corner + (a + b) / 2, normal, reflectance};
      };
      for (int i = 0; i < per_edge; ++i)
        for (int j = 0; j < per_edge; ++j) {
          const Vec3 corner = side * room_.size_m[axis] * Vec3::Unit(axis) + i * u + j * v;
          patches.push_back(patch(corner, u, v));
          auto& parts = level.parts.emplace_back();
          for (int a = 0; a < kParts; ++a)
            for (int b = 0; b < kParts; ++b)
              parts.push_back(patch(corner + a * u / kParts + b * v / kParts, u / kParts, v / kParts));
        }
    }
  const auto n = static_cast<Eigen::Index>(patches.size());
  Eigen::MatrixXd gain(n, n);
  Eigen::VectorXd direct(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Patch& at = patches[static_cast<std::size_t>(i)];
    direct[i] = 0;
    for (const Patch& part : level.parts[static_cast<std::size_t>(i)])
      direct[i] += direct_lx(part.centre_m, part.normal) / (kParts * kParts);
    for (Eigen::Index j = 0; j < n; ++j) {
      const Patch& from = patches[static_cast<std::size_t>(j)];
      gain(i, j) = from.reflectance * form_factor(at.centre_m, at.normal, from);
    }
  }
  level.reflected_lx = Eigen::VectorXd::Zero(n);
  for (int bounce = 0; bounce < 400; ++bounce) {
    const Eigen::VectorXd next = gain * (direct + level.reflected_lx);
    const double change = (next - level.reflected_lx).cwiseAbs().maxCoeff();
    level.reflected_lx = next;
    if (change < 1e-9 * next.maxCoeff()) break;
  }
  return level;
}

double BoxRadiosity::direct_lx(const Vec3& position_m, const Vec3& normal) const {
  const Vec3 towards = room_.source_m - position_m;
  return std::max(0.0, room_.flux_lm / (4 * kPi) * normal.dot(towards) / std::pow(towards.norm(), 3));
}

double BoxRadiosity::gathered_lx(const Level& level, const Vec3& position_m, const Vec3& normal) const {
  double sum = 0;
  for (std::size_t j = 0; j < level.parts.size(); ++j)
    for (const Patch& part : level.parts[j])
      sum += form_factor(position_m, normal, part) * part.reflectance *
             (direct_lx(part.centre_m, part.normal) + level.reflected_lx[static_cast<Eigen::Index>(j)]);
  return sum;
}

double BoxRadiosity::reflected_lx(const Vec3& position_m, const Vec3& normal) const {
  return (4 * gathered_lx(fine_, position_m, normal) - gathered_lx(coarse_, position_m, normal)) / 3;
}

/// Lambert's formula for a polygon. In a box the horizon of a wall point cuts no polygon. A polygon in the point's own
/// plane contributes nothing.
double BoxRadiosity::form_factor(const Vec3& position_m, const Vec3& normal, const Patch& patch) {
  if (normal.dot(patch.centre_m - position_m) <= 1e-9) return 0;
  const std::array<Vec3, 4> corners = {patch.corner_m, patch.corner_m + patch.u_m,
                                       patch.corner_m + patch.u_m + patch.v_m, patch.corner_m + patch.v_m};
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3 a = corners[k] - position_m, b = corners[(k + 1) % 4] - position_m, cross = a.cross(b);
    const double sine = cross.norm();
    if (sine > 0) sum += std::atan2(sine, a.dot(b)) * normal.dot(cross) / sine;
  }
  return std::abs(sum) / (2 * kPi);
}

}  // namespace luxrig
