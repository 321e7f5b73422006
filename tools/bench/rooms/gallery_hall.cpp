#include <cmath>

#include "tools/bench/rooms/figures.h"
#include "tools/bench/rooms/room_plan.h"

namespace luxrig {
namespace {

constexpr double kHallLength_m = 20, kHallWidth_m = 12, kHallHeight_m = 4.5, kPlinth_m = 1.05, kPictures_z_m = 1.55;

class Gallery {
 public:
  Gallery(std::uint64_t seed, bool polished) : dice_(seed), gloss_(polished ? 0.04 : 0.0) {}

  LitRoom build() {
    white_ = model_.material("white wall", {0.80, 0.80, 0.78});
    const auto parquet = model_.material("parquet", {0.34, 0.24, 0.15}, gloss_, 0.25);
    const auto ceiling = model_.material("ceiling", {0.75, 0.75, 0.73});
    dark_red_ = model_.material("dark red wall", {0.30, 0.045, 0.04});
    model_.begin_object("hall");
    model_.shell(Vec3::Zero(), {kHallLength_m, kHallWidth_m, kHallHeight_m}, 0.3, parquet, ceiling,
                 {white_, dark_red_, white_, white_});
    partitions();
    pictures();
    sculptures();
    lamps();
    measure();
    room_.interior_m = Eigen::AlignedBox3d(Vec3::Zero(), Vec3(kHallLength_m, kHallWidth_m, kHallHeight_m));
    room_.scene = model_.scene();
    return std::move(room_);
  }

 private:
  void partitions() {
    model_.begin_object("partitions");
    model_.box({5.0, 3.0, -0.05}, {5.2, 8.0, 3.2}, white_);
    model_.box({8.2, 5.0, -0.05}, {12.2, 5.2, 3.2}, white_);
    model_.box({14.8, 4.0, -0.05}, {15.0, 9.0, 3.2}, white_);
    model_.box({9.0, 9.0, -0.05}, {9.2, 12.05, 3.2}, white_);
    const auto grey = model_.material("bench cloth", {0.14, 0.15, 0.17});
    model_.begin_object("bench");
    for (const double x : {2.6, 17.3}) {
      model_.box({x, 5.4, 0.36}, {x + 0.5, 7.0, 0.46}, grey);
      model_.box({x + 0.1, 5.6, 0}, {x + 0.4, 5.7, 0.36}, grey);
      model_.box({x + 0.1, 6.7, 0}, {x + 0.4, 6.8, 0.36}, grey);
    }
  }

  void picture(const HangingPlace& place) {
    constexpr double kColours[6][3] = {{0.42, 0.30, 0.18}, {0.12, 0.20, 0.34}, {0.50, 0.46, 0.36},
                                       {0.35, 0.08, 0.06}, {0.14, 0.26, 0.12}, {0.60, 0.50, 0.20}};
    const double width_m = dice_.between(0.6, 1.2), height_m = dice_.between(0.6, 1.0);
    const double* c = kColours[pictures_.size() % 6];
    const auto canvas =
        model_.material("picture " + std::to_string(pictures_.size() + 1), {c[0], c[1], c[2]}, gloss_, 0.2);
    model_.begin_object("picture");
    const Vec3 half = place.right * (width_m / 2 + 0.01) + Vec3::UnitZ() * (height_m / 2 + 0.01);
    const Vec3 a = place.middle_m - half - 0.02 * place.out, b = place.middle_m + half + 0.015 * place.out;
    model_.box(a.cwiseMin(b), a.cwiseMax(b), canvas);
    model_.moulding(place, width_m, height_m, 0.08, 0.05, 24, pictures_.size() % 3 ? gilt_ : black_);
    pictures_.push_back({place, width_m, height_m});
  }

  void pictures() {
    gilt_ = model_.material("gilt", {0.52, 0.38, 0.16});
    black_ = model_.material("black lacquer", {0.05, 0.05, 0.05});
    const auto row = [&](double fixed, bool along_x, double out, double from, double to, int count) {
      for (int i = 0; i < count; ++i) {
        const double at = from + (to - from) * (i + 0.5) / count;
        const Vec3 middle = along_x ? Vec3(at, fixed, kPictures_z_m) : Vec3(fixed, at, kPictures_z_m);
        const Vec3 away = out * (along_x ? Vec3::UnitY() : Vec3::UnitX());
        picture({middle, away.cross(Vec3::UnitZ()), away});
      }
    };
    row(0, true, 1, 1, 19, 6);
    row(kHallWidth_m, true, -1, 0.8, 8.6, 3);
    row(kHallWidth_m, true, -1, 10, 19, 3);
    row(0, false, 1, 2, 10, 3);
    row(5.2, false, 1, 3.2, 7.8, 2);
    row(5.0, true, -1, 8.4, 12, 2);
    row(5.2, true, 1, 8.4, 12, 2);
    row(14.8, false, -1, 4.2, 8.8, 2);
    row(15.0, false, 1, 5.0, 8.0, 1);
  }

