#include <cmath>

#include "core/check.h"
#include "tools/bench/rooms/figures.h"
#include "tools/bench/rooms/room_plan.h"
#include "tools/bench/rooms/surface_spread.h"

namespace luxrig {
namespace {

constexpr double kStudioLength_m = 10, kStudioWidth_m = 7, kStudioHeight_m = 3;
/// The wall of shelves between bed and living room, with a passage on the window's side.
constexpr double kShelves_m = 4.0, kShelvesDepth_m = 0.36, kShelvesTop_m = 2.7;

class Studio {
 public:
  explicit Studio(std::uint64_t seed) : dice_(seed), seed_(seed) {}

  LitRoom build() {
    const auto boards = model_.material("floor boards", {0.38, 0.27, 0.17}),
               ceiling = model_.material("ceiling", {0.82, 0.81, 0.79}),
               brick = model_.material("brick wall", {0.38, 0.17, 0.11});
    white_ = model_.material("white paint", {0.79, 0.78, 0.75});
    oak_ = model_.material("oak", {0.46, 0.33, 0.20});
    cloth_ = model_.material("mustard cloth", {0.55, 0.36, 0.05});
    linen_ = model_.material("linen", {0.68, 0.65, 0.60});
    leaf_ = model_.material("leaves", {0.06, 0.20, 0.05});
    clay_ = model_.material("terracotta", {0.48, 0.22, 0.12});
    bronze_ = model_.material("bronze", {0.20, 0.13, 0.07});
    model_.begin_object("floor");
    model_.shell(Vec3::Zero(), {kStudioLength_m, kStudioWidth_m, kStudioHeight_m}, 0.3, boards, ceiling,
                 {white_, brick, white_, white_});
    shelves(dice_.between(4.2, 4.8));
    bedroom();
    living();
    room_.emitters = {
        bare_lamp({2 + dice_.between(-0.4, 0.4), 3.4, kStudioHeight_m - 0.4}, dice_.between(1200, 1800)),
        bare_lamp({7.4 + dice_.between(-0.4, 0.4), 3.4, kStudioHeight_m - 0.4}, dice_.between(2200, 3200))};
    room_.interior_m = Eigen::AlignedBox3d(Vec3::Zero(), Vec3(kStudioLength_m, kStudioWidth_m, kStudioHeight_m));
    room_.scene = model_.scene();
    measure();
    return std::move(room_);
  }

 private:
  /// Five boards, filled with leaning books and vases; a back in the middle blocks all light.
  void shelves(double x) {
    model_.begin_object("shelves");
    const double y0 = 0, y1 = kShelves_m, middle = x + kShelvesDepth_m / 2;
    model_.box({middle - 0.01, y0, 0}, {middle + 0.01, y1, kShelvesTop_m}, oak_);
    for (int board = 0; board <= 6; ++board) {
      const double z = (kShelvesTop_m - 0.03) / 6 * board;
      model_.box({x, y0, z}, {x + kShelvesDepth_m, y1, z + 0.03}, oak_);
    }
    for (int upright = 0; upright <= 4; ++upright) {
      const double y = (y1 - 0.03) / 4 * upright;
      model_.box({x, y, 0}, {x + kShelvesDepth_m, y + 0.03, kShelvesTop_m}, oak_);
    }
    const std::array<SolidModel::MaterialIndex, 5> spines = {
        model_.material("red book", {0.40, 0.05, 0.04}), model_.material("green book", {0.08, 0.24, 0.10}),
        model_.material("blue book", {0.06, 0.12, 0.36}), model_.material("cream book", {0.66, 0.60, 0.46}),
        model_.material("black book", {0.05, 0.05, 0.05})};
    model_.begin_object("books");
    for (const double side : {x + 0.09, x + kShelvesDepth_m - 0.09})
      for (int board = 0; board < 6; ++board)
        for (int bay = 0; bay < 4; ++bay) {
          const double z = (kShelvesTop_m - 0.03) / 6 * board + 0.03, end = (y1 - 0.03) / 4 * (bay + 1) - 0.05;
          double y = (y1 - 0.03) / 4 * bay + 0.06;
          if (dice_.between(0, 1) < 0.25) {
            add_vase(model_, {side, y + 0.2, z}, 0.24, clay_, 7);
            y += 0.4;
          }
          while (y < end - 0.06) {
            const double thick = dice_.between(0.018, 0.05);
            model_.turned_box({side, y + thick / 2, z}, {dice_.between(0.11, 0.15), thick, dice_.between(0.20, 0.36)},
                              dice_.between(-0.04, 0.04), spines[static_cast<std::size_t>(dice_.between(0, 4.999))]);
            y += thick + 0.004;
          }
        }
  }

