// Lamps that are on or off: the output, the effect of limits, and whole shows with them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/estimation/gain_estimator.h"
#include "core/output/output_program.h"
#include "core/show/show_controller.h"
#include "tests/core/output/at.h"
#include "tests/core/plan/plans.h"

namespace luxrig {
namespace {

using Eigen::Index;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<double> levels(const OutputProgram& program, Time now) {
  std::vector<double> level(program.max_level.size());
  program.levels_at(now, level);
  return level;
}

TEST(Switched, TurnsOffAtTheStartOfAFadeAndOnAtItsEnd) {
  OutputProgram program;
  program.from_level = {1, 0, 1, 0.2};
  program.to_level = {0, 1, 1, 0.6};
  program.max_level = {1, 1, 1, 1};
  program.switched = {1, 1, 1, 0};
  program.start = at(10);
  program.duration = from_seconds(2);
  program.curve = FadeCurve::linear;
  EXPECT_EQ(levels(program, at(9)), (std::vector<double>{1, 0, 1, 0.2}));
  const std::vector<double> first = levels(program, at(10.001)), last = levels(program, at(11.999));
  for (const auto& level : {first, last}) {
    EXPECT_EQ(level[0], 0);
    EXPECT_EQ(level[1], 0);
    EXPECT_EQ(level[2], 1);
  }
  EXPECT_EQ(levels(program, at(12)), (std::vector<double>{0, 1, 1, 0.6}));
}

TEST(Switched, IsOffWhereItMayNotBeFull) {
  OutputProgram program;
  program.from_level = program.to_level = {1, 1, 0.7, std::nan("")};
  program.max_level = {0.9, 1, 1, 1};
  program.switched = {1, 1, 1, 1};
  EXPECT_EQ(levels(program, at(1)), (std::vector<double>{0, 1, 0, 0}));
  program.lamp_starts.resize(4);
  program.lamp_starts[1] = {at(5), from_seconds(2)};
  EXPECT_EQ(levels(program, at(6.9))[1], 0) << "its ceiling is not there yet";
  EXPECT_EQ(levels(program, at(7))[1], 1);
  program.lamp_starts.clear();
  program.dims.push_back({1, 1, 0, at(10), from_seconds(1), false, {}});
  EXPECT_EQ(levels(program, at(10))[1], 1);
  EXPECT_EQ(levels(program, at(10.01))[1], 0) << "it cannot dim on the way to a keep-out zone";
}

TEST(Switched, OthersDimForItWhileThatSuffices) {
  const Eigen::MatrixXd lux{{60, 40}};
  const std::vector<std::uint8_t> switched{1, 0};
  std::vector<double> level{1, 1};
  scale_to_limits(lux, Eigen::VectorXd::Constant(1, 80), level, 0, switched);
  EXPECT_EQ(level[0], 1);
  EXPECT_NEAR(level[1], 0.5, 1e-12);
  level = {1, 1};
  scale_to_limits(lux, Eigen::VectorXd::Constant(1, 50), level, 0, switched);
  EXPECT_EQ(level[0], 0);
  EXPECT_EQ(level[1], 1) << "alone it is within the limit";
  level = {1, 1};
  scale_to_limits(lux, Eigen::VectorXd::Constant(1, 20), level, 0, switched);
  EXPECT_EQ(level[0], 0);
  EXPECT_NEAR(level[1], 0.5, 1e-12);
}

TEST(Switched, LimitsHoldForAnyLevels) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  int went_off = 0, stayed = 0;
  for (int i = 0; i < 5000; ++i) {
    const Index lights = 1 + static_cast<Index>(random() % 8), rows = 1 + static_cast<Index>(random() % 4);
    Eigen::MatrixXd lux(rows, lights);
    Eigen::VectorXd max_lx(rows);
    for (double& value : lux.reshaped()) value = unit(random) < 0.2 ? 0 : 100 * unit(random);
    for (double& value : max_lx) value = unit(random) < 0.1 ? 0 : 300 * unit(random);
    const double odd = unit(random);
    if (odd < 0.05) lux(0, 0) = std::nan("");
    if (odd > 0.95) lux(0, 0) = kInfinity;
    std::vector<double> level(static_cast<std::size_t>(lights));
    std::vector<std::uint8_t> switched(level.size());
    for (std::size_t j = 0; j < level.size(); ++j) {
      switched[j] = unit(random) < 0.5 ? 1 : 0;
      level[j] = switched[j] != 0 ? (unit(random) < 0.7 ? 1 : 0) : unit(random);
    }
    const std::vector<double> wanted = level;
    scale_to_limits(lux, max_lx, level, 0, switched);
    for (Index row = 0; row < rows; ++row) {
      double sum = 0;
      for (Index j = 0; j < lights; ++j)
        if (level[static_cast<std::size_t>(j)] > 0) sum += lux(row, j) * level[static_cast<std::size_t>(j)];
      ASSERT_LE(sum, max_lx[row]) << i;
    }
    for (std::size_t j = 0; j < level.size(); ++j) {
      ASSERT_LE(level[j], wanted[j]);
      if (switched[j] == 0) continue;
      ASSERT_TRUE(level[j] == 0 || level[j] == wanted[j]) << i;
      went_off += wanted[j] > 0 && level[j] == 0;
      stayed += level[j] > 0;
    }
    std::vector<double> as_dimmed = wanted, without_mask = wanted;
    scale_to_limits(lux, max_lx, as_dimmed, 0, std::vector<std::uint8_t>(wanted.size(), 0));
    scale_to_limits(lux, max_lx, without_mask);
    ASSERT_EQ(as_dimmed, without_mask);
  }
  EXPECT_GT(went_off, 1000);
  EXPECT_GT(stayed, 1000);
}

TEST(Switched, FollowsADeskFromHalfUpWithinLimits) {
  OutputProgram program;
  program.from_level = program.to_level = {0, 0};
  program.max_level = {1, 1};
  program.switched = {1, 0};
  program.any_lux_per_level = Eigen::MatrixXd{{100, 100}};
  program.any_max_lx = Eigen::VectorXd::Constant(1, 120);
  DeskBlend desk;
  desk.fixtures = {0, 1};
  desk.desk_has = {1, 1};
  desk.from_level = {0, 0};
  desk.to_desk = true;
  const auto with = [&](double switched, double dimmed) {
    desk.desk_level = {switched, dimmed};
    program.desks = {desk};
    return levels(program, at(100));
  };
  EXPECT_EQ(with(0.49, 0), (std::vector<double>{0, 0}));
  EXPECT_EQ(with(0.5, 0), (std::vector<double>{1, 0}));
  EXPECT_NEAR(with(0.7, 1)[1], 0.2, 1e-9) << "the other dims for it";
  program.any_max_lx[0] = 90;
  EXPECT_EQ(with(1, 0.5), (std::vector<double>{0, 0.5}));
}

TEST(Switched, APlanMaySetItOnlyOnOrOff) {
  Rig rig = two_fixture_rig();
  rig.fixtures[0].switched = true;
  EXPECT_TRUE(levels_for(plan_for_two(1, 0.5), rig, "plan.json"));
  EXPECT_TRUE(levels_for(plan_for_two(0, 0.5), rig, "plan.json"));
  const auto half = levels_for(plan_for_two(0.5, 0.5), rig, "plan.json");
  ASSERT_FALSE(half);
  EXPECT_NE(half.error()[0].text().find("\"left\", which is on or off"), std::string::npos) << half.error()[0].text();
}

/// Six lamps, two or three of them on or off, over five points: four metered, two with a limit. The truth deviates from
/// the model like a real rig: output, meters, single entries.
struct Hall {
  Rig rig;
  LightModel model;
  Eigen::MatrixXd truth;
  Eigen::VectorXd meter_scale;
  std::vector<double> plan;

