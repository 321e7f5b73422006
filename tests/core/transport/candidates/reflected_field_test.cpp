#include "core/transport/candidates/reflected_field.h"

#include <gtest/gtest.h>

#include "core/transport/candidates/incremental_transport.h"
#include "tests/core/transport/candidates/box_rooms.h"
#include "tests/random.h"

namespace luxrig {
namespace {

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

// Against light worked out for that place by itself.
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
    if (!field.add(at_m, lux, nullptr)) continue;  // under the table, say
    ++told;
    const auto column = (*exact)->column({two.lumen.intensity, {Mat3::Identity(), at_m}});
    const Eigen::VectorXd reflected = column->total_lux - column->direct_lux;
    off += (lux - reflected).squaredNorm();
    all += reflected.squaredNorm();
  }
  EXPECT_GE(told, 17);
  EXPECT_LE(std::sqrt(off / all), 0.05);
}

// Nodes as fine as the places leave many of them without enough neighbours for a plane, in a narrow room most of all.
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

TEST(ReflectedField, SaysNothingBesideItsNodesAndOfNone) {
  const FieldOfTwoRooms two;
  Eigen::VectorXd lux = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(two.receivers.size()));
  EXPECT_FALSE(two.field(200).add({50, 50, 50}, lux, nullptr));
  EXPECT_FALSE(two.field(0).add({1, 1, 1.5}, lux, nullptr));
  EXPECT_EQ(lux.norm(), 0);
}

}  // namespace
}  // namespace luxrig
