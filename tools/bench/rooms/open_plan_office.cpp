#include <cmath>

#include "core/check.h"
#include "tools/bench/rooms/room_plan.h"
#include "tools/bench/rooms/surface_spread.h"

namespace luxrig {
namespace {

constexpr double kOfficeLength_m = 16, kOfficeWidth_m = 11, kOfficeHeight_m = 2.8, kOfficeWall_m = 0.1;
constexpr double kDeskLength_m = 1.5, kDeskDepth_m = 0.75, kDeskTop_m = 0.74;
/// Two cells in the corners of the long back wall.
constexpr double kMeetingLeft_m = 11.9, kMeetingFront_m = 7, kStoreRight_m = 3, kStoreFront_m = 8;

class Office {
 public:
  explicit Office(std::uint64_t seed) : dice_(seed), seed_(seed) {}

  LitRoom build() {
    const auto carpet = model_.material("grey carpet", {0.17, 0.18, 0.19}),
               ceiling = model_.material("ceiling tiles", {0.82, 0.82, 0.80});
    white_ = model_.material("white paint", {0.78, 0.77, 0.74});
    beech_ = model_.material("beech", {0.56, 0.42, 0.27});
    grey_ = model_.material("grey steel", {0.42, 0.43, 0.44});
    black_ = model_.material("black plastic", {0.04, 0.04, 0.04});
    cloths_ = {model_.material("blue cloth", {0.05, 0.13, 0.38}), model_.material("green cloth", {0.10, 0.30, 0.12}),
               model_.material("grey cloth", {0.35, 0.35, 0.36})};
    model_.begin_object("floor and walls");
    model_.shell(Vec3::Zero(), {kOfficeLength_m, kOfficeWidth_m, kOfficeHeight_m}, 0.3, carpet, ceiling,
                 {white_, white_, white_, white_});
    cells();
    for (const auto& [x, y] : {std::pair{2.7, 2.5}, {6.8, 2.5}, {10.9, 2.5}, {4.4, 6.2}, {8.6, 6.2}, {7.4, 9.3}})
      group({x + dice_.between(-0.3, 0.3), y + dice_.between(-0.25, 0.25), 0});
    cupboards();
    lamps();
    room_.scene = model_.scene();
    room_.interior_m = Eigen::AlignedBox3d(Vec3::Zero(), Vec3(kOfficeLength_m, kOfficeWidth_m, kOfficeHeight_m));
    measure();
    return std::move(room_);
  }

 private:
  /// A meeting room and a store, each with a doorway to the open plan, and two pillars.
  void cells() {
    constexpr double kReachIn_m = 0.05, kDoor_m = 0.9, kDoorTop_m = 2.1;
    const double bottom = -kReachIn_m, top = kOfficeHeight_m + kReachIn_m;
    model_.begin_object("cell wall");
    const double door = dice_.between(8, 9.5), store_door = dice_.between(0.8, 1.6);
    model_.wall({kMeetingLeft_m, kMeetingFront_m, bottom},
                {kMeetingLeft_m + kOfficeWall_m, kOfficeWidth_m + kReachIn_m, top},
                {{{door, door + kDoor_m, bottom, kDoorTop_m}}}, white_);
    model_.box({kMeetingLeft_m, kMeetingFront_m - kOfficeWall_m, bottom},
               {kOfficeLength_m + kReachIn_m, kMeetingFront_m, top}, white_);
    model_.box({kStoreRight_m, kStoreFront_m, bottom},
               {kStoreRight_m + kOfficeWall_m, kOfficeWidth_m + kReachIn_m, top}, white_);
    model_.wall({-kReachIn_m, kStoreFront_m - kOfficeWall_m, bottom},
                {kStoreRight_m + kOfficeWall_m, kStoreFront_m, top},
                {{{store_door, store_door + kDoor_m, bottom, kDoorTop_m}}}, white_);
    model_.begin_object("pillar");
    for (const double x : {5.4, 11.2}) model_.box({x, 4.2, bottom}, {x + 0.35, 4.55, top}, white_);
    const Vec3 table(dice_.between(13.2, 13.7), dice_.between(8.2, 8.7), 0);
    model_.begin_object("desk");
    model_.box(table + Vec3(0, 0, kDeskTop_m - 0.04), table + Vec3(1.6, 1.1, kDeskTop_m), beech_);
    model_.begin_object("desk leg");
    model_.box(table + Vec3(0.5, 0.4, 0), table + Vec3(1.1, 0.7, kDeskTop_m - 0.04), grey_);
    model_.begin_object("shelf");
    for (const double z : {0.0, 0.45, 0.9, 1.35, 1.8})
      model_.box({0, kOfficeWidth_m - 0.4, z}, {2.6, kOfficeWidth_m, z + 0.03}, grey_);
    for (const double x : {0.0, 1.3, 2.58})
      model_.box({x, kOfficeWidth_m - 0.4, 0}, {x + 0.02, kOfficeWidth_m, 1.83}, grey_);
  }

