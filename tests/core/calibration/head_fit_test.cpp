#include "core/calibration/head_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace luxrig {
namespace {

constexpr Approach kSides[] = {{1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
const Vec3 kEye_m(0.3, 0.3, 2.8);

/// A head under the ceiling of a room of 8 × 7 × 3.5 m, and what a camera in its corner sees of its beam.
struct HeadInRoom {
  HeadPose truth;
  HeadKind kind;
  Vec3 camera_turn_rad = Vec3::Zero();
  std::mt19937_64 random;
  std::normal_distribution<double> normal;

  explicit HeadInRoom(std::uint64_t seed, const HeadKind& of = {}, double spread = 1) : kind(of), random(seed) {
    truth = start_of({Mat3::Identity(), Vec3(4, 3.5, 3.2)}, of);
    const HeadPriors priors;
    for (int k = 0; k < 3; ++k) {
      truth.parameters[kHeadOffset + k] = spread * priors.offset_m * normal(random);
      truth.parameters[kHeadTurn + k] = spread * priors.turn_rad * normal(random);
    }
    for (int k = 0; k < 2; ++k) {
      truth.parameters[kHeadAskew + k] = spread * priors.askew_rad * normal(random);
      truth.parameters[kHeadPanScale + k] += spread * priors.scale * normal(random);
      truth.parameters[kHeadPanPlay + k] = priors.play_rad * (1 + spread * normal(random));
    }
  }

  /// Where a ray from inside meets the room.
  static std::pair<Vec3, Vec3> wall(const Vec3& from_m, const Vec3& direction) {
    const Vec3 size_m(8, 7, 3.5);
    double nearest_m = 1e9;
    Vec3 normal_there = Vec3::UnitZ();
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(direction[axis]) < 1e-12) continue;
      const double side_m = direction[axis] > 0 ? size_m[axis] : 0;
      const double distance_m = (side_m - from_m[axis]) / direction[axis];
      if (distance_m >= nearest_m) continue;
      nearest_m = distance_m;
      normal_there = Vec3::Unit(axis) * (direction[axis] > 0 ? -1 : 1);
    }
    return {from_m + nearest_m * direction, normal_there};
  }

  /// At these joints; the true place is seen along a ray of a camera that is turned.
  HeadSighting sighting(const Joints& sent, const Approach& from, double noise_rad) {
    const auto [place_m, normal_there] = wall(truth.pivot_world_m(), truth.beam_world(sent, from));
    const Vec3 ray = rotated<double>(-camera_turn_rad, place_m - kEye_m);
    HeadSighting seen{sent, from, kEye_m, Vec3::Zero(), normal_there, std::max(noise_rad, 1e-5)};
    seen.position_world_m = kEye_m + ray * ((place_m - kEye_m).dot(normal_there) / ray.dot(normal_there));
    if (noise_rad > 0) {
      const Vec3 to_m = seen.position_world_m - truth.pivot_world_m();
      const Vec3 off = noise_rad * Vec3(normal(random), normal(random), normal(random));
      const Vec3 towards = to_m + to_m.norm() * off;
      seen.position_world_m = truth.pivot_world_m() + towards * (to_m.dot(normal_there) / towards.dot(normal_there));
    }
    return seen;
  }

  std::vector<HeadSighting> sightings(int count, double noise_rad) {
    std::vector<HeadSighting> list;
    std::uniform_real_distribution<double> pan(-2.5, 2.5), tilt(0.4, 1.1);
    for (int k = 0; k < count; ++k) {
      Joints sent{pan(random), (k % 2 ? 1 : -1) * tilt(random), 0};
      if (truth.upside_down) sent.tilt_rad = (k % 2 ? 1 : -1) * (2.35 - 0.3 * tilt(random));
      list.push_back(sighting(sent, kSides[k / 2 % 4], noise_rad));
    }
    return list;
  }
};

HeadPriors weak_priors() {
  HeadPriors weak;
  weak.offset_m = weak.turn_rad = weak.askew_rad = weak.scale = weak.play_rad = 10;
  return weak;
}

TEST(HeadFit, IsExactWithoutNoiseForEveryKind) {
  for (const HeadKind& kind : head_kinds()) {
    HeadInRoom room(7, kind);
    const auto seen = room.sightings(24, 0);
    // The priors hardly weigh against sightings that are exact.
    const HeadFit fit = fit_head(room.truth.stated, kind, seen, weak_priors());
    EXPECT_LT((fit.pose.parameters - room.truth.parameters).cwiseAbs().maxCoeff(), 1e-6) << words_of(kind);
    EXPECT_LT(*std::max_element(fit.off_rad.begin(), fit.off_rad.end()), 1e-7);
  }
}

TEST(HeadFit, TellsEachKindFromAllOthers) {
  for (const HeadKind& kind : head_kinds()) {
    HeadInRoom room(11, kind);
    const auto seen = room.sightings(12, 5e-4);
    const double cost = fit_head(room.truth.stated, kind, seen, {}).cost;
    for (const HeadKind& other : head_kinds()) {
      if (other == kind) continue;
      EXPECT_GT(fit_head(room.truth.stated, other, seen, {}).cost, cost + 12);
    }
  }
}

/// Over many heads drawn from the priors, the true parameters are off by what the covariance says.
TEST(HeadFit, KnowsItsErrors) {
  double of_aims = 0, aims = 0, of_all = 0;
  constexpr int kHeads = 60;
  for (int s = 0; s < kHeads; ++s) {
    HeadInRoom room(100 + static_cast<std::uint64_t>(s), {}, 0.8);
    const HeadFit fit = fit_head(room.truth.stated, {}, room.sightings(20, 6e-4), {});
    const HeadVector off = fit.pose.parameters - room.truth.parameters;
    of_all += off.dot(fit.covariance.topLeftCorner<kHeadParameters, kHeadParameters>().ldlt().solve(off));
    for (const HeadSighting& other : room.sightings(10, 0)) {
      of_aims += off_sight(fit, other).squaredNorm() / (2 * std::pow(aim_error_rad(fit, other), 2));
      ++aims;
    }
  }
  EXPECT_NEAR(of_all / kHeads, kHeadParameters, 4);
  EXPECT_NEAR(of_aims / aims, 1, 0.35);
}

TEST(HeadFit, StandsReflectionsAmongItsSightings) {
  HeadInRoom room(5);
  auto seen = room.sightings(18, 5e-4);
  for (const std::size_t k : {2U, 7U, 11U}) seen[k].position_world_m += Vec3(0.7, -0.4, 0);
  const HeadFit fit = fit_head(room.truth.stated, {}, seen, {});
  for (const HeadSighting& other : room.sightings(10, 0)) EXPECT_LT(off_sight(fit, other).norm(), rad_from_deg(0.1));
}

HeadResult concluded(HeadInRoom& room, std::vector<HeadSighting> fitted, std::vector<HeadSighting> held_out,
                     const HeadPriors& priors = {}) {
  HeadResult result;
  result.fit = fit_head(room.truth.stated, room.kind, fitted, priors);
  result.fitted = std::move(fitted);
  result.held_out = std::move(held_out);
  conclude(priors, result);
  return result;
}

TEST(HeadFit, IsFoundByItsTest) {
  HeadInRoom room(21);
  const HeadResult result = concluded(room, room.sightings(18, 5e-4), room.sightings(6, 5e-4));
  EXPECT_FALSE(result.refused) << *result.refused;
  EXPECT_TRUE(result.believed);
}

TEST(HeadFit, IsRefusedWhenPlacesKeptForTheTestAreMissed) {
  HeadInRoom room(22);
  auto fitted = room.sightings(18, 5e-4), held_out = room.sightings(6, 5e-4);
  for (std::size_t k = 0; k < 2; ++k) held_out[k].position_world_m += Vec3(0.05, 0.05, 0);
  const HeadResult result = concluded(room, fitted, held_out);
  ASSERT_TRUE(result.refused);
  EXPECT_NE(result.refused->find("kept for the test"), std::string::npos) << *result.refused;
  EXPECT_TRUE(concluded(room, fitted, {}).refused) << "no test";
}

TEST(HeadFit, IsRefusedWhenItsBeamDoesNotMove) {
  HeadInRoom room(23);
  auto fitted = room.sightings(18, 5e-4), held_out = room.sightings(6, 5e-4);
  for (auto* list : {&fitted, &held_out})
    for (HeadSighting& seen : *list) seen.position_world_m = fitted.front().position_world_m;
  EXPECT_TRUE(concluded(room, fitted, held_out).refused);
}

TEST(HeadFit, IsRefusedWhenAnotherHeadMoves) {
  HeadInRoom room(24), other(25);
  other.truth.stated.translation_m += Vec3(1.5, 1, 0);
  EXPECT_TRUE(concluded(room, other.sightings(18, 5e-4), other.sightings(6, 5e-4)).refused);
}

TEST(HeadFit, IsRefusedWhenAnotherKindExplainsAsWell) {
  HeadInRoom room(26);
  HeadResult result = concluded(room, room.sightings(18, 5e-4), room.sightings(6, 5e-4));
  EXPECT_TRUE(why_not_believed(result.fit, 3.0, result.fitted, result.held_out));
  EXPECT_FALSE(why_not_believed(result.fit, 300.0, result.fitted, result.held_out));
}

TEST(HeadFit, IsRefusedWhenItSawTooLittleToKnow) {
  HeadInRoom room(27);
  // One narrow place: the pose is open, though all of it is explained and the test is hit.
  std::vector<HeadSighting> fitted, held_out;
  for (int k = 0; k < 24; ++k)
    (k < 18 ? fitted : held_out).push_back(room.sighting({0.3 + 0.002 * k, 0.7, 0}, {}, 2e-3));
  EXPECT_TRUE(concluded(room, fitted, held_out).refused);
}

TEST(HeadsOfOneCamera, FindItsTurnTogether) {
  HeadPriors priors;
  priors.camera.covariance_rad2 = Mat3::Identity() * std::pow(rad_from_deg(1), 2);
  std::vector<HeadResult> results;
  std::vector<HeadInRoom> rooms;
  const Vec3 turn_rad(0.012, -0.009, 0.014);
  for (std::uint64_t h = 0; h < 6; ++h) {
    rooms.emplace_back(40 + h, HeadKind{}, 0.7);
    rooms.back().camera_turn_rad = turn_rad;
    results.push_back(
        concluded(rooms.back(), rooms.back().sightings(18, 4e-4), rooms.back().sightings(6, 4e-4), priors));
  }
  const auto error_of = [](const HeadResult& r) {
    return std::sqrt(r.fit.covariance.bottomRightCorner<3, 3>().trace());
  };
  double alone_rad = 0, together_rad = 0;
  for (const HeadResult& r : results) alone_rad += error_of(r) / 6;
  conclude_together(priors, results);
  for (const HeadResult& r : results) {
    together_rad += error_of(r) / 6;
    EXPECT_LT((r.fit.camera_turn_rad - turn_rad).norm(), 4 * error_of(r));
    EXPECT_FALSE(r.refused) << *r.refused;
  }
  EXPECT_LT(together_rad, 0.7 * alone_rad);
}

/// Whatever is seen, it ends, and with numbers.
TEST(HeadFit, EndsForAnything) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const auto vector = [&](double size) -> Vec3 { return size * Vec3(normal(random), normal(random), normal(random)); };
  for (int k = 0; k < 60; ++k) {
    HeadInRoom room(900 + static_cast<std::uint64_t>(k));
    std::vector<HeadSighting> seen;
    for (int n = static_cast<int>(random() % 12); n > 0; --n) {
      HeadSighting one{
          {normal(random), normal(random), 0}, kSides[random() % 4], kEye_m, vector(3), Vec3::UnitZ(), 1e-3};
      if (random() % 4 == 0) one.position_world_m = kEye_m;
      if (random() % 4 == 0) one.position_world_m = room.truth.stated.translation_m;
      if (random() % 4 == 0) one.normal_world = (one.position_world_m - kEye_m).unitOrthogonal();
      seen.push_back(one);
    }
    const HeadResult result = concluded(room, seen, seen);
    EXPECT_TRUE(result.refused);
    EXPECT_TRUE(result.fit.pose.parameters.allFinite());
  }
}

}  // namespace
}  // namespace luxrig
