#pragma once
/// What light is asked for.

#include "tools/bench/placement_cases/placement_case.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {

/// Scene and lamp box of a room with its receivers, and no goal yet.
[[nodiscard]] PlacementCase case_of_room(const std::string& name, LitRoom room);

/// The goal is what the room's lamps give, each taken as isotropic: direct light exactly, or with reflected light by
/// path tracing. Receivers that none of them lights directly are left out.
[[nodiscard]] Result<PlacementCase> known_lights_case(const std::string& name, LitRoom room, bool global,
                                                      const PlacementCaseOptions& options);

/// The same lux everywhere, one channel.
void ask_uniform(PlacementCase& one, double lux);

/// A colour in each region, abruptly; white outside of all. Colours have 1 as their largest primary, as painted.
void ask_colours(PlacementCase& one, const std::vector<Eigen::AlignedBox3d>& regions_world_m, double lux);

}  // namespace luxrig