  explicit Hall(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform;
    const Index fixtures = 6, points = 5, meters = 4;
    model.point_lux_per_level.resize(points, fixtures);
    for (double& lux : model.point_lux_per_level.reshaped()) lux = uniform(random) < 0.3 ? 2 : 100 * uniform(random);
    model.meter_lux_per_level = model.point_lux_per_level.topRows(meters);
    truth = model.point_lux_per_level;
    for (double& lux : truth.reshaped()) lux *= 0.9 + 0.2 * uniform(random);
    for (Index j = 0; j < fixtures; ++j) truth.col(j) *= 0.8 + 0.25 * uniform(random);
    meter_scale.resize(meters);
    for (double& scale : meter_scale) scale = 1 + 0.03 * (2 * uniform(random) - 1);
    rig.name = "hall";
    rig.buses.resize(2);
    rig.control.fade_s = 1;
    rig.control.correction_fade_s = 1;
    rig.control.settle_s = 0.2;
    rig.control.gain_min = 0.6;
    rig.control.gain_max = 1.15;
    rig.limits.open_loop_margin = 0.2;
    for (Index j = 0; j < fixtures; ++j) {
      Fixture& fixture = rig.fixtures.emplace_back();
      fixture.name = "lamp " + std::to_string(j);
      fixture.switched = j < 2 || (j == 2 && uniform(random) < 0.5);
      plan.push_back(fixture.switched ? (uniform(random) < 0.7 ? 1 : 0) : 0.2 + 0.5 * uniform(random));
    }
    const Eigen::VectorXd goal = model.point_lux_per_level * Eigen::Map<const Eigen::VectorXd>(plan.data(), fixtures);
    for (Index i = 0; i < points; ++i) {
      Point& point = rig.points.emplace_back();
      point.name = "p" + std::to_string(i);
      point.goal_lx = goal[i];
      if (i == 0 || i == 4) point.max_lx = goal[i] * (0.8 + 0.6 * uniform(random));
      if (i >= meters) continue;
      Luxmeter& meter = rig.luxmeters.emplace_back();
      meter.name = "m" + std::to_string(i);
      meter.point = static_cast<std::size_t>(i);
      meter.tolerance = 0.04;
      meter.bus = 1;
    }
  }
};

TEST(Switched, ShowsKeepLimitsWithoutChatteringRelays) {
  int met = 0, goals = 0, on_at_the_end = 0, forced_off = 0, flips = 0;
  double max_share = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Hall hall(seed);
    ShowController show(hall.rig, hall.model);
    double now_s = 0;
    show.apply(at(0), hall.plan);
    std::vector<double> level(6), before(6);
    for (int step = 0; step < 500; ++step) {  // 25 s
      show.program().levels_at(at(now_s), level);
      const Eigen::VectorXd lux = hall.truth * Eigen::Map<const Eigen::VectorXd>(level.data(), 6);
      for (std::size_t j = 0; j < 6; ++j) {
        if (!hall.rig.fixtures[j].switched) continue;
        ASSERT_TRUE(level[j] == 0 || level[j] == 1) << "seed " << seed << ": " << level[j];
        flips += level[j] != before[j];
      }
      before = level;
      for (std::size_t i = 0; i < hall.rig.points.size(); ++i) {
        if (!hall.rig.points[i].max_lx) continue;
        const double share = lux[static_cast<Index>(i)] / *hall.rig.points[i].max_lx;
        max_share = std::max(max_share, share);
        ASSERT_LE(share, 1) << "seed " << seed << " at " << now_s << " s, point " << i;
      }
      for (std::size_t m = 0; m < 4; ++m) {
        const auto at_meter = static_cast<Index>(m);
        show.reading(at(now_s), {m, lux[at_meter] * hall.meter_scale[at_meter], at(now_s)});
      }
      show.step(at(now_s));
      now_s += 0.05;
    }
    for (const PointStatus& point : show.status(at(now_s)).points) {
      goals += point.measured_lx.has_value();
      met += point.measured_lx.has_value() &&
             std::abs(*point.measured_lx - *point.goal_lx) <= hall.rig.control.goal_tolerance * *point.goal_lx;
    }
    for (std::size_t j = 0; j < 6; ++j) {
      if (!hall.rig.fixtures[j].switched) continue;
      on_at_the_end += level[j] > 0;
      forced_off += hall.plan[j] > 0 && level[j] == 0;
    }
  }
  std::printf(
      "of 300 shows: %d of %d metered goals read within 10 %%; relays on at the end %d, kept off by a limit %d, "
      "switched %d "
      "times; most light %.3f of a limit\n",
      met, goals, on_at_the_end, forced_off, flips, max_share);
  EXPECT_GT(on_at_the_end, 150);
  EXPECT_GT(forced_off, 20);
  EXPECT_LE(flips, on_at_the_end + 2 * forced_off) << "each is switched on once, and off at most once";
  EXPECT_GT(met, goals / 2);
}

}  // namespace
}  // namespace luxrig
