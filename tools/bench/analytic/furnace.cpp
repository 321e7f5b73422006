/// A furnace: a closed box. All its surfaces emit M lm/m² and reflect the share ρ. Then every radiosity in it is B = M
/// + ρB. So any receiver gets M/(1-ρ) in total and M directly, whatever its place, direction or the mesh.

#include <cmath>
#include <random>

#include "tools/bench/analytic/case.h"
#include "tools/bench/analytic/rectangle_scene.h"

namespace luxrig {
namespace {

constexpr double kExitance_lm_m2 = 50, kWallReflectance = 0.6;

/// A box's faces: rectangles that shine outwards (or inwards), and the mesh under them.
void add_shining_box(const Vec3& low_m, const Vec3& high_m, bool inwards, RectangleScene& scene, AnalyticCase& one) {
  const Vec3 size_m = high_m - low_m;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      // A block's underside is on the floor and lights nothing.
      if (!inwards && axis == 2 && side == 0) continue;
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      const Vec3 corner_m = low_m + side * size_m[axis] * Vec3::Unit(axis);
      const Vec3 u_m = size_m[a] * Vec3::Unit(a), v_m = size_m[b] * Vec3::Unit(b);
      scene.add(corner_m, u_m, v_m, kWallReflectance);
      Emitter face{make_lambertian(kExitance_lm_m2 * size_m[a] * size_m[b]), {}};
      face.shape = {LuminousShape::Kind::rectangle, {size_m[a], size_m[b], 0}};
      const Vec3 z = (inwards == (side == 0) ? -1.0 : 1.0) * Vec3::Unit(axis);  // light leaves along -Z
      face.world_from_lamp.rotation << Vec3::Unit(a), z.cross(Vec3::Unit(a)), z;
      face.world_from_lamp.translation_m = corner_m + (u_m + v_m) / 2;
      one.emitters.push_back(face);
    }
}

AnalyticCase furnace(bool bumpy, std::size_t receivers) {
  const Vec3 size_m(4, 3, 2.5);
  AnalyticCase one;
  RectangleScene scene;
  add_shining_box(Vec3::Zero(), size_m, true, scene, one);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Eigen::AlignedBox3d> blocks;
  for (int i = 0; bumpy && i < 6; ++i) {
    const Vec3 low_m(i % 3 * 1.3 + 0.1 + 0.3 * unit(random), i / 3 * 1.5 + 0.1 + 0.3 * unit(random), 0);
    const Vec3 high_m = low_m + Vec3(0.4 + 0.4 * unit(random), 0.4 + 0.4 * unit(random), 0.3 + unit(random));
    blocks.emplace_back(low_m, high_m);
    add_shining_box(low_m, high_m, false, scene, one);
  }
  one.scene = scene.scene();
  std::normal_distribution<double> normal;
  while (one.receivers.size() < receivers) {
    const Vec3 at_m = Vec3(unit(random), unit(random), unit(random)).cwiseProduct(size_m - Vec3::Constant(0.1)) +
                      Vec3::Constant(0.05);
    bool inside = false;
    for (const auto& block : blocks) inside |= block.exteriorDistance(at_m) < 0.03;
    if (inside) continue;
    one.receivers.push_back({at_m, Vec3(normal(random), normal(random), normal(random)).normalized()});
  }
  return one;
}

}  // namespace

void add_furnace_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  for (const bool bumpy : {false, true}) {
    AnalyticCase one = furnace(bumpy, options.quick ? 2 : 40);
    one.name = bumpy ? "furnace-bumpy-direct" : "furnace-direct";
    one.part = AnalyticCase::Part::direct;
    one.exact_lx.assign(one.receivers.size(), kExitance_lm_m2);
    // Behind blocks a luminaire is partly hidden, and its light has no closed form any more.
    one.direct_target = bumpy ? 1e-3 : 1e-4;
    measure_case(one, options, rows);
    one.name = bumpy ? "furnace-bumpy" : "furnace";
    one.part = AnalyticCase::Part::total;
    one.exact_lx.assign(one.receivers.size(), kExitance_lm_m2 / (1 - kWallReflectance));
    one.reflects = true;
    if (!(options.quick && bumpy)) measure_case(one, options, rows);
  }
}

}  // namespace luxrig
