#pragma once
/// Rooms built of boxes for tests: thick walls, a doorway, a table.

#include <array>
#include <cmath>
#include <vector>

#include "core/transport/candidates/candidate_transport.h"
#include "tests/core/transport/boxes.h"

namespace luxrig {

/// Two rooms of 4 × 3 × 2.5 m side by side along x, from (0, 0, 0). Between them stands a wall of 15 cm at x = 4. The
/// first room has a table. door: a gap of 0.9 × 2 m in that wall.
inline Scene two_rooms(double reflectance, bool door) {
  Scene scene;
  scene.materials = {{"wall", Vec3::Constant(reflectance)}, {"table", Vec3::Constant(0.3 * reflectance)}};
  scene.object_names = {"scene"};
  const double x = 8.15, y = 3, z = 2.5, t = 0.2, o = 0.05;
  add_box(scene, {-t, -t, -t}, {x + t, y + t, 0});
  add_box(scene, {-t, -t, z}, {x + t, y + t, z + t});
  add_box(scene, {-t, -t, -o}, {0, y + t, z + o});
  add_box(scene, {x, -t, -o}, {x + t, y + t, z + o});
  add_box(scene, {-o, -t, -o}, {x + o, 0, z + o});
  add_box(scene, {-o, y, -o}, {x + o, y + t, z + o});
  if (door) {
    add_box(scene, {4, -o, -o}, {4.15, 1, z + o});
    add_box(scene, {4, 1.9, -o}, {4.15, y + o, z + o});
    add_box(scene, {4, 0.95, 2}, {4.15, 1.95, z + o});
  } else {
    add_box(scene, {4, -o, -o}, {4.15, y + o, z + o});
  }
  add_box(scene, {1, 1, 0.7}, {2.4, 1.8, 0.75}, 1);
  return scene;
}

/// Points in both rooms: facing up at 0.9 m, on the floor, and on a wall.
inline std::vector<Receiver> receivers_in_two_rooms(int per_room) {
  std::vector<Receiver> receivers;
  for (const double from_x : {0.0, 4.15})
    for (int i = 0; i < per_room; ++i) {
      const double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0), v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
      switch (i % 3) {
        case 0:
          receivers.push_back({{from_x + 4 * u, 3 * v, 0.9}, Vec3::UnitZ()});
          break;
        case 1:
          receivers.push_back({{from_x + 4 * u, 3 * v, 0.001}, Vec3::UnitZ()});
          break;
        default:
          receivers.push_back({{from_x + 4 * u, 0.001, 2.5 * v}, Vec3::UnitY()});
      }
    }
  return receivers;
}

/// Lattice over both rooms and a little beyond, including the insides of walls and table.
inline std::vector<Vec3> lattice_m(double step_m) {
  std::vector<Vec3> positions_m;
  for (double z = -0.3 + 0.6 * step_m; z < 2.8; z += step_m)
    for (double y = -0.3 + 0.4 * step_m; y < 3.3; y += step_m)
      for (double x = -0.3 + 0.5 * step_m; x < 8.5; x += step_m) positions_m.push_back({x, y, z});
  return positions_m;
}

inline Emitter isotropic_luminaire(double flux_lm = 1000) { return {make_isotropic(flux_lm), {}}; }

inline Emitter spot_luminaire(const Vec3& aim, const Vec3& offset_m = Vec3::Zero()) {
  const Mat3 turned = shortest_rotation(-Vec3::UnitZ(), aim);
  return {make_spot(800, rad_from_deg(20), rad_from_deg(40)), {turned, offset_m}};
}

/// Column c of a matrix as a dense vector.
inline std::vector<float> dense_column(const CandidateColumns& matrix, std::size_t c, const std::vector<float>& part,
                                       std::size_t receivers) {
  std::vector<float> column(receivers, 0.0f);
  for (auto i = matrix.begin[c]; i < matrix.begin[c + 1]; ++i) column[matrix.receiver[i]] = part[i];
  return column;
}

}  // namespace luxrig
