// Lamps read by the luxmeters that hang: which lights it asks for, and the dimmer curves that follow, against dimmers whose
// exponents are known.
#include "core/calibration/meter_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/output/dimming.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Lamps, dimmers and luxmeters as they truly are. Each meter shows mostly its own lamps, and more or less of the others.
struct TrueRig {
  Rig rig;
  MatrixXd lux;                  ///< luxmeters × fixtures, at full light
  std::vector<double> exponent;  ///< of the dimmers
  double noise = 0.01;           ///< of a reading, relative, as a standard error
  double dark_lx = 0;

  [[nodiscard]] Eigen::VectorXd truth_lx(std::span<const double> level) const {
    Eigen::VectorXd light = Eigen::VectorXd::Constant(lux.rows(), dark_lx);
    for (std::size_t f = 0; f < level.size(); ++f)
      light += std::pow(level[f], exponent[f]) * lux.col(static_cast<Index>(f));
    return light;
  }
  [[nodiscard]] std::vector<std::optional<SteadyReading>> read(std::span<const double> level,
                                                               std::mt19937_64& random) const {
    std::normal_distribution<double> normal;
    std::vector<std::optional<SteadyReading>> readings;
    for (const double truth : truth_lx(level)) {
      const double error_lx = std::hypot(noise * truth, 0.01);
      readings.push_back(SteadyReading{truth + error_lx * normal(random), error_lx});
    }
    return readings;
  }
};

TrueRig random_rig(std::mt19937_64& random, std::size_t lamps, std::size_t meters) {
  std::uniform_real_distribution<double> unit(0, 1);
  TrueRig made;
  for (std::size_t f = 0; f < lamps; ++f) {
    Fixture fixture;
    fixture.name = "lamp-" + std::to_string(f);
    made.rig.fixtures.push_back(fixture);
    made.exponent.push_back(0.8 + 1.6 * unit(random));
  }
  made.rig.luxmeters.resize(meters);
  const double spill = 0.3 * unit(random) * unit(random);
  made.lux.resize(static_cast<Index>(meters), static_cast<Index>(lamps));
  for (std::size_t f = 0; f < lamps; ++f) {
    // A third is seen by its reflection alone.
    const double own_lx = f % 3 == 2 ? 1 + 5 * unit(random) : 40 + 300 * unit(random);
    for (std::size_t m = 0; m < meters; ++m)
      made.lux(static_cast<Index>(m), static_cast<Index>(f)) = own_lx * (m == f % meters ? 1 : spill * unit(random));
  }
  made.dark_lx = 5 * unit(random);
  return made;
}

MeterRun measured_in_groups(const TrueRig& rig, std::mt19937_64& random, const MatrixXd& stated_lux) {
  const std::vector<double> levels(rig.rig.fixtures.size(), 1.0);
  MeterRun run(rig.rig, levels, stated_lux);
  for (std::size_t k = 0; k < run.plan().size(); ++k) {
    const std::vector<double> sent = levels_of(run.plan()[k], rig.rig);
    run.take(sent, rig.read(sent, random));
  }
  return run;
}

TEST(MeterRun, FindsDimmerCurvesFromLampsThatAreLitTogether) {
  std::mt19937_64 random(21);
  std::size_t shares = 0, within_two = 0, seen = 0, found = 0, lights = 0, one_by_one = 0;
  double worst = 0;
  for (int k = 0; k < 200; ++k) {
    const TrueRig rig = random_rig(random, 3 + random() % 16, 1 + random() % 7);
    const MeterRun run = measured_in_groups(rig, random, rig.lux);
    // One lamp at a time, and the dark once for eight lights.
    const std::size_t lamps = rig.rig.fixtures.size(), each = std::size(kCurveShares) * lamps;
    const std::size_t alone = each + (each + 7) / 8;
    EXPECT_LE(run.plan().size(), alone);
    if (rig.rig.luxmeters.size() >= 6) {
      lights += run.plan().size();
      one_by_one += alone;
    }
    for (std::size_t f = 0; f < lamps; ++f) {
      const LampCurve& curve = run.curves()[f];
      const bool bright = rig.lux.col(static_cast<Index>(f)).maxCoeff() > 20 * std::max(1.0, 0.1 * rig.dark_lx);
      seen += bright;
      if (curve.of_level.empty()) continue;
      found += bright;
      for (const auto& [level, share] : curve.of_level) {
        if (level == 1 || level < curve.known_from) continue;
        const double off = std::abs(share / std::pow(level, rig.exponent[f]) - 1);
        ++shares;
        within_two += off <= 2 * curve.error;
        worst = std::max(worst, off / curve.error);
        EXPECT_LE(curve.error, 0.05);
      }
    }
  }
  RecordProperty("lights_over_one_by_one",
                 std::to_string(static_cast<double>(lights) / static_cast<double>(one_by_one)));
  RecordProperty("within_two_errors", std::to_string(static_cast<double>(within_two) / static_cast<double>(shares)));
  EXPECT_GT(shares, 4000u);
  EXPECT_EQ(found, seen) << "each lamp that a meter sees well";
  EXPECT_GE(static_cast<double>(within_two), 0.93 * static_cast<double>(shares));
  EXPECT_LT(worst, 6);
  EXPECT_LT(static_cast<double>(lights), 0.75 * static_cast<double>(one_by_one))
      << "of rigs with six luxmeters or more";
}

