#include <cmath>

#include "tools/bench/rooms/room_plan.h"

namespace luxrig {
namespace {

constexpr double kAtriumLength_m = 30, kAtriumWidth_m = 20, kStorey_m = 3.5, kSlab_m = 0.3, kWall_m = 0.3;
constexpr int kStoreys = 4;
constexpr double kAtriumHeight_m = kStorey_m * kStoreys;
/// The court within the balconies, and the opening in the roof.
constexpr double kCourtLow_m[2] = {8, 6}, kCourtHigh_m[2] = {22, 14}, kSkyLow_m[2] = {10, 7.5},
                 kSkyHigh_m[2] = {20, 12.5};

class Atrium {
 public:
  explicit Atrium(std::uint64_t seed) : dice_(seed) {}

  LitRoom build(const Sky& sky) {
    concrete_ = model_.material("concrete", {0.45, 0.44, 0.42});
    plaster_ = model_.material("white plaster", {0.77, 0.76, 0.73});
    stone_ = model_.material("stone floor", {0.38, 0.35, 0.30});
    rail_ = model_.material("balustrade", {0.60, 0.58, 0.54});
    orange_ = model_.material("orange paint", {0.60, 0.22, 0.03});
    teal_ = model_.material("teal paint", {0.04, 0.26, 0.28});
    shell();
    for (int storey = 1; storey < kStoreys; ++storey) balconies(storey);
    for (int storey = 0; storey < kStoreys; ++storey) bays(storey);
    columns();
    for (int storey = 0; storey + 1 < kStoreys; ++storey) stairs(storey);
    bridge();
    trees();
    lamps();
    measure();
    if (sky) {
      Emitter above;
      above.sky = sky;
      room_.emitters.push_back(std::move(above));
    }
    room_.interior_m = Eigen::AlignedBox3d(Vec3::Zero(), Vec3(kAtriumLength_m, kAtriumWidth_m, kAtriumHeight_m));
    room_.scene = model_.scene();
    return std::move(room_);
  }

 private:
  void shell() {
    model_.begin_object("shell");
    constexpr double kOutLow[2] = {-kWall_m, -kWall_m},
                     kOutHigh[2] = {kAtriumLength_m + kWall_m, kAtriumWidth_m + kWall_m};
    constexpr double kInLow[2] = {0, 0}, kInHigh[2] = {kAtriumLength_m, kAtriumWidth_m};
    model_.box({-kWall_m - 0.05, -kWall_m - 0.05, -0.4},
               {kAtriumLength_m + kWall_m + 0.05, kAtriumWidth_m + kWall_m + 0.05, 0}, stone_);
    model_.ring(kOutLow, kOutHigh, kInLow, kInHigh, -0.1, kAtriumHeight_m + 0.1, plaster_);
    constexpr double kRoofLow[2] = {-kWall_m - 0.05, -kWall_m - 0.05},
                     kRoofHigh[2] = {kAtriumLength_m + kWall_m + 0.05, kAtriumWidth_m + kWall_m + 0.05};
    model_.ring(kRoofLow, kRoofHigh, kSkyLow_m, kSkyHigh_m, kAtriumHeight_m, kAtriumHeight_m + 0.4, plaster_);
    model_.begin_object("glazing bars");
    for (int i = 1; i < 5; ++i) {
      const double x = kSkyLow_m[0] + 2.0 * i;
      model_.box({x - 0.03, kSkyLow_m[1] - 0.05, kAtriumHeight_m + 0.1},
                 {x + 0.03, kSkyHigh_m[1] + 0.05, kAtriumHeight_m + 0.25}, rail_);
    }
  }

