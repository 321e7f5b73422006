#pragma once
/// A series of dimmer levels to judge a camera by. One fixture of the rig goes through them; all others are dark.

#include <filesystem>
#include <memory>
#include <optional>

#include "core/radiometry/level_check.h"
#include "core/run.h"
#include "drivers/camera/camera_source.h"

namespace luxrig {

struct LevelsWanted {
  std::size_t fixture = 0;  ///< index in the rig
  int steps = 9, frames = 5;
};

/// The light of the scene: from the rig through its daemon, or from the simulated rig.
class LevelLight {
 public:
  virtual ~LevelLight() = default;
  /// Waits until the light is there. Returns the level that the fixture has, which limits may have lowered.
  virtual Result<double> set(double level) = 0;
  /// Whether the light has stood still since. A fault says what changed it.
  virtual Result<void> still() = 0;
  /// Restores the light from before.
  virtual void give_back() = 0;
};
/// Through the API of the daemon on this port.
[[nodiscard]] std::unique_ptr<LevelLight> make_daemon_light(const Rig& rig, std::size_t fixture, int port,
                                                            const std::optional<std::filesystem::path>& token);

/// Takes a picture with the camera, or with a simulated one.
using TakeRaw = std::function<Result<RawPicture>()>;

/// Level 0, then rising levels. Gives the light back in every case.
[[nodiscard]] Result<LevelSeries> take_level_series(LevelLight& light, const TakeRaw& take, const SampleCurve& curve,
                                                    const LevelsWanted& wanted, const Progress& progress);

/// From files whose names state levels in percent ("wall_40pct_3.png"). A file with 0pct is required.
[[nodiscard]] Result<LevelSeries> level_series_of_files(const PictureCamera& camera, const SampleCurve& curve);

/// The same with a simulated rig that is started for it and then ended. `seed` sets the deviations of its fixtures and
/// its camera from the rig file. Pictures are light: the simulated camera is linear.
[[nodiscard]] Result<LevelSeries> simulated_level_series(const Rig& rig, const std::filesystem::path& rig_path,
                                                         std::size_t camera, std::uint64_t seed,
                                                         const LevelsWanted& wanted, const Progress& progress);

}  // namespace luxrig
