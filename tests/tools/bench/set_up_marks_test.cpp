// The marks by which photographers know a set-up, on the face of a head: where its light falls, by rays.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/highlight/lights/set_up.h"
#include "core/scene/ray_scene.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

/// A face seen from far, before it: pixels of 1 mm, rows from the top.
struct Face {
  static constexpr int kWidth = 180, kHeight = 190;
  static constexpr double kTop_m = 0.09;  ///< z of the first row

  enum Pixel : char { nothing, shadow, lit };
  std::vector<Pixel> pixels = std::vector<Pixel>(static_cast<std::size_t>(kWidth * kHeight), nothing);

  [[nodiscard]] static double x_m(int column) { return (column + 0.5) / 1000 - 0.09; }
  [[nodiscard]] static double z_m(int row) { return kTop_m - (row + 0.5) / 1000; }
  [[nodiscard]] Pixel at(int column, int row) const { return pixels[static_cast<std::size_t>(row * kWidth + column)]; }
  [[nodiscard]] Pixel at_m(double x, double z) const {
    return at(static_cast<int>((x + 0.09) * 1000), static_cast<int>((kTop_m - z) * 1000));
  }
  /// Of the pixels on this side (±1) of the face: between brow and chin, off its edge.
  [[nodiscard]] double lit_share(int side) const {
    int all = 0, bright = 0;
    for (int row = 0; row < kHeight; ++row)
      for (int column = 0; column < kWidth; ++column) {
        const double x = side * x_m(column), z = z_m(row);
        if (at(column, row) == nothing || x < 0 || x > 0.06 || z < -0.08 || z > 0.05) continue;
        ++all;
        bright += at(column, row) == lit ? 1 : 0;
      }
    return static_cast<double>(bright) / all;
  }
  /// Pixels of the same kind that hang together with this one, and whether they reach a place.
  [[nodiscard]] std::vector<bool> patch_at(double x, double z) const {
    std::vector<bool> in(pixels.size(), false);
    std::vector<std::size_t> next = {
        static_cast<std::size_t>(static_cast<int>((kTop_m - z) * 1000) * kWidth + static_cast<int>((x + 0.09) * 1000))};
    const Pixel kind = pixels[next.front()];
    while (!next.empty()) {
      const std::size_t at = next.back();
      next.pop_back();
      if (in[at] || pixels[at] != kind) continue;
      in[at] = true;
      const int column = static_cast<int>(at) % kWidth, row = static_cast<int>(at) / kWidth;
      if (column > 0) next.push_back(at - 1);
      if (column + 1 < kWidth) next.push_back(at + 1);
      if (row > 0) next.push_back(at - kWidth);
      if (row + 1 < kHeight) next.push_back(at + kWidth);
    }
    return in;
  }
};

/// By a distant lamp. turned_rad: of the head, to the picture's right.
Face lit_from(const Vec3& towards, double turned_rad = 0) {
  static const RayScene head(make_head());
  const Mat3 turn = Eigen::AngleAxisd(turned_rad, Vec3::UnitZ()).toRotationMatrix();
  Face face;
  for (int row = 0; row < Face::kHeight; ++row)
    for (int column = 0; column < Face::kWidth; ++column) {
      const Vec3 from = turn.transpose() * Vec3(Face::x_m(column), -1, Face::z_m(row));
      const auto hit = head.nearest(from, turn.transpose() * Vec3::UnitY(), Vec3::Zero());
      if (!hit) continue;
      const Vec3 lamp = turn.transpose() * towards.normalized();
      const bool bright = hit->normal_world.dot(lamp) > 0 &&
                          !head.occluded(hit->position_world_m, hit->normal_world, hit->position_world_m + 9 * lamp);
      face.pixels[static_cast<std::size_t>(row * Face::kWidth + column)] = bright ? Face::lit : Face::shadow;
    }
  return face;
}

/// From before the face; the picture's right is +x.
Face by(SetUp set_up, int side = -1, double turned_rad = 0, int broad_side = 0) {
  SetUpFrame frame;
  frame.broad_side = broad_side;
  return lit_from(LightWindow(set_up, LightRole::key, frame).middle(side), turned_rad);
}

