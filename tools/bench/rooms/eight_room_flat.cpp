#include <cmath>

#include "tools/bench/rooms/room_plan.h"

namespace luxrig {
namespace {

constexpr double kFlatLength_m = 14.6, kFlatWidth_m = 9.4, kFlatHeight_m = 2.6, kReach_m = 0.05;
constexpr double kHallLow_m = 3.9, kHallHigh_m = 5.5, kHallWall_m = 0.12, kPartition_m = 0.10;
constexpr double kDoorWidth_m = 0.9, kDoorHeight_m = 2.05;
constexpr double kRoomWidths_m[2][4] = {{4.2, 3.2, 3.6, 3.3}, {3.0, 4.0, 3.2, 4.1}};

/// A room's floor.
struct Floor {
  double left_m, right_m, front_m, back_m;  ///< front: towards the hallway
  [[nodiscard]] double inward() const { return back_m > front_m ? 1 : -1; }
};

class Flat {
 public:
  explicit Flat(std::uint64_t seed) : dice_(seed) {}

  LitRoom build() {
    const auto oak = model_.material("oak floor", {0.40, 0.28, 0.17}),
               ceiling = model_.material("ceiling", {0.81, 0.80, 0.78});
    white_ = model_.material("white paint", {0.78, 0.77, 0.73});
    door_ = model_.material("door", {0.62, 0.60, 0.55});
    model_.begin_object("flat");
    model_.shell(Vec3::Zero(), {kFlatLength_m, kFlatWidth_m, kFlatHeight_m}, 0.3, oak, ceiling,
                 {white_, white_, white_, white_});
    for (const int side : {0, 1}) divide(side);
    furnish();
    room_.emitters.push_back(lamp({3.6, 4.7}));
    room_.emitters.push_back(lamp({11.0, 4.7}));
    for (const Floor& floor : floors_)
      room_.emitters.push_back(lamp({(floor.left_m + floor.right_m) / 2 + dice_.between(-0.4, 0.4),
                                     (floor.front_m + floor.back_m) / 2 + dice_.between(-0.4, 0.4)}));
    measure();
    room_.interior_m = Eigen::AlignedBox3d(Vec3::Zero(), Vec3(kFlatLength_m, kFlatWidth_m, kFlatHeight_m));
    for (const Floor& f : floors_)
      room_.regions_m.emplace_back(Vec3(f.left_m, std::min(f.front_m, f.back_m), 0),
                                   Vec3(f.right_m, std::max(f.front_m, f.back_m), kFlatHeight_m));
    room_.regions_m.emplace_back(Vec3(0, kHallLow_m, 0), Vec3(kFlatLength_m, kHallHigh_m, kFlatHeight_m));
    room_.scene = model_.scene();
    return std::move(room_);
  }

 private:
  /// Hallway wall with its four doors, and the partitions behind it.
  void divide(int side) {
    const double hall_y = side == 0 ? kHallLow_m - kHallWall_m : kHallHigh_m;
    const double front = side == 0 ? hall_y : hall_y + kHallWall_m, back = side == 0 ? 0 : kFlatWidth_m;
    std::vector<WallGap> gaps;
    double left = 0;
    for (int r = 0; r < 4; ++r) {
      const double right = left + kRoomWidths_m[side][r];
      floors_.push_back({left, right, front, back});
      const double door = left + dice_.between(0.2, 0.6);
      gaps.push_back({door, door + kDoorWidth_m, -kReach_m, kDoorHeight_m});
      left = right + kPartition_m;
    }
    model_.wall({-kReach_m, hall_y, -kReach_m},
                {kFlatLength_m + kReach_m, hall_y + kHallWall_m, kFlatHeight_m + kReach_m}, gaps, white_);
    for (std::size_t r = 0; r < 3; ++r) {
      const Floor& floor = floors_[floors_.size() - 4 + r];
      model_.box({floor.right_m, std::min(front, back) - kReach_m, -kReach_m},
                 {floor.right_m + kPartition_m, std::max(front, back) + kReach_m, kFlatHeight_m + kReach_m}, white_);
    }
    for (std::size_t r = 0; r < 4; ++r) {
      // Hinged at its left jamb, ajar into the room.
      const Floor& floor = floors_[floors_.size() - 4 + r];
      const double open_rad = floor.inward() * rad_from_deg(dice_.between(65, 100)), leaf_m = 0.84;
      model_.begin_object("door");
      model_.turned_box({gaps[r].from_m + 0.02 + leaf_m / 2 * std::cos(open_rad),
                         front + floor.inward() * 0.03 + leaf_m / 2 * std::sin(open_rad), 0.01},
                        {leaf_m, 0.04, 2.0}, open_rad, door_);
      model_.begin_object("walls");
    }
  }

