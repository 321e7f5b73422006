#pragma once
/// Where paths ended in tail records: kept until the end, to be looked up again when there are more records.
///
/// The first records are few and far between. A path that took its light from one of them for good would keep that
/// record's noise and distance; as it is, all paths have the light of the records that there are at last.

#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

struct TailEnd {
  Vec3 position_world_m;
  Vec3f normal_world;
  Vec3f per_lux_rgb;        ///< what reflected lux there counts at the path's start
  std::uint32_t record;     ///< that speaks for it so far
  std::uint32_t looked_at;  ///< so many records there were when it was looked up last
};

/// The ends of one receiver's paths in one replicate.
struct TailEnds {
  /// A path that went on beside its record, to tell how far that is off.
  struct Check {
    std::uint32_t end;
    float by_path_lx;  ///< luminous, at the levels
  };
  std::vector<TailEnd> ends;
  std::vector<Check> checks;  ///< by `end`
};

}  // namespace luxrig
