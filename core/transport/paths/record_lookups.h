#pragma once
/// Stored ends of paths in irradiance records, to be looked up again when there are more records.
///
/// The first records are few and far apart. A path that took its light from one of them for good would keep that
/// record's noise and distance. With stored ends, all paths get the light of the final records.

#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

struct RecordLookup {
  Vec3 position_world_m;
  Vec3f normal_world;
  Vec3f per_lux_rgb;        ///< weight of the reflected lux there at the path's start
  std::uint32_t record;     ///< that represents it so far
  std::uint32_t looked_at;  ///< number of records at the last look-up
};

/// The ends of one receiver's paths in one replicate.
struct RecordLookups {
  /// A path that continued beside its record, to measure the record's bias.
  struct Check {
    std::uint32_t end;
    float by_path_lx;  ///< luminous, at the levels
  };
  std::vector<RecordLookup> ends;
  std::vector<Check> checks;  ///< by `end`
};

}  // namespace luxrig
