#pragma once
/// Where photographers put a light for a known effect, as directions from the object.
///
///   set-up     aside of the camera   above the level
///   loop       30…45°                10…35°              slightly above the eyes [1]
///   rembrandt  30…60°                30…60°              45° and 45° [1]
///   split      80…100°               -15…30°             the 90° axis [2]
///   broad      30…60°                10…50°              from the side that lights more of what is seen [3]
///   raking     5…15° off the surface, from any side      inscriptions, paint
///   copy       45° ± 5° off the surface's normal, within 20° of the picture's rows; two lights, from either side
///   rim        100…180° from the camera's own direction  from behind, as a kicker
///
/// The middles are the sources'; how far a light may be off is ours. Aside of the camera is around the vertical.
/// [1] silverlog.app/encyclopaedia/techniques/lighting-patterns
/// [2] fotoforum.larmonstudios.com/portrait-light-patterns
/// [3] D. Stabley, Master your lighting setup, NM CliQ Magazine, June 2015, p. 61

#include <optional>
#include <string>

#include "core/highlight/seen/seen_contrast.h"
#include "core/rig/brief.h"

namespace luxrig {

/// What directions are measured from. Unit vectors.
struct SetUpFrame {
  Vec3 to_camera = -Vec3::UnitY();
  Vec3 right = Vec3::UnitX();     ///< of the picture
  Vec3 surface = -Vec3::UnitY();  ///< mean normal of what is seen
  int broad_side = 0;  ///< 1: lights from the right light more of what is seen; -1: from the left; 0: neither
};

/// seen   by one camera at eye_world_m
[[nodiscard]] SetUpFrame set_up_frame(const SeenContrast& seen, const Vec3& middle_world_m, const Vec3& eye_world_m);

/// Directions in which lights may stand.
class LightWindow {
 public:
  LightWindow(SetUp set_up, LightRole role, const SetUpFrame& frame) : set_up_(set_up), role_(role), frame_(frame) {}

  /// Neither set-up nor role asks for a direction.
  [[nodiscard]] bool open() const { return set_up_ == SetUp::none && role_ != LightRole::rim; }
  /// towards   from the object to the light, of any length but 0
  [[nodiscard]] bool has(const Vec3& towards) const;
  /// Lights of a set-up: two for copy, else one; none = any number.
  [[nodiscard]] std::optional<int> lights() const;
  /// 1 on the picture's right, -1 on its left.
  [[nodiscard]] int side_of(const Vec3& towards) const { return towards.dot(frame_.right) < 0 ? -1 : 1; }
  /// In the middle of it, on that side. Unit.
  [[nodiscard]] Vec3 middle(int side) const;
  /// As in: set_up "loop" wants its light 30 to 45° aside of the camera and 10 to 35° above the level.
  [[nodiscard]] std::string words() const;

 private:
  SetUp set_up_;
  LightRole role_;
  SetUpFrame frame_;
};

/// Where a light stands beside the camera.
struct AsideAbove {
  double aside_rad = 0;  ///< 0…π, between the level directions to the camera and to the light
  double above_rad = 0;  ///< above the horizontal
};
[[nodiscard]] AsideAbove aside_above(const SetUpFrame& frame, const Vec3& towards);

}  // namespace luxrig
