/// A lighting desk beside the show: limits, meters, messages to the user.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/show/show_controller.h"
#include "tests/core/output/at.h"

namespace luxrig {
namespace {

/// Two fixtures over two points with meters; the first point is limited. A desk may have both.
struct DeskShow {
  Rig rig;
  LightModel model;
  std::unique_ptr<ShowController> show;
  double now_s = 0;
  Eigen::Vector2d gain{0.9, 0.95};  ///< the truth

  explicit DeskShow(DeskRules rules, bool limited = true, bool metered = true) {
    rig.name = "small";
    rig.buses.resize(2);
    rig.buses[1].name = "meters";
    for (const char* name : {"left", "right"}) {
      rig.fixtures.emplace_back();
      rig.fixtures.back().name = name;
      rig.points.emplace_back();
      rig.points.back().name = std::string("below ") + name;
      rig.points.back().goal_lx = 40;
      if (!metered) continue;
      rig.luxmeters.emplace_back();
      rig.luxmeters.back().name = std::string("meter ") + name;
      rig.luxmeters.back().point = rig.points.size() - 1;
      rig.luxmeters.back().bus = 1;
    }
    if (limited) rig.points[0].max_lx = 50;
    rig.fixtures[1].max_level = 0.8;
    rig.control.fade_s = 1;
    rig.control.settle_s = 0.2;
    model.point_lux_per_level = Eigen::MatrixXd{{100, 10}, {10, 100}};
    if (metered) model.meter_lux_per_level = model.point_lux_per_level;
    show = std::make_unique<ShowController>(rig, model);
    EXPECT_EQ(show->add_desk(rules, {"dmx, universe 1", {0, 1}}), 0u);
  }
  void desk(DeskPresence presence, double left, double right) {
    frame = {presence, {{0, left, std::nullopt}, {1, right, std::nullopt}}, "desk"};
  }
  [[nodiscard]] std::vector<double> levels() const {
    std::vector<double> level(2);
    show->program().levels_at(at(now_s), level);
    return level;
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 20)); ++i) {
      now_s += 0.05;
      show->desk(at(now_s), 0, frame);
      const std::vector<double> level = levels();
      const Eigen::Vector2d lux = model.point_lux_per_level * Eigen::Vector2d(gain[0] * level[0], gain[1] * level[1]);
      for (std::size_t m = 0; m < rig.luxmeters.size(); ++m) {
        show->reading(at(now_s), {m, lux[static_cast<Eigen::Index>(m)], at(now_s)});
      }
      show->step(at(now_s));
    }
  }
  [[nodiscard]] ShowStatus status() const { return show->status(at(now_s)); }

  DeskFrame frame;
};

TEST(ShowDesk, NeverLiftsALimitedPointAboveItsLimit) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share(-0.2, 1.2);
  for (const DeskMode mode : {DeskMode::merge, DeskMode::takeover}) {
    for (const HandBack rule : {HandBack::at_once, HandBack::fade}) {
      DeskShow small({mode, rule});
      small.show->apply(at(0), std::vector<double>{0.4, 0.4});
      double brightest = 0;
      for (int i = 0; i < 400; ++i) {
        const bool there = random() % 7 != 0;
        small.desk(there ? DeskPresence::present : DeskPresence::absent, share(random), share(random));
        small.run(0.05 * static_cast<double>(1 + random() % 12));
        for (double s = small.now_s; s < small.now_s + 1.5; s += 0.1) {
          std::vector<double> level(2);
          small.show->program().levels_at(at(s), level);
          // The maximum that the model's bounds allow: gain_max, and everywhere off by the open-loop margin.
          const double worst_case_lx = (100 * level[0] + 10 * level[1]) * 1.15 / 0.75;
          // Where a meter has confirmed the model, Luxrig's own light may rely on it.
          const double known_lx = (100 * 0.9 * level[0] + 10 * 0.95 * level[1]) / (1 - 0.05);
          ASSERT_LE(small.status().desks[0].phase == DeskPhase::own ? known_lx : worst_case_lx, 50 * (1 + 1e-9));
          ASSERT_LE(level[1], 0.8);
          brightest = std::max(brightest, worst_case_lx);
        }
      }
      EXPECT_GT(brightest, 45);
    }
  }
}

