#pragma once
/// A picture as the camera gives it: samples, not yet light.

#include <vector>

#include "core/output/devices.h"
#include "core/radiometry/sample_curve.h"
#include "core/rig/equipment.h"

namespace luxrig {

struct RawPicture {
  int width_px = 0, height_px = 0;
  int channels = 1;             ///< 1: grey; 3: red, green, blue
  int full_scale_counts = 255;  ///< steps from black to full scale
  bool is_light = false;        ///< samples are cd/m² already (a floating-point file)
  std::vector<float> samples;   ///< shares of full scale, encoded; row by row from the top, channel by channel
  double exposure_s = 0;        ///< 0 = unknown
};

/// Larger pictures are refused from any source.
inline constexpr int kMaxPictureSide_px = 16384;
inline constexpr long long kMaxPicturePixels = 100'000'000;

/// A rig's response curve; Cause::invalid if its file cannot be used.
[[nodiscard]] Result<SampleCurve> curve_of(const PictureTaking& taking);

[[nodiscard]] TakenPicture light_of(const RawPicture& raw, const SampleCurve& curve, const PictureTaking& taking,
                                    Time taken);

}  // namespace luxrig
