#pragma once
/// Emitters made ready for many questions "what reaches this point directly?".

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/evaluator.h"

namespace luxrig {

/// Keeps pointers into the emitters' distributions: the emitters must outlive it.
class Lamps {
 public:
  explicit Lamps(std::span<const Emitter> emitters);

  /// Direct illuminance [lx at level 1] at a surface point from each emitter that lights it,
  ///   E = I(ω) cosθ V / d²   (photometric distance law)
  ///
  /// scene         what can stand in between; null = nothing can, and no ray is cast
  /// normal_world  unit, on the lit side
  /// lit           called as lit(emitter index, lux > 0), once per emitter that contributes
  /// returns       shadow rays cast: one per distinct lamp position from which something could come; none for lamps
  ///               behind the surface, whose cone misses the point, or without intensity towards it
  template <class Lit>
  std::uint64_t light(const RayScene* scene, const Vec3& position_world_m, const Vec3& normal_world, Lit&& lit) const {
    std::uint64_t rays = 0;
    for (const Group& group : groups_) {
      const Vec3 towards_m = group.position_world_m - position_world_m;
      const double height_m = normal_world.dot(towards_m);
      if (!(height_m > 0)) continue;
      const double distance_squared_m2 = towards_m.squaredNorm();
      const double per_distance = 1 / std::sqrt(distance_squared_m2);
      const Vec3 direction_world = towards_m * per_distance;
      const double lux_per_candela = height_m * per_distance / distance_squared_m2;
      if (!std::isfinite(lux_per_candela)) continue;
      bool sees = scene == nullptr;
      for (std::size_t i = group.begin; i < group.end; ++i) {
        const Lamp& lamp = lamps_[i];
        if (-lamp.axis_world.dot(direction_world) < lamp.cos_half_cone) continue;
        const double lux = lux_per_candela * lamp.intensity->intensity_cd(-(lamp.lamp_from_world * direction_world));
        if (!(lux > 0)) continue;
        if (!sees) {
          ++rays;
          if (scene->occluded(position_world_m, normal_world, group.position_world_m)) break;
          sees = true;
        }
        lit(lamp.emitter, lux);
      }
    }
    return rays;
  }

 private:
  struct Lamp {
    std::size_t emitter;
    Vec3 axis_world;  ///< -Z of the lamp
    double cos_half_cone;
    Mat3 lamp_from_world;
    const IntensityDistribution* intensity;
  };
  /// Lamps in one place, such as the candidate aims of one head: they see the same.
  struct Group {
    Vec3 position_world_m;
    std::size_t begin, end;  ///< into lamps_
  };
  std::vector<Lamp> lamps_;
  std::vector<Group> groups_;
};

/// Refuses what evaluators cannot work on, naming receiver or emitter and the figure: not finite, a normal or
/// rotation that is not unit, no distribution, levels of the wrong number or sign, and an emitter in a receiver.
[[nodiscard]] Result<void> check_evaluation(std::span<const Receiver> receivers, std::span<const Emitter> emitters,
                                            const EvaluateOptions& options);

/// Smallest distance [m] at which two points are told apart well enough for 1/d²: coordinates of size M are rounded
/// to M·2⁻⁵³, which at this distance changes the illuminance by one part in a million.
[[nodiscard]] double smallest_distance_m(const Vec3& a_world_m, const Vec3& b_world_m);

}  // namespace luxrig