  void balconies(int storey) {
    const double z = storey * kStorey_m;
    constexpr double kLow[2] = {-0.05, -0.05}, kHigh[2] = {kAtriumLength_m + 0.05, kAtriumWidth_m + 0.05};
    model_.begin_object("balconies");
    model_.ring(kLow, kHigh, kCourtLow_m, kCourtHigh_m, z - kSlab_m, z, concrete_);
    model_.begin_object("balustrades");
    constexpr double kRailLow[2] = {kCourtLow_m[0] - 0.12, kCourtLow_m[1] - 0.12},
                     kRailHigh[2] = {kCourtHigh_m[0] + 0.12, kCourtHigh_m[1] + 0.12};
    constexpr double kEdgeLow[2] = {kCourtLow_m[0] - 0.02, kCourtLow_m[1] - 0.02},
                     kEdgeHigh[2] = {kCourtHigh_m[0] + 0.02, kCourtHigh_m[1] + 0.02};
    // The balustrade starts 10 cm above the floor.
    model_.ring(kRailLow, kRailHigh, kEdgeLow, kEdgeHigh, z + 0.1, z + 1.05, rail_);
  }

  /// Cross walls with doorways behind the balconies, every fourth one painted, and a shelf in each bay.
  void bays(int storey) {
    const double z = storey * kStorey_m, top = z + kStorey_m - (storey + 1 < kStoreys ? kSlab_m : 0) + 0.02;
    for (int i = 1; i <= 4; ++i) {
      const auto paint = (i + storey) % 4 == 0 ? orange_ : (i + storey) % 4 == 1 ? teal_ : plaster_;
      const double x = 6.0 * i;
      const WallGap doorway{2.6, 3.6, z - 0.02, z + 2.1};
      model_.begin_object("cross wall");
      model_.wall({x - 0.08, -0.05, z - 0.02}, {x + 0.08, 4.2, top}, {{doorway}}, paint);
      const WallGap opposite{16.4, 17.4, z - 0.02, z + 2.1};
      model_.wall({x - 0.08, 15.8, z - 0.02}, {x + 0.08, 20.05, top}, {{opposite}}, paint);
      model_.begin_object("shelf");
      for (int board = 0; board < 4; ++board)
        model_.box({x - 2.0, 0, z + 0.3 + 0.45 * board}, {x - 0.6, 0.35, z + 0.33 + 0.45 * board}, rail_);
      model_.turned_box({x - dice_.between(2.5, 3.5), 18.6, z}, {1.4, 0.7, 0.74}, dice_.between(-0.3, 0.3),
                        i % 2 ? rail_ : orange_);
    }
  }

  void columns() {
    model_.begin_object("columns");
    for (int i = 0; i < 4; ++i)
      for (const double y : {kCourtLow_m[1] - 0.5, kCourtHigh_m[1] + 0.5})
        model_.column({kCourtLow_m[0] - 0.5 + 5.0 * i, y, -0.05}, 0.22, kAtriumHeight_m + 0.1, 32, concrete_);
  }

  /// A flight along the wall at X = 0, through the slab's level beside the court.
  void stairs(int storey) {
    model_.begin_object("stairs");
    constexpr int kSteps = 18;
    const double z = storey * kStorey_m;
    for (int s = 0; s < kSteps; ++s) {
      const double x = kCourtLow_m[0] + 1.5 + 0.3 * s, rise = kStorey_m / kSteps;
      const double y = storey % 2 ? kCourtHigh_m[1] - 1.4 : kCourtLow_m[1] + 0.2;
      model_.box({x, y, z + rise * s + (s ? 0.04 : 0.0)}, {x + 0.32, y + 1.2, z + rise * (s + 1)}, stone_);
    }
  }

  void bridge() {
    model_.begin_object("bridge");
    const double z = 2 * kStorey_m;
    model_.box({17.5, kCourtLow_m[1] - 0.1, z - 0.25}, {19.5, kCourtHigh_m[1] + 0.1, z - 0.001}, concrete_);
    for (const double x : {17.52, 19.42})
      model_.box({x, kCourtLow_m[1] + 0.01, z + 0.1}, {x + 0.06, kCourtHigh_m[1] - 0.01, z + 1.05}, rail_);
  }

