/// A controller takes the light over from another: no lamp jumps, and limits are met as soon as possible.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/show/show_controller.h"
#include "tests/core/output/at.h"

namespace luxrig {
namespace {

/// A head and two lamps over a metered point, with or without a limit.
struct TakeoverShow {
  Rig rig;
  LightModel model;
  std::unique_ptr<ShowController> show;
  double now_s = 100;
  double largest_step = 0;  ///< of any lamp, in 20 ms
  std::vector<double> last;

  explicit TakeoverShow(std::optional<double> max_lx = {}) {
    rig.name = "small";
    rig.buses.resize(1);
    for (const char* name : {"head", "spot", "wash"}) {
      rig.fixtures.emplace_back();
      rig.fixtures.back().name = name;
    }
    rig.fixtures[0].moves = true;
    rig.fixtures[0].range = {-2, 2, -1, 1};
    rig.fixtures[0].pan_speed_rad_s = rig.fixtures[0].tilt_speed_rad_s = 1;
    rig.points.emplace_back();
    rig.points.back().goal_lx = 30;
    rig.points.back().max_lx = max_lx;
    rig.luxmeters.emplace_back();
    rig.luxmeters.back().point = 0;
    rig.control.fade_s = 2;
    rig.control.settle_s = 0.2;
    rig.safe.level = 0.2;
    rig.safe.fade_s = 1;
    model.point_lux_per_level = Eigen::MatrixXd{{60, 10, 50}};
    model.meter_lux_per_level = model.point_lux_per_level;
  }
  void begin(const LightInForce& light) {
    show = std::make_unique<ShowController>(rig, model);
    show->go_on_from(at(now_s), light);
    last = light.look.levels;
  }
  [[nodiscard]] std::vector<double> levels() const {
    std::vector<double> level(3);
    show->program().levels_at(at(now_s), level);
    return level;
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 50)); ++i) {
      now_s += 0.02;
      const std::vector<double> level = levels();
      for (std::size_t f = 0; f < 3; ++f) largest_step = std::max(largest_step, std::abs(level[f] - last[f]));
      last = level;
      show->reading(at(now_s), {0, 0.9 * (60 * level[0] + 10 * level[1] + 50 * level[2]), at(now_s)});
      show->step(at(now_s));
    }
  }
};

const LightInForce kLight{{{0.3, 0.8, 0.5}, {{0.7, 0.3}, {}, {}}}, {0.2, 0.2, 0.2}, 1, 2};

TEST(ShowTakeover, WithoutAPlanHoldsTheLightAndThenGoesToTheSafeLook) {
  TakeoverShow small;
  small.begin(kLight);
  EXPECT_NE(small.show->program().revision, 0u) << "it goes out at once";
  EXPECT_EQ(small.levels(), kLight.look.levels);
  EXPECT_EQ(small.show->program().joints[0], (Joints{0.7, 0.3}));
  small.run(0.9);
  EXPECT_EQ(small.levels(), kLight.look.levels);
  small.run(3);
  EXPECT_EQ(small.levels(), kLight.safe_levels);
  EXPECT_LT(small.largest_step, 0.02);
  EXPECT_EQ(small.show->status(at(small.now_s)).phase, Phase::idle);
  small.show->apply(at(small.now_s), std::vector<double>{0.3, 0.1, 0.4});
  EXPECT_EQ(small.levels(), kLight.safe_levels);
}

TEST(ShowTakeover, APlanFadesFromTheCurrentLight) {
  TakeoverShow small;
  small.begin(kLight);
  small.run(0.3);
  Look look;
  look.joints = kLight.look.joints;
  look.goal_lx = {30};
  look.levels = {0.3, 0.4, 0.2};
  small.show->apply(at(small.now_s), look, small.model);
  double least = 1;
  for (int i = 0; i < 150; ++i) {
    small.run(0.02);
    least = std::min(least, small.levels()[0]);
  }
  EXPECT_NEAR(least, 0.3, 1e-9) << "the head looks there already: nothing to wait for, no dark";
  EXPECT_LT(small.largest_step, 0.02);
  small.run(10);
  EXPECT_EQ(small.show->status(at(small.now_s)).phase, Phase::holding);
}

