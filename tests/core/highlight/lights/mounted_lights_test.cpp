#include "core/highlight/lights/mounted_lights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/highlight/shadow/direction_modes.h"
#include "tests/random.h"

namespace luxrig {
namespace {

/// A direction at most this far from another, uniform over the cap.
Vec3 direction_near(Random& random, const Vec3& middle, double within_rad) {
  const double z = random.between(std::cos(within_rad), 1), angle = random.between(0, 2 * kPi);
  const Vec3 x = middle.unitOrthogonal(), y = middle.cross(x);
  return std::sqrt(1 - z * z) * (std::cos(angle) * x + std::sin(angle) * y) + z * middle;
}

TEST(DirectionModes, LieAtTheCentresOfClusters) {
  Random random(1);
  for (int round = 0; round < 10; ++round) {
    const Vec3 a = random.direction(), b = direction_near(random, -a, 1);
    std::vector<Vec3f> directions;
    std::vector<double> weights;
    for (int i = 0; i < 3000; ++i) {
      const bool first = i % 3 != 0;
      directions.push_back(direction_near(random, first ? a : b, rad_from_deg(8)).cast<float>());
      weights.push_back(1);
    }
    const auto modes = direction_modes(directions, weights, rad_from_deg(20));
    ASSERT_EQ(modes.size(), 2u);
    // A mean of n directions within 8° is off by about 4°/√n.
    EXPECT_LT((modes[0].direction - a).norm(), rad_from_deg(0.5));
    EXPECT_LT((modes[1].direction - b).norm(), rad_from_deg(0.5));
    EXPECT_NEAR(modes[0].weight, 2000, 1e-9);
    EXPECT_NEAR(modes[1].weight, 1000, 1e-9);
  }
}

TEST(DirectionModes, RespectWeights) {
  const Vec3f a(1, 0, 0), b(0, 1, 0), c = Vec3f(1, 0.1f, 0).normalized();
  const std::vector<Vec3f> directions = {a, b, c, Vec3f(0, 0, 1)};
  const std::vector<double> weights = {3, 2, 1, 0};
  const auto modes = direction_modes(directions, weights, 0.3);
  ASSERT_EQ(modes.size(), 2u);
  const Vec3 mean = (3 * a.cast<double>() + c.cast<double>()).normalized();
  EXPECT_LT((modes[0].direction - mean).norm(), 1e-6);
  EXPECT_DOUBLE_EQ(modes[0].weight, 4);
  EXPECT_LT((modes[1].direction - Vec3::UnitY()).norm(), 1e-6);
  EXPECT_TRUE(direction_modes({}, {}, 0.3).empty());
  EXPECT_TRUE(direction_modes(std::vector<Vec3f>{a}, std::vector<double>{0.0}, 0.3).empty());
}

TEST(DirectionModes, AreFixedPointsOfTheShift) {
  Random random(2);
  for (const double window_rad : {0.02, 0.1, 0.5, 2.0, kPi}) {
    std::vector<Vec3f> directions;
    std::vector<double> weights;
    for (int i = 0; i < 400; ++i) {
      directions.push_back(direction_near(random, Vec3::UnitX(), 1).cast<float>());
      weights.push_back(random.between(0, 1));
    }
    const auto modes = direction_modes(directions, weights, window_rad);
    ASSERT_FALSE(modes.empty());
    std::size_t off = 0;
    for (const DirectionMode& mode : modes) {
      Vec3 sum = Vec3::Zero();
      for (std::size_t i = 0; i < directions.size(); ++i)
        if (std::acos(std::clamp(directions[i].cast<double>().dot(mode.direction), -1.0, 1.0)) <= window_rad)
          sum += weights[i] * directions[i].cast<double>();
      off += (sum.normalized() - mode.direction).norm() > 0.1 * window_rad ? 1 : 0;
    }
    // With few directions the mean moves if one is at the window's rim: its bin is in the window, the direction is not.
    EXPECT_LE(off, modes.size() / 10);
    for (std::size_t i = 0; i < modes.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_GE(modes[j].weight, modes[i].weight);
        EXPECT_GT((modes[i].direction - modes[j].direction).norm(), 2 * std::sin(0.5 * window_rad));
      }
  }
}

/// One cell with votes from blobs: (direction from the points to the cell, feature, votes).
DomainVotes one_cell(const std::vector<std::tuple<Vec3, std::uint32_t, int>>& blobs, unsigned seed) {
  Random random(seed);
  DomainVotes votes;
  votes.cells.push_back({{0, 0}, 0, Vec3(1, 2, 3)});
  std::uint32_t point = 0;
  for (const auto& [direction, feature, count] : blobs) {
    for (int i = 0; i < count; ++i) {
      const Vec3 d = direction_near(random, direction, rad_from_deg(3));
      votes.votes.push_back({point, feature, d.cast<float>(), 4});
      if (i % 2 == 1) ++point;  // two votes from each point
    }
    votes.features = std::max(votes.features, feature + 1);
  }
  votes.begin = {0, votes.votes.size()};
  votes.points_of_feature.assign(votes.features, 100);
  return votes;
}

TEST(PotentialLights, ShineOppositeToTheirVotes) {
  const Vec3 a = Vec3(1, 0.2, 0.4).normalized(), b = Vec3(-0.2, 1, 0.3).normalized(), c(0, 0, 1);
  const DomainVotes votes = one_cell({{a, 0, 200}, {a, 2, 100}, {b, 1, 100}, {c, 3, 6}}, 5);
  PotentialLightOptions options;
  options.beam_angle_rad = rad_from_deg(20);
  options.min_share = 0;
  const auto lights = potential_lights(votes, options);
  ASSERT_TRUE(lights);
  ASSERT_EQ(lights->lights.size(), 2u);  // six votes are too few
  EXPECT_LT((lights->lights[0].direction + a).norm(), rad_from_deg(0.5));
  EXPECT_LT((lights->lights[1].direction + b).norm(), rad_from_deg(0.5));
  EXPECT_EQ(lights->lights[0].position_world_m, Vec3(1, 2, 3));
  EXPECT_DOUBLE_EQ(lights->lights[0].weight, 75);  // 300 votes from 2 m
  ASSERT_EQ(lights->of(0).size(), 2u);
  EXPECT_EQ(lights->of(0)[0].feature, 0u);
  EXPECT_EQ(lights->of(0)[0].points, 100u);
  EXPECT_DOUBLE_EQ(lights->of(0)[0].weight, 50);
  EXPECT_EQ(lights->of(0)[1].feature, 2u);
  options.min_share = 0.5;
  EXPECT_EQ(potential_lights(votes, options)->lights.size(), 1u);
  options.beam_angle_rad = 2 * kPi;  // a bare lamp: all votes belong to one light
  EXPECT_EQ(potential_lights(votes, options)->lights[0].votes, 406u);
  options.min_votes = 1000;
  EXPECT_FALSE(potential_lights(votes, options));
  options = {};
  options.beam_angle_rad = 0;
  EXPECT_FALSE(potential_lights(votes, options));
  options.beam_angle_rad = std::nan("");
  EXPECT_FALSE(potential_lights(votes, options));
}

struct DrawnVote {
  std::uint32_t light, feature;
  double weight;
};

struct DrawnTable {
  std::vector<DrawnVote> votes;
  PotentialLights lights;

