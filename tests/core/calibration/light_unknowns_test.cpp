#include "core/calibration/light_unknowns.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <random>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Spots in a row before a wall with points; every third point has a meter. Lux of a spot: a beam I0 cos^40 over the
/// square of the distance; and a room that sends back a tenth of all its flux evenly, more with whiter paint.
struct Room {
  static constexpr Index kSpots = 6, kPoints = 18, kMeters = 6;
  LightPriors priors;
  std::mt19937_64 random;
  VectorXd output, mount, meter_log_gain;
  double paint = 0;
  MatrixXd rest;

  explicit Room(std::uint64_t seed) : random(seed) {
    priors.log_meter = VectorXd::Constant(kMeters, 0.01);
    output = normal(kSpots, priors.log_output);
    mount.resize(kSpots * kMountUnknowns);
    for (Index j = 0; j < kSpots; ++j) {
      mount.segment(kMountUnknowns * j, 3) = normal(3, priors.position_m);
      mount.segment(kMountUnknowns * j + 3, 3) = normal(3, priors.angle_rad);
    }
    meter_log_gain = normal(kMeters, 0.01);
    paint = normal(1, priors.reflectance)[0];
    rest.resize(kPoints + kMeters, kSpots);
    for (double& share : rest.reshaped()) share = normal(1, priors.rest_share)[0];
  }
  VectorXd normal(Index count, double sd) {
    std::normal_distribution<double> draw(0, sd);
    VectorXd values(count);
    for (double& value : values) value = draw(random);
    return values;
  }
  static Eigen::Vector3d place(Index receiver) {
    const auto p = static_cast<double>(receiver < kPoints ? receiver : 3 * (receiver - kPoints) + 1);
    return {p * 0.4, 0, 1.5 + 0.2 * std::sin(p)};
  }
  /// Direct light at level 1 and rated flux of spot j whose mount is off.
  static double direct_lx(Index receiver, Index j, const VectorXd& off) {
    const Eigen::Vector3d at = Eigen::Vector3d(0.4 + 1.2 * static_cast<double>(j), 2, 2.8) + off.head(3);
    Eigen::Vector3d aim = Eigen::Vector3d(0.4 + 1.2 * static_cast<double>(j), 0, 1.5) -
                          Eigen::Vector3d(0.4 + 1.2 * static_cast<double>(j), 2, 2.8);
    const double angle = off.tail(3).norm();
    if (angle > 0) aim = Eigen::AngleAxisd(angle, Eigen::Vector3d(off.tail(3) / angle)) * aim;
    const Eigen::Vector3d to = place(receiver) - at;
    const double cos_beam = std::max(0.0, to.normalized().dot(aim.normalized()));
    return 2000 * std::pow(cos_beam, 40) * std::max(0.0, to.normalized().dot(Eigen::Vector3d(0, -1, 0))) /
           to.squaredNorm();
  }
  static constexpr double kIndirect_lx = 12;
  static LightSensitivity sensitivity(const VectorXd& mounts) {
    LightSensitivity light;
    light.lux.resize(kPoints + kMeters, kSpots);
    light.paint.assign(1, MatrixXd::Constant(kPoints + kMeters, kSpots, kIndirect_lx));
    for (Index j = 0; j < kSpots; ++j) {
      const VectorXd off = mounts.segment(kMountUnknowns * j, kMountUnknowns);
      MatrixXd slope(kPoints + kMeters, kMountUnknowns);
      for (Index r = 0; r < light.lux.rows(); ++r) {
        light.lux(r, j) = direct_lx(r, j, off) + kIndirect_lx;
        for (Index k = 0; k < kMountUnknowns; ++k) {
          VectorXd more = off, less = off;
          more[k] += 1e-4;
          less[k] -= 1e-4;
          slope(r, k) = (direct_lx(r, j, more) - direct_lx(r, j, less)) / 2e-4;
        }
      }
      light.mount.push_back(slope);
      MatrixXd bend(kPoints + kMeters, kMountUnknowns * kMountUnknowns);
      for (Index r = 0; r < light.lux.rows(); ++r)
        for (Index a = 0; a < kMountUnknowns; ++a)
          for (Index b = 0; b < kMountUnknowns; ++b) {
            const auto at = [&](double of_a, double of_b) {
              VectorXd moved = off;
              moved[a] += of_a;
              moved[b] += of_b;
              return direct_lx(r, j, moved);
            };
            const double h = 1e-3;
            bend(r, kMountUnknowns * a + b) = (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4 * h * h);
          }
      light.bend.push_back(bend);
    }
    return light;
  }
  [[nodiscard]] double true_lx(Index receiver, const VectorXd& level) const {
    double lux = 0;
    for (Index j = 0; j < kSpots; ++j) {
      const double all =
          std::exp(output[j]) *
          (direct_lx(receiver, j, mount.segment(kMountUnknowns * j, kMountUnknowns)) + kIndirect_lx * (1 + paint));
      lux += level[j] * all * (1 + rest(receiver, j));
    }
    return lux;
  }
  LightReading reading(std::size_t luxmeter, const VectorXd& level) {
    LightReading reading;
    reading.receiver = kPoints + luxmeter;
    reading.meter = luxmeter;
    reading.level = level;
    const double shown =
        std::exp(meter_log_gain[static_cast<Index>(luxmeter)]) * true_lx(kPoints + static_cast<Index>(luxmeter), level);
    reading.standard_error_lx = 0.005 * shown + 0.05;
    reading.lux = shown + normal(1, reading.standard_error_lx)[0];
    return reading;
  }
  /// Each spot alone at full light, at each meter.
  std::vector<LightReading> one_at_a_time() {
    std::vector<LightReading> all;
    for (Index j = 0; j < kSpots; ++j)
      for (std::size_t m = 0; m < kMeters; ++m) all.push_back(reading(m, VectorXd::Unit(kSpots, j)));
    return all;
  }
  /// Mounts that an estimate has found.
  static VectorXd found(const LightUnknowns& unknowns) {
    VectorXd mounts(kSpots * kMountUnknowns);
    for (Index j = 0; j < kSpots; ++j)
      mounts.segment(kMountUnknowns * j, kMountUnknowns) = unknowns.mount(static_cast<std::size_t>(j));
    return mounts;
  }
};

