/// In furnished rooms the skips of evaluators change no result by more than its stated error.

#include <gtest/gtest.h>

#include "core/transport/direct/direct_sources.h"
#include "tools/bench/rooms/enclosures.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {
namespace {

TEST(DirectSkips, LightMatchesOneShadowRayPerPair) {
  for (const LitRoom& room : {make_box_room(), make_eight_room_flat(), make_gallery_hall(), make_atrium()}) {
    const RayScene rays(room.scene);
    const auto got = make_direct_evaluator(rays)->evaluate(room.receivers, room.emitters, {});
    ASSERT_TRUE(got);
    const auto pairs = static_cast<std::uint64_t>(got->lux_per_level.size());
    // Bare lamps above receivers that all look up leave nothing to skip. Spots do.
    EXPECT_LE(got->rays, pairs) << room.name;
    if (room.name == "gallery") {
      EXPECT_LT(got->rays, pairs / 2) << room.name;
    }
    double largest = 0;
    for (std::size_t r = 0; r < room.receivers.size(); ++r)
      for (std::size_t e = 0; e < room.emitters.size(); ++e) {
        const Receiver& receiver = room.receivers[r];
        const Pose& pose = room.emitters[e].world_from_lamp;
        const Vec3 towards_m = pose.translation_m - receiver.position_world_m;
        const double distance_m = towards_m.norm(), cosine = receiver.normal_world.dot(towards_m) / distance_m;
        const double candela =
            room.emitters[e].intensity->intensity_cd(pose.inverse_direction(-towards_m / distance_m));
        const bool seen = !rays.occluded(receiver.position_world_m, receiver.normal_world, pose.translation_m);
        const double lux = seen && cosine > 0 ? candela * cosine / (distance_m * distance_m) : 0;
        largest = std::max(
            largest, std::abs(lux - got->lux_per_level(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(e))));
      }
    EXPECT_LT(largest, 1e-9 * got->lux_per_level.maxCoeff()) << room.name;
  }
}

TEST(DirectSkips, SamplesAgreeWithProvenClearAndBlockedShafts) {
  for (const LitRoom& room : {make_box_room(), make_eight_room_flat()}) {
    const RayScene rays(room.scene);
    std::vector<Emitter> disks = room.emitters;
    for (Emitter& disk : disks) disk.shape = {LuminousShape::Kind::disk, Vec3::Constant(0.3)};
    DirectSources::Scratch scratch;
    std::size_t clear = 0, blocked = 0;
    for (std::size_t r = 0; r < room.receivers.size(); ++r)
      for (std::size_t e = 0; e < disks.size(); ++e) {
        std::uint64_t proof_rays = 0;
        const Way way = way_between(rays, room.receivers[r], disks[e], proof_rays);
        if (way == Way::unknown) continue;
        const SobolSequence samples(mixed(3, r * disks.size() + e));
        const DirectSum sum =
            sample_direct(rays, room.receivers[r], disks[e], Way::unknown, SkyOpenings(), samples, 0, 128, scratch);
        double lux = 0, unobstructed_lux = 0;
        for (const DirectSum::Part& part : sum.parts) lux += part.lux, unobstructed_lux += part.unobstructed_lux;
        if (way == Way::clear) {
          ++clear;
          EXPECT_EQ(lux, unobstructed_lux) << room.name << ' ' << r << ' ' << e;
        } else {
          ++blocked;
          EXPECT_EQ(lux, 0) << room.name << ' ' << r << ' ' << e;
        }
      }
    EXPECT_GT(clear, room.receivers.size() / 4) << room.name;
    EXPECT_GT(blocked, 0u) << room.name;
  }
}

// Seven lamps beyond a closed wall: their columns are dark, and the first lamp's columns move within their errors.
TEST(PathSkips, IrrelevantLampsCostFewRaysAndShiftLightOnlyWithinErrors) {
  const LitRoom room = make_box_room();
  Scene scene = room.scene;
  // A closed box with lamps in it, far above the room.
  const Scene cube = make_cube(2, 0.7);
  const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
  for (const Vec3f& v : cube.vertices_m) scene.vertices_m.push_back(v + Vec3f(2, 1.5f, 9));
  for (const auto& t : cube.triangles) {
    scene.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    scene.material_of_triangle.push_back(0);
    scene.object_of_triangle.push_back(0);
  }
  const RayScene rays(scene);
  std::vector<Emitter> lamps = {room.emitters.front()};
  EvaluateOptions options;
  options.wanted_relative_error = 0.03;
  const auto alone = make_path_evaluator(rays)->evaluate(room.receivers, lamps, options);
  for (int i = 0; i < 7; ++i) lamps.push_back({make_isotropic(900), {Mat3::Identity(), {2 + 0.2 * (i - 3), 1.5, 9.1}}});
  const auto among = make_path_evaluator(rays)->evaluate(room.receivers, lamps, options);
  ASSERT_TRUE(alone && among);
  EXPECT_EQ(among->lux_per_level.rightCols(7).maxCoeff(), 0);
  EXPECT_LT(static_cast<double>(among->rays), 2.5 * static_cast<double>(alone->rays));
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1), of_first = Eigen::VectorXd::Unit(8, 0);
  const Eigen::ArrayXd moved = (alone->lux(one) - among->lux(of_first)).array().abs(),
                       error = (alone->standard_error_lux(one).array().square() +
                                among->standard_error_lux(of_first).array().square())
                                   .sqrt();
  EXPECT_GE((moved <= 2 * error).count(), moved.size() * 85 / 100);
  EXPECT_LT(std::abs(alone->lux(one).sum() / among->lux(of_first).sum() - 1), 0.01);
}

}  // namespace
}  // namespace luxrig
