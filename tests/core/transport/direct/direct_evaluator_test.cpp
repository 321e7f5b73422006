#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "core/transport/direct/emitter_sampler.h"
#include "core/transport/evaluator.h"
#include "tests/core/transport/lamp_pose.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Scene wall_at_x(double x_m, double half_size_m) {
  Scene scene = make_cube(1, 0.5);
  const auto h = static_cast<float>(half_size_m), x = static_cast<float>(x_m);
  scene.vertices_m = {{x, -h, -h}, {x, h, -h}, {x, h, h}, {x, -h, h}};
  scene.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.material_of_triangle = scene.object_of_triangle = {0, 0};
  return scene;
}

TransportMatrix direct_matrix(const Scene& scene, const std::vector<Receiver>& receivers,
                              const std::vector<Emitter>& emitters) {
  const RayScene rays(scene);
  auto result = make_direct_evaluator(rays)->evaluate(receivers, emitters, {});
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().detail);
  return result ? *result : TransportMatrix{};
}

/// I(γ) = I0 cos γ about -Z, written here so that the expected values do not depend on our photometry.
class CosineLamp final : public IntensityDistribution {
 public:
  double intensity_cd(const Vec3& direction_lamp) const override { return std::max(0.0, -123.0 * direction_lamp.z()); }
  double flux_lm() const override { return 123 * kPi; }
  double max_intensity_cd() const override { return 123; }
  double emission_cone_rad() const override { return kPi; }
};

TEST(DirectEvaluator, MatchesTheDistanceLawAtAThousandRandomConfigurations) {
  std::mt19937_64 random(20240601);
  std::uniform_real_distribution<double> unit(-1, 1), exponent(-3, 4);
  const RayScene empty{Scene{}};
  const auto evaluator = make_direct_evaluator(empty);
  int lit = 0;
  for (int i = 0; i < 1000; ++i) {
    const double size_m = std::pow(10, exponent(random));  // millimetres to 10 km
    const auto any = [&] { return Vec3(unit(random), unit(random), unit(random)); };
    const Vec3 p = any() * size_m, q = any() * size_m, n = any().normalized(), axis = any().normalized();
    const Emitter lambertian{std::make_shared<CosineLamp>(), lamp_at(q, q + axis)};
    const Emitter isotropic{make_isotropic(777), lamp_at(q, q + axis)};
    const auto matrix =
        evaluator->evaluate(std::vector<Receiver>{{p, n}}, std::vector<Emitter>{lambertian, isotropic}, {});
    ASSERT_TRUE(matrix.has_value()) << matrix.error().detail;
    // In long double, from the coordinates alone.
    long double d2 = 0, nd = 0, ad = 0;
    for (int k = 0; k < 3; ++k) {
      const long double d = static_cast<long double>(q[k]) - p[k];
      d2 += d * d;
      nd += n[k] * d;
      ad -= axis[k] * d;
    }
    const long double d = std::sqrt(d2), geometry = std::max(nd / d, 0.0L) / d2;
    const auto lambertian_lx = static_cast<double>(123 * std::max(ad / d, 0.0L) * geometry);
    const auto isotropic_lx = static_cast<double>(777 / (4 * std::numbers::pi_v<long double>)*geometry);
    EXPECT_NEAR(matrix->lux_per_level(0, 0), lambertian_lx, 1e-5 * lambertian_lx) << i;
    EXPECT_NEAR(matrix->lux_per_level(0, 1), isotropic_lx, 1e-5 * isotropic_lx) << i;
    lit += lambertian_lx > 0;
  }
  EXPECT_GT(lit, 150);
}

TEST(DirectEvaluator, AWallCastsAShadowOnlyBehindIt) {
  const std::vector<Emitter> lamp = {{make_isotropic(4 * kPi), {Mat3::Identity(), {2, 0, 0}}}};
  const std::vector<Receiver> receivers = {{{0, 0, 0}, Vec3::UnitX()},    // behind the wall
                                           {{0, 5, 0}, Vec3::UnitX()},    // the line to the lamp passes beside the wall
                                           {{1.5, 0, 0}, Vec3::UnitX()},  // between wall and lamp
                                           {{1, 0, 0.25}, Vec3::UnitX()}};  // on the wall, lit side
  const auto matrix = direct_matrix(wall_at_x(1, 0.5), receivers, lamp);
  EXPECT_EQ(matrix.lux_per_level(0, 0), 0);
  EXPECT_NEAR(matrix.lux_per_level(1, 0), 2 / std::pow(29, 1.5), 1e-12);
  EXPECT_NEAR(matrix.lux_per_level(2, 0), 4, 1e-12);
  EXPECT_NEAR(matrix.lux_per_level(3, 0), 1 / std::pow(1.0625, 1.5), 1e-12);
  EXPECT_EQ(matrix.rays, 4u);
  EXPECT_EQ(matrix.relative_error, 0);
  EXPECT_TRUE(matrix.replicates.empty());
}