constexpr double kCheek_m = 0.045, kUnderEye_m = -0.018;

TEST(MarksOfSetUps, RembrandtLeavesATriangleOfLightOnTheFarCheek) {
  const Face face = by(SetUp::rembrandt);
  const std::vector<bool> triangle = face.patch_at(kCheek_m, kUnderEye_m);
  ASSERT_EQ(face.at_m(kCheek_m, kUnderEye_m), Face::lit);
  // It ends on the cheek: shadow all around it, below the nose as at the temple.
  double area_cm2 = 0, lowest_m = 1;
  for (std::size_t k = 0; k < triangle.size(); ++k) {
    if (!triangle[k]) continue;
    area_cm2 += 0.01;
    const int row = static_cast<int>(k) / Face::kWidth, column = static_cast<int>(k) % Face::kWidth;
    lowest_m = std::min(lowest_m, Face::z_m(row));
    EXPECT_GT(Face::x_m(column), 0) << "it crosses the nose";
  }
  EXPECT_GT(area_cm2, 2);
  EXPECT_LT(area_cm2, 20);
  EXPECT_GT(lowest_m, -0.08) << "it reaches the chin";
}

TEST(MarksOfSetUps, ALoopsNoseShadowDoesNotMeetTheShadowOfTheCheek) {
  const Face face = by(SetUp::loop);
  EXPECT_EQ(face.at_m(kCheek_m, kUnderEye_m), Face::lit);
  const std::vector<bool> light = face.patch_at(-kCheek_m, kUnderEye_m);
  const auto reaches = [&](double x, double z) {
    return light[static_cast<std::size_t>(static_cast<int>((Face::kTop_m - z) * 1000) * Face::kWidth +
                                          static_cast<int>((x + 0.09) * 1000))];
  };
  EXPECT_TRUE(reaches(kCheek_m, kUnderEye_m)) << "both cheeks are one light";
  // The nose casts a shadow on the far side of it, all the same.
  int beside_nose = 0;
  for (int mm = 8; mm < 30; ++mm) beside_nose += face.at_m(0.001 * mm, -0.03) == Face::shadow ? 1 : 0;
  EXPECT_GT(beside_nose, 2);
}

TEST(MarksOfSetUps, ASplitLightsOneHalf) {
  const Face face = by(SetUp::split);
  EXPECT_GT(face.lit_share(-1), 0.75);
  EXPECT_LT(face.lit_share(1), 0.15);
}

TEST(MarksOfSetUps, ABroadLightLightsTheSideOfATurnedFaceThatTheCameraSees) {
  // Turned to the picture's left, it shows its right cheek and ear.
  const double turned_rad = rad_from_deg(-30);
  const auto lit_side = [](const Face& face) {
    int all = 0, bright = 0;
    for (int row = 0; row < Face::kHeight; ++row)
      for (int column = 0; column < Face::kWidth; ++column) {
        if (face.at(column, row) == Face::nothing || Face::x_m(column) < 0.035 || Face::z_m(row) < -0.05 ||
            Face::z_m(row) > 0.05)
          continue;
        ++all;
        bright += face.at(column, row) == Face::lit ? 1 : 0;
      }
    return static_cast<double>(bright) / all;
  };
  EXPECT_GT(lit_side(by(SetUp::broad, 1, turned_rad, 1)), 0.9);
  EXPECT_LT(lit_side(by(SetUp::rembrandt, -1, turned_rad)), 0.5) << "a short light leaves most of it dark";
}

TEST(MarksOfSetUps, OneSideIsTheOthersMirrorImage) {
  for (const luxrig::SetUp set_up : {SetUp::loop, SetUp::rembrandt, SetUp::split}) {
    EXPECT_NEAR(by(set_up, 1).lit_share(1), by(set_up, -1).lit_share(-1), 0.02) << name_of(set_up);
    EXPECT_NEAR(by(set_up, 1).lit_share(-1), by(set_up, -1).lit_share(1), 0.02) << name_of(set_up);
  }
}

}  // namespace
}  // namespace luxrig
