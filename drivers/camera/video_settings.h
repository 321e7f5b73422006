#pragma once
/// Has a camera expose as it is told, and nothing by itself; and sees that it does.

#include "drivers/camera/video_channel.h"

namespace luxrig {

struct VideoSettings {
  double exposure_s = 0;  ///< as the device has it; 0: it has no control of it
  bool changed = false;   ///< frames under way may have been exposed before
};

/// Everything automatic off, tone at its default, then exposure and gain; all is read back. Cause::refused: the device
/// does not keep what it was told, cannot expose so, or wants to be told and was not.
[[nodiscard]] Result<VideoSettings> fix_settings(VideoChannel& channel, const PictureTaking& wanted);

/// Least and most exposure the device has; nothing when it has no control of it.
[[nodiscard]] std::optional<std::pair<double, double>> exposure_range_s(VideoChannel& channel);

}  // namespace luxrig
