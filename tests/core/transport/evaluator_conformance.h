#pragma once
/// Requirements for every evaluator, whatever its method. To test a new one, add a line to the table of a program that
/// includes this header.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <thread>

#include "core/transport/evaluator.h"
#include "tests/core/transport/lamp_pose.h"

namespace luxrig::conformance {

struct Entry {
  const char* name;
  std::unique_ptr<Evaluator> (*make)(const Scene&, const RayScene&);  ///< keeps references to both
};

inline void PrintTo(const Entry& entry, std::ostream* out) { *out << entry.name; }

/// A room with a pillar, lamps and receivers. It can be moved, turned, mirrored and scaled as a whole.
struct Room {
  std::vector<Vec3> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Receiver> receivers;
  std::vector<Emitter> emitters;

  void add_box(const Vec3& low_m, const Vec3& high_m) {
    const auto first = static_cast<std::uint32_t>(vertices_m.size());
    for (int i = 0; i < 8; ++i)
      vertices_m.emplace_back(i & 1 ? high_m.x() : low_m.x(), i & 2 ? high_m.y() : low_m.y(),
                              i & 4 ? high_m.z() : low_m.z());
    constexpr std::uint32_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                            {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    for (const auto& f : kFaces) {
      triangles.push_back({first + f[0], first + f[1], first + f[2]});
      triangles.push_back({first + f[0], first + f[2], first + f[3]});
    }
  }

  Scene scene() const {
    Scene s;
    if (!vertices_m.empty()) s.origin_world_m = vertices_m.front();
    for (const Vec3& v : vertices_m) s.vertices_m.push_back((v - s.origin_world_m).cast<float>());
    s.triangles = triangles;
    s.material_of_triangle.assign(triangles.size(), 0);
    s.object_of_triangle.assign(triangles.size(), 0);
    s.materials = {{"paint", Vec3::Constant(0.6)}};
    s.object_names = {"scene"};
    return s;
  }

  /// point -> scale · linear · point + shift. `linear` is orthogonal and may mirror (the lamps are round).
  Room transformed(const Mat3& linear, double scale, const Vec3& shift_m) const {
    Room other = *this;
    const Mat3 handed = linear.determinant() < 0 ? Mat3(Vec3(-1, 1, 1).asDiagonal()) : Mat3(Mat3::Identity());
    const auto move = [&](const Vec3& p) { return Vec3(scale * (linear * p) + shift_m); };
    for (Vec3& v : other.vertices_m) v = move(v);
    for (Receiver& r : other.receivers) r = {move(r.position_world_m), linear * r.normal_world};
    for (Emitter& e : other.emitters)
      e.world_from_lamp = {linear * e.world_from_lamp.rotation * handed, move(e.world_from_lamp.translation_m)};
    return other;
  }
};

inline Room furnished_room() {
  Room room;
  room.add_box({-2, -1.5, 0}, {2, 1.5, 2.7});
  room.add_box({0.2, 0.1, 0}, {0.6, 0.5, 1.1});
  room.receivers = {{{-1, -0.5, 0.75}, Vec3::UnitZ()},
                    {{0.4, 0.3, 1.1}, Vec3::UnitZ()},
                    {{2, 0.2, 1.4}, -Vec3::UnitX()},
                    {{1.2, 1.0, 0}, Vec3::UnitZ()}};
  const Intensity spot = make_spot(900, rad_from_deg(36), rad_from_deg(60));
  room.emitters = {{spot, lamp_at({-1.2, 0.4, 2.5}, {0.4, 0.3, 1.1})},
                   {spot, lamp_at({1.2, -0.9, 2.5}, {-1, -0.5, 0.75})},
                   {make_isotropic(600), lamp_at({-0.4, -0.7, 2.0}, {-0.4, -0.7, 0})}};
  return room;
}

class EvaluatorConformance : public testing::TestWithParam<Entry> {
 protected:
  static EvaluateOptions quick() {
    EvaluateOptions options;
    options.wanted_relative_error = 0.05;
    return options;
  }
  static Result<TransportMatrix> evaluate(const Room& room, const EvaluateOptions& options = quick()) {
    const Scene scene = room.scene();
    const RayScene rays(scene);
    return GetParam().make(scene, rays)->evaluate(room.receivers, room.emitters, options);
  }
  static TransportMatrix matrix(const Room& room, const EvaluateOptions& options = quick()) {
    auto result = evaluate(room, options);
    EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().detail);
    return result ? *result : TransportMatrix{};
  }
  /// a = factor · b within four standard errors of both, plus the effect of rounding coordinates to float.
  static void expect_same_light(const TransportMatrix& a, const TransportMatrix& b, double factor = 1) {
    ASSERT_EQ(a.receivers(), b.receivers());
    ASSERT_EQ(a.emitters(), b.emitters());
    for (Eigen::Index e = 0; e < a.emitters(); ++e) {
      const Eigen::VectorXd only = Eigen::VectorXd::Unit(a.emitters(), e);
      const Eigen::VectorXd error_a = a.standard_error_lux(only), error_b = factor * b.standard_error_lux(only);
      for (Eigen::Index r = 0; r < a.receivers(); ++r)
        EXPECT_NEAR(a.lux_per_level(r, e), factor * b.lux_per_level(r, e),
                    4 * std::hypot(error_a[r], error_b[r]) + 1e-6 * a.lux_per_level.maxCoeff())
            << "receiver " << r << ", emitter " << e;
    }
    const double largest = a.direct_lux_per_level.maxCoeff();
    EXPECT_LT((a.direct_lux_per_level - factor * b.direct_lux_per_level).cwiseAbs().maxCoeff(), 1e-6 * largest);
  }
};

TEST_P(EvaluatorConformance, NamesItself) {
  const Scene nothing;
  const RayScene rays(nothing);
  EXPECT_EQ(GetParam().make(nothing, rays)->name(), GetParam().name);
}

TEST_P(EvaluatorConformance, GivesFiniteLuxOfAtLeastZeroAndNoLessThanDirect) {
  const auto m = matrix(furnished_room());
  EXPECT_TRUE(m.lux_per_level.allFinite());
  EXPECT_GE(m.direct_lux_per_level.minCoeff(), 0);
  EXPECT_GE((m.lux_per_level - m.direct_lux_per_level).minCoeff(), 0);
  EXPECT_GT(m.lux_per_level.maxCoeff(), 10);
  EXPECT_GT(m.rays, 0u);
}

TEST_P(EvaluatorConformance, DirectPartIsThatOfTheDirectEvaluator) {
  const Room room = furnished_room();
  const RayScene rays(room.scene());
  const auto direct = make_direct_evaluator(rays)->evaluate(room.receivers, room.emitters, {});
  EXPECT_EQ(matrix(room).direct_lux_per_level, direct->lux_per_level);
}

TEST_P(EvaluatorConformance, LuxIsLinearInLevelsAndAFreshEvaluationAgrees) {
  const Room room = furnished_room();
  const auto ones = matrix(room);
  auto options = quick();
  options.levels = {0.2, 0, 0.7};
  options.seed = 99;
  expect_same_light(ones, matrix(room, options));  // levels change the effort, not the matrix
  const Eigen::Vector3d a(0.2, 0, 0.7), b(0.1, 0.9, 0.3);
  EXPECT_LT((ones.lux(a + 2 * b) - ones.lux(a) - 2 * ones.lux(b)).norm(), 1e-12 * ones.lux(a).norm());
}

TEST_P(EvaluatorConformance, ReachesTheWantedErrorAndReportsIt) {
  const auto m = matrix(furnished_room());
  EXPECT_LE(m.relative_error, 0.05);
  EXPECT_EQ(m.relative_error > 0, !m.replicates.empty());
}

TEST_P(EvaluatorConformance, SameSeedGivesTheSameBitsForAnyNumberOfThreads) {
  auto options = quick();
  options.threads = 1;
  const auto one = matrix(furnished_room(), options);
  for (const int threads : {2, 5}) {
    options.threads = threads;
    const auto other = matrix(furnished_room(), options);
    EXPECT_EQ(one.lux_per_level, other.lux_per_level);
    EXPECT_EQ(one.replicates, other.replicates);
    EXPECT_EQ(one.rays, other.rays);
    EXPECT_EQ(one.relative_error, other.relative_error);
  }
}

TEST_P(EvaluatorConformance, AMirroredRoomHasTheSameLight) {
  const Room room = furnished_room();
  expect_same_light(matrix(room), matrix(room.transformed(Vec3(-1, 1, 1).asDiagonal(), 1, Vec3::Zero())));
}

TEST_P(EvaluatorConformance, MovingTheVenueAThousandKilometresChangesNothing) {
  const Room room = furnished_room();
  expect_same_light(matrix(room), matrix(room.transformed(Mat3::Identity(), 1, {1e6, -1e6, 500})));
}

TEST_P(EvaluatorConformance, TurningTheVenueChangesNothing) {
  const Room room = furnished_room();
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  expect_same_light(matrix(room), matrix(room.transformed(turn, 1, Vec3::Zero())));
}

TEST_P(EvaluatorConformance, LuxFallsWithTheSquareOfTheScaleFromMillimetresToKilometres) {
  const Room room = furnished_room();
  const auto m = matrix(room);
  for (const double scale : {1e-3, 1e3})
    expect_same_light(m, matrix(room.transformed(Mat3::Identity(), scale, Vec3::Zero())), scale * scale);
}

TEST_P(EvaluatorConformance, AReceiverThatFacesAwayFromEverythingIsDark) {
  Room room = furnished_room();
  room.triangles.clear();  // no walls, so no reflections
  room.receivers = {{{0, 0, 0}, -Vec3::UnitZ()}};
  const auto m = matrix(room);
  EXPECT_EQ(m.lux_per_level.cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(m.rays, 0u);
}

TEST_P(EvaluatorConformance, NothingToLightOrNothingThatShinesIsFine) {
  Room room = furnished_room();
  room.emitters.clear();
  auto m = matrix(room);
  EXPECT_EQ(m.receivers(), 4);
  EXPECT_EQ(m.emitters(), 0);
  EXPECT_EQ(m.lux(Eigen::VectorXd(0)), Eigen::VectorXd::Zero(4));
  EXPECT_EQ(m.standard_error_lux(Eigen::VectorXd(0)), Eigen::VectorXd::Zero(4));
  EXPECT_EQ(m.rays, 0u);
  room = furnished_room();
  room.receivers.clear();
  m = matrix(room);
  EXPECT_EQ(m.receivers(), 0);
  EXPECT_EQ(m.emitters(), 3);
  EXPECT_EQ(m.rays, 0u);
}

TEST_P(EvaluatorConformance, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refuses = [&](const Room& room, const EvaluateOptions& options) {
    const auto result = evaluate(room, options);
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().cause, Cause::invalid);
    EXPECT_FALSE(result.error().detail.empty());
  };
  Room room = furnished_room();
  room.receivers[1].position_world_m.y() = nan;
  refuses(room, quick());
  room = furnished_room();
  room.receivers[1].normal_world = Vec3::Zero();
  refuses(room, quick());
  room = furnished_room();
  room.emitters[2].world_from_lamp.rotation(0, 0) = nan;
  refuses(room, quick());
  room = furnished_room();
  room.receivers[0].position_world_m = room.emitters[0].world_from_lamp.translation_m;
  refuses(room, quick());
  auto options = quick();
  options.levels = {1, nan, 1};
  refuses(furnished_room(), options);
}

TEST_P(EvaluatorConformance, StopsWhenAskedBeforeAndDuringTheWork) {
  std::stop_source stop;
  auto options = quick();
  options.watch.stop = stop.get_token();
  options.wanted_relative_error = 1e-9;  // would run for days
  options.threads = 2;
  options.watch.progress = [&](double) { stop.request_stop(); };
  auto result = evaluate(furnished_room(), options);
  if (!result) {
    EXPECT_EQ(result.error().cause, Cause::cancelled);
  }
  EXPECT_TRUE(!result || result->replicates.empty()) << "only an exact evaluator may have finished first";
  stop.request_stop();
  result = evaluate(furnished_room(), options);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().cause, Cause::cancelled);
}

