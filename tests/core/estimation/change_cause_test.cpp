#include "core/estimation/change_cause.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = ChangeCause::Kind;

/// Of a mean over a minute, of a meter whose single readings scatter by 2 %.
constexpr double kNoise = 0.0015;

/// Ten lamps over six meters: each lamp lights one or two, and all a little by reflection. The model is wrong by 10 % of
/// each entry.
class Room {
 public:
  static constexpr Index kLamps = 10, kMeters = 6;

  explicit Room(unsigned seed) : random_(seed) {
    true_.resize(kMeters, kLamps);
    for (Index m = 0; m < kMeters; ++m)
      for (Index f = 0; f < kLamps; ++f) true_(m, f) = 4 + 6 * uniform();
    for (Index f = 0; f < kLamps; ++f) {
      true_(f % kMeters, f) += 150 + 250 * uniform();
      if (uniform() < 0.7) true_((f + 1 + f % 3) % kMeters, f) += 30 + 120 * uniform();
    }
    level_.resize(kLamps);
    for (Index f = 0; f < kLamps; ++f) level_[f] = 0.4 + 0.6 * uniform();
    model_ = true_;
    for (double& entry : model_.reshaped()) entry *= 1 + 0.1 * normal();
  }
  double uniform() { return std::uniform_real_distribution<double>()(random_); }
  double normal() { return std::normal_distribution<double>()(random_); }
  [[nodiscard]] std::size_t any(Index of) { return static_cast<std::size_t>(random_() % static_cast<unsigned>(of)); }

  /// Readings under these levels of this light.
  [[nodiscard]] VectorXd readings(const MatrixXd& light, const VectorXd& level) {
    VectorXd lux = light * level;
    for (double& each : lux) each *= 1 + kNoise * normal();
    return lux;
  }
  [[nodiscard]] LightChange change(const VectorXd& now) {
    LightChange change;
    change.before_lx = readings(true_, level_);
    change.now_lx = now;
    change.error_lx = std::sqrt(2) * kNoise * change.before_lx;
    change.of_fixture = model_ * level_.asDiagonal();
    change.level = level_;
    return change;
  }

  MatrixXd true_, model_;
  VectorXd level_;

 private:
  std::mt19937_64 random_;
};

/// right: the true cause is the only one named. among: one of those named. open: no single cause is named.
struct Tally {
  int right = 0, among = 0, open = 0, wrong = 0;
  void count(const std::vector<ChangeCause>& causes, Kind kind, std::size_t who) {
    const bool named = std::any_of(causes.begin(), causes.end(), [&](const ChangeCause& cause) {
      return cause.kind == kind && std::find(cause.who.begin(), cause.who.end(), who) != cause.who.end();
    });
    if (named)
      ++(causes.size() == 1 ? right : among);
    else if (causes.empty() || causes.front().kind == Kind::unclear)
      ++open;
    else
      ++wrong;
  }
};

constexpr int kRooms = 200;

TEST(ChangeCause, NoiseHasNone) {
  for (unsigned seed = 0; seed < 2000; ++seed) {
    Room room(seed);
    EXPECT_TRUE(causes_of(room.change(room.readings(room.true_, room.level_))).empty()) << seed;
  }
}

TEST(ChangeCause, ALampThatGivesLessIsNamedWithItsShare) {
  Tally tally;
  for (unsigned seed = 0; seed < kRooms; ++seed) {
    Room room(seed);
    const std::size_t lamp = room.any(Room::kLamps);
    const double share = seed % 2 ? 0 : 0.6;
    MatrixXd light = room.true_;
    light.col(static_cast<Index>(lamp)) *= share;
    const auto causes = causes_of(room.change(room.readings(light, room.level_)));
    tally.count(causes, Kind::lamp, lamp);
    if (causes.size() == 1 && causes[0].kind == Kind::lamp) EXPECT_NEAR(causes[0].share, share, 0.25) << seed;
  }
  // Two lamps on the same meters in the same ratio cannot be told apart by them.
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GE(tally.right, 0.7 * kRooms);
  EXPECT_GE(tally.right + tally.among, 0.98 * kRooms);
}

TEST(ChangeCause, ACoveredMeterIsNamedAndNoLamp) {
  Tally tally;
  for (unsigned seed = 0; seed < kRooms; ++seed) {
    Room room(seed);
    const std::size_t meter = room.any(Room::kMeters);
    VectorXd now = room.readings(room.true_, room.level_);
    now[static_cast<Index>(meter)] *= 0.2 + 0.6 * room.uniform();
    tally.count(causes_of(room.change(now)), Kind::meter, meter);
  }
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GE(tally.right, 0.95 * kRooms);
}

