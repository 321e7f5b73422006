#pragma once
/// Independent reference for diffuse light in a cube: patches with exact form factors from points, no sampling.

#include <array>
#include <cmath>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// Reflected illuminance in the cube [-edge/2, edge/2]³ of uniform reflectance around an isotropic point source.
/// Reflected light is constant on each patch. Direct light varies more: it is constant on each of 4×4 parts of a patch.
class CubeRadiosity {
 public:
  CubeRadiosity(double edge_m, double reflectance, double flux_lm, const Vec3& source_m, int patches_per_edge)
      : reflectance_(reflectance), candela_(flux_lm / (4 * kPi)), source_m_(source_m) {
    const std::vector<Patch> patches = patches_of_cube(edge_m, patches_per_edge);
    const auto n = static_cast<Eigen::Index>(patches.size());
    Eigen::MatrixXd form(n, n);
    Eigen::VectorXd direct_lx(n);
    for (const Patch& patch : patches) parts_.push_back(parts_of(patch));
    for (Eigen::Index i = 0; i < n; ++i) {
      const Patch& at = patches[static_cast<std::size_t>(i)];
      direct_lx[i] = 0;
      for (const Patch& part : parts_[static_cast<std::size_t>(i)]) direct_lx[i] += direct_at(part) / 16;
      for (Eigen::Index j = 0; j < n; ++j)
        form(i, j) = form_factor(at.centre_m, at.normal, patches[static_cast<std::size_t>(j)]);
    }
    reflected_lx_ = Eigen::VectorXd::Zero(n);
    for (int bounce = 0; bounce < 200; ++bounce)
      reflected_lx_ = (reflectance * form * (direct_lx + reflected_lx_)).eval();
  }

  double reflected_lx(const Vec3& position_m, const Vec3& normal) const {
    double sum_lx = 0;
    for (std::size_t j = 0; j < parts_.size(); ++j)
      for (const Patch& part : parts_[j])
        sum_lx += form_factor(position_m, normal, part) * reflectance_ *
                  (direct_at(part) + reflected_lx_[static_cast<Eigen::Index>(j)]);
    return sum_lx;
  }

 private:
  struct Patch {
    Vec3 corner_m, u_m, v_m, centre_m, normal;
  };

  static Patch patch_at(const Vec3& corner_m, const Vec3& u_m, const Vec3& v_m, const Vec3& normal) {
    return {corner_m, u_m, v_m, corner_m + (u_m + v_m) / 2, normal};
  }

  static std::vector<Patch> patches_of_cube(double edge_m, int per_edge) {
    std::vector<Patch> patches;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0})
        for (int i = 0; i < per_edge; ++i)
          for (int j = 0; j < per_edge; ++j) {
            const Vec3 u_m = edge_m / per_edge * Vec3::Unit((axis + 1) % 3);
            const Vec3 v_m = edge_m / per_edge * Vec3::Unit((axis + 2) % 3);
            const Vec3 face_m =
                edge_m / 2 * (side * Vec3::Unit(axis) - Vec3::Unit((axis + 1) % 3) - Vec3::Unit((axis + 2) % 3));
            patches.push_back(patch_at(face_m + i * u_m + j * v_m, u_m, v_m, -side * Vec3::Unit(axis)));
          }
    return patches;
  }

  static std::vector<Patch> parts_of(const Patch& patch) {
    std::vector<Patch> parts;
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b)
        parts.push_back(patch_at(patch.corner_m + a / 4.0 * patch.u_m + b / 4.0 * patch.v_m, patch.u_m / 4,
                                 patch.v_m / 4, patch.normal));
    return parts;
  }

  double direct_at(const Patch& part) const {
    const Vec3 towards_m = source_m_ - part.centre_m;
    return candela_ * part.normal.dot(towards_m) / std::pow(towards_m.norm(), 3);
  }

  /// Lambert's formula: cosine-weighted share of a point's hemisphere that a polygon fills. In a cube the horizon clips
  /// no polygon; a polygon in the point's own plane fills nothing.
  static double form_factor(const Vec3& position_m, const Vec3& normal, const Patch& patch) {
    if (normal.dot(patch.centre_m - position_m) <= 1e-9) return 0;
    const std::array<Vec3, 4> corners_m = {patch.corner_m, patch.corner_m + patch.u_m,
                                           patch.corner_m + patch.u_m + patch.v_m, patch.corner_m + patch.v_m};
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 a = corners_m[k] - position_m, b = corners_m[(k + 1) % 4] - position_m;
      const Vec3 cross = a.cross(b);
      const double sine = cross.norm();
      if (sine > 0) sum += std::atan2(sine, a.dot(b)) * normal.dot(cross) / sine;
    }
    return std::abs(sum) / (2 * kPi);
  }

  double reflectance_, candela_;
  Vec3 source_m_;
  std::vector<std::vector<Patch>> parts_;
  Eigen::VectorXd reflected_lx_;
};

}  // namespace luxrig
