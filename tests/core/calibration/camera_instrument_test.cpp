#include "core/calibration/camera_instrument.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/calibration/exposures.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kWidth_px = 640, kHeight_px = 400;

/// Two kinds of lamps before a wall of two materials that a camera sees; one luxmeter in a hand.
struct SeenWall {
  static constexpr Index kLamps = 4, kPlaces = 40, kPoints = 3;
  Rig rig;
  LightPriors priors;
  LightSensitivity light;
  std::mt19937_64 random;
  std::normal_distribution<double> normal;

  explicit SeenWall(std::uint64_t seed) : random(seed) {
    rig.luminaires.resize(2);
    rig.fixtures.resize(kLamps);
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f) rig.fixtures[f].luminaire = f / 2;
    priors.log_meter = VectorXd::Constant(1, 0.01);
    priors.rest_share = 1e-3;
    priors.position_m = priors.angle_rad = 1e-4;
    light.lux.resize(kPoints + kPlaces, kLamps);
    for (double& lux : light.lux.reshaped()) lux = 100 * std::exp(normal(random));
    light.mount.assign(kLamps, Eigen::MatrixXd::Zero(kPoints + kPlaces, kMountUnknowns));
    light.paint.assign(2, Eigen::MatrixXd::Zero(kPoints + kPlaces, kLamps));
  }
  [[nodiscard]] SeenPlace place(Index k) {
    std::uniform_real_distribution<double> any(3, 397);
    SeenPlace place;
    place.material = static_cast<std::size_t>(k % 2);
    place.reflectance = 0.5;
    place.x_px = any(random) * kWidth_px / kHeight_px;
    place.y_px = any(random);
    return place;
  }
};

double lens(double rho2) { return std::pow(1 + 0.2 * rho2, -2); }

double rho2_of(const SeenPlace& place) {
  return (std::pow(place.x_px - kWidth_px / 2.0, 2) + std::pow(place.y_px - kHeight_px / 2.0, 2)) /
         (std::pow(kWidth_px / 2.0, 2) + std::pow(kHeight_px / 2.0, 2));
}

// A camera that loses 31 % in the corners, sees one kind of lamp three times as bright as the other, paint that is not as
// stated, and a veil: with one reading by hand of one lamp of each kind, all of it and the light follow.
TEST(CameraInstrument, FindsLensResponsesAndFlareWithAReadingByHandForEachKindOfLamp) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SeenWall wall(seed);
    const CameraInstrument camera(wall.rig, 2, wall.priors);
    LightUnknowns known(wall.light, wall.priors);
    const double response[] = {0.6, 1.8}, paint[] = {1.08, 0.9}, flare = 0.02;
    VectorXd output(SeenWall::kLamps);
    for (double& gain : output) gain = std::exp(wall.priors.log_output * wall.normal(wall.random));
    std::vector<std::optional<SeenPlace>> places;
    for (Index k = 0; k < SeenWall::kPlaces; ++k) places.emplace_back(wall.place(k));
    std::vector<LightReading> readings;
    for (Index j = 0; j < SeenWall::kLamps; ++j) {
      std::vector<std::optional<SeenLight>> light;
      double mean_lx = 0;
      for (Index k = 0; k < SeenWall::kPlaces; ++k) {
        const SeenPlace& at = *places[static_cast<std::size_t>(k)];
        light.emplace_back(SeenLight{wall.light.lux(SeenWall::kPoints + k, j) * output[j] * paint[at.material] *
                                         response[j / 2] * lens(rho2_of(at)),
                                     0.01, 0, 0});
        mean_lx += light.back()->lux / SeenWall::kPlaces;
      }
      for (auto& seen : light) {
        seen->lux = (1 - flare) * seen->lux + flare * mean_lx;
        seen->veil_lx = mean_lx - seen->lux;
        seen->lux *= std::exp(0.01 * wall.normal(wall.random));
      }
      const auto seen =
          camera.readings(places, light, kWidth_px, kHeight_px, SeenWall::kPoints, VectorXd::Unit(SeenWall::kLamps, j));
      readings.insert(readings.end(), seen.begin(), seen.end());
    }
    for (const Index j : {0, 2}) {
      const double lux = wall.light.lux(0, j) * output[j];
      readings.push_back({0, 0, lux, 0.005 * lux, VectorXd::Unit(SeenWall::kLamps, j), 0, {}});
    }
    known.learn(readings);
    CalibratedCamera kept;
    camera.put(wall.rig, known, kept);
    double log_loss = 0;
    for (const Known& part : kept.lens_loss) log_loss += part.value;
    EXPECT_NEAR(std::exp(-log_loss), camera.lens_share(known, 1), 1e-12) << "in a corner all powers are 1";
    EXPECT_EQ(kept.flare, (Known{known.stray(0), known.stray_standard_error(0)}));
    EXPECT_EQ(kept.halo, (Known{known.stray(1), known.stray_standard_error(1)}));
    ASSERT_EQ(kept.responses.size(), 2u);
    for (std::size_t l = 0; l < 2; ++l)
      EXPECT_NEAR(kept.responses[l].second.value, response[l], 4 * kept.responses[l].second.standard_error) << seed;
    for (const double rho2 : {0.25, 0.5, 0.9})
      EXPECT_NEAR(camera.lens_share(known, std::sqrt(rho2)), lens(rho2), 0.03) << seed;
    EXPECT_NEAR(known.meter_gain(camera.response_to(1)) / known.meter_gain(camera.response_to(0)), 3, 0.1) << seed;
    EXPECT_NEAR(known.paint(0) / known.paint(1), paint[0] / paint[1], 0.05) << seed;
    EXPECT_NEAR(known.stray(0), flare, 4 * known.stray_standard_error(0)) << seed;
    EXPECT_LT(known.stray_standard_error(0), 0.01) << seed;
    for (std::size_t p = 0; p < SeenWall::kPoints; ++p)
      for (Index j = 0; j < SeenWall::kLamps; ++j) {
        const LightEstimate found = known.at(p, VectorXd::Unit(SeenWall::kLamps, j));
        const double truth_lx = wall.light.lux(static_cast<Index>(p), j) * output[j];
        EXPECT_NEAR(found.lux, truth_lx, 4 * found.standard_error_lx) << seed;
        EXPECT_LT(found.standard_error_lx, 0.03 * truth_lx) << seed;
      }
  }
}

