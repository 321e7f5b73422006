#pragma once
/// Internal to finding openings: from glimpses of the sky to rectangles that explain them.

#include "core/transport/sky/sky_openings.h"

namespace luxrig {

/// A ray from a surface that reaches the sky.
struct SkyGlimpse {
  Vec3 from_world_m, normal_world, direction_world;
};

/// What was felt of an opening's rim from where one glimpse started.
struct OpeningRim {
  struct Stop {
    Vec3 position_world_m, normal_world;
  };
  std::size_t glimpse = 0;
  std::vector<Vec3> free_world;  ///< directions that just reach the sky
  std::vector<Stop> stops;       ///< what just stops those beyond them
};

struct FoundOpenings {
  std::vector<SkyOpening> openings;
  double missed_share = 1;  ///< of the glimpses, about
};
/// Rectangles, most explaining first, until few glimpses are left that pass through none.
[[nodiscard]] FoundOpenings fit_openings(const std::vector<SkyGlimpse>& glimpses, const std::vector<OpeningRim>& rims);

}  // namespace luxrig