TEST(DirectEvaluator, LampsThatCannotContributeCastNoRay) {
  const Scene wall = wall_at_x(100, 0.5);
  const auto spot = make_spot(1000, rad_from_deg(20), rad_from_deg(30));
  const Receiver up{{0, 0, 0}, Vec3::UnitZ()};
  const Emitter above{make_isotropic(100), {Mat3::Identity(), {0, 0, 3}}};
  const Emitter below{make_isotropic(100), {Mat3::Identity(), {0, 0, -3}}};
  const Emitter in_plane{make_isotropic(100), {Mat3::Identity(), {3, 0, 0}}};
  const Emitter aimed_here{spot, lamp_at({0, 0, 3}, {0, 0, 0})};
  const Emitter aimed_away{spot, lamp_at({1, 0, 3}, {1, 0, 9})};
  EXPECT_EQ(direct_matrix(wall, {up}, {above}).rays, 1u);
  EXPECT_EQ(direct_matrix(wall, {up}, {below}).rays, 0u);
  EXPECT_EQ(direct_matrix(wall, {up}, {in_plane}).rays, 0u);
  EXPECT_EQ(direct_matrix(wall, {up}, {aimed_here}).rays, 1u);
  EXPECT_EQ(direct_matrix(wall, {up}, {aimed_away}).rays, 0u);
  EXPECT_EQ(direct_matrix(Scene{}, {up}, {above}).rays, 0u) << "an empty scene needs no ray";
}

TEST(DirectEvaluator, LampsInOnePlaceShareOneShadowRay) {
  const auto spot = make_spot(1000, rad_from_deg(60), rad_from_deg(80));
  std::vector<Emitter> aims;
  for (int i = 0; i < 50; ++i) aims.push_back({spot, lamp_at({0, 0, 3}, {0.01 * i, 0, 0})});
  const auto matrix = direct_matrix(wall_at_x(100, 0.5), {{{0, 0, 0}, Vec3::UnitZ()}}, aims);
  EXPECT_EQ(matrix.rays, 1u);
  EXPECT_GT(matrix.lux_per_level.minCoeff(), 0);
}

TEST(DirectEvaluator, AnEmitterInAReceiverIsRefusedByName) {
  const RayScene empty{Scene{}};
  const std::vector<Receiver> receivers = {{{0, 0, 0}, Vec3::UnitZ()}, {{1, 2, 3}, Vec3::UnitZ()}};
  const std::vector<Emitter> emitters = {{make_isotropic(1), {Mat3::Identity(), {5, 5, 5}}},
                                         {make_isotropic(1), {Mat3::Identity(), {1, 2, 3}}}};
  const auto result = make_direct_evaluator(empty)->evaluate(receivers, emitters, {});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().cause, Cause::invalid);
  EXPECT_NE(result.error().detail.find("emitter 1 lies in receiver 1"), std::string::npos) << result.error().detail;
}

TEST(DirectEvaluator, TheSmallestDistanceFollowsFromTheRoundingOfCoordinates) {
  const RayScene empty{Scene{}};
  const auto lux_at = [&](const Vec3& p, double distance_m) {
    return make_direct_evaluator(empty)->evaluate(
        std::vector<Receiver>{{p, Vec3::UnitZ()}},
        std::vector<Emitter>{{make_isotropic(4 * kPi), {Mat3::Identity(), p + Vec3(0, 0, distance_m)}}}, {});
  };
  for (const double coordinate_m : {0.0, 1.0, 1e3, 1e6}) {
    const Vec3 p = Vec3::Constant(coordinate_m);
    const double bound_m = std::max(smallest_distance_m(p, p), 1e-90);
    const auto near = lux_at(p, 2 * bound_m);
    ASSERT_TRUE(near.has_value()) << coordinate_m;
    const double expected = 1 / (4 * bound_m * bound_m);
    EXPECT_NEAR(near->lux_per_level(0, 0), expected, 1e-5 * expected) << coordinate_m;
  }
  EXPECT_FALSE(lux_at(Vec3::Constant(1e6), 1e-5).has_value());
}

TEST(DirectEvaluator, RefusesNonFiniteInputByName) {
  const RayScene empty{Scene{}};
  const auto evaluator = make_direct_evaluator(empty);
  const Receiver good{{0, 0, 0}, Vec3::UnitZ()};
  const Emitter lamp{make_isotropic(1), {Mat3::Identity(), {0, 0, 1}}};
  const auto refusal = [&](const Receiver& r, const Emitter& e, const EvaluateOptions& o) {
    const auto result = evaluator->evaluate(std::vector{good, r}, std::vector{lamp, e}, o);
    EXPECT_FALSE(result.has_value());
    return result ? std::string() : result.error().detail;
  };
  EXPECT_NE(refusal({{kNaN, 0, 0}, Vec3::UnitZ()}, lamp, {}).find("receiver 1"), std::string::npos);
  EXPECT_NE(refusal({{0, 0, 0}, {0, 0, 2}}, lamp, {}).find("length 2"), std::string::npos);
  EXPECT_NE(refusal({{0, 0, 0}, Vec3::Zero()}, lamp, {}).find("length 0"), std::string::npos);
  EXPECT_NE(refusal(good, {nullptr, {}}, {}).find("emitter 1"), std::string::npos);
  EXPECT_NE(refusal(good, {lamp.intensity, {Mat3::Identity(), {0, 0, HUGE_VAL}}}, {}).find("emitter 1"),
            std::string::npos);
  EXPECT_NE(refusal(good, {lamp.intensity, {2 * Mat3::Identity(), {0, 0, 1}}}, {}).find("rotation"), std::string::npos);
  EvaluateOptions options;
  options.levels = {1};
  EXPECT_NE(refusal(good, lamp, options).find("1 levels for 2 emitters"), std::string::npos);
  options.levels = {1, -0.5};
  EXPECT_NE(refusal(good, lamp, options).find("level of emitter 1"), std::string::npos);
  options.levels = {1, kNaN};
  EXPECT_NE(refusal(good, lamp, options).find("level of emitter 1"), std::string::npos);
  options = {};
  options.wanted_relative_error = kNaN;
  EXPECT_NE(refusal(good, lamp, options).find("wanted relative error"), std::string::npos);
}

}  // namespace
}  // namespace luxrig