  void bedroom() {
    const double y = dice_.between(1.0, 1.4);
    model_.begin_object("bed");
    model_.box({0.05, y, 0}, {2.1, y + 1.6, 0.5}, linen_);
    model_.begin_object("pillows");
    for (const double at : {0.4, 1.2})
      model_.body(mesh_level_set({Vec3(0.1, y + at - 0.35, 0.45), Vec3(0.6, y + at + 0.35, 0.75)}, 0.02,
                                 [&](const Vec3& p) {
                                   const Vec3 q = (p - Vec3(0.35, y + at, 0.57)).cwiseQuotient(Vec3(0.2, 0.3, 0.09));
                                   return 0.09 * (std::pow(q.array().abs().pow(4).sum(), 0.25) - 1);
                                 }),
                  white_);
    model_.begin_object("wardrobe");
    model_.box({0, 4.2, 0}, {0.6, 5.8, 2.2}, oak_);
    model_.begin_object("plant");
    plant({3.4, 6.2, 0}, 0.9, 1.5);
  }

  void living() {
    model_.begin_object("sofa");
    const double x = dice_.between(6.6, 7.4);
    model_.box({x, 5.9, 0}, {x + 2.2, 6.9, 0.42}, cloth_);
    model_.box({x, 6.65, 0.4}, {x + 2.2, 6.9, 0.85}, cloth_);
    for (const double arm : {x - 0.2, x + 2.18}) model_.box({arm, 5.9, 0}, {arm + 0.2, 6.9, 0.62}, cloth_);
    model_.begin_object("low table");
    const Vec3 low(x + 0.5, dice_.between(4.6, 4.9), 0);
    model_.box(low + Vec3(0, 0, 0.36), low + Vec3(1.2, 0.7, 0.40), oak_);
    for (const double leg : {0.05, 1.09})
      model_.box(low + Vec3(leg, 0.05, 0), low + Vec3(leg + 0.06, 0.65, 0.36), oak_);
    model_.begin_object("table");
    const Vec3 table(dice_.between(7.0, 7.6), dice_.between(1.0, 1.4), 0);
    model_.box(table + Vec3(0, 0, 0.70), table + Vec3(1.8, 0.9, 0.74), oak_);
    for (const double leg : {0.05, 1.69})
      model_.box(table + Vec3(leg, 0.1, 0), table + Vec3(leg + 0.06, 0.8, 0.70), oak_);
    model_.begin_object("vases");
    for (const double at : {0.35, 0.9, 1.45})
      add_vase(model_, table + Vec3(at, 0.45, 0.74), dice_.between(0.2, 0.4), clay_, 5 + static_cast<int>(4 * at));
    model_.begin_object("sculpture");
    const Vec3 foot(5.8, 2.2, 0);
    model_.turned_box(foot, {0.6, 0.6, 0.5}, dice_.between(-0.3, 0.3), white_);
    model_.column(foot + Vec3(0, 0, 0.5), 0.06, 0.2, 32, bronze_);
    model_.knot(foot + Vec3(0, 0, 1.05), 0.38, 480, 48, bronze_);
    model_.begin_object("plant");
    plant({9.4, 3.6, 0}, 0.9, 1.6);
  }

  void plant(const Vec3& foot, double width_m, double height_m) {
    add_vase(model_, foot, 0.45, clay_, 9);
    model_.column(foot + Vec3(0, 0, 0.4), 0.03, 0.4, 12, oak_);
    add_crown(model_, foot + Vec3(0, 0, 0.7), width_m, height_m, 120, leaf_);
  }

  void measure() {
    const RayScene rays(room_.scene);
    const SurfaceSpread spread(room_.scene, rays, room_.emitters.front().world_from_lamp.translation_m);
    // As a person would ask: more receivers on bed and tables than on the floor.
    room_.regions_m.emplace_back(Vec3(0, 0, 0), Vec3(4.2, kStudioWidth_m, kStudioHeight_m));
    room_.regions_m.emplace_back(Vec3(5.2, 0, 0), Vec3(kStudioLength_m, kStudioWidth_m, kStudioHeight_m));
    for (const auto& region_m : room_.regions_m)
      for (const bool furniture : {false, true}) {
        SurfacePart part;
        part.box_world_m = region_m;
        part.box_world_m.min().z() = -0.1;
        part.objects = {"floor"};
        part.headroom_m = 1;
        if (furniture) part.objects = {"bed", "sofa", "low table", "table"}, part.headroom_m = 0.3;
        const auto some = spread.over(part, furniture ? 50 : 100, seed_ + room_.receivers.size());
        room_.receivers.insert(room_.receivers.end(), some.begin(), some.end());
      }
  }

  RoomDice dice_;
  std::uint64_t seed_;
  SolidModel model_;
  LitRoom room_{"studio", {}, {}, {}};
  SolidModel::MaterialIndex white_ = 0, oak_ = 0, cloth_ = 0, linen_ = 0, leaf_ = 0, clay_ = 0, bronze_ = 0;
};

}  // namespace

LitRoom make_studio(std::uint64_t seed) { return Studio(seed).build(); }

}  // namespace luxrig