  DrawnTable(std::uint32_t light_count, std::uint32_t features, int per_light, unsigned seed) {
    Random random(seed);
    lights.features = features;
    lights.points_of_feature.assign(features, 10);
    for (std::uint32_t light = 0; light < light_count; ++light) {
      std::vector<double> of(features, 0);
      std::vector<std::uint32_t> points(features, 0);
      for (int k = 0; k < per_light; ++k) {
        const auto feature = static_cast<std::uint32_t>(random.below(features));
        const double weight = random.log_between(1e-4, 1e4);
        votes.push_back({light, feature, weight});
        of[feature] += weight;
        ++points[feature];
      }
      double sum = 0;
      for (std::uint32_t feature = 0; feature < features; ++feature) {
        if (points[feature] == 0) continue;
        lights.votes.push_back({feature, points[feature], of[feature]});
        sum += of[feature];
      }
      lights.begin.push_back(lights.votes.size());
      lights.lights.push_back({Vec3::Zero(), Vec3::UnitZ(), 0, static_cast<std::uint32_t>(per_light), sum});
    }
  }
};

/// The thesis's procedure, vote by vote: rank by summed weight, take the best, strike all votes of the features that
/// voted for it, rank again.
std::vector<std::uint32_t> chosen_vote_by_vote(std::vector<DrawnVote> votes, std::uint32_t lights,
                                               std::vector<double>& weights) {
  std::vector<std::uint32_t> chosen;
  while (!votes.empty()) {
    std::vector<double> sum(lights, 0);
    for (const DrawnVote& vote : votes) sum[vote.light] += vote.weight;
    const auto best = static_cast<std::uint32_t>(std::max_element(sum.begin(), sum.end()) - sum.begin());
    weights.push_back(sum[best]);
    chosen.push_back(best);
    std::vector<std::uint32_t> served;
    for (const DrawnVote& vote : votes)
      if (vote.light == best) served.push_back(vote.feature);
    std::erase_if(votes, [&](const DrawnVote& v) { return std::ranges::count(served, v.feature) > 0; });
  }
  return chosen;
}

TEST(LightSelection, MatchesStrikingOutVotesOneByOne) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const DrawnTable table(30, 60, 1 + static_cast<int>(seed % 7), seed);
    std::vector<double> weights;
    const auto expected = chosen_vote_by_vote(table.votes, 30, weights);
    LightSelection selection(table.lights);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(selection.count(expected[i]) / weights[i], 1, 1e-9);
      const auto light = selection.add();
      ASSERT_TRUE(light);
      EXPECT_EQ(*light, expected[i]);
    }
    EXPECT_FALSE(selection.add());
    // Every feature with a vote is served.
    std::vector<std::uint8_t> voted(60, 0);
    for (const DrawnVote& vote : table.votes) voted[vote.feature] = 1;
    EXPECT_DOUBLE_EQ(selection.coverage(), static_cast<double>(std::ranges::count(voted, 1)) / 60);
    EXPECT_DOUBLE_EQ(selection.point_coverage(), selection.coverage());
  }
}

