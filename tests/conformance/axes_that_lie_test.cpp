// Axes that report wrong things about themselves, and where the simulated joints truly go.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/conformance/axes_bench.h"

namespace luxrig {
namespace {

constexpr std::uint32_t kPanStatus = 0x185, kPanAnswer = 0x585;

void put_position(can::CanFrame& frame, std::size_t at, std::int32_t counts) {
  for (std::size_t i = 0; i < 4; ++i) frame.data[at + i] = static_cast<std::uint8_t>(counts >> (8 * i));
}

std::int32_t position_in(const can::CanFrame& frame, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(frame.data[at + i]) << (8 * i);
  return static_cast<std::int32_t>(value);
}

/// The head at rest at (20, 10), then under way to (140, -80) at full speed.
struct UnderWay : AxesBench {
  explicit UnderWay(Rig the_rig = rig_of_axes()) : AxesBench(std::move(the_rig)) {
    aim = deg(20, 10);
    EXPECT_TRUE(arrive());
    path.clear();
    aim = deg(140, -80);
    run(1);
    EXPECT_GT(std::abs(pan().speed_deg_s()), 30);
  }
  /// Largest distance of the joints beyond their path [deg].
  [[nodiscard]] double past_the_way_deg() const {
    double worst = 0;
    for (const Joints& at : path) {
      const double pan_deg = deg_from_rad(at.pan_rad), tilt_deg = deg_from_rad(at.tilt_rad);
      worst = std::max({worst, 20 - pan_deg, pan_deg - 140, -80 - tilt_deg, tilt_deg - 10});
    }
    return worst;
  }
};

TEST(AxesThatLie, AWrongStatuswordNeverCutsTheTorqueOfAMovingAxis) {
  // Switch on disabled, ready, switched on, fault, fault reaction, not ready: each needs another control word to go on.
  for (const int word : {0x0250, 0x0231, 0x0233, 0x0208, 0x020F, 0x0200}) {
    UnderWay bench;
    bench.run(0.2);  // so near the end that its momentum would carry it beyond
    bench.lie = [word](can::CanFrame& frame) {
      if (frame.id != kPanStatus) return;
      frame.data[0] = static_cast<std::uint8_t>(word);
      frame.data[1] = static_cast<std::uint8_t>(word >> 8);
    };
    bench.run(0.2);
    EXPECT_EQ(bench.health(1).life, Life::faulted) << word;
    bench.run(2.5);
    EXPECT_LT(bench.past_the_way_deg(), 0.1) << word;
    bench.lie = nullptr;
    EXPECT_TRUE(bench.arrive(10)) << word << ": " << bench.health(1).detail;
    EXPECT_LT(bench.past_the_way_deg(), 0.1) << word;
    EXPECT_TRUE(bench.pan().homed()) << word << ": its position held";
  }
}

TEST(AxesThatLie, AnImpossiblePositionStopsTheHeadAndIsReadAgain) {
  UnderWay bench;
  bench.lie = [](can::CanFrame& frame) {
    if (frame.id == kPanStatus) frame.data[5] ^= 0x10;
  };
  const Time began = bench.now;
  ASSERT_TRUE(bench.run_until(1, [&] { return bench.health(1).life == Life::faulted; }));
  EXPECT_LE(bench.now - began, std::chrono::milliseconds(100));
  EXPECT_NE(bench.health(1).detail.find("is stopped, as it says what cannot be: its position went from"),
            std::string::npos)
      << bench.health(1).detail;
  bench.run(1);
  EXPECT_EQ(bench.pan().speed_deg_s(), 0);
  EXPECT_EQ(bench.tilt().speed_deg_s(), 0);
  // From now on its position never changes. Only the other way to read the position shows that it is wrong.
  const Time still = bench.now;
  bench.run(3);
  EXPECT_LT(bench.moved_at, still);
  EXPECT_NE(bench.health(1).detail.find("what cannot be"), std::string::npos) << bench.health(1).detail;
  bench.lie = nullptr;
  ASSERT_TRUE(bench.arrive(6)) << bench.health(1).detail;
  EXPECT_LT(bench.past_the_way_deg(), 0.1) << "no way to a switch";
}

TEST(AxesThatLie, AnEncoderThatLostItsCountIsHomedAgain) {
  UnderWay bench;
  // Both ways agree on a position that the axis cannot have reached: the count has jumped.
  bool searched = false;
  bench.lie = [&](can::CanFrame& frame) {
    if (bench.pan().mode_display() == 6) searched = true;
    if (searched) return;
    constexpr std::int32_t kJump = 60 * 500;
    if (frame.id == kPanStatus) put_position(frame, 2, position_in(frame, 2) + kJump);
    if (frame.id == kPanAnswer && frame.data[1] == 0x64 && frame.data[2] == 0x60)
      put_position(frame, 4, position_in(frame, 4) + kJump);
  };
  ASSERT_TRUE(bench.run_until(4, [&] { return searched; })) << bench.health(1).detail;
  EXPECT_LT(bench.past_the_way_deg(), 0.1) << "until it looks for its home";
  EXPECT_TRUE(bench.arrive(60)) << bench.health(1).detail;
}

TEST(AxesThatLie, AnEncoderThatLostItsCountNeedsAPersonIfHomingIsForbidden) {
  AxesBench bench(rig_of_axes({{"home", std::string("never")}}));
  bench.aim = AxesBench::deg(5, 5);
  bench.run(4);
  bench.lie = [](can::CanFrame& frame) {
    if (frame.id == kPanStatus) put_position(frame, 2, position_in(frame, 2) + 20000);
    if (frame.id == kPanAnswer && frame.data[1] == 0x64 && frame.data[2] == 0x60)
      put_position(frame, 4, position_in(frame, 4) + 20000);
  };
  ASSERT_TRUE(bench.run_until(4, [&] {
    return bench.health(1).detail.find("look at its encoder") != std::string::npos;
  })) << bench.health(1).detail;
  const Time still = bench.now;
  bench.run(10);
  EXPECT_LT(bench.moved_at, still);
}

TEST(AxesThatLie, ATargetThatReadsBackDifferentlyStopsTheHead) {
  AxesBench bench;
  bench.aim = AxesBench::deg(20, 10);
  ASSERT_TRUE(bench.arrive());
  bench.run(1);
  bench.lie = [](can::CanFrame& frame) {
    if (frame.id == kPanAnswer && frame.data[1] == 0x7A && frame.data[2] == 0x60) frame.data[5] ^= 0x20;
  };
  bench.aim = AxesBench::deg(140, -80);
  const Time asked = bench.now;
  ASSERT_TRUE(bench.run_until(2, [&] { return bench.health(1).life == Life::faulted; }));
  EXPECT_LT(bench.now - asked, std::chrono::milliseconds(250));
  EXPECT_NE(bench.health(1).detail.find("its target was set to 157500 counts and is another"), std::string::npos)
      << bench.health(1).detail;
  bench.lie = nullptr;
  EXPECT_TRUE(bench.arrive(6)) << bench.health(1).detail;
}

TEST(AxesThatLie, HomeIsAcceptedOnlyAfterThreeReports) {
  AxesBench bench;
  bench.aim = AxesBench::deg(20, 10);
  ASSERT_TRUE(bench.run_until(10, [&] { return bench.pan().mode_display() == 6 && bench.pan().speed_deg_s() != 0; }));
  int status = 0;
  bench.lie = [&](can::CanFrame& frame) {
    if (frame.id == kPanStatus && ++status % 3 != 0) frame.data[1] |= 0x14;  // target reached, two times of three
  };
  bench.run(1);
  bench.lie = nullptr;
  EXPECT_NE(bench.health(1).detail.find("on its way to its home position"), std::string::npos)
      << bench.health(1).detail;
  ASSERT_TRUE(bench.arrive(60));
  EXPECT_TRUE(bench.pan().homed());
}

TEST(AxesThatLie, HomeIsAcceptedOnlyAtCountZero) {
  AxesBench bench;
  bench.aim = AxesBench::deg(20, 10);
  bench.lie = [&](can::CanFrame& frame) {  // always at home, but 10 degrees off
    if (frame.id != kPanStatus || bench.pan().mode_display() != 6) return;
    frame.data[1] |= 0x14;
    put_position(frame, 2, 5000);
  };
  ASSERT_TRUE(bench.run_until(20, [&] { return bench.health(1).detail.find("where home is 0") != std::string::npos; }))
      << bench.health(1).detail;
  EXPECT_FALSE(bench.result);
}

TEST(AxesThatLie, FalseReportsNeverTakeTheJointsOffTheirPath) {
  std::mt19937 random(7);
  const auto draw = [&](int most) { return std::uniform_int_distribution<int>(0, most)(random); };
  for (int i = 0; i < 60; ++i) {
    UnderWay bench;
    const double seconds = 0.01 * draw(60);
    bench.run(seconds);
    const int share = 1 + draw(99);
    bool looks_for_home = false;
    bench.lie = [&](can::CanFrame& frame) {
      if ((frame.id & 0x7F) != 5 || draw(99) >= share || frame.size == 0) return;
      frame.data[static_cast<std::size_t>(draw(frame.size - 1))] ^= static_cast<std::uint8_t>(1 + draw(254));
    };
    bench.each_cycle = [&] {
      looks_for_home = looks_for_home || bench.pan().mode_display() == 6 || !bench.pan().homed();
      if (!looks_for_home) {
        ASSERT_LT(bench.past_the_way_deg(), 0.5) << i << " at " << bench.path.size();
      }
      bench.path.clear();
    };
    bench.run(2);
    bench.lie = nullptr;
    EXPECT_TRUE(bench.arrive(90)) << i << ": " << bench.health(1).detail;
  }
}

}  // namespace
}  // namespace luxrig
