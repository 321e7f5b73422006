#include <cmath>

#include "core/check.h"
#include "tools/bench/rooms/figures.h"
#include "tools/bench/rooms/room_plan.h"
#include "tools/bench/rooms/surface_spread.h"

namespace luxrig {
namespace {

constexpr double kCloister_m = 24, kWalk_m = 4, kArcade_m = 0.5, kWalkHeight_m = 4.5, kCloisterWall_m = 0.4;
constexpr int kBays = 5;
constexpr double kBay_m = (kCloister_m - 2 * kWalk_m) / kBays, kSpringing_m = 2.2;
constexpr double kPedestal_m = 1.1, kStatue_m = 2.0;

class Cloister {
 public:
  explicit Cloister(std::uint64_t seed) : dice_(seed), seed_(seed) {}

  LitRoom build() {
    stone_ = model_.material("sandstone", {0.52, 0.44, 0.33});
    plaster_ = model_.material("lime plaster", {0.74, 0.71, 0.64});
    const auto paving = model_.material("paving", {0.34, 0.31, 0.27}),
               tiles = model_.material("tiles", {0.36, 0.16, 0.10});
    model_.begin_object("paving");
    model_.box({-kCloisterWall_m - 0.05, -kCloisterWall_m - 0.05, -0.4},
               {kCloister_m + kCloisterWall_m + 0.05, kCloister_m + kCloisterWall_m + 0.05, 0}, paving);
    model_.begin_object("outer wall");
    constexpr double kOutLow_m[2] = {-kCloisterWall_m, -kCloisterWall_m},
                     kOutHigh_m[2] = {kCloister_m + kCloisterWall_m, kCloister_m + kCloisterWall_m},
                     kInLow_m[2] = {0, 0}, kInHigh_m[2] = {kCloister_m, kCloister_m};
    model_.ring(kOutLow_m, kOutHigh_m, kInLow_m, kInHigh_m, -0.1, kWalkHeight_m + 0.05, plaster_);
    model_.begin_object("roof");
    constexpr double kEaves_m = kWalk_m + kArcade_m + 0.2;
    constexpr double kHoleLow_m[2] = {kEaves_m, kEaves_m},
                     kHoleHigh_m[2] = {kCloister_m - kEaves_m, kCloister_m - kEaves_m};
    model_.ring(kOutLow_m, kOutHigh_m, kHoleLow_m, kHoleHigh_m, kWalkHeight_m, kWalkHeight_m + 0.25, tiles);
    for (const int side : {0, 1, 2, 3}) arcade(side);
    garden();
    benches();
    lamps();
    room_.interior_m = Eigen::AlignedBox3d(Vec3::Zero(), Vec3(kCloister_m, kCloister_m, kWalkHeight_m));
    room_.scene = model_.scene();
    measure();
    return std::move(room_);
  }

 private:
  /// Rotates a point of the walk along y = 0 to another side.
  [[nodiscard]] static Vec3 turned(int side, const Vec3& p) {
    const double far = kCloister_m;
    if (side == 0) return p;
    if (side == 1) return {far - p.y(), p.x(), p.z()};
    if (side == 2) return {far - p.x(), far - p.y(), p.z()};
    return {p.y(), far - p.x(), p.z()};
  }
  struct Block {
    Vec3 low, high;
  };
  [[nodiscard]] static Block turned(int side, const Vec3& a, const Vec3& b) {
    const Vec3 p = turned(side, a), q = turned(side, b);
    return {p.cwiseMin(q), p.cwiseMax(q)};
  }

  /// Five arches on columns towards the court, a rib across the walk behind each column, and a parapet except in the
  /// middle.
  void arcade(int side) {
    for (int bay = 0; bay < kBays; ++bay) {
      const double x0 = kWalk_m + kBay_m * bay, x1 = x0 + kBay_m;
      model_.begin_object("arch");
      const Block arch = turned(side, {x0, kWalk_m, kSpringing_m}, {x1, kWalk_m + kArcade_m, kWalkHeight_m + 0.05});
      model_.arch(arch.low, arch.high, 0.25, 24, stone_);
      model_.begin_object("rib");
      const Block rib =
          turned(side, {x0 - 0.12, -0.05, kSpringing_m + 0.15}, {x0 + 0.12, kWalk_m + 0.02, kWalkHeight_m + 0.05});
      model_.arch(rib.low, rib.high, 0.3, 16, stone_);
      model_.begin_object("column");
      const Vec3 foot = turned(side, {x0 + (bay == 0 ? 0.25 : 0.0), kWalk_m + kArcade_m / 2, 0});
      model_.turned_box(foot, {0.5, 0.5, 0.5}, 0, stone_);
      model_.column(foot + Vec3(0, 0, 0.45), 0.16, kSpringing_m - 0.6, 24, stone_);
      model_.turned_box(foot + Vec3(0, 0, kSpringing_m - 0.2), {0.5, 0.5, 0.25}, 0, stone_);
      if (bay == kBays / 2) continue;
      model_.begin_object("parapet");
      const Block parapet = turned(side, {x0 + 0.2, kWalk_m + 0.1, -0.05}, {x1 - 0.2, kWalk_m + 0.4, 0.55});
      model_.box(parapet.low, parapet.high, stone_);
    }
  }

