#pragma once
/// GET /api/surface-patches/{name}: the patches of a goal's surfaces and their lux, in few bytes. Little-endian:
///
///   0   4 bytes "LXP1"
///   4   uint32 patches n
///   8   float64 edge of a cell [m]
///   16  float64 × 3 origin [m], world
///   40  16 letters: the version of the strokes (ETag of /api/surface-goals/{name})
///   56  8 bytes, 0
///   64  n × { float32 × 3 place relative to the origin [m], world axes; int8 × 3 normal × 127; uint8 edge of a square
///       of its area, in 1/128 of a cell's edge, at most 255 }
///   64 + 16 n   n × float32 lux; NaN = not painted

#include <span>
#include <string>

#include "core/goals/surface_patches.h"

namespace luxrig {

/// version: of 16 letters. lux: of each patch.
[[nodiscard]] std::string patch_file(const SurfacePatches& surface, std::span<const float> lux,
                                     const std::string& version);

}  // namespace luxrig
