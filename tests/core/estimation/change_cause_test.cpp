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
