#include "tools/luxrigd/lateness.h"

#include <gtest/gtest.h>

#include "tests/core/output/at.h"

namespace luxrig {
namespace {

TEST(Lateness, IgnoresAThreadThatWakesInTime) {
  Lateness lateness;
  for (int i = 0; i < 100; ++i) lateness.record(at(i), at(i + 0.1));
  EXPECT_FALSE(lateness.spell(at(100)));
}

TEST(Lateness, KeepsTheWorstOfASpellForAMinuteAfterItsEnd) {
  Lateness lateness;
  lateness.record(at(10), at(10.4));
  lateness.record(at(20), at(22));
  lateness.record(at(30), at(30.3));
  const auto spell = lateness.spell(at(90));
  ASSERT_TRUE(spell);
  EXPECT_EQ(spell->since, at(10.4));
  EXPECT_EQ(spell->most, from_seconds(2));
  EXPECT_FALSE(lateness.spell(at(90.4)));
}

}  // namespace
}  // namespace luxrig
