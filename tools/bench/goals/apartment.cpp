// The flat that the thesis paints in its figures has the same name; this one is by another hand. It is open at the top,
// and its doors stand open.
#include <fmt/format.h>

#include "core/scene/mesh/mesh_file.h"
#include "tools/bench/goals/canvas.h"

namespace luxrig {
namespace {

constexpr double kEye_m = 1.9;  // below the lintels
constexpr int kProbes = 40;     // along each side of a room

/// Inner part of a room, as measured in the file, and the place of a click in it.
struct Room {
  Eigen::AlignedBox2d box_m;
  Eigen::Vector2d click_m;
  double lux;
};

std::optional<SurfacePlace> seen(const RayScene& rays, const Vec3& from_m, const Vec3& direction) {
  const auto hit = rays.nearest(from_m, direction, Vec3::Zero());
  if (!hit) return std::nullopt;
  return SurfacePlace{hit->position_world_m, hit->normal_world};
}

std::optional<SurfacePlace> floor_at(const RayScene& rays, const Eigen::Vector2d& at_m) {
  const auto place = seen(rays, {at_m.x(), at_m.y(), kEye_m}, -Vec3::UnitZ());
  return place && place->position_world_m.z() < 0.01 ? place : std::nullopt;
}

/// Share of places on the floors that have another lux than that of their room.
double wrong_floor(const Canvas& canvas, std::span<const Room> rooms) {
  Painting painting(canvas.surface, canvas.rays);
  for (const Room& room : rooms)
    if (const auto place = floor_at(canvas.rays, room.click_m))
      painting.add({StrokeKind::selective, {*place}, room.lux, 0, 0});
  int probes = 0, wrong = 0;
  for (const Room& room : rooms)
    for (int i = 0; i < kProbes * kProbes; ++i) {
      const Eigen::Array2d share((i % kProbes + 0.5) / kProbes, (i / kProbes + 0.5) / kProbes);
      const auto place = floor_at(canvas.rays, room.box_m.min() + (share * room.box_m.sizes().array()).matrix());
      if (!place) continue;  // furniture
      ++probes;
      wrong += painting.lux_at(*place) != room.lux;
    }
  return probes > 0 ? static_cast<double>(wrong) / probes : 1;
}

/// The same for a wall 0.1 m thick between kitchen and bathroom of which only the kitchen's side is painted.
double wrong_wall(const Canvas& canvas) {
  Painting painting(canvas.surface, canvas.rays);
  const Vec3 kitchen_m(7.0, 5.5, 1.2), bathroom_m(6.3, 5.5, 1.2);
  if (const auto place = seen(canvas.rays, kitchen_m, -Vec3::UnitX()))
    painting.add({StrokeKind::bucket, {*place}, 150, 0, 0});
  int wrong = 0;
  for (int i = 0; i < kProbes; ++i) {
    const Vec3 beside_m(0, 0.6 * i / kProbes, 0);
    const auto painted = seen(canvas.rays, kitchen_m + beside_m, -Vec3::UnitX()),
               bare = seen(canvas.rays, bathroom_m + beside_m, Vec3::UnitX());
    wrong += !painted || painting.lux_at(*painted) != 150;
    wrong += !bare || painting.lux_at(*bare);
  }
  return wrong / (2.0 * kProbes);
}

}  // namespace

void add_apartment(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::string name = "apartment";
  if (!wanted_goal_case(options, name) || options.data_folder.empty()) return;
  auto scene = load_mesh({options.data_folder / "apartment.glb", 1.0, UpAxis::y});
  if (!scene) {
    fmt::print(stderr, "{}\n", scene.error().front().text());
    return;
  }
  const auto canvas = make_canvas(std::move(*scene), kGoalCell_m, options);
  if (!canvas) return;
  rows.push_back(patches_row(name, *canvas, kGoalCell_m, {}));
  using Corner = Eigen::Vector2d;
  const Room rooms[] = {{{Corner(4.75, 9.05), Corner(6.4, 10.85)}, {5.8, 9.6}, 100},
                        {{Corner(6.95, 7.9), Corner(10.6, 10.85)}, {7.0, 9.0}, 200},
                        {{Corner(8.4, 3.5), Corner(12.3, 7.3)}, {8.8, 5.6}, 300}};
  for (const auto& [method, error] :
       {std::pair{"three selective fills", wrong_floor(*canvas, rooms)}, {"sides of a wall", wrong_wall(*canvas)}}) {
    BenchRow row = goal_row(name, method, 0, {}, columns_of(*canvas));
    row.error = error;
    row.target_error = 0.01;
    rows.push_back(row);
  }
}

}  // namespace luxrig