  void trees() {
    const auto leaf = model_.material("leaves", {0.07, 0.22, 0.05}), bark = model_.material("bark", {0.16, 0.11, 0.07});
    for (int i = 0; i < 4; ++i) {
      const Vec3 foot(17.0 + 1.3 * (i % 2) + dice_.between(-0.2, 0.2), 8.6 + 3.0 * (i / 2), 0);
      model_.begin_object("tree");
      model_.column(foot, 0.5, 0.5, 24, concrete_);
      model_.column(foot + Vec3(0, 0, 0.45), 0.07, 1.4, 12, bark);
      std::vector<Eigen::Vector2d> crown;
      for (int k = 0; k <= 14; ++k) {
        const double t = k / 14.0;
        crown.emplace_back(0.1 + 0.75 * std::sin(kPi * std::pow(t, 0.7)) * (1 - 0.12 * (k % 2)), 2.6 * t);
      }
      model_.turned_body(foot + Vec3(0, 0, 1.6), crown, 36, leaf, 9, 0.12);
    }
  }

  void lamps() {
    for (int storey = 0; storey < kStoreys; ++storey) {
      const double z = (storey + 1) * kStorey_m - (storey + 1 < kStoreys ? kSlab_m : 0) - 0.05;
      for (int i = 0; i < 5; ++i)
        for (const double y : {3.0, 17.0}) downlight({3.0 + 6.0 * i, y, z}, 1400);
    }
    for (const double x : {4.0, 26.0}) downlight({x, 10, kAtriumHeight_m - 0.05}, 2600);
    for (const double y : {7.0, 13.0})
      for (const double x : {9.0, 21.0})
        room_.emitters.push_back({make_spot(4500, rad_from_deg(30), rad_from_deg(52)),
                                  aimed({x, y, kAtriumHeight_m - 0.3}, {15 + dice_.between(-1, 1), 10, 0})});
  }

  void downlight(const Vec3& at_m, double flux_lm) {
    room_.emitters.push_back({make_spot(flux_lm * dice_.between(0.8, 1.2), rad_from_deg(70), rad_from_deg(115)),
                              aimed(at_m, at_m - Vec3::UnitZ())});
  }

  void measure() {
    const auto floor = [&](const Vec3& p) {
      const Vec3 above = p + Vec3(0, 0, 0.03);
      return !model_.occupied(above, 0.02) && model_.open_above(above, 1.0);
    };
    const auto plane = [&](const Vec3& p) { return !model_.occupied(p, 0.02) && model_.open_above(p, 1.0); };
    const auto free_wall = [&](const Vec3& p) { return !model_.occupied(p, 0.0); };
    const auto level = [&](int count, double x0, double x1, double y0, double y1, double z, const auto& fits) {
      spread_receivers(room_, count, {x0, y0, z}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}, Vec3::UnitZ(), dice_, fits);
    };
    level(60, 0.3, 29.7, 0.3, 19.7, kOffSurface_m, floor);
    level(30, 0.3, 29.7, 0.3, 19.7, 0.75, plane);
    for (int storey = 1; storey < kStoreys; ++storey) {
      const double z = storey * kStorey_m;
      for (const double y : {0.3, 14.4}) {
        level(15, 0.3, 29.7, y, y + 5.3, z + kOffSurface_m, floor);
        level(10, 0.3, 29.7, y, y + 5.3, z + 0.75, plane);
      }
      spread_receivers(room_, 20, {0.3, kAtriumWidth_m - kOffSurface_m, z + 0.5}, {29.4, 0, 0}, {0, 0, 2},
                       -Vec3::UnitY(), dice_, free_wall);
    }
  }

  RoomDice dice_;
  SolidModel model_;
  LitRoom room_{"atrium", {}, {}, {}};
  SolidModel::MaterialIndex concrete_ = 0, plaster_ = 0, stone_ = 0, rail_ = 0, orange_ = 0, teal_ = 0;
};

}  // namespace

LitRoom make_atrium(std::uint64_t seed, const Sky& sky) { return Atrium(seed).build(sky); }

}  // namespace luxrig
