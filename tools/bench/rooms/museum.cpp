#include <cmath>

#include "core/check.h"
#include "tools/bench/rooms/figures.h"
#include "tools/bench/rooms/room_plan.h"
#include "tools/bench/rooms/surface_spread.h"

namespace luxrig {
namespace {

constexpr double kMuseumLength_m = 30, kMuseumWidth_m = 20, kHalls_m = 4.6, kUpperFloor_m = 5, kMuseumHeight_m = 9.6;
constexpr double kMuseumReach_m = 0.05, kMuseumWall_m = 0.2, kDoorway_m = 1.8, kDoorwayTop_m = 2.8;
/// Middles of the walls between the halls, and the outer walls' faces.
constexpr double kAcross_m[4] = {0, 10, 20, kMuseumLength_m}, kAlong_m[4] = {0, 6.6, 13.4, kMuseumWidth_m};
constexpr double kVoidLow_m[2] = {12, 8.2}, kVoidHigh_m[2] = {18, 11.8};
constexpr double kMuseumPedestal_m = 1.2, kMuseumStatue_m = 2.4;

class Museum {
 public:
  explicit Museum(std::uint64_t seed) : dice_(seed), seed_(seed) {}

  LitRoom build() {
    const auto stone = model_.material("stone floor", {0.42, 0.39, 0.34}),
               ceiling = model_.material("ceiling", {0.78, 0.77, 0.74});
    white_ = model_.material("white wall", {0.80, 0.79, 0.76});
    colours_ = {model_.material("red wall", {0.36, 0.06, 0.05}), model_.material("blue wall", {0.06, 0.12, 0.32}),
                model_.material("sage wall", {0.28, 0.36, 0.24})};
    oak_ = model_.material("oak", {0.40, 0.28, 0.17});
    bronze_ = model_.material("bronze", {0.20, 0.13, 0.07});
    glaze_ = model_.material("blue glaze", {0.04, 0.12, 0.40});
    marble_ = model_.material("marble", {0.74, 0.72, 0.68});
    model_.begin_object("lower floor");
    model_.shell(Vec3::Zero(), {kMuseumLength_m, kMuseumWidth_m, kMuseumHeight_m}, 0.3, stone, ceiling,
                 {white_, white_, white_, white_});
    model_.begin_object("upper floor");
    constexpr double kLow_m[2] = {-kMuseumReach_m, -kMuseumReach_m},
                     kHigh_m[2] = {kMuseumLength_m + kMuseumReach_m, kMuseumWidth_m + kMuseumReach_m};
    model_.ring(kLow_m, kHigh_m, kVoidLow_m, kVoidHigh_m, kHalls_m, kUpperFloor_m, oak_);
    for (const double floor_m : {0.0, kUpperFloor_m}) {
      walls(floor_m);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) hall(i, j, floor_m);
    }
    middle();
    room_.interior_m = Eigen::AlignedBox3d(Vec3::Zero(), Vec3(kMuseumLength_m, kMuseumWidth_m, kMuseumHeight_m));
    room_.scene = model_.scene();
    measure();
    return std::move(room_);
  }

 private:
  /// A wall between each two neighbouring halls, with a doorway near its middle.
  void walls(double floor_m) {
    const double bottom = floor_m - kMuseumReach_m, top = floor_m + kHalls_m + kMuseumReach_m;
    model_.begin_object("wall");
    for (const bool along_x : {false, true}) {
      const double* ends_m = along_x ? kAcross_m : kAlong_m;
      for (int w = 1; w <= 2; ++w) {
        std::vector<WallGap> gaps;
        for (int h = 0; h < 3; ++h) {
          const double from = (ends_m[h] + ends_m[h + 1]) / 2 + dice_.between(-1.2, 1.2) - kDoorway_m / 2;
          gaps.push_back({from, from + kDoorway_m, bottom, floor_m + kDoorwayTop_m});
        }
        const double at = (along_x ? kAlong_m : kAcross_m)[w], half = kMuseumWall_m / 2;
        const auto paint = colours_[static_cast<std::size_t>(dice_.between(0, 2.999))];
        if (along_x) {
          model_.wall({-kMuseumReach_m, at - half, bottom}, {kMuseumLength_m + kMuseumReach_m, at + half, top}, gaps,
                      white_);
        } else {
          model_.wall({at - half, -kMuseumReach_m, bottom}, {at + half, kMuseumWidth_m + kMuseumReach_m, top}, gaps,
                      paint);
        }
      }
    }
  }