  /// A box in a room, at distances from its left wall and its back wall.
  void piece(std::size_t floor_index, const char* name, double left_m, double back_m, const Vec3& size_m,
             SolidModel::MaterialIndex material, double bottom_m = 0) {
    const Floor& floor = floors_[floor_index];
    const double x = floor.left_m + left_m;
    const double y0 = floor.back_m - floor.inward() * back_m, y1 = y0 - floor.inward() * size_m.y();
    model_.begin_object(name);
    model_.box({x, std::min(y0, y1), bottom_m}, {x + size_m.x(), std::max(y0, y1), bottom_m + size_m.z()}, material);
  }

  void desk(std::size_t floor_index, double left_m, double back_m, double length_m,
            SolidModel::MaterialIndex material) {
    piece(floor_index, "desk", left_m, back_m, {length_m, 0.75, 0.04}, material, 0.70);
    const Floor& floor = floors_[floor_index];
    const double y0 = floor.back_m - floor.inward() * back_m, y1 = y0 - floor.inward() * 0.75;
    desks_.emplace_back(Vec3(floor.left_m + left_m, std::min(y0, y1), 0.70),
                        Vec3(floor.left_m + left_m + length_m, std::max(y0, y1), 0.74));
    piece(floor_index, "desk leg", left_m + 0.05, back_m + 0.1, {0.06, 0.55, 0.70}, material);
  }

  void furnish() {
    const auto beech = model_.material("beech", {0.56, 0.42, 0.27}),
               lacquer = model_.material("white lacquer", {0.82, 0.82, 0.80}),
               red = model_.material("red cloth", {0.45, 0.04, 0.03}),
               blue = model_.material("blue paint", {0.05, 0.12, 0.42}),
               linen = model_.material("linen", {0.66, 0.62, 0.55}),
               dark = model_.material("dark wood", {0.12, 0.08, 0.05});
    piece(0, "sofa", dice_.between(0.8, 1.2), 0.1, {2.1, 0.9, 0.42}, red);
    piece(0, "sideboard", 0, 1.6, {0.45, 1.5, 0.8}, dark);
    desk(1, dice_.between(0.3, 0.6), 0, 1.6, beech);
    piece(2, "bed", dice_.between(0.9, 1.2), 0.05, {1.6, 2.05, 0.5}, linen);
    piece(2, "wardrobe", 0, 1.2, {0.6, 1.2, 2.1}, lacquer);
    piece(3, "kitchen units", 0, 0, {3.3, 0.6, 0.9}, lacquer);
    piece(4, "bath", 0.1, 0.1, {0.8, 1.7, 0.55}, lacquer);
    desk(5, dice_.between(1.0, 1.6), 0, 1.8, beech);
    piece(5, "shelf", 0, 0.8, {0.35, 1.3, 1.9}, dark);
    piece(6, "bed", dice_.between(0.8, 1.1), 0.05, {1.4, 2.05, 0.5}, blue);
    piece(7, "blue wall", 4.08, 0.02, {0.04, 3.6, kFlatHeight_m - 0.05}, blue);
    desk(7, dice_.between(0.6, 1.2), 0.6, 1.7, dark);
  }

  Emitter lamp(const Eigen::Vector2d& at_m) {
    return {make_isotropic(dice_.between(650, 1150)),
            {Mat3::Identity(), {at_m.x(), at_m.y(), kFlatHeight_m - dice_.between(0.15, 0.30)}}};
  }

  void measure() {
    const auto free = [&](const Vec3& p) { return !model_.occupied(p, 0.02) && model_.open_above(p, 1.0); };
    const auto free_floor = [&](const Vec3& p) { return free(p + Vec3(0, 0, 0.03)); };
    const auto anywhere = [](const Vec3&) { return true; };
    const auto area = [&](int count, double x0, double x1, double y0, double y1, double z_m, const auto& fits) {
      spread_receivers(room_, count, {x0, y0, z_m}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}, Vec3::UnitZ(), dice_, fits);
    };
    for (const Floor& f : floors_) {
      const double x0 = f.left_m + 0.1, x1 = f.right_m - 0.1;
      const double y0 = std::min(f.front_m, f.back_m) + 0.1, y1 = std::max(f.front_m, f.back_m) - 0.1;
      area(18, x0, x1, y0, y1, 0.75, free);
      area(12, x0, x1, y0, y1, kOffSurface_m, free_floor);
    }
    for (const auto& [low, high] : desks_)
      area(8, low.x() + 0.05, high.x() - 0.05, low.y() + 0.05, high.y() - 0.05, high.z() + kOffSurface_m, anywhere);
    area(18, 0.1, kFlatLength_m - 0.1, kHallLow_m + 0.1, kHallHigh_m - 0.1, 0.75, free);
    area(18, 0.1, kFlatLength_m - 0.1, kHallLow_m + 0.1, kHallHigh_m - 0.1, kOffSurface_m, free_floor);
  }

  RoomDice dice_;
  SolidModel model_;
  LitRoom room_{"flat", {}, {}, {}};
  std::vector<Floor> floors_;
  std::vector<std::pair<Vec3, Vec3>> desks_;
  SolidModel::MaterialIndex white_ = 0, door_ = 0;
};

}  // namespace

LitRoom make_eight_room_flat(std::uint64_t seed) { return Flat(seed).build(); }

}  // namespace luxrig