TEST_P(EvaluatorConformance, ProgressRisesFromZeroToOneOnTheCallingThread) {
  auto options = quick();
  options.threads = 2;
  std::vector<double> seen;
  const auto caller = std::this_thread::get_id();
  options.watch.progress = [&](double done) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    seen.push_back(done);
  };
  matrix(furnished_room(), options);
  ASSERT_FALSE(seen.empty());
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_GE(seen.front(), 0);
  EXPECT_EQ(seen.back(), 1.0);
}

TEST_P(EvaluatorConformance, CoincidentPointsAndLampsGetEqualLight) {
  Room room = furnished_room();
  room.receivers = {room.receivers[0], room.receivers[0]};
  room.emitters = {room.emitters[2], room.emitters[2]};
  const auto m = matrix(room);
  // The difference of two lamps with no true difference contains only noise.
  const Eigen::VectorXd difference_error_lx = m.standard_error_lux(Eigen::Vector2d(1, -1));
  EXPECT_EQ(m.direct_lux_per_level.col(0), m.direct_lux_per_level.col(1));
  for (Eigen::Index r = 0; r < 2; ++r)
    EXPECT_NEAR(m.lux_per_level(r, 0), m.lux_per_level(r, 1), 4 * difference_error_lx[r]);
  EXPECT_EQ(m.direct_lux_per_level.row(0), m.direct_lux_per_level.row(1));
  const Eigen::VectorXd error_lx = m.standard_error_lux(Eigen::Vector2d(1, 0));
  EXPECT_NEAR(m.lux_per_level(0, 0), m.lux_per_level(1, 0), 4 * error_lx.norm());
}

TEST_P(EvaluatorConformance, ASceneWithoutTrianglesIsOpenAir) {
  Room room = furnished_room();
  room.triangles.clear();
  const auto m = matrix(room);
  EXPECT_EQ(m.lux_per_level, m.direct_lux_per_level);
  EXPECT_EQ(m.rays, 0u);
  EXPECT_GT(m.lux_per_level.maxCoeff(), 0);
}

inline std::string name_of(const testing::TestParamInfo<Entry>& one) { return one.param.name; }

}  // namespace luxrig::conformance