TEST(ChangeCause, MetersThatAreExchangedAreNamedTogether) {
  Tally tally;
  for (unsigned seed = 0; seed < kRooms; ++seed) {
    Room room(seed);
    VectorXd now = room.readings(room.true_, room.level_);
    const std::size_t a = room.any(Room::kMeters), b = (a + 1) % Room::kMeters;
    if (std::abs(now[static_cast<Index>(a)] / now[static_cast<Index>(b)] - 1) < 0.25) continue;
    std::swap(now[static_cast<Index>(a)], now[static_cast<Index>(b)]);
    tally.count(causes_of(room.change(now)), Kind::meters_swapped, a);
  }
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GE(tally.right, 0.9 * (tally.right + tally.among + tally.open));
  EXPECT_GT(tally.right, kRooms / 2);
}

TEST(ChangeCause, LampsThatGetEachOthersLevelAreNamedTogether) {
  Tally tally;
  for (unsigned seed = 0; seed < kRooms; ++seed) {
    Room room(seed);
    const std::size_t a = room.any(Room::kLamps), b = (a + 1) % Room::kLamps;
    VectorXd level = room.level_;
    if (std::abs(level[static_cast<Index>(a)] - level[static_cast<Index>(b)]) < 0.2) continue;
    std::swap(level[static_cast<Index>(a)], level[static_cast<Index>(b)]);
    tally.count(causes_of(room.change(room.readings(room.true_, level))), Kind::lamps_swapped, a);
  }
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GE(tally.right, 0.75 * (tally.right + tally.among + tally.open));
  EXPECT_GE(tally.right + tally.among, 0.9 * (tally.right + tally.among + tally.open));
  EXPECT_GT(tally.right, kRooms / 4);
}

TEST(ChangeCause, AHeadThatShinesElsewhereIsNamed) {
  Tally tally;
  for (unsigned seed = 0; seed < kRooms; ++seed) {
    Room room(seed);
    const std::size_t lamp = room.any(Room::kLamps);
    MatrixXd light = room.true_;
    const auto f = static_cast<Index>(lamp);
    const auto from = static_cast<Index>(lamp % Room::kMeters), to = (from + 3) % Room::kMeters;
    light(to, f) += 0.7 * light(from, f);
    for (Index m = 0; m < Room::kMeters; ++m)
      if (m != to && light(m, f) > 20) light(m, f) *= 0.1 + 0.3 * room.uniform();
    tally.count(causes_of(room.change(room.readings(light, room.level_))), Kind::lamp_moved, lamp);
  }
  // Light that went from one meter to the other may look as if these were exchanged.
  EXPECT_LE(tally.wrong, 0.02 * kRooms);
  EXPECT_GE(tally.right + tally.among, 0.8 * kRooms);
}

TEST(ChangeCause, AllLightAndDaylightAreNoFault) {
  for (unsigned seed = 0; seed < kRooms; ++seed) {
    Room room(seed);
    const auto all = causes_of(room.change(0.9 * room.readings(room.true_, room.level_)));
    ASSERT_EQ(all.size(), 1u) << seed;
    EXPECT_EQ(all[0].kind, Kind::all_light);
    EXPECT_NEAR(all[0].share, 0.9, 0.01);
    LightChange cloud = room.change(room.readings(room.true_, room.level_));
    cloud.daylight = VectorXd::LinSpaced(Room::kMeters, 20, 120);
    cloud.before_lx += cloud.daylight;
    cloud.now_lx += 0.5 * cloud.daylight;
    const auto day = causes_of(cloud);
    ASSERT_EQ(day.size(), 1u) << seed;
    EXPECT_EQ(day[0].kind, Kind::daylight);
  }
}

TEST(ChangeCause, WhereOneMeterAloneSeesALampBothAreNamed) {
  LightChange change;
  change.before_lx = VectorXd::Constant(3, 100);
  change.now_lx = change.before_lx;
  change.now_lx[1] = 40;
  change.error_lx = VectorXd::Constant(3, 0.5);
  change.of_fixture = MatrixXd::Identity(3, 3) * 100;
  change.level = VectorXd::Ones(3);
  const auto causes = causes_of(change);
  ASSERT_EQ(causes.size(), 2u);
  EXPECT_NE(causes[0].kind, causes[1].kind);
  for (const ChangeCause& cause : causes) EXPECT_EQ(cause.who, std::vector<std::size_t>{1});
}

/// Two lamps over two meters and a third that sees both; all as before but for the change and the dips.
LightChange two_lamps(const MatrixXd& light, const VectorXd& now) {
  LightChange change;
  change.of_fixture = light;
  change.fixture_error = 0.05 * light;
  change.level = VectorXd::Constant(light.cols(), 0.5);
  change.before_lx = light.rowwise().sum();
  change.now_lx = now;
  change.error_lx = VectorXd::Constant(light.rows(), 0.3);
  return change;
}

LampDip dip_of(std::size_t lamp, const VectorXd& change_lx) {
  return {lamp, 0.8, change_lx, VectorXd::Constant(change_lx.size(), 0.3)};
}