TEST(LightUnknowns, WithoutReadingsItSaysWhatTheFileSays) {
  LightSensitivity light = Room::sensitivity(VectorXd::Zero(Room::kSpots * kMountUnknowns));
  light.bend.clear();
  Room room(1);
  const LightUnknowns unknowns(light, room.priors);
  const VectorXd level = VectorXd::Constant(Room::kSpots, 0.5);
  const LightEstimate at = unknowns.at(4, level);
  EXPECT_NEAR(at.lux, 0.5 * light.lux.row(4).sum(), 1e-9);
  // In closed form: output, mount, paint and rest of each lamp, all independent but for the paint.
  double variance = std::pow(0.5 * Room::kSpots * Room::kIndirect_lx * room.priors.reflectance, 2);
  for (Index j = 0; j < Room::kSpots; ++j) {
    variance += std::pow(0.5 * light.lux(4, j), 2) *
                (std::pow(room.priors.log_output, 2) + std::pow(room.priors.rest_share, 2));
    variance +=
        0.25 *
        (light.mount[static_cast<std::size_t>(j)].row(4).head(3).squaredNorm() * std::pow(room.priors.position_m, 2) +
         light.mount[static_cast<std::size_t>(j)].row(4).tail(3).squaredNorm() * std::pow(room.priors.angle_rad, 2));
  }
  EXPECT_NEAR(at.standard_error_lx, std::sqrt(variance), 1e-9);
}