  void sculptures() {
    const auto bronze = model_.material("bronze", {0.20, 0.13, 0.07}),
               marble = model_.material("marble", {0.74, 0.72, 0.68}),
               glaze = model_.material("blue glaze", {0.04, 0.12, 0.40}),
               clay = model_.material("terracotta", {0.48, 0.22, 0.12});
    constexpr double kPlaces_m[10][2] = {{2.5, 2.5},  {7.0, 6.5},  {10.2, 2.6}, {10.2, 7.8},  {13.2, 6.5},
                                         {17.0, 2.5}, {17.5, 9.5}, {2.5, 9.8},  {12.0, 10.2}, {7.2, 2.4}};
    for (std::size_t i = 0; i < std::size(kPlaces_m); ++i) {
      const Vec3 foot(kPlaces_m[i][0] + dice_.between(-0.2, 0.2), kPlaces_m[i][1] + dice_.between(-0.2, 0.2), 0);
      plinths_m_.push_back(foot);
      model_.begin_object("plinth");
      model_.box(foot - Vec3(0.25, 0.25, 0.0), foot + Vec3(0.25, 0.25, kPlinth_m), white_);
      model_.begin_object("sculpture");
      const Vec3 top = foot + Vec3(0, 0, kPlinth_m);
      if (i % 3 == 0) {
        model_.column(top, 0.03, 0.1, 24, bronze);
        model_.knot(top + Vec3(0, 0, 0.23), 0.11, 96, 20, i % 2 ? bronze : glaze);
      } else if (i % 3 == 1) {
        add_vase(model_, top, 0.42, i % 2 ? clay : glaze, 3 + static_cast<int>(i));
      } else {
        model_.column(top, 0.06, 0.06, 24, bronze);
        model_.ball(top + Vec3(0, 0, 0.19), 0.15, 48, marble);
      }
    }
  }

  /// Spots on two tracks below the ceiling: eight at pictures, four at sculptures.
  void lamps() {
    const auto track = model_.material("track", {0.05, 0.05, 0.05});
    model_.begin_object("track");
    for (const double y : {2.0, 10.0})
      model_.box({1.0, y - 0.02, kHallHeight_m - 0.3}, {19.0, y + 0.02, kHallHeight_m - 0.26}, track);
    const double z = kHallHeight_m - 0.36;
    const auto spot = [&](double beam_deg) {
      return make_spot(dice_.between(1200, 2200), rad_from_deg(beam_deg), rad_from_deg(1.8 * beam_deg));
    };
    constexpr std::size_t kAimed[8] = {0, 1, 3, 5, 6, 8, 9, 11};
    for (const std::size_t p : kAimed) {
      const Vec3 aim = pictures_[p].place.middle_m;
      room_.emitters.push_back(
          {spot(dice_.between(24, 36)), aimed({aim.x() + dice_.between(-0.5, 0.5), aim.y() < 6 ? 2.0 : 10.0, z}, aim)});
    }
    for (const std::size_t p : {0UL, 5UL, 6UL, 9UL}) {
      const Vec3 aim = plinths_m_[p] + Vec3(0, 0, kPlinth_m + 0.2);
      room_.emitters.push_back(
          {spot(dice_.between(18, 26)), aimed({aim.x() + (p % 2 ? 0.9 : -0.9), aim.y() < 6 ? 2.0 : 10.0, z}, aim)});
    }
  }

  void measure() {
    const auto clear = [&](const Vec3& p) { return !model_.occupied(p, 0.0); };
    const auto wall = [&](int count, const Vec3& from, const Vec3& to, const Vec3& normal) {
      spread_receivers(room_, count, from + kOffSurface_m * normal + Vec3(0, 0, 0.6), to - from, {0, 0, 2.2}, normal,
                       dice_, clear);
    };
    wall(44, {0.3, 0, 0}, {19.7, 0, 0}, Vec3::UnitY());
    wall(20, {0.3, kHallWidth_m, 0}, {8.8, kHallWidth_m, 0}, -Vec3::UnitY());
    wall(24, {9.4, kHallWidth_m, 0}, {19.7, kHallWidth_m, 0}, -Vec3::UnitY());
    wall(16, {0, 0.3, 0}, {0, 11.7, 0}, Vec3::UnitX());
    wall(16, {kHallLength_m, 0.3, 0}, {kHallLength_m, 11.7, 0}, -Vec3::UnitX());
    wall(12, {5.0, 3.2, 0}, {5.0, 7.8, 0}, -Vec3::UnitX());
    wall(12, {5.2, 3.2, 0}, {5.2, 7.8, 0}, Vec3::UnitX());
    wall(10, {8.4, 5.0, 0}, {12.0, 5.0, 0}, -Vec3::UnitY());
    wall(10, {8.4, 5.2, 0}, {12.0, 5.2, 0}, Vec3::UnitY());
    wall(12, {14.8, 4.2, 0}, {14.8, 8.8, 0}, -Vec3::UnitX());
    wall(12, {15.0, 4.2, 0}, {15.0, 8.8, 0}, Vec3::UnitX());
    for (const Hung& hung : pictures_)
      for (int i = 0; i < 3; ++i)
        room_.receivers.push_back({hung.place.middle_m + hung.place.right * (hung.width_m * (i - 1) * 0.35) +
                                       Vec3(0, 0, hung.height_m * dice_.between(-0.4, 0.4)) +
                                       hung.place.out * (0.015 + kOffSurface_m),
                                   hung.place.out});
    for (const Vec3& foot : plinths_m_)
      for (const double x : {-0.215, 0.215})
        for (const double y : {-0.215, 0.215})
          room_.receivers.push_back({foot + Vec3(x, y, kPlinth_m + kOffSurface_m), Vec3::UnitZ()});
  }

  struct Hung {
    HangingPlace place;
    double width_m, height_m;
  };
  RoomDice dice_;
  double gloss_;
  SolidModel model_;
  LitRoom room_{"gallery", {}, {}, {}};
  SolidModel::MaterialIndex white_ = 0, dark_red_ = 0, gilt_ = 0, black_ = 0;
  std::vector<Hung> pictures_;
  std::vector<Vec3> plinths_m_;
};

}  // namespace

LitRoom make_gallery_hall(std::uint64_t seed, bool polished) { return Gallery(seed, polished).build(); }

}  // namespace luxrig