TEST(ShowTakeover, AHeadThatMustTurnIsFadedOutFirst) {
  TakeoverShow small;
  small.begin(kLight);
  Look look;
  look.joints = {{-0.7, 0.3}, {}, {}};
  look.goal_lx = {30};
  look.levels = {0.3, 0.4, 0.2};
  small.show->apply(at(small.now_s), look, small.model);
  bool dark = false;
  for (int i = 0; i < 400; ++i) {
    small.run(0.02);
    const bool turned = small.show->program().joints[0] == look.joints[0];
    if (turned && !dark) {
      EXPECT_EQ(small.levels()[0], 0) << "turned in the dark";
    }
    dark = dark || turned;
  }
  EXPECT_TRUE(dark);
  EXPECT_LT(small.largest_step, 0.02);
}

TEST(ShowTakeover, ALimitWithoutLearntGainsCausesNoJump) {
  // 60 · 0.3 + 10 · 0.8 + 50 · 0.5 = 51 lx in the model: meters had taught the dead controller that it is less.
  TakeoverShow small(40);
  small.begin(kLight);
  small.run(0.5);
  EXPECT_EQ(small.levels(), kLight.look.levels);
  small.show->apply(at(small.now_s), std::vector<double>{0.3, 0.8, 0.5});
  small.run(4);
  EXPECT_LT(small.largest_step, 0.02);
  const auto lux = [&] {
    const std::vector<double> level = small.levels();
    return 60 * level[0] + 10 * level[1] + 50 * level[2];
  };
  EXPECT_LE(lux(), 40 * (1 + 1e-6)) << "by the fade's end the limit holds by what is known";
  // From then on as usual: no level beyond it, whatever is asked.
  small.show->apply(at(small.now_s), std::vector<double>{1, 1, 1});
  for (int i = 0; i < 200; ++i) {
    small.run(0.02);
    ASSERT_LE(0.9 * lux(), 40 * (1 + 1e-6));
  }
}

TEST(ShowTakeover, LitLampsAreNotStaged) {
  TakeoverShow small;
  small.rig.startup.stage_s = 2;
  LightInForce light = kLight;
  light.look.joints[0] = {};  // the pose of the plan
  small.begin(light);
  small.show->apply(at(small.now_s), std::vector<double>{0.3, 0.8, 0.5});
  small.run(1);
  EXPECT_EQ(small.levels(), kLight.look.levels);
}

TEST(ShowTakeover, AHeadOnAxesStaysDarkUntilItsPoseIsKnown) {
  TakeoverShow small;
  small.rig.fixtures[0].axes = AxesPatch{0, {5, 500, -2, 3}, {6, 500, -1, 2}};
  small.begin(kLight);
  EXPECT_EQ(small.levels()[0], 0);
  EXPECT_EQ(small.levels()[1], 0.8);
  small.last = small.levels();
  small.show->apply(at(small.now_s), std::vector<double>{0.3, 0.8, 0.5});
  small.run(3);  // its longest move takes over 4 s
  EXPECT_EQ(small.levels()[0], 0);
  EXPECT_EQ(small.levels()[1], 0.8) << "the others are held meanwhile";
  small.run(8);
  EXPECT_NEAR(small.levels()[0], 0.3, 0.1);
  EXPECT_LT(small.largest_step, 0.02);
}

TEST(ShowTakeover, ABlackoutIsDarkAndLiftingItRestoresTheLook) {
  TakeoverShow small;
  small.begin(kLight);
  small.show->apply(at(small.now_s), std::vector<double>{0.3, 0.8, 0.5});
  small.show->blackout(at(small.now_s), true);
  EXPECT_EQ(small.levels(), (std::vector<double>{0, 0, 0}));
}

}  // namespace
}  // namespace luxrig