TEST(LightUnknowns, ALampIsAsUncertainAsItsDimmerAtTheLevelWhereItIsRead) {
  const Room room(3);
  LightPriors priors = room.priors;
  priors.dimmer_exponent = 0.5;
  priors.read_at = VectorXd::Constant(Room::kSpots, 0.4);
  LightUnknowns unknowns(Room::sensitivity(VectorXd::Zero(Room::kSpots * kMountUnknowns)), priors);
  EXPECT_NEAR(unknowns.gain_standard_error(0), std::hypot(priors.log_output, 0.5 * std::log(0.4)), 1e-12);
  VectorXd level = VectorXd::Constant(Room::kSpots, 0.4);
  level[0] = 1;
  unknowns.read_at(level);
  EXPECT_NEAR(unknowns.gain_standard_error(0), priors.log_output, 1e-12);
  EXPECT_NEAR(unknowns.gain_standard_error(1), std::hypot(priors.log_output, 0.5 * std::log(0.4)), 1e-12);
}

TEST(LightUnknowns, ReadingsOfSingleLampsTellOfPointsWithoutAMeterAndHowWell) {
  double before = 0, after = 0;
  int within_two = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Room room(seed);
    LightUnknowns unknowns(Room::sensitivity(VectorXd::Zero(Room::kSpots * kMountUnknowns)), room.priors);
    const VectorXd level = VectorXd::Constant(Room::kSpots, 0.6);
    for (std::size_t p = 0; p < Room::kPoints; ++p)
      before += std::pow(unknowns.at(p, level).lux / room.true_lx(static_cast<Index>(p), level) - 1, 2);
    unknowns.learn(room.one_at_a_time());
    for (int i = 0; i < 6; ++i) unknowns.relinearise(Room::sensitivity(Room::found(unknowns)));
    for (std::size_t p = 0; p < Room::kPoints; ++p) {
      const LightEstimate at = unknowns.at(p, level);
      const double truth = room.true_lx(static_cast<Index>(p), level);
      after += std::pow(at.lux / truth - 1, 2);
      within_two += std::abs(at.lux - truth) <= 2 * at.standard_error_lx;
      ++all;
    }
  }
  before = std::sqrt(before / all);
  after = std::sqrt(after / all);
  std::printf("rms error at points: %.1f %% before, %.1f %% after; %.1f %% of truths within two standard errors\n",
              100 * before, 100 * after, 100.0 * within_two / all);
  EXPECT_LT(after, 0.4 * before);
  EXPECT_GT(within_two, 0.92 * all);
  EXPECT_LT(within_two, 0.99 * all);
}

TEST(LightUnknowns, AReadingThatNothingExplainsChangesLittle) {
  Room room(3);
  LightUnknowns clean(Room::sensitivity(VectorXd::Zero(Room::kSpots * kMountUnknowns)), room.priors), spoilt = clean;
  std::vector<LightReading> readings = room.one_at_a_time();
  clean.learn(readings);
  readings[8].lux *= 0.1;  // a hand over the meter
  spoilt.learn(readings);
  const VectorXd level = VectorXd::Constant(Room::kSpots, 0.6);
  for (std::size_t p = 0; p < Room::kPoints; ++p)
    EXPECT_NEAR(spoilt.at(p, level).lux, clean.at(p, level).lux, 2.5 * clean.at(p, level).standard_error_lx) << p;
  EXPECT_LT(spoilt.surprise()[8], -10);
}

// Such as a luxmeter at a point: what of a lamp's light nothing explains there is then known, too.
TEST(LightUnknowns, AReadingAtAPlaceTellsMostOfThatPlace) {
  Room room(2);
  LightSensitivity light = Room::sensitivity(VectorXd::Zero(Room::kSpots * kMountUnknowns));
  for (std::size_t r = 0; r < static_cast<std::size_t>(Room::kPoints + Room::kMeters); ++r)
    light.place.push_back(r < Room::kPoints ? r : 3 * (r - Room::kPoints) + 1);
  LightSensitivity apart = light;
  apart.place.clear();
  LightUnknowns together(light, room.priors), other(apart, room.priors);
  const std::vector<LightReading> readings = room.one_at_a_time();
  together.learn(readings);
  other.learn(readings);
  const VectorXd level = VectorXd::Constant(Room::kSpots, 0.6);
  EXPECT_LT(together.at(4, level).standard_error_lx, 0.8 * other.at(4, level).standard_error_lx);
}

