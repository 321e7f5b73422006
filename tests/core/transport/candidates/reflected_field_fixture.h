#pragma once
/// Shared by the tests of reflected_field.

#include "core/transport/candidates/incremental_transport.h"
#include "core/transport/candidates/reflected/reflected_field.h"
#include "tests/core/transport/candidates/box_rooms.h"

namespace luxrig::reflected_field_fixture {

struct FieldOfTwoRooms {
  Scene scene = two_rooms(0.5, true);
  RayScene rays{scene};
  std::vector<Receiver> receivers;
  Emitter lumen{make_isotropic(1), {}};
  std::vector<Vec3> places_m;
  CandidateOptions options;

  FieldOfTwoRooms() {
    for (double x = 0.5; x < 8; x += 1)
      for (double y = 0.5; y < 3; y += 1)
        if (x < 3.9 || x > 4.3) receivers.push_back({{x, y, 0.001}, Vec3::UnitZ()});
    for (double x = 0.3; x < 8; x += 0.3)
      for (double y = 0.3; y < 3; y += 0.3)
        for (double z = 1; z < 2.4; z += 0.3) places_m.emplace_back(x, y, z);
    options.wanted_relative_error = 0.03;
    options.surface_cells = 4000;
  }
  [[nodiscard]] ReflectedField field(std::size_t nodes) const {
    return std::move(*ReflectedField::make(scene, rays, receivers, lumen, places_m, nodes, options));
  }
};

}  // namespace luxrig::reflected_field_fixture
