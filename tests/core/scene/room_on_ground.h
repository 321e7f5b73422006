#pragma once
/// A room on ground of any size, anywhere: neither should affect results in the room.

#include "core/rig/rig.h"

namespace luxrig {

/// A rig of boxes about `at`: a room of 6 x 5 x 3 m on a ground of any size with its middle `aside`, a lamp under the
/// ceiling with a sheet hung below it, and a point on the floor.
inline Rig room_on_ground(double ground_m, const Vec3& aside_m, const Vec3& at_m, double sheet_below_lamp_m) {
  Rig rig;
  const auto add = [&](const char* name, const Vec3& size_m, const Vec3& position_m) {
    SceneObject object;
    object.name = name;
    object.box_m = size_m;
    object.position_world_m = at_m + position_m;
    rig.scene.objects.push_back(object);
  };
  add("ground", {ground_m, ground_m, 1}, aside_m - Vec3(0, 0, 1));
  add("west", {0.1, 5, 3}, {-3.05, 0, 0});
  add("east", {0.1, 5, 3}, {3.05, 0, 0});
  add("south", {6.2, 0.1, 3}, {0, -2.55, 0});
  add("north", {6.2, 0.1, 3}, {0, 2.55, 0});
  add("ceiling", {6.2, 5.2, 0.1}, {0, 0, 3});
  add("sheet", {0.3, 0.3, 0.0001}, {0, 0, 2.8 - sheet_below_lamp_m});
  rig.luminaires.resize(1);
  rig.luminaires.front().intensity = make_isotropic(3000);
  rig.fixtures.resize(1);
  rig.fixtures.front().world_from_mount.translation_m = at_m + Vec3(0, 0, 2.8);
  rig.points.resize(1);
  rig.points.front().position_world_m = at_m + Vec3(0.2, 0.1, 0);
  return rig;
}

}  // namespace luxrig
