#pragma once
/// Shared by the rooms: placing lamps and receivers.

#include <functional>
#include <random>

#include "tools/bench/rooms/lit_room.h"
#include "tools/bench/rooms/solid_model.h"

namespace luxrig {

/// Distance of receivers from their surface, more than the rounding of any surface.
inline constexpr double kOffSurface_m = 0.001;

/// Random numbers that are the same with every standard library.
class RoomDice {
 public:
  explicit RoomDice(std::uint64_t seed) : bits_(seed) {}
  [[nodiscard]] double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits_() >> 11) * 0x1p-53);
  }

 private:
  std::mt19937_64 bits_;
};

/// A lamp at one place whose beam (-Z) goes through another.
[[nodiscard]] Pose aimed(const Vec3& position_m, const Vec3& aim_m);

/// An isotropic lamp.
[[nodiscard]] Emitter bare_lamp(const Vec3& position_m, double flux_lm);

/// Adds `count` receivers on a jittered grid over the rectangle corner + [0,1] across + [0,1] up, with roughly square
/// cells. A place that `fits` refuses is drawn again in its cell. If all places of a cell are refused, its receiver
/// goes to the next cell.
void spread_receivers(LitRoom& room, int count, const Vec3& corner_m, const Vec3& across_m, const Vec3& up_m,
                      const Vec3& normal, RoomDice& dice, const std::function<bool(const Vec3&)>& fits);

}  // namespace luxrig
