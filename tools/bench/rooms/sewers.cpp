#include <cmath>

#include "core/check.h"
#include "tools/bench/rooms/room_plan.h"
#include "tools/bench/rooms/surface_spread.h"

namespace luxrig {
namespace {

constexpr double kTunnelRadius_m = 2, kTunnelAxis_m = 1.4, kTunnelCell_m = 0.3, kRock_m = 1;

/// Ends and junctions in plan, and the tunnels between them.
constexpr double kShafts_m[8][2] = {{0, 6}, {8, 7}, {16, 5}, {25, 7}, {6, 15}, {17, 13}, {13, -4}, {24, 15}};
constexpr int kTunnels[8][2] = {{0, 1}, {1, 2}, {2, 3}, {1, 4}, {2, 5}, {5, 4}, {2, 6}, {5, 7}};

class Sewers {
 public:
  explicit Sewers(std::uint64_t seed) : dice_(seed), seed_(seed) {}

  LitRoom build() {
    const auto brick = model_.material("wet brick", {0.30, 0.20, 0.15});
    rust_ = model_.material("rust", {0.34, 0.10, 0.04});
    blue_ = model_.material("blue drum", {0.04, 0.10, 0.32});
    wood_ = model_.material("crate", {0.42, 0.30, 0.18});
    run();
    // The floor is at mid-height of a cell, where a surface net is flat.
    const Eigen::AlignedBox3d bounds_m = around();
    model_.begin_object("tunnels");
    const ClosedMesh air = mesh_level_set(bounds_m, kTunnelCell_m, [&](const Vec3& p) {
      double nearest_m = HUGE_VAL;
      for (std::size_t i = 0; i + 1 < bends_m_.size(); i += 2)
        nearest_m = std::min(nearest_m, distance_to_segment_m(p, bends_m_[i], bends_m_[i + 1]));
      return std::max(nearest_m - kTunnelRadius_m, -p.z());
    });
    const Vec3 rock = Vec3::Constant(kRock_m);
    model_.hollow_block(bounds_m.min() - rock, bounds_m.max() + rock, air, brick);
    litter();
    room_.scene = model_.scene();
    room_.interior_m = Eigen::AlignedBox3d(Vec3(bounds_m.min().x(), bounds_m.min().y(), 0), bounds_m.max());
    measure();
    return std::move(room_);
  }

 private:
  /// Each tunnel bends once; lamps hang below its crown.
  void run() {
    std::vector<Vec3> shafts_m;
    for (const auto& at : kShafts_m)
      shafts_m.emplace_back(at[0] + dice_.between(-0.7, 0.7), at[1] + dice_.between(-0.7, 0.7), kTunnelAxis_m);
    for (const auto& [from, to] : kTunnels) {
      const Vec3 a = shafts_m[static_cast<std::size_t>(from)], b = shafts_m[static_cast<std::size_t>(to)];
      const Vec3 aside = (b - a).cross(Vec3::UnitZ()).normalized();
      const Vec3 bend = a + dice_.between(0.35, 0.65) * (b - a) + dice_.between(-0.9, 0.9) * aside;
      bends_m_.insert(bends_m_.end(), {a, bend, bend, b});
      lamp((bend + dice_.between(-0.3, 0.3) * aside));
    }
    for (const std::size_t shaft : {0UL, 3UL, 6UL}) lamp(shafts_m[shaft]);
  }

  void lamp(const Vec3& at_m) {
    const Vec3 below_crown(0, 0, kTunnelRadius_m - dice_.between(0.2, 0.5));
    room_.emitters.push_back(bare_lamp(at_m + below_crown, dice_.between(1500, 3000)));
  }

  [[nodiscard]] Eigen::AlignedBox3d around() const {
    Eigen::AlignedBox3d bounds_m;
    for (const Vec3& bend : bends_m_) bounds_m.extend(bend);
    const Vec3 margin(kTunnelRadius_m + kTunnelCell_m, kTunnelRadius_m + kTunnelCell_m, 0);
    return {Vec3(bounds_m.min().x(), bounds_m.min().y(), -1.5 * kTunnelCell_m) - margin,
            Vec3(bounds_m.max().x(), bounds_m.max().y(), kTunnelAxis_m + kTunnelRadius_m + 2 * kTunnelCell_m) + margin};
  }

  /// Crates and drums at the sides of the floors, and a pipe below the crown of each straight.
  void litter() {
    for (std::size_t i = 0; i + 1 < bends_m_.size(); i += 2) {
      const Vec3 a = bends_m_[i], along = (bends_m_[i + 1] - a).normalized(), aside = along.cross(Vec3::UnitZ());
      const double side = dice_.between(0, 1) < 0.5 ? -1 : 1, length_m = (bends_m_[i + 1] - a).norm();
      Vec3 at = a + dice_.between(0.3, 0.7) * length_m * along + side * 1.0 * aside;
      at.z() = 0;
      model_.begin_object("litter");
      if (i % 4 == 0) {
        model_.turned_box(at, {0.6, 0.5, dice_.between(0.4, 0.9)}, dice_.between(0, 1.5), wood_);
      } else {
        model_.column(at, 0.29, 0.88, 20, i % 8 == 2 ? blue_ : rust_);
      }
    }
  }

  void measure() {
    const RayScene rays(room_.scene);
    const SurfaceSpread spread(room_.scene, rays, room_.emitters.front().world_from_lamp.translation_m);
    SurfacePart floor;
    floor.objects = {"tunnels"};
    floor.box_world_m = room_.interior_m;
    floor.box_world_m.max().z() = 0.1;
    floor.within_rad = rad_from_deg(5);
    floor.headroom_m = 1;
    room_.receivers = spread.over(floor, 300, seed_);
  }

  RoomDice dice_;
  std::uint64_t seed_;
  SolidModel model_;
  LitRoom room_{"sewers", {}, {}, {}};
  std::vector<Vec3> bends_m_;  ///< pairs: the axes of straight parts
  SolidModel::MaterialIndex rust_ = 0, blue_ = 0, wood_ = 0;
};

}  // namespace

LitRoom make_sewers(std::uint64_t seed) { return Sewers(seed).build(); }

}  // namespace luxrig
