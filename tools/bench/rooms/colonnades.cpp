#include <cmath>

#include "core/check.h"
#include "tools/bench/rooms/figures.h"
#include "tools/bench/rooms/room_plan.h"
#include "tools/bench/rooms/surface_spread.h"

namespace luxrig {
namespace {

constexpr double kCourtLength_m = 30, kCourtWidth_m = 13, kAisle_m = 3.2, kEnd_m = 3.6, kCourtWall_m = 0.4;
constexpr double kGallery_m = 5.2, kGallerySlab_m = 0.4, kCourtRoof_m = 9.6, kCourtTop_m = 12, kPillar_m = 0.6;
constexpr int kLongBays = 6, kShortBays = 2;

class Colonnades {
 public:
  explicit Colonnades(std::uint64_t seed) : dice_(seed), seed_(seed) {}

  LitRoom build() {
    stone_ = model_.material("limestone", {0.55, 0.48, 0.38});
    const auto paving = model_.material("paving", {0.36, 0.33, 0.29}),
               brick = model_.material("brick", {0.44, 0.30, 0.22});
    cloths_ = {model_.material("red cloth", {0.42, 0.03, 0.03}), model_.material("green cloth", {0.05, 0.24, 0.06}),
               model_.material("blue cloth", {0.03, 0.07, 0.36})};
    leaf_ = model_.material("leaves", {0.07, 0.22, 0.05});
    clay_ = model_.material("terracotta", {0.48, 0.22, 0.12});
    model_.begin_object("court floor");
    model_.box({-kCourtWall_m - 0.05, -kCourtWall_m - 0.05, -0.4},
               {kCourtLength_m + kCourtWall_m + 0.05, kCourtWidth_m + kCourtWall_m + 0.05, 0}, paving);
    constexpr double kOutLow_m[2] = {-kCourtWall_m, -kCourtWall_m},
                     kOutHigh_m[2] = {kCourtLength_m + kCourtWall_m, kCourtWidth_m + kCourtWall_m},
                     kInLow_m[2] = {0, 0}, kInHigh_m[2] = {kCourtLength_m, kCourtWidth_m};
    constexpr double kHoleLow_m[2] = {kEnd_m, kAisle_m},
                     kHoleHigh_m[2] = {kCourtLength_m - kEnd_m, kCourtWidth_m - kAisle_m};
    model_.begin_object("outer wall");
    model_.ring(kOutLow_m, kOutHigh_m, kInLow_m, kInHigh_m, -0.1, kCourtRoof_m + 0.05, brick);
    model_.begin_object("gallery floor");
    constexpr double kReachLow_m[2] = {-0.05, -0.05}, kReachHigh_m[2] = {kCourtLength_m + 0.05, kCourtWidth_m + 0.05};
    model_.ring(kReachLow_m, kReachHigh_m, kHoleLow_m, kHoleHigh_m, kGallery_m, kGallery_m + kGallerySlab_m, paving);
    model_.begin_object("roof");
    model_.ring(kOutLow_m, kOutHigh_m, kHoleLow_m, kHoleHigh_m, kCourtRoof_m, kCourtRoof_m + 0.3, brick);
    // The wall above the upper arcade.
    constexpr double kBehindLow_m[2] = {kEnd_m - kPillar_m, kAisle_m - kPillar_m},
                     kBehindHigh_m[2] = {kCourtLength_m - kEnd_m + kPillar_m, kCourtWidth_m - kAisle_m + kPillar_m};
    model_.ring(kBehindLow_m, kBehindHigh_m, kHoleLow_m, kHoleHigh_m, kCourtRoof_m + 0.2, kCourtTop_m, brick);
    for (const double floor_m : {0.0, kGallery_m + kGallerySlab_m}) storey(floor_m);
    balustrade();
    plants();
    lamps();
    room_.interior_m = Eigen::AlignedBox3d(Vec3::Zero(), Vec3(kCourtLength_m, kCourtWidth_m, kCourtRoof_m));
    room_.scene = model_.scene();
    regions();
    measure();
    return std::move(room_);
  }

