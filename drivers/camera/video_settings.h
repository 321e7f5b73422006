#pragma once
/// Makes a camera expose exactly as asked, with nothing automatic, and verifies that it does.

#include <utility>
#include <vector>

#include "drivers/camera/video_channel.h"

namespace luxrig {

struct VideoSettings {
  double exposure_s = 0;  ///< as the device reports it; 0 = it has no exposure control
  bool changed = false;   ///< pending frames may have been exposed with the old settings
};

/// Turns off everything automatic, sets tone to its default, then exposure and gain, and reads all back.
/// Cause::refused: the device does not keep a value, cannot expose as wanted, or needs a value that the rig does not
/// give.
[[nodiscard]] Result<VideoSettings> fix_settings(VideoChannel& channel, const PictureTaking& wanted);

/// Earlier values of the controls that fix_settings() sets, in an order in which they can be set back. Only controls
/// that the device has and can report.
using FoundSettings = std::vector<std::pair<VideoControl, std::int64_t>>;
[[nodiscard]] FoundSettings settings_found(VideoChannel& channel);

/// Restores them. Automatic modes come last, as devices refuse an exposure or gain that they choose themselves. Tries
/// all; returns the first failure.
[[nodiscard]] Result<void> give_back(VideoChannel& channel, const FoundSettings& found);

/// Shortest and longest exposure of the device; empty if it has no exposure control.
[[nodiscard]] std::optional<std::pair<double, double>> exposure_range_s(VideoChannel& channel);

}  // namespace luxrig