TEST(CameraInstrument, TheBudgetSumsToTheVarianceAndFallsWhereAReadingTells) {
  SeenWall wall(3);
  const CameraInstrument camera(wall.rig, 2, wall.priors);
  LightUnknowns known(wall.light, wall.priors);
  const VectorXd all = VectorXd::Ones(SeenWall::kLamps);
  std::vector<std::optional<SeenPlace>> places{wall.place(0), wall.place(1), std::nullopt, wall.place(3)};
  std::vector<std::optional<SeenLight>> light{SeenLight{150, 1, 20, 5}, SeenLight{120, 1, 40, -8}, std::nullopt,
                                              SeenLight{90, 1, 50, 30}};
  known.learn(camera.readings(places, light, kWidth_px, kHeight_px, SeenWall::kPoints, all));
  const auto variance = [&] {
    const LightQuery query{1, all, {}, {}};
    return known.covariance({&query, 1})(0, 0);
  };
  const CameraInstrument* const each[] = {&camera};
  const LightBudget before = known.budget(1, all);
  EXPECT_NEAR(before.sum(), variance(), 1e-9 * variance());
  const CameraBudget shares = budget_of(before, each);
  EXPECT_NEAR(
      shares.lens + shares.stray + shares.response + shares.reflectance + shares.lamps + shares.noise + shares.other, 1,
      1e-9);
  for (Index j = 0; j < SeenWall::kLamps; ++j)
    known.learn(
        std::vector<LightReading>{{1, 0, wall.light.lux(1, j), 0.5, VectorXd::Unit(SeenWall::kLamps, j), 0, {}}});
  const LightBudget after = known.budget(1, all);
  EXPECT_NEAR(after.sum(), variance(), 1e-9 * variance());
  EXPECT_LT(after.output, 0.05 * before.output);
}

TEST(CameraInstrument, TheBudgetOfTwoCamerasHasThePartsOfBoth) {
  SeenWall wall(3);
  const CameraInstrument left(wall.rig, 2, wall.priors), right(wall.rig, 2, wall.priors);
  LightUnknowns known(wall.light, wall.priors);
  const VectorXd all = VectorXd::Ones(SeenWall::kLamps);
  const std::vector<std::optional<SeenPlace>> near{wall.place(0), std::nullopt}, far{std::nullopt, wall.place(1)};
  const std::vector<std::optional<SeenLight>> light{SeenLight{150, 1, 20, 5}, SeenLight{120, 1, 40, -8}};
  known.learn(left.readings(near, light, kWidth_px, kHeight_px, SeenWall::kPoints, all));
  known.learn(right.readings(far, light, kWidth_px, kHeight_px, SeenWall::kPoints, all));
  const CameraInstrument *const one[] = {&left}, *const other[] = {&right}, *const both[] = {&left, &right};
  const LightBudget budget = known.budget(1, all);
  const CameraBudget of_left = budget_of(budget, one), of_right = budget_of(budget, other),
                     all_of_it = budget_of(budget, both);
  EXPECT_GT(of_right.response, 0);
  EXPECT_NEAR(all_of_it.response, of_left.response + of_right.response, 1e-12);
  EXPECT_NEAR(all_of_it.lens, of_left.lens + of_right.lens, 1e-12);
  EXPECT_NEAR(all_of_it.lamps, of_left.lamps, 1e-12) << "counted once";
  EXPECT_LT(all_of_it.other, of_left.other) << "what is the other camera's is not unexplained";
}

