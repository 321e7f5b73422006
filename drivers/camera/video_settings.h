#pragma once
/// Has a camera expose as it is told, and nothing by itself; and sees that it does.

#include <utility>
#include <vector>

#include "drivers/camera/video_channel.h"

namespace luxrig {

struct VideoSettings {
  double exposure_s = 0;  ///< as the device has it; 0: it has no control of it
  bool changed = false;   ///< frames under way may have been exposed before
};

/// Everything automatic off, tone at its default, then exposure and gain; all is read back. Cause::refused: the device
/// does not keep what it was told, cannot expose so, or wants to be told and was not.
[[nodiscard]] Result<VideoSettings> fix_settings(VideoChannel& channel, const PictureTaking& wanted);

/// What the controls that fix_settings() sets were before, in the order in which they can be set; those that the device
/// has and tells.
using FoundSettings = std::vector<std::pair<VideoControl, std::int64_t>>;
[[nodiscard]] FoundSettings settings_found(VideoChannel& channel);

/// Sets them so again; automatic modes last, as devices refuse an exposure or a gain that they choose themselves. All
/// are tried; the first that failed is given.
[[nodiscard]] Result<void> give_back(VideoChannel& channel, const FoundSettings& found);

/// Least and most exposure the device has; nothing when it has no control of it.
[[nodiscard]] std::optional<std::pair<double, double>> exposure_range_s(VideoChannel& channel);

}  // namespace luxrig
