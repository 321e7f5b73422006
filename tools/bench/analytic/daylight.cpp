/// CIE 171:2006, 5.9, 5.11, 5.13 and 5.14 from first principles: light of the CIE skies through an unglazed opening in
/// a roof or façade, with outside ground and masks before the opening. Dimensions are our own; the references are
/// quadratures of the sky's formula over the opening. (5.5, 5.10 and 5.12 need glass, which these scenes do not have.)

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/photometry/sky/sky.h"
#include "tools/bench/analytic/case.h"
#include "tools/bench/analytic/closed_forms.h"
#include "tools/bench/analytic/rectangle_scene.h"
#include "tools/bench/analytic/reference_sky.h"

namespace luxrig {
namespace {

constexpr double kSkyTarget = 2e-3;

std::shared_ptr<const ReferenceSky> sky_of(int type) {
  const double up = rad_from_deg(40), turn = rad_from_deg(250);
  return std::make_shared<ReferenceSky>(
      type, Vec3(std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up)), 3000.0);
}

/// The sky under test, with the same type, sun and illuminance.
Emitter daylight(int type, const ReferenceSky& like) {
  Emitter emitter;
  emitter.sky = make_general_sky(type, like.towards_sun_world(), like.horizontal_illuminance_lx());
  return emitter;
}

/// Black room of 4 × 4 × 3 m with an opening of `edge_m` in the middle of its roof: the sky component on floor and
/// wall.
AnalyticCase roof(int type, double edge_m) {
  AnalyticCase one;
  one.name = fmt::format("cie171-5.9-roof-{:g}m-sky-{}", edge_m, type);
  one.direct_target = kSkyTarget;
  const double near_m = 2 - edge_m / 2, far_m = 2 + edge_m / 2;
  RectangleScene room;
  room.add({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, 0);
  room.add({0, 0, 0}, {4, 0, 0}, {0, 0, 3}, 0);
  room.add({0, 4, 0}, {4, 0, 0}, {0, 0, 3}, 0);
  room.add({0, 0, 0}, {0, 4, 0}, {0, 0, 3}, 0);
  room.add({4, 0, 0}, {0, 4, 0}, {0, 0, 3}, 0);
  room.add({0, 0, 3}, {4, 0, 0}, {0, near_m, 0}, 0);
  room.add({0, far_m, 3}, {4, 0, 0}, {0, near_m, 0}, 0);
  room.add({0, near_m, 3}, {near_m, 0, 0}, {0, edge_m, 0}, 0);
  room.add({far_m, near_m, 3}, {near_m, 0, 0}, {0, edge_m, 0}, 0);
  one.scene = room.scene();
  const auto sky = sky_of(type);
  one.emitters.push_back(daylight(type, *sky));
  const GaussNodes rule = gauss_rule(40);
  const auto expect = [&](const Vec3& at_m, const Vec3& normal) {
    one.receivers.push_back({at_m, normal});
    one.exact_lx.push_back(integral(rule, near_m, far_m, near_m, far_m, [&](double x, double y) {
      const Vec3 to_m = Vec3(x, y, 3) - at_m;
      const double d2 = to_m.squaredNorm();
      return sky->luminance_cd_m2(to_m / std::sqrt(d2)) * std::max(0.0, normal.dot(to_m)) * to_m.z() / (d2 * d2);
    }));
  };
  for (int i = 0; i < 6; ++i) expect({0.5 + 0.6 * i, 0.4 + 0.55 * i, 0}, Vec3::UnitZ());
  for (int i = 0; i < 4; ++i) expect({1.3, 0, 0.4 + 0.6 * i}, Vec3::UnitY());
  return one;
}

enum class Mask { none, overhang, opposite };

/// Black room, 4 m wide, 4 m deep and 3 m high. It is 150 m above the ground, so that its own shadow on the ground is
/// below 2e-4. A window of 2 × 1 m, 1 m above the floor, in the façade y = 0. Ground of reflectance 0.3, 4 × 4 km.
/// Masks are black and 400 m wide: an overhang of 2 m at roof level, or a wall 6 m away up to 2 m above the floor.
AnalyticCase facade(int type, Mask mask) {
  constexpr double kGround = 0.3, kBelow_m = 150, kGroundHalf_m = 2000, kOverhang_m = 2, kAway_m = 6, kTop_m = 2;
  AnalyticCase one;
  one.reflects = true;
  RectangleScene room;
  room.add({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, 0);
  room.add({0, 0, 3}, {4, 0, 0}, {0, 4, 0}, 0);
  room.add({0, 0, 0}, {0, 4, 0}, {0, 0, 3}, 0);
  room.add({4, 0, 0}, {0, 4, 0}, {0, 0, 3}, 0);
  room.add({0, 4, 0}, {4, 0, 0}, {0, 0, 3}, 0);
  room.add({0, 0, 0}, {4, 0, 0}, {0, 0, 1}, 0);
  room.add({0, 0, 2}, {4, 0, 0}, {0, 0, 1}, 0);
  room.add({0, 0, 1}, {1, 0, 0}, {0, 0, 1}, 0);
  room.add({3, 0, 1}, {1, 0, 0}, {0, 0, 1}, 0);
  constexpr int kTiles = 20;
  const double tile_m = 2 * kGroundHalf_m / kTiles;
  for (int i = 0; i < kTiles; ++i)
    for (int j = 0; j < kTiles; ++j)
      room.add({i * tile_m - kGroundHalf_m, j * tile_m - kGroundHalf_m, -kBelow_m}, {tile_m, 0, 0}, {0, tile_m, 0},
               kGround);
  if (mask == Mask::overhang) room.add({-200, -kOverhang_m, 3}, {400, 0, 0}, {0, kOverhang_m, 0}, 0);
  if (mask == Mask::opposite) room.add({-200, -kAway_m, kTop_m - 3}, {400, 0, 0}, {0, 0, 3}, 0);
  one.scene = room.scene();
  const auto sky = sky_of(type);
  one.emitters.push_back(daylight(type, *sky));
  const double ground_cd_m2 = kGround / kPi * sky->horizontal_illuminance_lx();
  const auto seen_cd_m2 = [&](const Vec3& from_m, const Vec3& direction) {
    if (mask == Mask::overhang && direction.z() > 0) {
      const Vec3 at_m = from_m + (3 - from_m.z()) / direction.z() * direction;
      if (at_m.y() > -kOverhang_m && from_m.z() < 3) return 0.0;
    }
    if (mask == Mask::opposite) {
      const double z_m = from_m.z() + (from_m.y() + kAway_m) / -direction.y() * direction.z();
      if (z_m < kTop_m && z_m > kTop_m - 3) return 0.0;
    }
    if (direction.z() >= 0) return sky->luminance_cd_m2(direction);
    const Vec3 at_m = from_m + (from_m.z() + kBelow_m) / -direction.z() * direction;
    return std::max(std::abs(at_m.x()), std::abs(at_m.y())) < kGroundHalf_m ? ground_cd_m2 : 0.0;
  };
  const GaussNodes rule = gauss_rule(40);
  const auto expect = [&](const Vec3& at_m, const Vec3& normal) {
    // Heights in the window at which the view through it changes: the horizon, the ground's end, the masks.
    std::vector<double> levels = {1, 2};
    const auto edge = [&](double z_m) {
      if (z_m > 1 && z_m < 2) levels.push_back(z_m);
    };
    edge(at_m.z());
    const auto through_m = [&](double y_m, double z_m) {
      return at_m.z() + (z_m - at_m.z()) * at_m.y() / (at_m.y() - y_m);
    };
    edge(through_m(-kGroundHalf_m, -kBelow_m));
    if (mask == Mask::overhang) edge(through_m(-kOverhang_m, 3));
    if (mask == Mask::opposite) edge(through_m(-kAway_m, kTop_m)), edge(through_m(-kAway_m, kTop_m - 3));
    std::sort(levels.begin(), levels.end());
    double lux = 0;
    for (std::size_t k = 0; k + 1 < levels.size(); ++k)
      lux += integral(rule, 1, 3, levels[k], levels[k + 1], [&](double x, double z) {
        const Vec3 to_m = Vec3(x, 0, z) - at_m;
        const double d2 = to_m.squaredNorm();
        return seen_cd_m2(at_m, to_m / std::sqrt(d2)) * std::max(0.0, normal.dot(to_m)) * -to_m.y() / (d2 * d2);
      });
    one.receivers.push_back({at_m, normal});
    one.exact_lx.push_back(lux);
  };
  for (int i = 1; i <= 6; ++i) expect({2, 0.6 * i, 0}, Vec3::UnitZ());
  for (int i = 1; i <= 3; ++i) expect({1.7, 1.1 * i, 3}, -Vec3::UnitZ());
  for (int i = 1; i <= 4; ++i) expect({1.2, 4, 0.6 * i}, -Vec3::UnitY());
  return one;
}

}  // namespace

void add_daylight_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  if (options.quick) {
    measure_case(with_receivers(roof(12, 1), 3), options, rows);
    return;
  }
  for (const int type : {1, 5, 12, 15}) {
    measure_case(roof(type, 1), options, rows);
    measure_case(roof(type, 3), options, rows);
  }
  for (const int type : {1, 12}) {
    AnalyticCase open = facade(type, Mask::none);
    open.name = fmt::format("cie171-5.11-facade-sky-{}", type);
    measure_case(open, options, rows);
    AnalyticCase overhang = facade(type, Mask::overhang);
    overhang.name = fmt::format("cie171-5.13-overhang-sky-{}", type);
    measure_case(overhang, options, rows);
    AnalyticCase opposite = facade(type, Mask::opposite);
    opposite.name = fmt::format("cie171-5.14-mask-sky-{}", type);
    measure_case(opposite, options, rows);
  }
}

}  // namespace luxrig
