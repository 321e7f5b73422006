/// error_bound: the same for any number of threads.
#include <gtest/gtest.h>

#include "core/solve/bounds/error_bound.h"
#include "tests/core/solve/bounds/error_bound_fixture.h"

namespace luxrig {
namespace {

using namespace error_bound_fixture;

TEST(ErrorBoundsByCount, AreTheSameForAnyNumberOfThreads) {
  const TinyLights tiny(17);
  std::vector<std::vector<double>> all;
  for (const int threads : {1, 2, 5}) {
    CountBoundOptions options;
    options.max_lights = 4;
    options.threads = threads;
    all.push_back(error_bounds_by_count(tiny.candidates(), options));
  }
  EXPECT_EQ(all[0], all[1]);
  EXPECT_EQ(all[0], all[2]);
}

}  // namespace
}  // namespace luxrig