  void garden() {
    const auto lawn = model_.material("lawn", {0.06, 0.19, 0.03}), leaf = model_.material("yew", {0.03, 0.09, 0.03}),
               marble = model_.material("marble", {0.76, 0.74, 0.70});
    const double middle = kCloister_m / 2;
    for (const int x : {-1, 1})
      for (const int y : {-1, 1}) {
        const Vec3 a(middle + x * 1.8, middle + y * 1.8, 0), b(middle + x * 6.8, middle + y * 6.8, 0.06);
        model_.begin_object("lawn");
        model_.box(a.cwiseMin(b), a.cwiseMax(b), lawn);
        model_.begin_object("yew");
        const double out = dice_.between(3.2, 4.8);
        add_crown(model_, {middle + x * out, middle + y * dice_.between(3.2, 4.8), 0.05}, dice_.between(1.0, 1.5),
                  dice_.between(2.2, 3.2), 36, leaf);
      }
    model_.begin_object("step");
    model_.turned_box({middle, middle, 0}, {2.0, 2.0, 0.15}, 0, stone_);
    model_.begin_object("pedestal");
    model_.turned_box({middle, middle, 0.1}, {1.0, 1.0, kPedestal_m - 0.1}, 0, stone_);
    model_.begin_object("statue");
    add_statue(model_, {middle, middle, kPedestal_m}, kStatue_m, dice_.between(0, 2 * kPi), 0.035, marble);
  }

  void benches() {
    for (const int side : {0, 1, 2, 3})
      for (const double x : {6.0, 16.0}) {
        const double at = x + dice_.between(-1.5, 1.5);
        const Block bench = turned(side, {at, 0.05, 0}, {at + 1.6, 0.5, 0.45});
        model_.begin_object("bench");
        model_.box(bench.low, bench.high, stone_);
      }
  }

  /// Three under the roof of each walk, and four low ones around the statue.
  void lamps() {
    for (const int side : {0, 1, 2, 3})
      for (const double x : {2.0, 8.8, 15.2})
        room_.emitters.push_back(
            bare_lamp(turned(side, {x + dice_.between(-0.4, 0.4), 2 + dice_.between(-0.3, 0.3), kWalkHeight_m - 0.4}),
                      dice_.between(700, 1200)));
    for (const int x : {-1, 1})
      for (const int y : {-1, 1})
        room_.emitters.push_back(
            bare_lamp(Vec3(kCloister_m / 2 + 1.6 * x, kCloister_m / 2 + 1.6 * y, dice_.between(2.4, 3.6)),
                      dice_.between(1500, 2500)));
  }

  void measure() {
    const RayScene rays(room_.scene);
    const SurfaceSpread spread(room_.scene, rays, room_.emitters.front().world_from_lamp.translation_m);
    for (const int side : {0, 1, 2, 3}) {
      SurfacePart walk;
      walk.objects = {"paving"};
      const Block floor = turned(side, {0, 0, -0.1}, {kCloister_m - kWalk_m, kWalk_m, 0.1});
      walk.box_world_m = Eigen::AlignedBox3d(floor.low, floor.high);
      room_.regions_m.emplace_back(Vec3(floor.low.x(), floor.low.y(), 0),
                                   Vec3(floor.high.x(), floor.high.y(), kWalkHeight_m));
      walk.headroom_m = 1;
      const auto some = spread.over(walk, 60, seed_ + static_cast<std::uint64_t>(side));
      room_.receivers.insert(room_.receivers.end(), some.begin(), some.end());
    }
    SurfacePart statue;
    statue.objects = {"statue"};
    statue.box_world_m = room_.interior_m;
    statue.within_rad = rad_from_deg(100);
    statue.elbow_room_m = 0.02;
    const auto some = spread.over(statue, 60, seed_);
    room_.receivers.insert(room_.receivers.end(), some.begin(), some.end());
  }

  RoomDice dice_;
  std::uint64_t seed_;
  SolidModel model_;
  LitRoom room_{"cloister", {}, {}, {}};
  SolidModel::MaterialIndex stone_ = 0, plaster_ = 0;
};

}  // namespace

LitRoom make_cloister(std::uint64_t seed) { return Cloister(seed).build(); }

}  // namespace luxrig