TEST(LightSelection, DependsOnlyOnTheLightsTakenNotOnTheirOrder) {
  Random random(7);
  for (unsigned seed = 0; seed < 20; ++seed) {
    const DrawnTable table(40, 80, 6, 100 + seed);
    for (const double share : {0.0, 0.2}) {
      LightSelection walked(table.lights, share);
      for (int step = 0; step < 60; ++step) {
        if (!walked.taken().empty() && random.below(3) == 0) {
          walked.remove(random.below(walked.taken().size()));
        } else if (random.below(2) == 0) {
          walked.add();
        } else {
          const auto light = static_cast<std::uint32_t>(random.below(40));
          if (std::ranges::count(walked.taken(), light) == 0) walked.add(light);
        }
        LightSelection direct(table.lights, share);
        std::vector<std::uint32_t> sorted(walked.taken().begin(), walked.taken().end());
        std::sort(sorted.begin(), sorted.end());
        for (const std::uint32_t light : sorted) direct.add(light);
        for (std::uint32_t light = 0; light < 40; ++light) ASSERT_EQ(walked.count(light), direct.count(light));
        ASSERT_EQ(walked.coverage(), direct.coverage());
        for (std::uint32_t f = 0; f < 80; ++f) ASSERT_EQ(walked.is_served(f), direct.is_served(f));
      }
    }
  }
}

TEST(LightSelection, AddingRemovedLightsAgainMatchesSelectingAtOnce) {
  const DrawnTable table(50, 100, 8, 3);
  LightSelection at_once(table.lights);
  for (int i = 0; i < 6; ++i) at_once.add();
  LightSelection again(table.lights);
  for (int i = 0; i < 4; ++i) again.add();
  again.remove(3);
  again.remove(2);
  for (int i = 0; i < 4; ++i) again.add();
  EXPECT_TRUE(std::ranges::equal(at_once.taken(), again.taken()));
}