  /// Four desks around a cross of screens.
  void group(const Vec3& middle) {
    const auto cloth = cloths_[static_cast<std::size_t>(dice_.between(0, 3)) % cloths_.size()];
    const double screen_m = dice_.between(1.2, 1.6);
    model_.begin_object("screen");
    model_.box(middle + Vec3(-kDeskLength_m - 0.05, -0.025, 0.05), middle + Vec3(kDeskLength_m + 0.05, 0.025, screen_m),
               cloth);
    for (const double side : {-1.0, 1.0}) {
      const double y0 = side < 0 ? -1.0 : 0.03, y1 = side < 0 ? -0.03 : 1.0;
      model_.box(middle + Vec3(-0.025, y0, 0.05), middle + Vec3(0.025, y1, screen_m), cloth);
    }
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0}) {
        const Vec3 a = middle + Vec3(x * 0.04, y * 0.04, 0);
        const Vec3 b = a + Vec3(x * kDeskLength_m, y * kDeskDepth_m, 0);
        const Vec3 low = a.cwiseMin(b), high = a.cwiseMax(b);
        model_.begin_object("desk");
        model_.box(low + Vec3(0, 0, kDeskTop_m - 0.04), high + Vec3(0, 0, kDeskTop_m), beech_);
        model_.begin_object("desk leg");
        const double end = x > 0 ? high.x() - 0.45 : low.x() + 0.02;
        model_.box({end, low.y() + 0.05, 0}, {end + 0.43, high.y() - 0.05, kDeskTop_m - 0.04}, grey_);
        model_.begin_object("monitor");
        const Vec3 foot = middle + Vec3(x * dice_.between(0.5, 1.0), y * 0.28, kDeskTop_m);
        model_.turned_box(foot, {0.2, 0.14, 0.015}, 0, black_);
        model_.turned_box(foot + Vec3(0, 0, 0.015), {0.04, 0.04, 0.13}, 0, black_);
        model_.turned_box(foot + Vec3(0, 0, 0.12), {0.55, 0.03, 0.33}, dice_.between(-0.25, 0.25), black_);
        model_.begin_object("chair");
        const Vec3 seat = middle + Vec3(x * dice_.between(0.6, 1.0), y * dice_.between(1.05, 1.2), 0);
        model_.column(seat, 0.03, 0.42, 8, black_);
        model_.turned_box(seat + Vec3(0, 0, 0.42), {0.46, 0.46, 0.07}, dice_.between(-0.6, 0.6), cloth);
      }
  }

  void cupboards() {
    model_.begin_object("cupboard");
    for (int i = 0; i < 4; ++i) {
      const double x = kOfficeLength_m - 0.45, y = 0.3 + 1.55 * i + dice_.between(0, 0.3);
      model_.box({x, y, 0}, {kOfficeLength_m, y + 1.2, dice_.between(1.1, 2.1)}, grey_);
    }
    for (const double x : {4.0, 9.2}) {
      const double at = x + dice_.between(0, 0.8);
      model_.box({at, kOfficeWidth_m - 0.45, 0}, {at + 1.2, kOfficeWidth_m, dice_.between(1.1, 2.1)}, grey_);
    }
  }

  void lamps() {
    for (const auto& [x, y] : {std::pair{2.6, 2.2},
                               {6.8, 2.4},
                               {10.9, 2.2},
                               {14.1, 3.2},
                               {2.2, 6.2},
                               {6.5, 6.1},
                               {9.8, 7.6},
                               {13.9, 9.0},
                               {1.5, 9.4}})
      room_.emitters.push_back(bare_lamp(
          {x + dice_.between(-0.5, 0.5), y + dice_.between(-0.5, 0.5), kOfficeHeight_m - dice_.between(0.15, 0.4)},
          dice_.between(1800, 3200)));
  }

  void measure() {
    const RayScene rays(room_.scene);
    const SurfaceSpread spread(room_.scene, rays, room_.emitters.front().world_from_lamp.translation_m);
    SurfacePart desks;
    desks.objects = {"desk"};
    desks.box_world_m = room_.interior_m;
    SurfacePart floor = desks;
    floor.objects = {"floor and walls"};
    floor.headroom_m = 1;
    for (const auto& [part, count, key] : {std::tuple{&desks, 130, 0}, {&floor, 170, 1}}) {
      const auto some = spread.over(*part, static_cast<std::size_t>(count), seed_ ^ static_cast<std::uint64_t>(key));
      room_.receivers.insert(room_.receivers.end(), some.begin(), some.end());
    }
  }

  RoomDice dice_;
  std::uint64_t seed_;
  SolidModel model_;
  LitRoom room_{"office", {}, {}, {}};
  SolidModel::MaterialIndex white_ = 0, beech_ = 0, grey_ = 0, black_ = 0;
  std::array<SolidModel::MaterialIndex, 3> cloths_{};
};

}  // namespace

LitRoom make_open_plan_office(std::uint64_t seed) { return Office(seed).build(); }

}  // namespace luxrig