TEST(ChangeCause, ADipTellsADeadLampFromACoveredMeter) {
  const MatrixXd light{{80, 20}, {0.1, 90}};
  LightChange change = two_lamps(light, VectorXd{{20, 90.1}});
  const auto either = likely_causes(change);
  ASSERT_EQ(either.size(), 2u);
  const std::vector<std::uint8_t> may{1, 1}, may_not{0, 0};
  EXPECT_EQ(lamp_that_tells(change, either, may, 0.8, change.error_lx), 0u);
  EXPECT_FALSE(lamp_that_tells(change, either, may_not, 0.8, change.error_lx));

  change.dips = {dip_of(0, VectorXd{{0, 0}})};  // a dead lamp has nothing to lose
  auto causes = causes_of(change);
  ASSERT_EQ(causes.size(), 1u);
  EXPECT_EQ(causes[0].kind, Kind::lamp);
  EXPECT_NEAR(causes[0].share, 0, 0.1);

  change.dips = {dip_of(0, VectorXd{{-0.2 * 0.2 * 80, -0.02}})};  // a fifth of what the covered meter still sees of it
  causes = causes_of(change);
  ASSERT_EQ(causes.size(), 1u);
  EXPECT_EQ(causes[0].kind, Kind::meter);
  EXPECT_NEAR(causes[0].share, 0.2, 1e-9);
}

TEST(ChangeCause, ADipTellsExchangedMetersFromExchangedLamps) {
  const MatrixXd light{{100, 1}, {1, 80}, {10, 1}};
  LightChange change = two_lamps(light, VectorXd{{81, 101, 11}});
  change.level = VectorXd{{0.5, 0.4}};
  // Meters: the third reads as before, and sees the first lamp dip.
  change.dips = {dip_of(0, VectorXd{{-0.2, -20, -2}})};
  const auto meters = causes_of(change);
  ASSERT_EQ(meters.size(), 1u);
  EXPECT_EQ(meters[0].kind, Kind::meters_swapped);
  // Lamps: what is sent to the first dims the second.
  change.now_lx = VectorXd{{100 * 0.8 + 1.25, 0.8 + 100, 8 + 1.25}};
  change.dips = {dip_of(0, VectorXd{{-0.25, -20, -0.25}})};
  const auto lamps = causes_of(change);
  ASSERT_EQ(lamps.size(), 1u);
  EXPECT_EQ(lamps[0].kind, Kind::lamps_swapped);
}

TEST(ChangeCause, NoCauseIsNamedWronglyAfterDips) {
  Tally tally;
  for (unsigned seed = 0; seed < kRooms; ++seed) {
    Room room(seed);
    MatrixXd light = room.true_;
    VectorXd seen = VectorXd::Ones(Room::kMeters);
    const bool of_lamp = seed % 2 == 0;
    const std::size_t who = room.any(of_lamp ? Room::kLamps : Room::kMeters);
    if (of_lamp)
      light.col(static_cast<Index>(who)) *= seed % 4 == 0 ? 0 : 0.5;
    else
      seen[static_cast<Index>(who)] = 0.2 + 0.6 * room.uniform();
    LightChange change = room.change(seen.cwiseProduct(room.readings(light, room.level_)));
    const std::vector<std::uint8_t> may(Room::kLamps, 1);
    const VectorXd error = std::sqrt(2) * kNoise * change.before_lx;
    for (int k = 0; k < 3; ++k) {
      const auto likely = likely_causes(change);
      const auto lamp = lamp_that_tells(change, likely, may, 0.8, error);
      if (!lamp) break;
      VectorXd dipped = room.level_;
      dipped[static_cast<Index>(*lamp)] *= 0.8;
      LampDip dip{*lamp, 0.8, seen.cwiseProduct(room.readings(light, dipped)) - change.now_lx, error};
      change.dips.push_back(std::move(dip));
    }
    tally.count(causes_of(change), of_lamp ? Kind::lamp : Kind::meter, who);
  }
  EXPECT_LE(tally.wrong, kRooms / 50);
  EXPECT_GE(tally.right, 0.9 * kRooms);
}

TEST(ChangeCause, MetersThatAreNotReadSayNothing) {
  Room room(7);
  VectorXd now = room.readings(room.true_, room.level_);
  now.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(causes_of(room.change(now)).empty());
  EXPECT_TRUE(causes_of({VectorXd(0), VectorXd(0), VectorXd(0), MatrixXd(0, 0), VectorXd(0), VectorXd(0)}).empty());
  LightChange dark = room.change(room.readings(room.true_, room.level_));
  dark.of_fixture.setZero();
  dark.before_lx.setZero();
  dark.level.setZero();
  dark.error_lx.setConstant(0.1);
  for (const ChangeCause& cause : causes_of(dark)) EXPECT_EQ(cause.kind, Kind::unclear);
}

}  // namespace
}  // namespace luxrig