/// All that is asked and read as one Gaussian, conditioned on the readings: the textbook's way, in their own space.
TEST(LightUnknowns, WhatIsLeftIsTheGaussianConditionedOnTheReadings) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Room room(seed);
    room.priors.stray = VectorXd::Constant(2, 0.02);
    LightSensitivity light = Room::sensitivity(VectorXd::Zero(Room::kSpots * kMountUnknowns));
    light.bend.clear();
    for (Index r = 0; r < light.lux.rows(); ++r)
      light.place.push_back(
          static_cast<std::size_t>(r < Room::kPoints ? r : 3 * (r - Room::kPoints) + 1));  // meters hang at points
    const LightUnknowns before(light, room.priors);
    LightUnknowns after(light, room.priors);
    std::vector<LightQuery> all;
    for (std::size_t p = 0; p < Room::kPoints; ++p) all.push_back({p, room.normal(Room::kSpots, 1).cwiseAbs(), {}, {}});
    const auto asked = static_cast<Index>(all.size());
    // Read just what is expected, so that nothing is found to be off and the light's slopes stay.
    std::vector<LightReading> readings = room.one_at_a_time();
    for (LightReading& reading : readings) {
      LightQuery query{reading.receiver, reading.level, reading.meter, {}};
      if (room.random() % 2 == 0) query.showing.stray = {{room.random() % 2, 30}};
      reading.lux = before.at(reading.receiver, reading.level).lux;
      reading.showing = query.showing;
      all.push_back(std::move(query));
    }
    MatrixXd joint = before.covariance(all);
    const auto read = static_cast<Index>(readings.size());
    for (Index k = 0; k < read; ++k)
      joint(asked + k, asked + k) += std::pow(readings[static_cast<std::size_t>(k)].standard_error_lx, 2);
    const MatrixXd cross = joint.topRightCorner(asked, read);
    const MatrixXd left =
        joint.topLeftCorner(asked, asked) - cross * joint.bottomRightCorner(read, read).ldlt().solve(cross.transpose());
    after.learn(readings);
    const MatrixXd found = after.covariance({all.data(), static_cast<std::size_t>(asked)});
    EXPECT_LT((found - left).cwiseAbs().maxCoeff(), 1e-7 * joint.topLeftCorner(asked, asked).maxCoeff());
    for (Index q = 0; q < asked; ++q) {
      const LightQuery& query = all[static_cast<std::size_t>(q)];
      EXPECT_NEAR(std::pow(after.at(query.receiver, query.level).standard_error_lx, 2), left(q, q), 1e-6 * joint(q, q));
      EXPECT_NEAR(after.budget(query.receiver, query.level).sum(), left(q, q), 1e-6 * joint(q, q));
    }
  }
}

TEST(LightUnknowns, TheExpectedErrorOfAReadingIsTheOneItThenHas) {
  Room room(5);
  LightUnknowns unknowns(Room::sensitivity(VectorXd::Zero(Room::kSpots * kMountUnknowns)), room.priors);
  unknowns.learn(room.one_at_a_time());
  const VectorXd level = VectorXd::Constant(Room::kSpots, 0.6);
  LightReading planned = room.reading(2, VectorXd::Unit(Room::kSpots, 2));
  // A reading of just what is expected leaves the linear model where it is.
  planned.lux = unknowns.meter_gain(2) * unknowns.at(Room::kPoints + 2, planned.level).lux;
  const std::vector<LightQuery> asked = {{7, level, {}}, {planned.receiver, planned.level, planned.meter}};
  const MatrixXd covariance = unknowns.covariance(asked);
  const double noise_lx = planned.standard_error_lx;
  const double expected = std::sqrt(covariance(0, 0) - covariance(0, 1) * covariance(0, 1) /
                                                           (covariance(1, 1) + noise_lx * noise_lx) +
                                    std::pow(unknowns.at(7, level).standard_error_lx, 2) - covariance(0, 0));
  EXPECT_LT(expected, unknowns.at(7, level).standard_error_lx);
  unknowns.learn({&planned, 1});
  // Weights of the other readings move a little with each estimate.
  EXPECT_NEAR(unknowns.at(7, level).standard_error_lx, expected, 0.05 * expected);
}

}  // namespace
}  // namespace luxrig
