/// side_exchange: the same for any number of threads.
#include <gtest/gtest.h>

#include "tests/tools/bench/cache/side_exchange_fixture.h"
#include "tools/bench/cache/side_exchange.h"

namespace luxrig {
namespace {

using namespace side_exchange_fixture;

TEST(SideExchange, DoesNotDependOnTheNumberOfThreads) {
  const Exchange room(make_icosphere(1, 2, 0.7));
  const SideExchange one = room.make(true, 0, 1), many = room.make(true, 0, 4);
  ASSERT_EQ(one.rows(), many.rows());
  const auto n = static_cast<Eigen::Index>(one.rows());
  const Eigen::VectorXd first = Eigen::VectorXd::LinSpaced(n, 0, 1);
  EXPECT_EQ(one.later(first, 0), many.later(first, 0));
}

}  // namespace
}  // namespace luxrig