// Such as a sample of the next light that has slipped in: its error says so.
TEST(MeterRun, AMeterThatWasDisturbedWhileALampWasAloneDoesNotBendItsCurve) {
  std::mt19937_64 random(26);
  std::size_t shares = 0, within_two = 0;
  for (int k = 0; k < 1000; ++k) {
    const TrueRig rig = random_rig(random, 12, 6);
    const std::vector<double> levels(12, 1.0);
    MeterRun run(rig.rig, levels, rig.lux);
    std::size_t disturbed = 0;
    while (run.plan()[disturbed].empty()) disturbed = random() % run.plan().size();
    const std::size_t f = run.plan()[disturbed].front().fixture;
    for (std::size_t light = 0; light < run.plan().size(); ++light) {
      const std::vector<double> sent = levels_of(run.plan()[light], rig.rig);
      auto readings = rig.read(sent, random);
      if (light == disturbed) {
        SteadyReading& wrong = *readings[random() % 6];
        const double off_lx = 0.5 * wrong.lux + 3;
        wrong = {wrong.lux + off_lx, off_lx};
      }
      run.take(sent, readings);
    }
    for (const auto& [level, share] : run.curves()[f].of_level) {
      if (level == 1 || level < run.curves()[f].known_from) continue;
      ++shares;
      within_two += std::abs(share / std::pow(level, rig.exponent[f]) - 1) <= 2 * run.curves()[f].error;
    }
  }
  RecordProperty("within_two_errors", std::to_string(static_cast<double>(within_two) / static_cast<double>(shares)));
  EXPECT_GT(shares, 2000u);
  EXPECT_GE(static_cast<double>(within_two), 0.93 * static_cast<double>(shares));
}

TEST(MeterRun, IsExactWithoutNoise) {
  std::mt19937_64 random(22);
  for (int k = 0; k < 50; ++k) {
    TrueRig rig = random_rig(random, 12, 6);
    std::vector<double> levels(12, 1.0);
    MeterRun run(rig.rig, levels, rig.lux);
    for (std::size_t light = 0; light < run.plan().size(); ++light) {
      const std::vector<double> sent = levels_of(run.plan()[light], rig.rig);
      std::vector<std::optional<SteadyReading>> readings;
      for (const double lux : rig.truth_lx(sent)) readings.push_back(SteadyReading{lux, 1e-4});
      run.take(sent, readings);
    }
    for (std::size_t f = 0; f < 12; ++f)
      for (const auto& [level, share] : run.curves()[f].of_level)
        EXPECT_NEAR(share, std::pow(level, rig.exponent[f]), 1e-9 + 1e-4 * run.curves()[f].error);
    for (const LightReading& reading : run.readings())
      EXPECT_NEAR(reading.lux, reading.level.dot(rig.lux.row(static_cast<Index>(reading.meter))), 1e-9);
  }
}

