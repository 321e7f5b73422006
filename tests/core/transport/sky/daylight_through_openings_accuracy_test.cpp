/// daylight_through_openings: accuracy over many samples.
#include <gtest/gtest.h>

#include "core/photometry/sky/sky.h"
#include "core/picture/picture.h"
#include "tests/core/transport/sky/daylight_through_openings_fixture.h"
#include "tests/core/transport/sky/room_with_windows.h"
#include "tests/core/transport/within.h"

namespace luxrig {
namespace {

using namespace daylight_through_openings_fixture;

RoomWithWindows without_a_roof() {
  RoomWithWindows room;
  room.roof = false;
  return room;
}

struct OfRoom {
  const char* name;
  RoomWithWindows (*make)();
  Sky sky;
  int paths;
};

void PrintTo(const OfRoom& of, std::ostream* out) { *out << of.name; }

const Vec3 kTowardsSun = Vec3(0.2, -0.7, 0.6).normalized();

class Daylit : public testing::TestWithParam<OfRoom> {};
INSTANTIATE_TEST_SUITE_P(
    All, Daylit,
    testing::Values(OfRoom{"small_window", with_a_small_window, make_overcast_sky(10'000), 1'000'000},
                    OfRoom{"small_window_clear_sky", with_a_small_window, make_clear_sky(kTowardsSun, 10'000),
                           1'000'000},
                    OfRoom{"opposite_windows", with_windows_that_face_each_other, make_overcast_sky(10'000), 200'000},
                    OfRoom{"no_roof", without_a_roof, make_clear_sky(kTowardsSun, 10'000), 50'000}),
    [](const auto& of) { return of.param.name; });

TEST_P(Daylit, AgreesWithPlainPathsWithinTheStatedErrors) {
  const RoomWithWindows room = GetParam().make();
  const RayScene rays(room.scene());
  const auto path = evaluated(*make_path_evaluator(rays), room.desks(), under(GetParam().sky), within(0.02));
  std::vector<Receiver> many;
  for (int k = 0; k < 8; ++k)
    for (const Receiver& desk : room.desks()) many.push_back(desk);
  const auto gather = evaluated(*make_gather_evaluator(rays), many, under(GetParam().sky), within(0.02));
  for (std::size_t r = 0; r < room.desks().size(); ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    const BruteForce plain = lux_by_plain_paths(rays, room.desks()[r], *GetParam().sky, GetParam().paths, 7 + r);
    ASSERT_LT(plain.error_lx, 0.02 * plain.lux);
    for (const TransportMatrix* matrix : {&path, &gather}) {
      const double error_lx = matrix->standard_error_lux(Eigen::VectorXd::Ones(1))[row];
      EXPECT_NEAR(matrix->lux_per_level(row, 0), plain.lux, 3.5 * std::hypot(plain.error_lx, error_lx)) << r;
    }
  }
}

// The sun through the window lights a patch of the floor. The room gets Φ / (1 - ρ) less the light that leaves.
TEST(DaylightThroughOpenings, SunThroughAWindowMatchesPlainPathsFromItsPatch) {
  const RoomWithWindows room = with_a_small_window();
  const RayScene rays(room.scene());
  const auto matrix =
      evaluated(*make_path_evaluator(rays), room.desks(), under(make_sun(kTowardsSun, 50'000)), within(0.02));
  const Eigen::VectorXd error_lx = matrix.standard_error_lux(Eigen::VectorXd::Ones(1));
  EXPECT_LE(matrix.relative_error, 0.02);
  // Plain paths that sample the sun at each surface they hit. The sun counts as a point; there is no penumbra.
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t r = 0; r < room.desks().size(); ++r) {
    double sum = 0, squares = 0;
    constexpr int kPaths = 400'000;
    for (int p = 0; p < kPaths; ++p) {
      Receiver at = room.desks()[r];
      double lux = 0, through = 1;
      while (true) {
        const double cosine = at.normal_world.dot(kTowardsSun);
        if (cosine > 0 && !rays.nearest(at.position_world_m, kTowardsSun, at.normal_world))
          lux += through * 50'000 * cosine;
        const double radius = std::sqrt(unit(random)), angle = 2 * kPi * unit(random);
        const Vec3 u = at.normal_world.unitOrthogonal(), v = at.normal_world.cross(u);
        const Vec3 d = (radius * (std::cos(angle) * u + std::sin(angle) * v) +
                        std::sqrt(std::max(0.0, 1 - radius * radius)) * at.normal_world)
                           .normalized();
        const auto hit = rays.nearest(at.position_world_m, d, at.normal_world);
        if (!hit || unit(random) >= rays.material_of(hit->triangle).reflectance_rgb.x()) break;
        at = {hit->position_world_m, hit->normal_world};
      }
      sum += lux, squares += lux * lux;
    }
    const double mean = sum / kPaths, plain_error_lx = std::sqrt((squares / kPaths - mean * mean) / kPaths);
    const auto row = static_cast<Eigen::Index>(r);
    EXPECT_NEAR(matrix.lux_per_level(row, 0), mean, 3.5 * std::hypot(plain_error_lx, error_lx[row]) + 0.005 * mean)
        << r;
  }
}

TEST(DaylightThroughOpenings, StatedErrorsCoverTheTruthAsOftenAsTheyShould) {
  const RoomWithWindows room = with_a_small_window();
  const RayScene rays(room.scene());
  const auto evaluator = make_path_evaluator(rays);
  const auto emitters = under(make_overcast_sky(10'000));
  const auto truth = evaluated(*evaluator, room.desks(), emitters, within(0.01, 999));
  int inside = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto matrix = evaluated(*evaluator, room.desks(), emitters, within(0.1, seed));
    const Eigen::VectorXd error_lx = matrix.standard_error_lux(Eigen::VectorXd::Ones(1));
    for (Eigen::Index r = 0; r < matrix.receivers(); ++r, ++all)
      inside += std::abs(matrix.lux_per_level(r, 0) - truth.lux_per_level(r, 0)) <= 2 * error_lx[r];
  }
  // 95 % would be 152, but receivers of one seed correlate. Measured: 92 % of 400; 94.4 % of 1 600 with other seeds.
  EXPECT_GE(inside, 138) << all;
  EXPECT_LT(inside, all);
}

TEST(DaylightThroughOpenings, APictureShowsTheIlluminanceThatTheEvaluatorMeasures) {
  const RoomWithWindows room = with_windows_that_face_each_other();
  const RayScene rays(room.scene());
  const auto emitters = under(make_overcast_sky(10'000));
  Camera camera;
  camera.eye_world_m = {3.5, 4.5, 1.6};
  camera.target_world_m = {1.5, 1.5, 0};
  camera.vertical_fov_rad = 0.02;  // all pixels look at nearly the same spot
  camera.width_px = camera.height_px = 5;
  PictureOptions options;
  options.wanted_relative_error = 0.05;
  options.max_passes = 1000;
  const auto picture = render_picture(rays, emitters, std::vector{1.0}, camera, options);
  ASSERT_TRUE(picture.has_value());
  double mean_lx = 0;
  for (const float lux : picture->illuminance_lx) mean_lx += static_cast<double>(lux) / 25;
  const auto matrix = evaluated(*make_path_evaluator(rays), {{{1.5, 1.5, 0}, Vec3::UnitZ()}}, emitters, within(0.01));
  EXPECT_NEAR(mean_lx, matrix.lux_per_level(0, 0), 0.03 * mean_lx);
}

}  // namespace
}  // namespace luxrig