TEST(CameraInstrument, SaysNothingOfAKindOfLampThatItDidNotSee) {
  SeenWall wall(2);
  wall.rig.luminaires[0].name = "white";
  wall.rig.luminaires[1].name = "amber";
  wall.rig.points.resize(2);
  const CameraInstrument camera(wall.rig, 2, wall.priors);
  LightUnknowns known(wall.light, wall.priors);
  CalibratedCamera found;
  camera.put(wall.rig, known, found);
  EXPECT_TRUE(found.responses.empty());
  const std::vector<std::optional<SeenPlace>> places{wall.place(0), wall.place(1)};
  const std::vector<std::optional<SeenLight>> light{SeenLight{100, 1, 0, 0}, SeenLight{120, 1, 0, 0}};
  known.learn(
      camera.readings(places, light, kWidth_px, kHeight_px, SeenWall::kPoints, VectorXd::Unit(SeenWall::kLamps, 3)));
  camera.put(wall.rig, known, found);
  ASSERT_EQ(found.responses.size(), 1u);
  EXPECT_EQ(found.responses[0].first, "amber");

  const CameraInstrument* const each[] = {&camera};
  EXPECT_FALSE(budget_of_goals(wall.rig, known, VectorXd::Ones(SeenWall::kLamps), each)) << "no goal";
  for (Point& point : wall.rig.points) point.goal_lx = 100;
  const auto mean = budget_of_goals(wall.rig, known, VectorXd::Ones(SeenWall::kLamps), each);
  ASSERT_TRUE(mean);
  double sum = 0, of_lamps = 0;
  for (const CameraBudgetPart& part : kCameraBudgetParts) sum += *mean.*part.share;
  for (std::size_t p = 0; p < 2; ++p)
    of_lamps += budget_of(known.budget(p, VectorXd::Ones(SeenWall::kLamps)), each).lamps / 2;
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_NEAR(mean->lamps, of_lamps, 1e-12);
}

TEST(CameraInstrument, LeavesOutPlacesThatShowHardlyAnythingOfALamp) {
  SeenWall wall(1);
  const CameraInstrument camera(wall.rig, 2, wall.priors);
  const std::vector<std::optional<SeenPlace>> places{wall.place(0), wall.place(1), std::nullopt};
  const std::vector<std::optional<SeenLight>> light{SeenLight{100, 1, 0, 0}, SeenLight{1, 1, 0, 0}, std::nullopt};
  const auto readings = camera.readings(places, light, kWidth_px, kHeight_px, 7, VectorXd::Unit(SeenWall::kLamps, 1));
  ASSERT_EQ(readings.size(), 1u);
  EXPECT_EQ(readings[0].receiver, 7u);
  EXPECT_EQ(readings[0].showing.paint, 0u);
}

TEST(Exposures, AreMergedWhereTheLongerOneIsFull) {
  Picture longer, shorter;
  for (Picture* picture : {&longer, &shorter}) picture->width_px = 3, picture->height_px = 1;
  longer.luminance_cd_m2 = {Vec3f::Constant(1), Vec3f::Constant(10), Vec3f(3, 10, 3)};  // full at 10
  shorter.luminance_cd_m2 = {Vec3f::Constant(2), Vec3f::Constant(40), Vec3f(3, 18, 3)};
  const Picture merged = merged_exposures(std::vector{longer, shorter});
  EXPECT_EQ(merged.luminance_cd_m2[0], Vec3f(1, 1, 1));
  EXPECT_EQ(merged.luminance_cd_m2[1], Vec3f(40, 40, 40));
  EXPECT_EQ(merged.luminance_cd_m2[2], Vec3f(3, 18, 3));
}

/// A wall with noise, and a lamp of 100 pixels in it that is brighter than the samples go.
Picture lamp_on_wall(double lamp, double full, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Picture picture;
  picture.width_px = picture.height_px = 100;
  for (int i = 0; i < 10000; ++i) {
    const double light = (i < 100 ? lamp : 2) * (1 + 0.005 * normal(random));
    picture.luminance_cd_m2.push_back(
        Vec3f::Constant(static_cast<float>(std::round(std::min(light / full, 1.0) * 4095) / 4095 * full)));
  }
  return picture;
}

TEST(Exposures, TellWhichPixelsAreFullInTheShortest) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_EQ(cut_pixels(lamp_on_wall(50, 10, seed)), 100u) << "cut";
    EXPECT_EQ(cut_pixels(lamp_on_wall(8, 10, seed)), 0u) << "the brightest, but not cut";
    EXPECT_EQ(cut_pixels(lamp_on_wall(2, 40, seed)), 0u) << "an even wall";
  }
  Picture black = lamp_on_wall(8, 10, 1);
  for (Vec3f& pixel : black.luminance_cd_m2) pixel.setZero();
  EXPECT_EQ(cut_pixels(black), 0u);

  const Picture cut = lamp_on_wall(50, 10, 3);
  const MergedPicture merged = merged_with_full({&cut, 1}, cut_pixels(cut));
  ASSERT_EQ(merged.full.size(), 10000u);
  for (std::size_t i = 0; i < merged.full.size(); ++i) EXPECT_EQ(merged.full[i], i < 100) << i;
  EXPECT_DOUBLE_EQ(merged.full_share(), 0.01);
  EXPECT_TRUE(merged_with_full({&cut, 1}, 0).full.empty());
  EXPECT_EQ(merged_with_full({&cut, 1}, 0).full_share(), 0);
}

}  // namespace
}  // namespace luxrig
