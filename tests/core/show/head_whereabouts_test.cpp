/// Possible positions of a head: a head with the stated speed and delay is never outside them.
#include "core/show/head_whereabouts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "core/output/head_move.h"
#include "core/output/trapezoid.h"
#include "tests/core/output/at.h"
#include "tests/random.h"

namespace luxrig {
namespace {

Fixture some_head() {
  Fixture head;
  head.moves = true;
  head.range = {-4, 4, -2, 2};
  head.pan_speed_rad_s = 2;
  head.tilt_speed_rad_s = 1;
  head.zoom_speed_rad_s = 1;
  return head;
}

bool holds(const JointBox& box, const Joints& at) {
  constexpr double kRounding = 1e-9;
  return at.pan_rad >= box.least.pan_rad - kRounding && at.pan_rad <= box.most.pan_rad + kRounding &&
         at.tilt_rad >= box.least.tilt_rad - kRounding && at.tilt_rad <= box.most.tilt_rad + kRounding;
}

TEST(HeadWhereabouts, StartsUnknownAndSettlesOnceTheLongestMoveIsOver) {
  HeadWhereabouts where(some_head());
  EXPECT_EQ(where.box().least.pan_rad, -4);
  EXPECT_EQ(where.box().most.tilt_rad, 2);
  const Joints told{1, 0.5, 0};
  // The longest move: 5 rad of pan at 2 rad/s, 2.5 rad of tilt at 1 rad/s, plus half a second.
  double arrived_s = -1;
  for (int i = 0; i <= 400 && arrived_s < 0; ++i) {
    where.step(at(0.02 * i), JointBox::at(told), true);
    if (where.box() == JointBox::at(told)) arrived_s = 0.02 * i;
  }
  EXPECT_NEAR(arrived_s, 3.0, 0.03);
}

TEST(HeadWhereabouts, WaitsLongerForAHeadThatWasFoundToNeedLonger) {
  Fixture slow = some_head();
  slow.settles_s = 1.2;
  HeadWhereabouts where(slow);
  const Joints told{1, 0.5, 0};
  double arrived_s = -1;
  for (int i = 0; i <= 400 && arrived_s < 0; ++i) {
    where.step(at(0.02 * i), JointBox::at(told), true);
    if (where.box() == JointBox::at(told)) arrived_s = 0.02 * i;
  }
  EXPECT_NEAR(arrived_s, 2.5 + 1.2, 0.03);
  slow.settles_s = 0.1;
  EXPECT_EQ(head_delay_s(slow), kHeadDelay_s) << "never less than any head may need";
}

TEST(HeadWhereabouts, ContainsHeadsOfEverySpeedAndDelay) {
  Random random(11);
  double narrowest = 100;
  for (int run = 0; run < 60; ++run) {
    HeadWhereabouts where(some_head());
    const double delay_s = random.between(0, 0.5), speed = random.log_between(1, 20);
    Joints truth{random.between(-4, 4), random.between(-2, 2), 0}, wanted{0, 0, 0};
    std::deque<std::pair<double, Joints>> told;
    double next_s = 0;
    bool obeys = true;
    for (int i = 0; i < 1500; ++i) {
      const double now_s = 0.02 * i;
      if (now_s >= next_s) {
        wanted = {random.between(-4, 4), random.between(-2, 2), 0};
        next_s = now_s + random.log_between(0.05, 5);
        obeys = run % 3 != 0 || random.below(3) != 0;
      }
      if (obeys) told.push_back({now_s, wanted});
      // The head obeys the command sent one delay ago, each joint at its own speed or faster.
      while (told.size() > 1 && told[1].first <= now_s - delay_s) told.pop_front();
      if (!told.empty() && told.front().first <= now_s - delay_s) {
        const auto go = [](double from, double to, double way) { return from + std::clamp(to - from, -way, way); };
        truth.pan_rad = go(truth.pan_rad, told.front().second.pan_rad, 0.02 * 2 * speed);
        truth.tilt_rad = go(truth.tilt_rad, told.front().second.tilt_rad, 0.02 * 1 * speed);
      }
      where.step(at(now_s), JointBox::at(wanted), obeys);
      ASSERT_TRUE(holds(where.box(), truth)) << run << " at " << now_s;
      narrowest = std::min(narrowest, where.box().most.pan_rad - where.box().least.pan_rad);
    }
  }
  EXPECT_EQ(narrowest, 0);
}

TEST(HeadWhereabouts, AHeadThatHomesIsUnknownUntilItsResetTimeIsOver) {
  Fixture head = some_head();
  head.reset_s = 20;
  HeadWhereabouts where(head);
  for (int i = 0; i <= 1000; ++i) where.step(at(0.02 * i), JointBox::at({}), true);
  EXPECT_EQ(where.box().least.pan_rad, -4);
  for (int i = 1001; i <= 1200; ++i) where.step(at(0.02 * i), JointBox::at({}), true);
  EXPECT_EQ(where.box(), JointBox::at({}));
}

TEST(HeadWhereabouts, AxesStayOnTheirLineUntilTheyArrive) {
  Fixture head = some_head();
  head.axes.emplace();
  head.axes->pan.acceleration_rad_s2 = 4;
  head.axes->tilt.acceleration_rad_s2 = 2;
  HeadWhereabouts where(head);
  double now_s = 0;
  const auto run = [&](double seconds, const Joints& to) {
    for (const double end_s = now_s + seconds; now_s < end_s; now_s += 0.02)
      where.step(at(now_s), JointBox::at(to), true);
  };
  run(10, {0, 0, 0});
  ASSERT_EQ(where.box(), JointBox::at({}));
  const Joints to{2, 1, 0};
  const double seconds = head_move(2, 1, {2, 4}, {1, 2}).seconds;
  run(seconds / 2, to);
  ASSERT_TRUE(where.on_line_to());
  EXPECT_EQ(*where.on_line_to(), to);
  EXPECT_EQ(where.box(), JointBox::at({}));
  run(seconds / 2 + 0.6, to);
  EXPECT_EQ(where.box(), JointBox::at(to));
  // With a new command under way, the head may be anywhere between.
  run(0.3, {0, 0, 0});
  run(0.04, {0, 1, 0});
  EXPECT_EQ(where.box(), (JointBox{{0, 0, 0}, {2, 1, 0}}));
}

TEST(HeadWhereabouts, AHeadTurnedBySomethingElseIsUnknown) {
  HeadWhereabouts where(some_head());
  for (int i = 0; i <= 400; ++i) where.step(at(0.02 * i), JointBox::at({}), true);
  ASSERT_EQ(where.box(), JointBox::at({}));
  where.lose(at(8.02));
  EXPECT_EQ(where.box().most.pan_rad, 4);
}

}  // namespace
}  // namespace luxrig
