#include "tools/bench/buses/frame_intervals.h"

#include <gtest/gtest.h>

#include <memory>

namespace luxrig {
namespace {

TEST(TimeCounts, QuantilesAreAccurateToAMicrosecond) {
  const auto counts = std::make_unique<TimeCounts>();
  EXPECT_EQ(counts->quantile(0.5), 0);
  for (int i = 1; i <= 1000; ++i) counts->add(i * 1e-6);
  EXPECT_EQ(counts->count(), 1000u);
  EXPECT_NEAR(counts->quantile(0.5), 500e-6, 1.1e-6);
  EXPECT_NEAR(counts->quantile(0.99), 990e-6, 1.1e-6);
  EXPECT_NEAR(counts->quantile(1), 1000e-6, 1e-12);
  counts->add(3);
  EXPECT_EQ(counts->largest(), 3);
  EXPECT_EQ(counts->quantile(1), 3);
}

TEST(TimeCounts, HistogramCountsEachTimeOnce) {
  const auto counts = std::make_unique<TimeCounts>();
  for (const double s : {10e-6, 50e-6, 51e-6, 0.0015, 0.06, 2.0}) counts->add(s);
  const std::string text = counts->histogram();
  EXPECT_NE(text.find("<=     50 us        2  33.33 %"), std::string::npos) << text;
  EXPECT_NE(text.find("<=    100 us        1"), std::string::npos) << text;
  EXPECT_NE(text.find("<=   2000 us        1"), std::string::npos) << text;
  EXPECT_NE(text.find(">   50000 us        2"), std::string::npos) << text;
}

}  // namespace
}  // namespace luxrig
