#include "core/transport/candidates/reflected/reflected_field.h"

#include <gtest/gtest.h>

#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/core/transport/candidates/reflected_field_fixture.h"

namespace luxrig {
namespace {

using namespace reflected_field_fixture;

// If nodes are as dense as the places, many have too few neighbours to fit a plane, most of all in a narrow room.
TEST(ReflectedField, LeavesNoPlaceWithoutReflectedLight) {
  FieldOfTwoRooms two;
  two.options.wanted_relative_error = 0.2;
  two.options.surface_cells = 600;
  for (const std::size_t nodes : {100u, 4000u}) {
    const ReflectedField field = two.field(nodes);
    int told = 0;
    for (const Vec3& at_m : two.places_m) {
      Eigen::VectorXd lux = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(two.receivers.size()));
      if (!field.add(at_m, lux, nullptr)) continue;  // in the wall, or under the table
      EXPECT_GT(lux.sum(), 0) << at_m.transpose();
      ++told;
    }
    EXPECT_GT(told, 0.9 * static_cast<double>(two.places_m.size())) << nodes;
  }
}

}  // namespace
}  // namespace luxrig