 private:
  struct Side {
    Vec3 from_m, along;  ///< along the court's edge
    Vec3 outward;
    double length_m;
    int bays;
  };
  [[nodiscard]] static std::array<Side, 4> sides() {
    const double x0 = kEnd_m, x1 = kCourtLength_m - kEnd_m, y0 = kAisle_m, y1 = kCourtWidth_m - kAisle_m;
    return {{{{x0, y0, 0}, Vec3::UnitX(), -Vec3::UnitY(), x1 - x0, kLongBays},
             {{x0, y1, 0}, Vec3::UnitX(), Vec3::UnitY(), x1 - x0, kLongBays},
             {{x0, y0, 0}, Vec3::UnitY(), -Vec3::UnitX(), y1 - y0, kShortBays},
             {{x1, y0, 0}, Vec3::UnitY(), Vec3::UnitX(), y1 - y0, kShortBays}}};
  }

  void block(const Vec3& a, const Vec3& b, SolidModel::MaterialIndex material) {
    model_.box(a.cwiseMin(b), a.cwiseMax(b), material);
  }

  /// Columns around the court with arches up to the next level; cloth hangs in some of the bays.
  void storey(double floor_m) {
    const bool upper = floor_m > 0;
    const double top_m = upper ? kCourtRoof_m + 0.05 : kGallery_m + 0.05;
    for (const Side& side : sides()) {
      const double bay_m = side.length_m / side.bays, pier_m = kPillar_m / 2, rise_m = bay_m / 2 - pier_m;
      const double springing_m = top_m - rise_m - 0.35;
      for (int bay = 0; bay < side.bays; ++bay) {
        const Vec3 at = side.from_m + bay_m * bay * side.along + Vec3(0, 0, floor_m);
        model_.begin_object("arch");
        Vec3 a = at, b = at + bay_m * side.along + kPillar_m * side.outward;
        a.z() = springing_m, b.z() = top_m;
        model_.arch(a.cwiseMin(b), a.cwiseMax(b), pier_m, 24, stone_);
        if (bay > 0 || side.along.x() > 0) column(at + pier_m * side.outward, springing_m, bay == 0);
        if (bay + 1 == side.bays && side.along.x() > 0)
          column(at + bay_m * side.along + pier_m * side.outward, springing_m, true);
        const double kind = dice_.between(0, 1);
        if (side.bays == kLongBays && kind < (upper ? 0.3 : 0.5)) cloth(at + bay_m / 2 * side.along, side, springing_m);
      }
    }
  }

  void column(const Vec3& foot, double springing_m, bool corner) {
    model_.begin_object("column");
    const double height_m = springing_m - foot.z();
    if (corner) {
      model_.turned_box(foot - Vec3(0, 0, 0.02), {kPillar_m, kPillar_m, height_m + 0.07}, 0, stone_);
      return;
    }
    model_.turned_box(foot, {kPillar_m, kPillar_m, 0.3}, 0, stone_);
    model_.column(foot + Vec3(0, 0, 0.25), 0.2, height_m - 0.45, 28, stone_);
    model_.turned_box(foot + Vec3(0, 0, height_m - 0.25), {kPillar_m, kPillar_m, 0.3}, 0, stone_);
  }

  /// A strip of cloth in folds, hung in the arch.
  void cloth(const Vec3& middle, const Side& side, double springing_m) {
    model_.begin_object("cloth");
    const auto material = cloths_[static_cast<std::size_t>(dice_.between(0, 2.999))];
    const double wide_m = dice_.between(1.4, 2.2), low_m = middle.z() + dice_.between(0.6, 1.6);
    const int folds = 14;
    for (int i = 0; i < folds; ++i) {
      const double from = wide_m * (static_cast<double>(i) / folds - 0.5), until = from + wide_m / folds;
      Vec3 a = middle + from * side.along + (0.25 + 0.05 * (i % 2)) * side.outward;
      Vec3 b = middle + until * side.along + (0.29 + 0.05 * (i % 2)) * side.outward;
      a.z() = low_m, b.z() = springing_m + 0.2;
      block(a, b, material);
    }
  }

