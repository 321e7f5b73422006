#include "core/calibration/exposures.h"

#include <algorithm>

#include "core/check.h"

namespace luxrig {

namespace {
/// Of an exposure's brightest sample: above, samples may be full.
constexpr float kFull = 0.95f;
}  // namespace

Picture merged_exposures(std::span<const Picture> longest_first) {
  LUXRIG_CHECK(!longest_first.empty(), "no exposure");
  Picture merged = longest_first.back();
  for (auto exposure = longest_first.rbegin(); exposure != longest_first.rend(); ++exposure) {
    LUXRIG_CHECK(exposure->width_px == merged.width_px && exposure->height_px == merged.height_px,
                 "exposures of {} × {} and {} × {} pixels", exposure->width_px, exposure->height_px, merged.width_px,
                 merged.height_px);
    float full = 0;
    for (const Vec3f& pixel : exposure->luminance_cd_m2) full = std::max(full, pixel.maxCoeff());
    for (std::size_t i = 0; i < merged.luminance_cd_m2.size(); ++i)
      if (exposure->luminance_cd_m2[i].maxCoeff() <= kFull * full)
        merged.luminance_cd_m2[i] = exposure->luminance_cd_m2[i];
  }
  return merged;
}

}  // namespace luxrig
