#include "tools/bench/cache/side_exchange.h"

#include <gtest/gtest.h>

#include "tests/tools/bench/cache/cache_rooms.h"
#include "tests/tools/bench/cache/side_exchange_fixture.h"

namespace luxrig {
namespace {

using namespace side_exchange_fixture;

TEST(SideExchange, EachReflectionKeepsItsShareInAClosedRoom) {
  for (const double reflectance : {0.3, 0.9}) {
    const Exchange room(make_cube(2, reflectance));
    const SideExchange exchange = room.make(true, 0);
    const auto n = static_cast<Eigen::Index>(exchange.rows());
    const Eigen::VectorXd later = exchange.later(Eigen::VectorXd::Ones(n), 0);
    const double expected = reflectance / (1 - reflectance);
    EXPECT_LT((later.array() - expected).abs().maxCoeff(), 1e-3 * expected + 1e-6);
    for (const int reflections : {1, 2, 4}) {
      double sum = 0;
      for (int i = 1; i < reflections; ++i) sum += std::pow(reflectance, i);
      const SideExchange few = room.make(true, reflections);
      const Eigen::VectorXd got = few.later(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(few.rows())), 0);
      EXPECT_NEAR(got.maxCoeff(), sum, 1e-6);
      EXPECT_NEAR(got.minCoeff(), sum, 1e-6);
    }
  }
}

TEST(SideExchange, SolvingAheadMatchesReflectionByReflection) {
  const Exchange room(make_cube(2, 0.8));
  for (const int reflections : {0, 1, 3}) {
    const SideExchange exchange = room.make(true, reflections);
    const auto n = static_cast<Eigen::Index>(exchange.rows());
    std::srand(1);
    const Eigen::MatrixXf reads = Eigen::MatrixXf::Random(5, n).cwiseAbs();
    const Eigen::VectorXd first = Eigen::VectorXd::Random(n).cwiseAbs();
    const Eigen::VectorXd ahead = (exchange.reads_of_later(reads, 0) * first.cast<float>()).cast<double>();
    const Eigen::VectorXd followed = reads.cast<double>() * exchange.later(first, 0);
    EXPECT_LT((ahead - followed).norm(), 1e-4 * followed.norm() + 1e-12);
  }
}

TEST(SideExchange, UnseenSidesHaveNoRowsAndNoRays) {
  const Exchange room(make_cube(2, 0.5));
  const SideExchange needed = room.make(true, 0), all = room.make(false, 0);
  EXPECT_EQ(needed.rows() * 2, all.rows());  // the outer faces are left out
  EXPECT_LT(needed.rays(), 0.6 * static_cast<double>(all.rays()));
  for (std::size_t group = 0; group < room.sides.groups(); ++group)
    EXPECT_EQ(needed.row_of_group(group) != SurfaceSides::kNone, room.seen[group]) << group;
  EXPECT_EQ(room.make(true, 1).rays(), 0u) << "one reflection needs no exchange";
}

}  // namespace
}  // namespace luxrig