  void balustrade() {
    model_.begin_object("balustrade");
    const double z = kGallery_m + kGallerySlab_m;
    constexpr double kRailLow_m[2] = {kEnd_m - 0.15, kAisle_m - 0.15},
                     kRailHigh_m[2] = {kCourtLength_m - kEnd_m + 0.15, kCourtWidth_m - kAisle_m + 0.15},
                     kEdgeLow_m[2] = {kEnd_m - 0.03, kAisle_m - 0.03},
                     kEdgeHigh_m[2] = {kCourtLength_m - kEnd_m + 0.03, kCourtWidth_m - kAisle_m + 0.03};
    model_.ring(kRailLow_m, kRailHigh_m, kEdgeLow_m, kEdgeHigh_m, z + 0.85, z + 0.95, stone_);
    for (const Side& side : sides())
      for (double at = 0.4; at < side.length_m; at += 0.4)
        model_.column(side.from_m + at * side.along + 0.09 * side.outward + Vec3(0, 0, z - 0.02), 0.05, 0.9, 10,
                      stone_);
  }

  void plants() {
    for (int i = 0; i < 8; ++i) {
      const double x = kEnd_m + 2.0 + (kCourtLength_m - 2 * kEnd_m - 4.0) * (i / 2) / 3 + dice_.between(-0.6, 0.6);
      const Vec3 foot(x, i % 2 ? kCourtWidth_m - kAisle_m - 0.7 : kAisle_m + 0.7, 0);
      model_.begin_object("plant");
      add_vase(model_, foot, 0.8, clay_, 9);
      model_.column(foot + Vec3(0, 0, 0.7), 0.04, 0.4, 12, clay_);
      add_crown(model_, foot + Vec3(0, 0, 1.0), 0.8, dice_.between(0.6, 1.0), 36, leaf_);
    }
  }

  /// Under the roofs of both storeys, a bay and a half apart.
  void lamps() {
    for (const double top_m : {kGallery_m, kCourtRoof_m}) {
      for (const double y : {kAisle_m / 2, kCourtWidth_m - kAisle_m / 2})
        for (const double x : {3.0, 9.0, 15.0, 21.0, 27.0})
          room_.emitters.push_back(
              bare_lamp({x + dice_.between(-0.6, 0.6), y, top_m - dice_.between(0.3, 0.9)}, dice_.between(2500, 4500)));
      room_.emitters.push_back(bare_lamp({top_m > kGallery_m ? 1.6 : 28.4, kCourtWidth_m / 2, top_m - 0.5}, 3500));
    }
  }

  /// Aisles of both storeys in three lengths each, and the court in three.
  void regions() {
    for (const bool upper : {false, true}) {
      const double low = upper ? kGallery_m + 0.2 : -0.1, high = upper ? kCourtRoof_m : kGallery_m;
      for (int third = 0; third < 3; ++third) {
        const double x0 = kCourtLength_m / 3 * third, x1 = x0 + kCourtLength_m / 3;
        room_.regions_m.emplace_back(Vec3(x0, 0, low), Vec3(x1, kAisle_m, high));
        room_.regions_m.emplace_back(Vec3(x0, kCourtWidth_m - kAisle_m, low), Vec3(x1, kCourtWidth_m, high));
        room_.regions_m.emplace_back(Vec3(x0, kAisle_m, low), Vec3(x1, kCourtWidth_m - kAisle_m, high));
      }
    }
  }

  void measure() {
    const RayScene rays(room_.scene);
    const SurfaceSpread spread(room_.scene, rays, room_.emitters.front().world_from_lamp.translation_m);
    SurfacePart floor;
    floor.objects = {"court floor", "gallery floor"};
    floor.box_world_m = Eigen::AlignedBox3d(Vec3(0, 0, -0.1), Vec3(kCourtLength_m, kCourtWidth_m, kCourtRoof_m));
    floor.headroom_m = 1;
    room_.receivers = spread.over(floor, 300, seed_);
  }

  RoomDice dice_;
  std::uint64_t seed_;
  SolidModel model_;
  LitRoom room_{"colonnades", {}, {}, {}};
  SolidModel::MaterialIndex stone_ = 0, leaf_ = 0, clay_ = 0;
  std::array<SolidModel::MaterialIndex, 3> cloths_{};
};

}  // namespace

LitRoom make_colonnades(std::uint64_t seed) { return Colonnades(seed).build(); }

}  // namespace luxrig
