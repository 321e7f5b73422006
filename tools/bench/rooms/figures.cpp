#include "tools/bench/rooms/figures.h"

#include <cmath>

namespace luxrig {
namespace {

/// For a figure of height 1 that stands on the origin and faces +Y.
double figure_distance(const Vec3& p) {
  struct Limb {
    Vec3 a, b;
    double radius, blend;
  };
  static const std::array<Limb, 9> limbs = {{{{0, 0, 0.50}, {0, 0.01, 0.72}, 0.095, 0.08},
                                             {{-0.10, 0, 0.755}, {0.10, 0, 0.755}, 0.055, 0.06},
                                             {{0, 0, 0.78}, {0, 0.01, 0.86}, 0.034, 0.03},
                                             {{0, 0.012, 0.905}, {0, 0.008, 0.925}, 0.062, 0.02},
                                             {{-0.12, 0, 0.75}, {-0.19, 0.03, 0.60}, 0.038, 0.03},
                                             {{-0.19, 0.03, 0.60}, {-0.08, 0.16, 0.63}, 0.030, 0.02},
                                             {{0.12, 0, 0.75}, {0.23, 0.03, 0.83}, 0.038, 0.03},
                                             {{0.23, 0.03, 0.83}, {0.26, 0.08, 1.00}, 0.028, 0.02},
                                             {{-0.09, 0.15, 0.52}, {-0.09, 0.17, 0.74}, 0.022, 0.01}}};
  const double folds = 1 + 0.07 * std::cos(11 * std::atan2(p.y(), p.x())) * std::max(0.0, 1 - 2 * p.z());
  const double robe = std::hypot(p.x(), p.y()) - (0.17 - 0.15 * std::clamp(p.z(), 0.0, 0.55)) * folds;
  double distance = std::max(robe, p.z() - 0.55);
  for (const Limb& limb : limbs)
    distance = blended_least_m(distance, distance_to_segment_m(p, limb.a, limb.b) - limb.radius, limb.blend);
  return distance;
}

}  // namespace

void add_statue(SolidModel& model, const Vec3& base_m, double height_m, double turn_rad, double cell_m,
                SolidModel::MaterialIndex material) {
  const Mat3 turn = Eigen::AngleAxisd(-turn_rad, Vec3::UnitZ()).toRotationMatrix();
  const Vec3 wide(0.36 * height_m, 0.36 * height_m, 0);
  // Its foot is one cell inside the object under it.
  const Eigen::AlignedBox3d box_m(base_m - wide - Vec3(0, 0, 2 * cell_m),
                                  base_m + wide + Vec3(0, 0, 1.05 * height_m + 2 * cell_m));
  model.body(mesh_level_set(box_m, cell_m,
                            [&](const Vec3& p) { return height_m * figure_distance(turn * (p - base_m) / height_m); }),
             material);
}

void add_vase(SolidModel& model, const Vec3& base_m, double height_m, SolidModel::MaterialIndex material, int flutes) {
  std::vector<Eigen::Vector2d> profile;
  for (int i = 0; i <= 29; ++i) {
    const double t = i / 29.0, scale = height_m / 0.42;
    profile.emplace_back(scale * (0.06 + 0.09 * std::sin(kPi * std::pow(t, 0.8)) + 0.03 * t * t * t), height_m * t);
  }
  model.turned_body(base_m, profile, 60, material, flutes, 0.06);
}

void add_crown(SolidModel& model, const Vec3& base_m, double width_m, double height_m, int segments,
               SolidModel::MaterialIndex material) {
  std::vector<Eigen::Vector2d> profile;
  const int rings = std::max(6, segments / 3);
  for (int k = 0; k <= rings; ++k) {
    const double t = static_cast<double>(k) / rings;
    profile.emplace_back(width_m / 2 * (0.12 + 0.8 * std::sin(kPi * std::pow(t, 0.7)) * (1 - 0.12 * (k % 2))),
                         height_m * t);
  }
  model.turned_body(base_m, profile, segments, material, 9, 0.1);
}

}  // namespace luxrig
