#pragma once
/// Rooms from files made by others.

#include "tools/bench/placement_cases/placement_case.h"

namespace luxrig {

/// apartment.glb: furnished, open at the top. Uniform floor.
[[nodiscard]] Result<PlacementCase> real_apartment_case(const std::string& name, std::uint64_t seed,
                                                        const PlacementCaseOptions& options);

/// office-scan.obj: a headset's scan, one closed shell. Uniform on everything that faces up below 1.1 m: floor and
/// desks.
[[nodiscard]] Result<PlacementCase> real_office_case(const std::string& name, std::uint64_t seed,
                                                     const PlacementCaseOptions& options);

}  // namespace luxrig
