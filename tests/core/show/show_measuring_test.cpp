// A rig whose luxmeters show what its model does not allow goes to its safe look (on_meter_loss), and may be measured
// from there.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/show/show_controller.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kTwo = 2;
constexpr double kLimit_lx = 150, kSafe = 0.1;

Rig two_lamps() {
  Rig rig;
  rig.name = "two-lamps";
  rig.buses.resize(1);
  rig.buses[0].name = "bus";
  rig.safe.on_meter_loss = true;
  rig.safe.level = kSafe;
  rig.safe.hold_s = rig.safe.fade_s = 1;
  for (std::size_t k = 0; k < kTwo; ++k) {
    Fixture fixture;
    fixture.name = "lamp-" + std::to_string(k);
    rig.fixtures.push_back(fixture);
    Point point;
    point.name = "place-" + std::to_string(k);
    point.goal_lx = 100;
    point.max_lx = kLimit_lx;
    rig.points.push_back(point);
    Luxmeter meter;
    meter.name = "meter-" + std::to_string(k);
    meter.point = k;
    meter.tolerance = 0.03;
    rig.luxmeters.push_back(meter);
  }
  return rig;
}

class MeasuredShow {
 public:
  /// Each lamp gives that share of its light in the model.
  explicit MeasuredShow(double share) : light_(share * stated()), show_(two_lamps(), model()) {
    show_.apply(now_, std::vector<double>(kTwo, 0.5));
  }
  void run(double seconds) {
    for (const Time end = now_ + from_seconds(seconds); now_ < end;) {
      now_ += std::chrono::milliseconds(50);
      const VectorXd lux = light_ * VectorXd::Map(levels().data(), static_cast<Index>(kTwo));
      most_lx_ = std::max(most_lx_, lux.maxCoeff());
      for (std::size_t m = 0; (now_.time_since_epoch() / std::chrono::milliseconds(50)) % 4 == 0 && m < kTwo; ++m)
        if (m != silent_) show_.reading(now_, {m, lux[static_cast<Index>(m)], now_});
      show_.step(now_);
    }
  }
  [[nodiscard]] std::vector<double> levels() const {
    std::vector<double> level(kTwo);
    show_.program().levels_at(now_, level);
    return level;
  }
  Result<void> measure(std::vector<double> level, bool measuring = true) {
    std::vector<ByHand> held;
    for (std::size_t f = 0; f < level.size(); ++f) held.push_back({ByHand::What::level, f, level[f], now_});
    return show_.hold(now_, held, {{}, 0.2, measuring});
  }
  [[nodiscard]] ShowStatus status() const { return show_.status(now_); }

  MatrixXd light_;
  std::size_t silent_ = kTwo;
  double most_lx_ = 0;
  Time now_{};
  ShowController show_;

 private:
  static MatrixXd stated() { return MatrixXd{{200, 10}, {10, 200}}; }
  static LightModel model() {
    LightModel model;
    model.point_lux_per_level = model.meter_lux_per_level = stated();
    return model;
  }
};

TEST(ShowMeasuring, FromTheSafeLookWhereOnlyTheModelIsOffLampsAreLitOneByOne) {
  MeasuredShow show(0.3);
  show.run(20);
  ASSERT_EQ(show.status().phase, Phase::safe) << show.status().detail;
  EXPECT_TRUE(show.status().may_be_measured);
  EXPECT_NE(show.status().detail.find("luxrig calibrate"), std::string::npos) << show.status().detail;
  for (const std::vector<double>& alone : {std::vector{0.4, 0.0}, std::vector{0.0, 0.4}, std::vector{0.0, 0.0}}) {
    ASSERT_TRUE(show.measure(alone));
    show.run(6);
    EXPECT_EQ(show.levels(), alone) << show.status().detail;
  }
  // By hand, but not to measure: the safe look, in which a lamp that is held dark stays dark. So when it is released.
  ASSERT_TRUE(show.measure({0.4, 0}, false));
  show.run(6);
  EXPECT_EQ(show.levels(), (std::vector{kSafe, 0.0}));
  ASSERT_TRUE(show.measure({0.4, 0}));
  show.run(6);
  EXPECT_EQ(show.levels(), (std::vector{0.4, 0.0}));
  show.show_.release(show.now_, std::vector<std::size_t>{0, 1}, {});
  show.run(6);
  EXPECT_EQ(show.levels(), std::vector<double>(kTwo, kSafe));
  EXPECT_EQ(show.status().phase, Phase::safe);
}

TEST(ShowMeasuring, ItIsRefusedInWordsWhereALampIsNotHeldOrALuxmeterIsSilent) {
  MeasuredShow show(0.3);
  show.run(20);
  ASSERT_EQ(show.status().phase, Phase::safe);
  const auto one = show.measure({0.4});
  ASSERT_FALSE(one);
  EXPECT_NE(one.error().detail.find("\"lamp-1\" is not held"), std::string::npos) << one.error().detail;
  show.silent_ = 1;
  show.run(4);
  EXPECT_FALSE(show.status().may_be_measured);
  const auto both = show.measure({0.4, 0});
  ASSERT_FALSE(both);
  EXPECT_NE(both.error().detail.find("mend that"), std::string::npos) << both.error().detail;
  show.silent_ = kTwo;
  show.run(6);
  ASSERT_TRUE(show.measure({0.4, 0}));
  show.run(6);
  EXPECT_EQ(show.levels(), (std::vector{0.4, 0.0}));
  // A meter that falls silent ends it.
  show.silent_ = 0;
  show.run(8);
  EXPECT_EQ(show.levels(), (std::vector{kSafe, 0.0}));
}

TEST(ShowMeasuring, LampsThatAreFarBrighterThanTheModelKeepTheLimitByWhatMetersShow) {
  MeasuredShow show(1.9);
  show.run(20);
  ASSERT_EQ(show.status().phase, Phase::safe) << show.status().detail;
  show.most_lx_ = 0;
  for (const std::vector<double>& alone : {std::vector{0.5, 0.0}, std::vector{0.0, 0.5}, std::vector{0.5, 0.5}}) {
    ASSERT_TRUE(show.measure(alone)) << show.status().detail;
    show.run(6);
    const std::vector<double> lit = show.levels();
    EXPECT_GT(*std::max_element(lit.begin(), lit.end()), 0.2) << show.status().detail;
  }
  EXPECT_LE(show.most_lx_, kLimit_lx);
}

TEST(ShowMeasuring, AReadingAboveALimitEndsItInTheSafeLookAndSaysSo) {
  MeasuredShow show(0.3);
  show.run(20);
  ASSERT_TRUE(show.measure({0.4, 0}));
  show.run(6);
  ASSERT_EQ(show.levels(), (std::vector{0.4, 0.0}));
  show.light_ *= 8;  // somebody brings a light
  show.run(4);
  EXPECT_EQ(show.levels(), (std::vector{kSafe, 0.0}));
  bool told = false;
  for (const Alarm& alarm : show.status().alarms)
    told = told || alarm.text.find("while the rig was measured") != std::string::npos;
  EXPECT_TRUE(told);
}

}  // namespace
}  // namespace luxrig
