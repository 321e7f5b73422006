/// A show that starts while a lighting desk may have the light: it listens first.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/show/show_controller.h"
#include "tests/core/output/at.h"

namespace luxrig {
namespace {

/// Two lamps. A desk may have the first. The second is on a bus without a desk, and its stage comes later.
struct ListeningShow {
  Rig rig;
  std::unique_ptr<ShowController> show;
  double now_s = 0;
  DeskFrame frame;
  std::vector<double> sent{0, 0};  ///< last level sent to each lamp
  double largest_step = 0;         ///< of the first lamp, once it has been sent a level, in 20 ms
  double first_sent_s = -1;        ///< first time the first lamp is sent a level above 0

  explicit ListeningShow(DeskRules rules) {
    rig.name = "small";
    rig.buses.resize(1);
    for (const char* name : {"shared", "own"}) {
      rig.fixtures.emplace_back();
      rig.fixtures.back().name = name;
    }
    rig.control.fade_s = 1;
    show = std::make_unique<ShowController>(rig, LightModel{});
    EXPECT_EQ(show->add_desk(rules, {"dmx, universe 1", {0}}), 0u);
  }
  void hear(DeskPresence presence, double drive = 0) { frame = {presence, {{0, drive, std::nullopt}}, "desk"}; }
  [[nodiscard]] bool silent() const { return show->program().desks[0].silent; }
  [[nodiscard]] std::vector<double> levels() const {
    std::vector<double> level(2);
    show->program().levels_at(at(now_s), level);
    return level;
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 50)); ++i) {
      now_s += 0.02;
      show->desk(at(now_s), 0, frame);
      show->step(at(now_s));
      const std::vector<double> level = levels();
      sent[1] = level[1];
      if (silent()) continue;
      largest_step = std::max(largest_step, std::abs(level[0] - sent[0]));
      sent[0] = level[0];
      if (first_sent_s < 0 && level[0] > 0) first_sent_s = now_s;
    }
  }
  [[nodiscard]] ShowStatus status() const { return show->status(at(now_s)); }
};

constexpr DeskMode kSilentModes[] = {DeskMode::takeover, DeskMode::standby};

TEST(ShowListening, APlanWaitsUntilNoDeskIsConfirmedAndThenFadesIn) {
  for (const DeskMode mode : kSilentModes) {
    ListeningShow small({mode, HandBack::fade});
    small.hear(DeskPresence::unknown);
    small.show->apply(at(0), std::vector<double>{0.8, 0.6});
    small.run(4);
    EXPECT_EQ(small.sent, (std::vector<double>{0, 0})) << "all of the rig waits";
    EXPECT_EQ(small.status().phase, Phase::idle);
    EXPECT_EQ(small.status().detail,
              "listening for a desk; the plan: the plan waits until it is known whether a desk has the light");
    small.hear(DeskPresence::absent);
    small.run(0.5);
    EXPECT_NEAR(small.sent[0], 0.4, 0.05);
    small.run(0.6);
    EXPECT_EQ(small.sent, (std::vector<double>{0.8, 0.6}));
    EXPECT_LT(small.largest_step, 0.03);
    EXPECT_NE(small.status().phase, Phase::idle);
  }
}

TEST(ShowListening, StagesAndHeadsStartWhenTheWaitIsOver) {
  ListeningShow small({DeskMode::takeover, HandBack::fade});
  small.rig.fixtures[1].stage = 2;
  small.rig.startup.stage_s = 2;
  small.rig.fixtures[1].moves = true;
  small.rig.fixtures[1].range = {-1, 1, -1, 1};
  small.rig.fixtures[1].pan_speed_rad_s = small.rig.fixtures[1].tilt_speed_rad_s = 2;
  small.show = std::make_unique<ShowController>(small.rig, LightModel{});
  (void)small.show->add_desk({DeskMode::takeover, HandBack::fade}, {"dmx, universe 1", {0}});
  small.show->apply(at(0), std::vector<double>{0.8, 0.6});
  small.run(3);
  small.hear(DeskPresence::absent);
  // The head's longest move takes half a second, after half a second of delay. Then two stages.
  small.run(0.98);
  EXPECT_EQ(small.sent, (std::vector<double>{0, 0}));
  small.run(1.5);
  EXPECT_EQ(small.sent, (std::vector<double>{0.8, 0}));
  small.run(0.45);
  EXPECT_EQ(small.sent[1], 0);
  small.run(1.2);
  EXPECT_EQ(small.sent, (std::vector<double>{0.8, 0.6}));
}