// Lamps are ± 20 % off what is stated, their dimmers any of the field, and their mounts are off: a point has up to a
// quarter more of a lamp, over what a meter shows of it, than stated.
TEST(MeterRun, NoLightExceedsALimitAndTheDarkIsNeverLongAgo) {
  std::mt19937_64 random(23);
  std::uniform_real_distribution<double> unit(0, 1);
  int lamps = 0, brighter = 0;
  double first_share = 0, last_share = 0;
  for (int k = 0; k < 300; ++k) {
    TrueRig rig = random_rig(random, 12, 6);
    constexpr Index kPoints = 5;
    MatrixXd stated(kPoints + 6, 12), truth_lx(kPoints, 12);
    for (Index p = 0; p < kPoints; ++p) {
      Point point;
      point.max_lx = 50;
      rig.rig.points.push_back(point);
      for (Index f = 0; f < 12; ++f) {
        stated(p, f) = 150 * unit(random);
        truth_lx(p, f) = stated(p, f) * (0.8 + 0.45 * unit(random));
      }
    }
    for (Index f = 0; f < 12; ++f) {
      const double output = 0.8 + 0.4 * unit(random);
      truth_lx.col(f) *= output;
      stated.col(f).tail(6) = rig.lux.col(f) / output;
    }
    // One meter hangs at a point.
    rig.rig.luxmeters[0].point = 0;
    stated.row(0) = stated.row(kPoints);
    truth_lx.row(0) = rig.lux.row(0);
    for (Luxmeter& meter : rig.rig.luxmeters) meter.tolerance = 0.03;
    const std::vector<double> brightest = brightest_levels(rig.rig, stated);
    MeterRun run(rig.rig, brightest, stated);
    std::size_t since_dark = 0;
    const auto at_points = [&](std::span<const double> sent) {
      Eigen::VectorXd lux = Eigen::VectorXd::Zero(kPoints);
      for (std::size_t f = 0; f < 12; ++f)
        lux += std::pow(sent[f], rig.exponent[f]) * truth_lx.col(static_cast<Index>(f));
      return lux;
    };
    for (std::size_t light = 0; light < run.plan().size(); ++light) {
      const std::vector<LampStep> lit = run.plan()[light];
      since_dark = lit.empty() ? 0 : since_dark + 1;
      EXPECT_LE(since_dark, 8u);
      const std::vector<double> sent = levels_of(lit, rig.rig);
      EXPECT_LE(at_points(sent).maxCoeff(), 50) << "rig " << k << ", light " << light << ", " << lit.size() << " lamps";
      run.take(sent, rig.read(sent, random));
    }
    for (std::size_t f = 0; f < 12; ++f) {
      if (brightest[f] == 1) continue;
      ++lamps;
      brighter += run.brightest()[f] > 1.05 * brightest[f];
      EXPECT_GE(run.brightest()[f], brightest[f]);
      first_share += at_points(levels_of(LampStep{f, brightest[f]}, rig.rig)).maxCoeff() / 50;
      last_share += at_points(levels_of(LampStep{f, run.brightest()[f]}, rig.rig)).maxCoeff() / 50;
    }
  }
  EXPECT_GT(lamps, 1000);
  EXPECT_GT(brighter, lamps / 2);
  RecordProperty("of_a_limit_before", std::to_string(first_share / lamps));
  RecordProperty("of_a_limit", std::to_string(last_share / lamps));
  EXPECT_GT(last_share, 1.4 * first_share) << "how much of a limit a lamp may use alone";
}

TEST(MeterRun, ALightThatAMeterMissedIsSetOnceMore) {
  std::mt19937_64 random(25);
  const TrueRig rig = random_rig(random, 8, 4);
  const std::vector<double> levels(8, 1.0);
  MeterRun run(rig.rig, levels, rig.lux);
  const std::size_t first = run.plan().size();
  for (std::size_t light = 0; light < run.plan().size(); ++light) {
    const std::vector<double> sent = levels_of(run.plan()[light], rig.rig);
    auto readings = rig.read(sent, random);
    // Somebody stands before a meter while the lamps are on that it sees.
    if (light < first && (sent[1] > 0 || sent[5] > 0)) readings[1] = std::nullopt;
    run.take(sent, readings);
  }
  EXPECT_GE(run.readings().size(), 8u * 4u - 6u) << "all but what the other lamps give there";
  EXPECT_FALSE(run.curves()[1].of_level.empty());
  EXPECT_EQ(run.plan()[first].size(), 0u) << "the dark";
  for (const std::size_t k : {1, 2}) {
    ASSERT_EQ(run.plan()[first + k].size(), 1u);
    EXPECT_EQ(run.plan()[first + k][0].fixture, k == 1 ? 1u : 5u);
    EXPECT_EQ(run.plan()[first + k][0].level, 1);
  }
}

TEST(MeterRun, SaysNothingOfALampThatIsDeadNorOfMetersThatAreGone) {
  std::mt19937_64 random(24);
  TrueRig rig = random_rig(random, 9, 4);
  rig.lux.col(0).setZero();
  const std::vector<double> levels(9, 1.0);
  MeterRun run(rig.rig, levels, rig.lux);
  for (std::size_t light = 0; light < run.plan().size(); ++light) {
    const std::vector<double> sent = levels_of(run.plan()[light], rig.rig);
    auto readings = rig.read(sent, random);
    readings[1] = std::nullopt;
    if (light % 3 == 0) readings[2] = std::nullopt;
    run.take(sent, readings);
  }
  EXPECT_TRUE(run.curves()[0].of_level.empty());
  EXPECT_FALSE(run.readings().empty());
  for (const LightReading& reading : run.readings()) EXPECT_NE(reading.meter, 1u);

  MeterRun blind(rig.rig, levels, rig.lux);
  for (std::size_t light = 0; light < blind.plan().size(); ++light)
    blind.take(levels_of(blind.plan()[light], rig.rig), std::vector<std::optional<SteadyReading>>(4));
  EXPECT_TRUE(blind.readings().empty());
  for (const LampCurve& curve : blind.curves()) EXPECT_TRUE(curve.of_level.empty());
}

}  // namespace
}  // namespace luxrig
