#include "tools/luxrigd/api/login_limits.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

using namespace std::chrono_literals;

TEST(LoginLimits, AnAddressWaitsTwiceAsLongAfterEachWrongAttempt) {
  LoginLimits limits;
  auto now = LoginLimits::Clock::time_point{};
  for (int i = 0; i < 5; ++i) EXPECT_EQ(limits.attempt("a" + std::to_string(i), "10.0.0.7", now), 0) << i;
  for (const int wait_s : {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 900, 900}) {
    EXPECT_EQ(limits.attempt("b", "10.0.0.7", now), wait_s);
    EXPECT_EQ(limits.attempt("b", "10.0.0.7", now), wait_s) << "a refused one does not count";
    EXPECT_EQ(limits.attempt("c" + std::to_string(wait_s), "10.0.0.8", now), 0) << "another address need not wait";
    limits.right("c" + std::to_string(wait_s), "10.0.0.8");
    now += std::chrono::seconds(wait_s);
    EXPECT_EQ(limits.attempt("b" + std::to_string(wait_s), "10.0.0.7", now), 0);
  }
  EXPECT_EQ(limits.attempt("b", "10.0.0.7", now + 3601s), 0) << "forgotten after an hour";
}

TEST(LoginLimits, AnAccountIsSlowFromEverywhereButNeverLockedForLong) {
  LoginLimits limits;
  auto now = LoginLimits::Clock::time_point{};
  int attempts = 0;
  for (int second = 0; second < 3600; ++second, now += 1s)
    if (limits.attempt("anna", "10.0.0." + std::to_string(second % 250) + std::to_string(second), now) == 0) ++attempts;
  EXPECT_GT(attempts, 60);
  EXPECT_LT(attempts, 80) << "from a thousand addresses: one a minute";
  EXPECT_LE(limits.attempt("anna", "192.168.1.1", now), 60);
}

TEST(LoginLimits, AttemptsAtTheSameTimeDoNotPassTogether) {
  LoginLimits limits;
  const LoginLimits::Clock::time_point now{};
  int passed = 0;
  for (int i = 0; i < 100; ++i) passed += limits.attempt("anna", "10.0.0.7", now) == 0 ? 1 : 0;
  EXPECT_EQ(passed, 5);
}

TEST(LoginLimits, WhoHasAnAccountCannotTryThoseOfOthersBetweenItsOwnLogins) {
  LoginLimits limits;
  auto now = LoginLimits::Clock::time_point{};
  int passed = 0;
  for (int second = 0; second < 600; ++second, now += 1s) {
    if (limits.attempt("otto", "10.0.0.7", now) == 0) limits.right("otto", "10.0.0.7");
    if (limits.attempt("victim" + std::to_string(second), "10.0.0.7", now) == 0) ++passed;
  }
  EXPECT_LT(passed, 20);
}

TEST(LoginLimits, MadeUpNamesDoNotMakeItForgetAnAccount) {
  LoginLimits limits;
  const LoginLimits::Clock::time_point now{};
  for (int i = 0; i < 15; ++i) (void)limits.attempt("anna", "10.0.1." + std::to_string(i), now);
  for (int i = 0; i < 5000; ++i) (void)limits.attempt("x" + std::to_string(i), "10.0.0.7", now);
  EXPECT_GT(limits.attempt("anna", "10.0.0.9", now), 0);
}

TEST(LoginLimits, AnIPv6NeighbourIsOneAddressHoweverManyItUses) {
  EXPECT_EQ(address_for_limits("2001:db8:1:2:3:4:5:6"), address_for_limits("2001:db8:1:2::1"));
  EXPECT_NE(address_for_limits("2001:db8:1:2::1"), address_for_limits("2001:db8:1:3::1"));
  EXPECT_NE(address_for_limits("10.0.0.7"), address_for_limits("10.0.0.8"));
}

}  // namespace
}  // namespace luxrig
