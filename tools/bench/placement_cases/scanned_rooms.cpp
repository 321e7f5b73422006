#include "tools/bench/placement_cases/scanned_rooms.h"

#include <fmt/format.h>

#include "core/scene/mesh/mesh_file.h"
#include "tools/bench/placement_cases/goals.h"
#include "tools/bench/rooms/surface_spread.h"

namespace luxrig {
namespace {

constexpr double kScannedFloor_lux = 300;

struct ScannedRoom {
  const char* file;
  Eigen::AlignedBox3d interior_world_m;  ///< as measured in the file
  Vec3 air_world_m;                      ///< a place in open air
  SurfacePart lit;
  std::size_t receivers;
};

Result<PlacementCase> uniform_case(const std::string& name, const ScannedRoom& room, std::uint64_t seed,
                                   const PlacementCaseOptions& options) {
  const std::filesystem::path path = options.data_folder / room.file;
  if (options.data_folder.empty() || !std::filesystem::exists(path))
    return refusal(fmt::format("{} needs {} in the folder of data", name, room.file));
  auto scene = load_mesh({path, 1.0, UpAxis::y});
  if (!scene) return refusal(scene.error().front().text());
  PlacementCase one;
  one.name = name;
  one.scene = std::move(*scene);
  one.lights_in_world_m = room.interior_world_m;
  const RayScene rays(one.scene);
  one.receivers = SurfaceSpread(one.scene, rays, room.air_world_m).over(room.lit, room.receivers, seed);
  if (one.receivers.size() < room.receivers)
    return refusal(fmt::format("{}: only {} places for receivers in {}", name, one.receivers.size(), room.file));
  ask_uniform(one, kScannedFloor_lux);
  return one;
}

}  // namespace

Result<PlacementCase> real_apartment_case(const std::string& name, std::uint64_t seed,
                                          const PlacementCaseOptions& options) {
  // The file also holds a figure several metres away from the flat. Walls are hollow, with lids: the floor is what sees
  // the sky.
  ScannedRoom room{"apartment.glb", {}, {8, 6, 1.6}, {}, 400};
  room.interior_world_m = Eigen::AlignedBox3d(Vec3(4.56, 2.43, 0), Vec3(12.5, 10.7, 2.5));
  room.lit.box_world_m = Eigen::AlignedBox3d(Vec3(4.56, 2.43, -0.05), Vec3(12.5, 10.7, 0.12));
  room.lit.either_side = true;
  room.lit.headroom_m = 100;
  return uniform_case(name, room, seed, options);
}

Result<PlacementCase> real_office_case(const std::string& name, std::uint64_t seed,
                                       const PlacementCaseOptions& options) {
  ScannedRoom room{"office-scan.obj", {}, {0, -1, 1.4}, {}, 300};
  room.interior_world_m = Eigen::AlignedBox3d(Vec3(-1.72, -3.55, 0), Vec3(1.56, 1.95, 2.44));
  room.lit.box_world_m = room.interior_world_m;
  room.lit.box_world_m.max().z() = 1.1;
  room.lit.within_rad = rad_from_deg(30);  // flat surfaces are not quite flat in a scan
  room.lit.either_side = true;
  room.lit.headroom_m = 0.8;
  return uniform_case(name, room, seed, options);
}

}  // namespace luxrig
