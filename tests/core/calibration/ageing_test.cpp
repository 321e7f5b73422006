#include "core/calibration/ageing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace luxrig {
namespace {

Calibration calibration_of_outputs(const std::string& made, std::vector<Known> outputs) {
  Calibration calibration;
  calibration.made = made;
  for (std::size_t f = 0; f < outputs.size(); ++f) {
    CalibratedFixture lamp;
    lamp.name = "lamp " + std::to_string(f);
    lamp.output = outputs[f];
    calibration.fixtures.push_back(lamp);
  }
  return calibration;
}

TEST(Ageing, IsWhatALampLostSinceItWasFirstMeasured) {
  const Calibration first = calibration_of_outputs("2025-01-02T03:04:05Z", {{1.1, 0.011}, {0.9, 0.009}});
  Calibration second = calibration_of_outputs("2025-07-02T03:04:05Z", {{1.045, 0.011}, {0.9, 0.009}});
  keep_first_outputs(first, second);
  Calibration third = calibration_of_outputs("2026-01-02T03:04:05Z", {{0.99, 0.0099}, {0.873, 0.009}});
  keep_first_outputs(second, third);
  const auto lost = ageing_of(third.fixtures[0]);
  ASSERT_TRUE(lost);
  EXPECT_NEAR(lost->value, 0.9, 1e-12);
  EXPECT_NEAR(lost->standard_error, 0.9 * 0.01 * std::sqrt(2.0), 1e-12);
  EXPECT_EQ(ageing_words(third.fixtures[0]), "-10.0 ± 1.3 % since 2025-01-02");
  EXPECT_EQ(ageing_words(third.fixtures[1]), "-3.0 ± 1.4 % since 2025-01-02");
}

TEST(Ageing, IsUnknownOfALampThatWasMeasuredOnce) {
  const Calibration first = calibration_of_outputs("2025-01-02T03:04:05Z", {{1, 0}, {1, 0.01}});
  Calibration second = calibration_of_outputs("2025-07-02T03:04:05Z", {{0.9, 0.01}, {1, 0}, {1, 0.01}});
  keep_first_outputs(first, second);
  for (const CalibratedFixture& lamp : second.fixtures) {
    EXPECT_FALSE(ageing_of(lamp)) << lamp.name;
    EXPECT_EQ(ageing_words(lamp), "");
  }
  // What was known of the second is not lost by the time when no meter saw it.
  Calibration third = calibration_of_outputs("2026-01-02T03:04:05Z", {{0.9, 0.01}, {0.8, 0.01}});
  keep_first_outputs(second, third);
  ASSERT_TRUE(ageing_of(third.fixtures[1]));
  EXPECT_NEAR(ageing_of(third.fixtures[1])->value, 0.8, 1e-12);
}

TEST(Ageing, BeginsAnewWithANewLamp) {
  const Calibration first = calibration_of_outputs("2025-01-02T03:04:05Z", {{1, 0.01}});
  Calibration second = calibration_of_outputs("2025-07-02T03:04:05Z", {{0.8, 0.01}});
  keep_first_outputs(first, second);
  Calibration replaced = calibration_of_outputs("2025-08-02T03:04:05Z", {{1.02, 0.01}});
  keep_first_outputs(second, replaced);
  EXPECT_FALSE(ageing_of(replaced.fixtures[0])) << ageing_words(replaced.fixtures[0]);
  Calibration again = calibration_of_outputs("2026-08-02T03:04:05Z", {{0.97, 0.01}});
  keep_first_outputs(replaced, again);
  EXPECT_EQ(ageing_words(again.fixtures[0]).substr(0, 4), "-4.9");
  // Two errors more are noise, not a lamp.
  Calibration noisy = calibration_of_outputs("2026-09-02T03:04:05Z", {{0.99, 0.01}});
  keep_first_outputs(again, noisy);
  EXPECT_TRUE(ageing_of(noisy.fixtures[0]));
}

}  // namespace
}  // namespace luxrig
