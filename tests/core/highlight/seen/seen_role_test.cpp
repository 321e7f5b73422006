#include "core/highlight/seen/seen_role.h"

#include <gtest/gtest.h>

#include <cmath>

namespace luxrig {
namespace {

/// The first two of four places are wanted, the last two spared.
SeenRole role_of_two() {
  SeenRole role;
  role.wanted = {0.5f, 0.5f, 0, 0};
  role.spared = {0, 0, 0.5f, 0.5f};
  role.max_spill = 0.1;
  return role;
}

TEST(SeenRole, CountsItsOwnLightOnly) {
  const std::vector<float> fixed = {10, 20, 30, 40}, lux = {110, 120, 35, 45};
  const RoleScore score = score_role(role_of_two(), lux, fixed, 0, 7);
  EXPECT_NEAR(score.wanted_lx, 100, 1e-4);
  EXPECT_NEAR(score.spared_lx, 5, 1e-4);
  EXPECT_NEAR(score.objective, 7, 1e-6);  // 5 % spill are allowed
}

TEST(SeenRole, SpillBeyondItsBudgetCosts) {
  const std::vector<float> lux = {100, 100, 30, 30};
  EXPECT_NEAR(score_role(role_of_two(), lux, {}, 0, 7).objective, 7 - kSpilt * 0.2, 1e-6);
  // Light that misses what is wanted is worst.
  EXPECT_LT(score_role(role_of_two(), std::vector<float>{0, 0, 30, 30}, {}, 0, 7).objective, 0);
}

TEST(SeenRole, EveryHalvingBelowItsLuxCosts) {
  SeenRole role = role_of_two();
  role.spared.clear();
  role.wanted_lx = 80;
  const auto objective = [&](float lx) {
    return score_role(role, std::vector{lx, lx, 0.0f, 0.0f}, {}, 0, 7).objective;
  };
  EXPECT_NEAR(objective(80), 7, 1e-6);
  EXPECT_NEAR(objective(20), 7 - 2 * kShortOfRatio, 1e-6);
  EXPECT_LT(objective(0), 0);
}

// Of lux a and b with the mean m: (a / (a + m) + b / (b + m)), 1 if they are the same.
TEST(SeenRole, EvennessAsInClosedForm) {
  SeenRole role = role_of_two();
  role.evenly = true;
  const auto even = [&](float a, float b, double darkest_lx) {
    return score_role(role, std::vector{a, b, 0.0f, 0.0f}, {}, darkest_lx, 7).even;
  };
  EXPECT_NEAR(even(50, 50, 0), 1, 1e-6);
  EXPECT_NEAR(even(500, 500, 0), 1, 1e-6);
  EXPECT_NEAR(even(100, 0, 0), 100.0 / 150, 1e-6);
  EXPECT_NEAR(even(90, 30, 0), 90.0 / 150 + 30.0 / 90, 1e-6);
  EXPECT_NEAR(even(1, 1, 99), 2 * 0.01, 1e-6);  // an eye does not adapt to that
}

}  // namespace
}  // namespace luxrig
