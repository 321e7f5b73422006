#include "tools/bench/placement_cases/placement_case.h"

#include <fmt/format.h>

#include "tools/bench/placement_cases/goals.h"
#include "tools/bench/placement_cases/scanned_rooms.h"
#include "tools/bench/rooms/lit_room.h"
#include "tools/bench/rooms/surface_spread.h"

namespace luxrig {
namespace {

constexpr double kFloor_lux = 300;
constexpr double kCloisterFloor_lux = 100, kCloisterStatue_lux = 300;
constexpr double kMuseumFloor_lux = 200, kMuseumPedestal_lux = 400, kMuseumNear_m = 0.3, kUpperStorey_m = 4.8;
constexpr double kStudioFloor_lux[2] = {60, 150}, kStudioFurniture_lux[2] = {120, 300};

using CaseOptions = PlacementCaseOptions;

/// `count` receivers on the floor of a room, on the named objects, below a height.
void put_on_floor(LitRoom& room, const std::vector<std::string>& objects, double below_m, std::size_t count,
                  std::uint64_t seed) {
  SurfacePart floor;
  floor.objects = objects;
  floor.box_world_m = room.interior_m;
  floor.box_world_m.min().z() -= 0.1;
  floor.box_world_m.max().z() = below_m;
  floor.headroom_m = 1;
  const RayScene rays(room.scene);
  room.receivers =
      SurfaceSpread(room.scene, rays, room.emitters.front().world_from_lamp.translation_m).over(floor, count, seed);
}

LitRoom flat_with_floor(std::uint64_t seed) {
  LitRoom room = make_eight_room_flat(seed);
  put_on_floor(room, {"flat"}, 0.1, 350, seed);
  return room;
}

LitRoom court_with_floors(std::uint64_t seed) {
  LitRoom room = make_colonnades(seed);
  put_on_floor(room, {"court floor", "gallery floor"}, room.interior_m.max().z(), 450, seed);
  return room;
}

Result<PlacementCase> uniform_floor(const std::string& name, LitRoom room, std::size_t lights, double error) {
  PlacementCase one = case_of_room(name, std::move(room));
  ask_uniform(one, kFloor_lux);
  one.thesis_lights = lights, one.thesis_error = error;
  return one;
}

Result<PlacementCase> coloured_floor(const std::string& name, LitRoom room, std::size_t lights, double error) {
  const auto regions_m = room.regions_m;
  PlacementCase one = case_of_room(name, std::move(room));
  ask_colours(one, regions_m, kFloor_lux);
  one.thesis_lights = lights, one.thesis_error = error;
  return one;
}

Result<PlacementCase> known(const std::string& name, LitRoom room, bool global, const CaseOptions& options,
                            std::size_t lights, double error) {
  auto one = known_lights_case(name, std::move(room), global, options);
  if (one) one->thesis_lights = lights, one->thesis_error = error;
  return one;
}

Result<PlacementCase> apartment_known(const std::string& name, std::uint64_t seed, const CaseOptions& options) {
  return known(name, make_eight_room_flat(seed), false, options, 10, 0.009);
}

Result<PlacementCase> office_known(const std::string& name, std::uint64_t seed, const CaseOptions& options) {
  return known(name, make_open_plan_office(seed), false, options, 9, 0.014);
}

Result<PlacementCase> office_known_global(const std::string& name, std::uint64_t seed, const CaseOptions& options) {
  return known(name, make_open_plan_office(seed), true, options, 10, 0.072);
}

template <LitRoom (*make_room)(std::uint64_t)>
Result<PlacementCase> room_known(const std::string& name, std::uint64_t seed, const CaseOptions& options) {
  return known_lights_case(name, make_room(seed), false, options);
}

Result<PlacementCase> sewers_uniform(const std::string& name, std::uint64_t seed, const CaseOptions&) {
  return uniform_floor(name, make_sewers(seed), 11, 0.073);
}

Result<PlacementCase> sewers_uniform_global(const std::string& name, std::uint64_t seed, const CaseOptions&) {
  auto one = uniform_floor(name, make_sewers(seed), 10, 0.153);
  one->global = true;
  return one;
}

Result<PlacementCase> apartment_uniform(const std::string& name, std::uint64_t seed, const CaseOptions&) {
  return uniform_floor(name, flat_with_floor(seed), 15, 0.195);
}

Result<PlacementCase> apartment_colour(const std::string& name, std::uint64_t seed, const CaseOptions&) {
  return coloured_floor(name, flat_with_floor(seed), 18, 0.173);
}

Result<PlacementCase> atrium_uniform(const std::string& name, std::uint64_t seed, const CaseOptions&) {
  return uniform_floor(name, court_with_floors(seed), 22, 0.211);
}

Result<PlacementCase> atrium_colour(const std::string& name, std::uint64_t seed, const CaseOptions&) {
  return coloured_floor(name, court_with_floors(seed), 50, 0.232);
}

/// Dim walks around a bright statue.
Result<PlacementCase> cloister_statue(const std::string& name, std::uint64_t seed, const CaseOptions&) {
  PlacementCase one = case_of_room(name, make_cloister(seed));
  ask_uniform(one, kCloisterFloor_lux);
  for (std::size_t r = 0; r < one.receivers.size(); ++r)
    if (one.receivers[r].position_world_m.z() > 1) one.goal_lux(static_cast<Eigen::Index>(r), 0) = kCloisterStatue_lux;
  one.thesis_lights = 10, one.thesis_error = 0.13;
  return one;
}

/// The upper floor, with brighter exhibits in the middle hall; no goal on the lower floor.
Result<PlacementCase> museum_near_surfaces(const std::string& name, std::uint64_t seed, const CaseOptions&) {
  LitRoom room = make_museum(seed);
  std::erase_if(room.receivers, [](const Receiver& r) { return r.position_world_m.z() < 0.1; });
  PlacementCase one = case_of_room(name, std::move(room));
  ask_uniform(one, kMuseumFloor_lux);
  for (std::size_t r = 0; r < one.receivers.size(); ++r)
    if (one.receivers[r].position_world_m.z() < kUpperStorey_m)
      one.goal_lux(static_cast<Eigen::Index>(r), 0) = kMuseumPedestal_lux;
  one.near_surfaces_m = kMuseumNear_m;
  one.thesis_lights = 43, one.thesis_error = 0.061;
  return one;
}

/// The living room brighter than the bedroom, furniture brighter than floor.
Result<PlacementCase> studio_two_lights(const std::string& name, std::uint64_t seed, const CaseOptions&) {
  LitRoom room = make_studio(seed);
  const auto living_m = room.regions_m.back();
  PlacementCase one = case_of_room(name, std::move(room));
  ask_uniform(one, 0);
  for (std::size_t r = 0; r < one.receivers.size(); ++r) {
    const Vec3& at_m = one.receivers[r].position_world_m;
    const int part = at_m.x() > living_m.min().x() ? 1 : 0;
    one.goal_lux(static_cast<Eigen::Index>(r), 0) =
        at_m.z() > 0.1 ? kStudioFurniture_lux[part] : kStudioFloor_lux[part];
  }
  one.thesis_lights = 2, one.thesis_error = 0.248;
  return one;
}

struct NamedCase {
  const char* name;
  Result<PlacementCase> (*make)(const std::string&, std::uint64_t, const CaseOptions&);
};
constexpr NamedCase kPlacementCases[] = {
    {"apartment-known", apartment_known},
    {"office-known", office_known},
    {"office-known-global", office_known_global},
    {"sewers-known", room_known<make_sewers>},
    {"cloister-known", room_known<make_cloister>},
    {"museum-known", room_known<make_museum>},
    {"studio-known", room_known<make_studio>},
    {"atrium-known", room_known<make_colonnades>},
    {"sewers-uniform", sewers_uniform},
    {"sewers-uniform-global", sewers_uniform_global},
    {"apartment-uniform", apartment_uniform},
    {"apartment-colour", apartment_colour},
    {"atrium-uniform", atrium_uniform},
    {"atrium-colour", atrium_colour},
    {"cloister-statue", cloister_statue},
    {"museum-near-surfaces", museum_near_surfaces},
    {"studio-two-lights", studio_two_lights},
    {"real-apartment", real_apartment_case},
    {"real-office", real_office_case},
};

}  // namespace

std::vector<std::string> placement_case_names() {
  std::vector<std::string> names;
  for (const NamedCase& one : kPlacementCases) names.emplace_back(one.name);
  return names;
}

Result<PlacementCase> make_placement_case(const std::string& name, std::uint64_t seed,
                                          const PlacementCaseOptions& options) {
  for (const NamedCase& one : kPlacementCases)
    if (name == one.name) return one.make(name, seed, options);
  return refusal(fmt::format("no placement case is called {}", name));
}

}  // namespace luxrig