TEST(ShowListening, APresentDeskHasTheLightFromTheFirstFrame) {
  for (const DeskMode mode : kSilentModes) {
    ListeningShow small({mode, HandBack::fade});
    small.hear(DeskPresence::unknown);
    small.show->apply(at(0), std::vector<double>{0.8, 0.6});
    small.run(1.5);
    small.hear(DeskPresence::present, 0.2);
    for (int i = 0; i < 200; ++i) {
      small.run(0.02);
      if (mode == DeskMode::standby) {
        ASSERT_TRUE(small.silent()) << small.now_s;
      } else {
        ASSERT_EQ(small.sent[0], 0.2) << small.now_s;
      }
    }
    EXPECT_EQ(small.sent[1], 0.6);
  }
}

TEST(ShowListening, AnUndecidedBusDelaysTheOthersForFiveSecondsAndFadesInLater) {
  ListeningShow small({DeskMode::standby, HandBack::fade});
  small.hear(DeskPresence::unknown);
  small.show->apply(at(0), std::vector<double>{0.8, 0.6});
  small.run(4.98);
  EXPECT_EQ(small.sent[1], 0);
  small.run(1.2);
  EXPECT_EQ(small.sent[1], 0.6);
  EXPECT_TRUE(small.silent());
  small.run(10);
  EXPECT_TRUE(small.silent());
  small.hear(DeskPresence::absent);
  small.run(0.5);
  EXPECT_NEAR(small.sent[0], 0.4, 0.05) << "from dark";
  small.run(1);
  EXPECT_EQ(small.sent[0], 0.8);
  EXPECT_LT(small.largest_step, 0.03);
}

TEST(ShowListening, MergeModeDoesNotWait) {
  ListeningShow small({DeskMode::merge, HandBack::fade});
  small.hear(DeskPresence::unknown);
  small.show->apply(at(0), std::vector<double>{0.8, 0.6});
  small.run(1.1);
  EXPECT_EQ(small.sent, (std::vector<double>{0.8, 0.6}));
}

TEST(ShowListening, AGuardiansLightContinuesWithoutAPauseUnlessItWasSilent) {
  for (const bool silent : {false, true}) {
    ListeningShow small({DeskMode::takeover, HandBack::fade});
    small.hear(DeskPresence::unknown);
    LightInForce light{{{0.4, 0.3}, std::vector<Joints>(2)}, {0, 0}, 60, 1};
    light.silent = {silent ? std::uint8_t{1} : std::uint8_t{0}, 0};
    small.show->go_on_from(at(0), light);
    EXPECT_EQ(small.silent(), silent);
    small.sent = light.look.levels;
    small.show->apply(at(0), std::vector<double>{0.8, 0.6});
    small.run(2);
    EXPECT_EQ(small.sent[1], 0.6) << "what is lit does not wait";
    EXPECT_EQ(small.silent(), silent);
    EXPECT_EQ(small.sent[0], silent ? 0.4 : 0.8);
    // A desk comes: it gets Luxrig's lights by fade, and has those that no other source sent.
    small.hear(DeskPresence::present, 0.2);
    small.run(0.02);
    EXPECT_NEAR(small.sent[0], silent ? 0.2 : 0.8, 0.01);
    small.run(1.1);
    EXPECT_NEAR(small.sent[0], 0.2, 1e-12);
  }
}

}  // namespace
}  // namespace luxrig
