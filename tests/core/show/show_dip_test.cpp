// A held show that dims a lamp for a moment, to tell a dead lamp from a covered luxmeter.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "core/show/show_controller.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kLamps = 3;

Rig three_lamps(bool fault_dips) {
  Rig rig;
  rig.control.fault_dips = fault_dips;
  rig.name = "three-lamps";
  rig.buses.resize(1);
  rig.buses[0].name = "bus";
  for (std::size_t k = 0; k < kLamps; ++k) {
    Fixture fixture;
    fixture.name = "lamp-" + std::to_string(k);
    rig.fixtures.push_back(fixture);
    Point point;
    point.name = "place-" + std::to_string(k);
    point.goal_lx = 100;
    point.max_lx = 150;
    rig.points.push_back(point);
    Luxmeter meter;
    meter.name = "meter-" + std::to_string(k);
    meter.point = k;
    meter.tolerance = 0.03;
    rig.luxmeters.push_back(meter);
  }
  return rig;
}

class DippedShow {
 public:
  explicit DippedShow(bool fault_dips = true)
      : light_{{180, 20, 1}, {20, 170, 1}, {1, 1, 190}}, show_(three_lamps(fault_dips), model()) {
    show_.apply(now_, std::vector<double>(kLamps, 0.5));
  }
  /// Until so() or for so long; returns whether it came to that.
  template <class So>
  bool run(double seconds, const So& so) {
    for (const Time end = now_ + from_seconds(seconds); now_ < end;) {
      now_ += std::chrono::milliseconds(50);
      VectorXd out = VectorXd::Map(levels().data(), static_cast<Index>(kLamps));
      most_share_of_limit_ = std::max(most_share_of_limit_, (light_ * out).maxCoeff() / 150);
      if (dead_) out[*dead_] = 0;
      const VectorXd lux = light_ * out;
      for (std::size_t m = 0; (now_.time_since_epoch() / std::chrono::milliseconds(50)) % 4 == 0 && m < kLamps; ++m)
        show_.reading(now_, {m, lux[static_cast<Index>(m)] * (1 + 0.005 * normal_(random_)), now_});
      show_.step(now_);
      if (so()) return true;
    }
    return false;
  }
  void run(double seconds) {
    run(seconds, [] { return false; });
  }
  [[nodiscard]] std::vector<double> levels() const {
    std::vector<double> level(kLamps);
    show_.program().levels_at(now_, level);
    return level;
  }
  /// Its lamp is dimmed by a fifth, and the others are as before.
  [[nodiscard]] bool dips(const std::vector<double>& before, std::size_t lamp) const {
    const std::vector<double> now = levels();
    for (std::size_t f = 0; f < kLamps; ++f)
      if (std::abs(now[f] - (f == lamp ? 0.8 : 1) * before[f]) > 1e-6) return false;
    return true;
  }
  [[nodiscard]] std::string told() const {
    for (const Alarm& alarm : show_.status(now_).alarms)
      if (alarm.text.find("readings: ") != std::string::npos) return alarm.text;
    return "";
  }

  MatrixXd light_;
  std::optional<std::size_t> dead_;
  double most_share_of_limit_ = 0;
  Time now_{};
  ShowController show_;

 private:
  LightModel model() const {
    LightModel model;
    model.point_lux_per_level = model.meter_lux_per_level = light_;
    return model;
  }
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
};

TEST(ShowDip, ADeadLampIsDimmedAndNamedAndTheLightComesBack) {
  DippedShow show;
  show.run(60);
  const std::vector<double> before = show.levels();
  show.dead_ = 2;
  ASSERT_TRUE(show.run(30, [&] { return show.dips(before, 2); }));
  ASSERT_TRUE(show.run(15, [&] { return show.levels() == before; }));
  ASSERT_TRUE(show.run(15, [&] { return !show.told().empty(); }));
  EXPECT_EQ(show.told().find("lamp \"lamp-2\" gives no light"), 0u) << show.told();
  EXPECT_NE(show.told().find("when lamp \"lamp-2\" was dimmed by 20 %, no luxmeter followed"), std::string::npos)
      << show.told();
  EXPECT_LE(show.most_share_of_limit_, 1);
}

TEST(ShowDip, WhereTheRigFileForbidsItNoLampIsDimmedAndTheAlarmSaysThatItWouldTell) {
  DippedShow show(false);
  show.run(60);
  const std::vector<double> before = show.levels();
  show.dead_ = 2;
  // The others may be corrected for what is missing, but are never dimmed for it.
  EXPECT_FALSE(show.run(120, [&] { return show.levels()[2] < 0.9 * before[2]; }));
  EXPECT_EQ(show.told().find("either "), 0u) << show.told();
  EXPECT_NE(show.told().find("dimming lamp \"lamp-2\" for 8 s would tell more"), std::string::npos) << show.told();
  EXPECT_NE(show.told().find("fault_dips"), std::string::npos) << show.told();
}

TEST(ShowDip, ABlackoutEndsItAndTheLampComesBackAsBefore) {
  DippedShow show;
  show.run(60);
  const std::vector<double> before = show.levels();
  show.dead_ = 2;
  ASSERT_TRUE(show.run(30, [&] { return show.dips(before, 2); }));
  show.show_.blackout(show.now_, true);
  EXPECT_EQ(show.levels(), std::vector<double>(kLamps, 0.0));
  show.run(1);
  show.show_.blackout(show.now_, false);
  ASSERT_TRUE(show.run(10, [&] { return std::abs(show.levels()[2] - before[2]) < 1e-6; }));
  EXPECT_LE(show.most_share_of_limit_, 1);
}

TEST(ShowDip, ALampHeldByHandStaysAsItIsHeld) {
  DippedShow show;
  show.run(30);
  ByHand held;
  held.what = ByHand::What::level;
  held.index = 2;
  held.value = 0.5;
  ASSERT_TRUE(show.show_.hold(show.now_, {&held, 1}));
  show.run(60);
  show.dead_ = 2;
  EXPECT_FALSE(show.run(70, [&] { return std::abs(show.levels()[2] - 0.5) > 1e-6; }));
  EXPECT_NE(show.told(), "");
  EXPECT_EQ(show.told().find("\"lamp-2\" was dimmed"), std::string::npos) << show.told();
}

}  // namespace
}  // namespace luxrig
