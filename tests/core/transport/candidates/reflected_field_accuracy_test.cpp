/// reflected_field: accuracy over many samples.
#include <gtest/gtest.h>

#include "core/transport/candidates/incremental_transport.h"
#include "core/transport/candidates/reflected/reflected_field.h"
#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/core/transport/candidates/reflected_field_fixture.h"
#include "tests/random.h"

namespace luxrig {
namespace {

using namespace reflected_field_fixture;

// Compared with light computed at that place alone.
TEST(ReflectedField, AgreesWithRaysFromThePlaceItself) {
  const FieldOfTwoRooms two;
  const ReflectedField field = two.field(400);
  EXPECT_LE(field.nodes(), 400u);
  EXPECT_GE(field.nodes(), 100u);
  IncrementalOptions incremental;
  incremental.rays_per_cell = 96;
  const auto exact = IncrementalTransport::make(two.scene, two.rays, two.receivers, incremental);
  Random random(4);
  double off = 0, all = 0;
  int told = 0;
  for (int trial = 0; trial < 25; ++trial) {
    const Vec3 at_m(random.between(0.5, 3.5), random.between(0.5, 2.5), random.between(1.2, 2.2));
    Eigen::VectorXd lux = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(two.receivers.size()));
    if (!field.add(at_m, lux, nullptr)) continue;  // e.g. under the table
    ++told;
    const auto column = (*exact)->column({two.lumen.intensity, {Mat3::Identity(), at_m}});
    const Eigen::VectorXd reflected = column->total_lux - column->direct_lux;
    off += (lux - reflected).squaredNorm();
    all += reflected.squaredNorm();
  }
  EXPECT_GE(told, 17);
  EXPECT_LE(std::sqrt(off / all), 0.05);
}

TEST(ReflectedField, AddsNothingAwayFromItsNodesOrWithoutAny) {
  const FieldOfTwoRooms two;
  Eigen::VectorXd lux = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(two.receivers.size()));
  EXPECT_FALSE(two.field(200).add({50, 50, 50}, lux, nullptr));
  EXPECT_FALSE(two.field(0).add({1, 1, 1.5}, lux, nullptr));
  EXPECT_EQ(lux.norm(), 0);
}

}  // namespace
}  // namespace luxrig
