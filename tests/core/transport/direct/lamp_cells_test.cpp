#include "core/transport/direct/lamp_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/transport/direct/emitter_sampler.h"

namespace luxrig {
namespace {

const Eigen::AlignedBox3d kHall_m(Vec3(0, 0, 0), Vec3(40, 20, 4));

/// Spots below the ceiling, aimed downwards at random. Some share a position, some are off.
struct HallOfSpots {
  explicit HallOfSpots(int count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < count; ++i) {
      const double tilt = 1.2 * uniform(random), turn = 2 * kPi * uniform(random);
      const Mat3 turned =
          (Eigen::AngleAxisd(turn, Vec3::UnitZ()) * Eigen::AngleAxisd(tilt, Vec3::UnitX())).toRotationMatrix();
      const Vec3 at_m(40 * uniform(random), 20 * uniform(random), 3.8);
      const double beam_rad = 0.2 + 0.4 * uniform(random);
      spots.push_back({make_spot(500, beam_rad, 2 * beam_rad), {turned, at_m}});
      if (i % 10 == 0) spots.push_back({make_spot(500, 0.3, 0.7), {Mat3::Identity(), at_m}});
    }
    for (std::size_t e = 0; e < spots.size(); ++e) levels.push_back(e % 7 == 0 ? 0 : 1);
  }
  std::vector<Emitter> spots;
  std::vector<double> levels;
};

struct SurfacePoint {
  Vec3 at_m, normal;
};
std::vector<SurfacePoint> points_in_hall(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  std::vector<SurfacePoint> points;
  for (int i = 0; i < count; ++i)
    points.push_back(
        {Vec3(40 * uniform(random), 20 * uniform(random), i % 3 == 0 ? 0 : 4 * uniform(random)),
         i % 3 == 0 ? Vec3(Vec3::UnitZ()) : Vec3(normal(random), normal(random), normal(random)).normalized()});
  return points;
}

TEST(LampCells, EveryLitLampCanBeChosenAndProbabilitiesAddUpToOne) {
  const HallOfSpots hall(600);
  const EmitterSampler lamps(hall.spots, hall.levels, kHall_m);
  EmitterSampler::Weights weights;
  int lit = 0, of_rest = 0;
  for (const SurfacePoint& point : points_in_hall(300)) {
    const double sum = lamps.weigh(point.at_m, point.normal, weights);
    EXPECT_LE(weights.places.size(), 150u) << "of 600 places";
    lamps.light(nullptr, point.at_m, point.normal, [&](std::size_t e, double lux) {
      ++lit;
      EXPECT_GT(lamps.choice_density(e, point.at_m, Vec3::UnitZ(), weights, sum), 0) << "spot " << e << ": " << lux;
    });
    double of_all = 0;
    for (const double one : weights.places) of_all += one / sum;
    for (const float one : weights.cell->rest_lx) of_all += static_cast<double>(one) / sum;
    of_rest += weights.cell->rest.empty() ? 0 : 1;
    EXPECT_NEAR(of_all, sum > 0 ? 1 : 0, 1e-9);
  }
  EXPECT_GT(lit, 1000);
  EXPECT_GT(of_rest, 200);
}

/// Σ lux / density over evenly spaced choices is the light of all lamps, those weighed one by one and the rest.
TEST(LampCells, ChoicesSumToTheLightOfAllLamps) {
  const HallOfSpots hall(300);
  const EmitterSampler lamps(hall.spots, hall.levels, kHall_m);
  EmitterSampler::Weights weights;
  constexpr int kChoices = 200'000;
  for (const SurfacePoint& point : points_in_hall(12)) {
    double exact_lx = 0, chosen_lx = 0;
    lamps.light(nullptr, point.at_m, point.normal, [&](std::size_t, double lux) { exact_lx += lux; });
    const double sum = lamps.weigh(point.at_m, point.normal, weights);
    for (int i = 0; i < kChoices; ++i) {
      const EmitterChoice choice = lamps.choose(point.at_m, point.normal, weights, sum, (i + 0.5) / kChoices, 0.5, 0.5);
      if (!(choice.density > 0)) continue;
      lamps.light(choice, [&](std::size_t e, double lux, double) {
        chosen_lx += lux / kChoices;
        EXPECT_NEAR(choice.density, lamps.choice_density(e, point.at_m, choice.direction_world, weights, sum),
                    1e-12 * choice.density);
      });
    }
    // Even spacing samples each place to within one choice.
    EXPECT_NEAR(chosen_lx, exact_lx, 0.01 * exact_lx + 1e-9);
  }
}

TEST(LampCells, FewLampsAndPointsOutsideWeighEveryLamp) {
  const HallOfSpots few(80), many(600);
  EmitterSampler::Weights weights;
  const EmitterSampler of_few(few.spots, {}, kHall_m), of_many(many.spots, {}, kHall_m);
  for (const SurfacePoint& point : points_in_hall(20)) {
    of_few.weigh(point.at_m, point.normal, weights);
    EXPECT_EQ(weights.places.size(), 80u);
    EXPECT_TRUE(weights.cell->rest.empty());
    of_many.weigh(point.at_m + Vec3(0, 0, 5), point.normal, weights);
    EXPECT_EQ(weights.places.size(), 600u);
    EXPECT_TRUE(weights.cell->rest.empty());
  }
}

}  // namespace
}  // namespace luxrig
