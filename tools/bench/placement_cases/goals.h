#pragma once
/// Goals of the cases.

#include "tools/bench/placement_cases/placement_case.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {

/// Scene and lamp box of a room with its receivers, without a goal.
[[nodiscard]] PlacementCase case_of_room(const std::string& name, LitRoom room);

/// The goal is the light of the room's lamps, each taken as isotropic: direct light exactly, or with reflected light by
/// path tracing. Receivers without direct light are left out.
[[nodiscard]] Result<PlacementCase> known_lights_case(const std::string& name, LitRoom room, bool global,
                                                      const PlacementCaseOptions& options);

/// The same lux everywhere, one channel.
void ask_uniform(PlacementCase& one, double lux);

/// One colour in each region, with hard edges; white outside all regions. The largest primary of a colour is 1, as
/// painted.
void ask_colours(PlacementCase& one, const std::vector<Eigen::AlignedBox3d>& regions_world_m, double lux);

}  // namespace luxrig