TEST(ShowDesk, LearnsFromNoMeterWhileADeskIsInControlAndResumes) {
  DeskShow small({DeskMode::takeover, HandBack::fade});
  small.desk(DeskPresence::absent, 0, 0);
  small.show->apply(at(0), std::vector<double>{0.3, 0.3});
  small.desk(DeskPresence::present, 0.05, 0.05);
  small.run(20);
  EXPECT_EQ(small.status().fixtures[0].gain, small.status().fixtures[1].gain);  // nothing learnt
  EXPECT_NE(small.status().phase, Phase::holding);
  EXPECT_EQ(small.status().desks[0].phase, DeskPhase::following);
  EXPECT_NE(small.status().detail.find("a desk has a say"), std::string::npos);
  small.desk(DeskPresence::absent, 0.05, 0.05);
  small.run(30);
  EXPECT_EQ(small.status().phase, Phase::holding);
  EXPECT_TRUE(small.status().converged);
  EXPECT_NEAR(small.status().points[1].measured_lx.value_or(0), 40, 1);
  ASSERT_EQ(small.status().alarms.size(), 1u);
  EXPECT_FALSE(small.status().alarms[0].severe);
  EXPECT_EQ(small.status().alarms[0].text,
            "desk \"desk\" is lost: dmx, universe 1 is Luxrig's again; look after the desk or its cable");
}

TEST(ShowDesk, StatusReportsThatADeskDrivingLampsItselfIsUnlimited) {
  DeskShow small({DeskMode::standby, HandBack::fade}, true, false);
  small.desk(DeskPresence::present, 0.9, 0.1);
  small.show->apply(at(0), std::vector<double>{0.2, 0.2});
  small.run(10);
  ShowStatus status = small.status();
  ASSERT_TRUE(status.desks[0].silent);
  EXPECT_DOUBLE_EQ(status.fixtures[0].level, 0.9) << "what the desk sends";
  EXPECT_NE(status.points[0].limit, LimitVerdict::kept) << "91 lx by the model, 50 are allowed";
  EXPECT_NE(status.points[0].limit_reason.find("a desk drives lamps"), std::string::npos)
      << status.points[0].limit_reason;
  EXPECT_EQ(status.limits_kept, 0);
  small.desk(DeskPresence::present, 0.1, 0.1);
  small.run(10);
  status = small.status();
  EXPECT_EQ(status.points[0].limit, LimitVerdict::kept) << status.points[0].limit_reason;
}

TEST(ShowDesk, FadesFromTheDesksLastLookWithoutAFlash) {
  DeskShow small({DeskMode::standby, HandBack::fade}, false);
  small.desk(DeskPresence::present, 0.9, 0.1);
  small.show->apply(at(0), std::vector<double>{0.2, 0.5});
  small.run(10);
  EXPECT_TRUE(small.status().desks[0].silent);
  small.desk(DeskPresence::absent, 0.9, 0.1);
  std::vector<double> last = {0.9, 0.1};
  for (int i = 0; i < 40; ++i) {  // before meters are trusted again, and correct
    small.run(0.05);
    EXPECT_FALSE(small.status().desks[0].silent);
    const std::vector<double> now = small.levels();
    for (std::size_t f = 0; f < 2; ++f) EXPECT_LE(std::abs(now[f] - last[f]), 0.06) << i;  // 1.5/1 s of 0.7 in 50 ms
    last = now;
  }
  EXPECT_NEAR(last[0], 0.2, 0.05);
  EXPECT_NEAR(last[1], 0.5, 0.05);
}

TEST(ShowDesk, WaitsUntilAPersonHandsTheLightBack) {
  DeskShow small({DeskMode::takeover, HandBack::when_asked}, false);
  small.desk(DeskPresence::absent, 0, 0);
  small.show->apply(at(0), std::vector<double>{0.2, 0.2});
  small.run(5);
  small.desk(DeskPresence::present, 0.9, 0.9);
  small.run(5);
  EXPECT_EQ(small.status().desks[0].phase, DeskPhase::waiting);
  EXPECT_LT(small.levels()[0], 0.5);
  ASSERT_FALSE(small.status().alarms.empty());
  small.show->hand_back(at(small.now_s));
  small.run(2);
  EXPECT_EQ(small.status().desks[0].phase, DeskPhase::following);
  EXPECT_DOUBLE_EQ(small.levels()[0], 0.9);
}

}  // namespace
}  // namespace luxrig
