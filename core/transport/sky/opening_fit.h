#pragma once
/// Internal to finding openings: fits rectangles to glimpses of the sky.

#include "core/transport/sky/sky_openings.h"

namespace luxrig {

/// A ray from a surface that reaches the sky.
struct SkyGlimpse {
  Vec3 from_world_m, normal_world, direction_world;
};

/// Rim of an opening, found by probing around one glimpse.
struct OpeningRim {
  struct Stop {
    Vec3 position_world_m, normal_world;
  };
  std::size_t glimpse = 0;
  std::vector<Vec3> free_world;  ///< directions that just reach the sky
  std::vector<Stop> stops;       ///< obstacles just outside them
};

struct FoundOpenings {
  std::vector<SkyOpening> openings;
  double missed_share = 1;  ///< approximate share of the glimpses
};
/// Rectangles, by falling number of glimpses explained, until few glimpses remain that pass through none.
[[nodiscard]] FoundOpenings fit_openings(const std::vector<SkyGlimpse>& glimpses, const std::vector<OpeningRim>& rims);

}  // namespace luxrig
