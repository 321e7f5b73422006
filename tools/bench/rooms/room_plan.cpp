#include "tools/bench/rooms/room_plan.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {

Pose aimed(const Vec3& position_m, const Vec3& aim_m) {
  const Vec3 z = (position_m - aim_m).normalized();
  const Vec3 x = z.cross(std::abs(z.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
  Pose pose;
  pose.rotation << x, z.cross(x), z;
  pose.translation_m = position_m;
  return pose;
}

Emitter bare_lamp(const Vec3& position_m, double flux_lm) {
  return {make_isotropic(flux_lm), {Mat3::Identity(), position_m}};
}

void spread_receivers(LitRoom& room, int count, const Vec3& corner_m, const Vec3& across_m, const Vec3& up_m,
                      const Vec3& normal, RoomDice& dice, const std::function<bool(const Vec3&)>& fits) {
  const double shape = across_m.norm() / up_m.norm();
  const int columns = std::clamp(static_cast<int>(std::lround(std::sqrt(count * shape))), 1, count);
  const int rows = (count + columns - 1) / columns;
  constexpr int kTries = 40;
  int placed = 0;
  // The last row is often not full. Further rounds replace the receivers of refused cells.
  for (int cell = 0; placed < count; ++cell) {
    LUXRIG_CHECK(cell < 100 * rows * columns, "no room for {} receivers of {}", count - placed, room.name);
    const int i = cell % columns, j = cell / columns % rows;
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const double u = (i + dice.between(0.1, 0.9)) / columns, v = (j + dice.between(0.1, 0.9)) / rows;
      const Vec3 position_m = corner_m + u * across_m + v * up_m;
      if (!fits(position_m)) continue;
      room.receivers.push_back({position_m, normal});
      ++placed;
      break;
    }
  }
}

}  // namespace luxrig