  /// A lamp, and in all halls except the middle ones a partition, a bench and two plinths, each in one of nine places.
  void hall(int i, int j, double floor_m) {
    const Vec3 low(kAcross_m[i], kAlong_m[j], floor_m), high(kAcross_m[i + 1], kAlong_m[j + 1], floor_m + kHalls_m);
    room_.regions_m.emplace_back(low, high);
    const Vec3 centre((low.x() + high.x()) / 2, (low.y() + high.y()) / 2, floor_m);
    const bool in_middle = i == 1 && j == 1;
    const Vec3 aside =
        in_middle ? Vec3(floor_m > 0 ? 0 : 3.4, 0, 0) : Vec3(dice_.between(-1, 1), dice_.between(-0.5, 0.5), 0);
    room_.emitters.push_back(
        bare_lamp(centre + aside + Vec3(0, 0, kHalls_m - dice_.between(0.2, 0.5)), dice_.between(2500, 4500)));
    if (in_middle) return;
    // Exhibits keep clear of the ways between doorways: they stand in the corners of a smaller rectangle.
    const int partition = static_cast<int>(dice_.between(0, 3.999));
    for (int corner = 0; corner < 4; ++corner) {
      const Vec3 at = centre + Vec3((corner & 1 ? 1 : -1) * dice_.between(2.5, 3.4),
                                    (corner & 2 ? 1 : -1) * dice_.between(1.5, 2.1), 0);
      if (corner == partition) {
        model_.begin_object("partition");
        model_.turned_box(at, {2.2, 0.15, 2.6}, dice_.between(-0.3, 0.3),
                          colours_[static_cast<std::size_t>(corner) % colours_.size()]);
      } else if (corner == (partition + 2) % 4) {
        model_.begin_object("bench");
        model_.turned_box(at, {1.6, 0.5, 0.45}, dice_.between(-0.4, 0.4), oak_);
      } else {
        exhibit(at, static_cast<int>(dice_.between(0, 3)));
      }
    }
  }

  void exhibit(const Vec3& foot, int kind) {
    constexpr double kHigh_m = 1.05;
    model_.begin_object("plinth");
    model_.turned_box(foot, {0.5, 0.5, kHigh_m}, dice_.between(-0.3, 0.3), white_);
    model_.begin_object("exhibit");
    const Vec3 top = foot + Vec3(0, 0, kHigh_m);
    if (kind == 0) {
      add_vase(model_, top, dice_.between(0.35, 0.55), glaze_, 5);
    } else if (kind == 1) {
      model_.column(top, 0.03, 0.1, 24, bronze_);
      model_.knot(top + Vec3(0, 0, 0.26), 0.12, 72, 14, bronze_);
    } else {
      add_statue(model_, top, dice_.between(0.6, 0.9), dice_.between(0, 2 * kPi), 0.04, marble_);
    }
  }

  /// A pedestal with a statue below the void, inside a balustrade that starts 10 cm above the floor.
  void middle() {
    const Vec3 foot(kMuseumLength_m / 2, kMuseumWidth_m / 2, 0);
    model_.begin_object("pedestal");
    model_.turned_box(foot, {1.6, 1.6, kMuseumPedestal_m}, 0, white_);
    model_.begin_object("statue");
    add_statue(model_, foot + Vec3(0, 0, kMuseumPedestal_m), kMuseumStatue_m, dice_.between(0, 2 * kPi), 0.055,
               marble_);
    constexpr double kRailLow_m[2] = {kVoidLow_m[0] - 0.12, kVoidLow_m[1] - 0.12},
                     kRailHigh_m[2] = {kVoidHigh_m[0] + 0.12, kVoidHigh_m[1] + 0.12},
                     kEdgeLow_m[2] = {kVoidLow_m[0] - 0.02, kVoidLow_m[1] - 0.02},
                     kEdgeHigh_m[2] = {kVoidHigh_m[0] + 0.02, kVoidHigh_m[1] + 0.02};
    model_.begin_object("balustrade");
    model_.ring(kRailLow_m, kRailHigh_m, kEdgeLow_m, kEdgeHigh_m, kUpperFloor_m + 0.1, kUpperFloor_m + 1.05, bronze_);
  }

  void measure() {
    const RayScene rays(room_.scene);
    const SurfaceSpread spread(room_.scene, rays, room_.emitters.front().world_from_lamp.translation_m);
    const auto add = [&](const SurfacePart& part, std::size_t count) {
      const auto some = spread.over(part, count, seed_ + room_.receivers.size());
      room_.receivers.insert(room_.receivers.end(), some.begin(), some.end());
    };
    SurfacePart floor;
    floor.headroom_m = 1;
    floor.objects = {"lower floor"};
    floor.box_world_m = Eigen::AlignedBox3d(Vec3(0, 0, -0.1), Vec3(kMuseumLength_m, kMuseumWidth_m, 0.1));
    add(floor, 60);
    floor.objects = {"upper floor"};
    floor.box_world_m = Eigen::AlignedBox3d(Vec3(0, 0, kUpperFloor_m - 0.1),
                                            Vec3(kMuseumLength_m, kMuseumWidth_m, kUpperFloor_m + 0.1));
    add(floor, 240);
    SurfacePart shown;
    shown.box_world_m = room_.interior_m;
    shown.objects = {"pedestal", "statue"};
    shown.within_rad = rad_from_deg(100);
    add(shown, 60);
  }

  RoomDice dice_;
  std::uint64_t seed_;
  SolidModel model_;
  LitRoom room_{"museum", {}, {}, {}};
  SolidModel::MaterialIndex white_ = 0, oak_ = 0, bronze_ = 0, glaze_ = 0, marble_ = 0;
  std::array<SolidModel::MaterialIndex, 3> colours_{};
};

}  // namespace

LitRoom make_museum(std::uint64_t seed) { return Museum(seed).build(); }

}  // namespace luxrig