TEST(LightSelection, AStepTouchesOnlyTheEntriesOfItsFeatures) {
  const DrawnTable table(200, 500, 10, 9);
  LightSelection selection(table.lights);
  for (int i = 0; i < 5; ++i) {
    std::vector<std::uint8_t> served(500);
    for (std::uint32_t f = 0; f < 500; ++f) served[f] = selection.is_served(f) ? 1 : 0;
    const std::uint64_t before = selection.entries_changed();
    const std::uint32_t light = *selection.add();
    std::uint64_t expected = 0;
    for (const LightVote& entry : table.lights.votes)
      for (const LightVote& mine : table.lights.of(light))
        expected += mine.feature == entry.feature && !served[entry.feature] ? 1 : 0;
    EXPECT_EQ(selection.entries_changed() - before, expected);
    EXPECT_LT(expected, table.lights.votes.size() / 10);
    const std::uint64_t after = selection.entries_changed();
    selection.remove(selection.taken().size() - 1);
    EXPECT_EQ(selection.entries_changed() - after, expected);
    selection.add(light);
  }
}

TEST(LightSelection, AFeatureCanRequireAShareOfItsPointsToBeServed) {
  PotentialLights lights;
  lights.features = 2;
  lights.points_of_feature = {10, 10};
  lights.votes = {{0, 9, 9}, {1, 1, 1}, {1, 8, 8}};
  lights.begin = {0, 2, 3};
  lights.lights.assign(2, {Vec3::Zero(), Vec3::UnitZ(), 0, 10, 10});
  LightSelection any(lights, 0), half(lights, 0.5);
  EXPECT_EQ(any.add(), 0u);
  EXPECT_FALSE(any.add());
  EXPECT_EQ(half.add(), 0u);
  EXPECT_DOUBLE_EQ(half.coverage(), 0.5);
  EXPECT_EQ(half.add(), 1u);
  EXPECT_DOUBLE_EQ(half.coverage(), 1);
}

TEST(SelectLights, StopsAtTheWantedNumberCoverageOrContrast) {
  const DrawnTable table(50, 100, 6, 4);
  LightSelection by_number(table.lights);
  ASSERT_TRUE(select_lights(by_number, {5, {}, {}, 1}));
  EXPECT_EQ(by_number.taken().size(), 5u);
  LightSelection by_coverage(table.lights);
  ASSERT_TRUE(select_lights(by_coverage, {50, 0.4, {}, 1}));
  EXPECT_GE(by_coverage.coverage(), 0.4);
  by_coverage.remove(by_coverage.taken().size() - 1);
  EXPECT_LT(by_coverage.coverage(), 0.4);

  const std::vector<double> curve = {0, 1, 3, 2.9, 3.5, 3.4, 3.3, 9};
  const auto contrast = [&](std::span<const std::uint32_t> taken) { return curve[taken.size()]; };
  for (const auto& [patience, expected, asked] :
       {std::tuple(1, 2u, 3u), std::tuple(2, 4u, 6u), std::tuple(3, 7u, 7u)}) {
    LightSelection by_contrast(table.lights), at_once(table.lights);
    const auto contrasts = select_lights(by_contrast, {7, {}, contrast, patience});
    ASSERT_TRUE(contrasts);
    EXPECT_EQ(contrasts->size(), asked);
    EXPECT_EQ(by_contrast.taken().size(), expected);
    for (unsigned i = 0; i < expected; ++i) at_once.add();
    EXPECT_TRUE(std::ranges::equal(by_contrast.taken(), at_once.taken()));
    EXPECT_EQ(by_contrast.coverage(), at_once.coverage());
  }
  LightSelection none(table.lights);
  EXPECT_FALSE(select_lights(none, {0, {}, {}, 1}));
  EXPECT_FALSE(select_lights(none, {1, 1.5, {}, 1}));
  EXPECT_FALSE(select_lights(none, {1, {}, contrast, 0}));
}

}  // namespace
}  // namespace luxrig
