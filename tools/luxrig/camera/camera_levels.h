#pragma once
/// A series of dimmer levels to judge a camera by: one fixture of the rig goes through them, all others are dark.

#include <filesystem>
#include <memory>
#include <optional>

#include "core/radiometry/level_check.h"
#include "core/run.h"
#include "drivers/camera/camera_source.h"

namespace luxrig {

struct LevelsWanted {
  std::size_t fixture = 0;  ///< of the rig
  int steps = 9, frames = 5;
};

/// What lights the scene: the rig by its daemon, or the simulated rig.
class LevelLight {
 public:
  virtual ~LevelLight() = default;
  /// Waits until the light is there. The level that the fixture has: limits may have lowered it.
  virtual Result<double> set(double level) = 0;
  /// Whether it has stood still since. A fault says what moved it.
  virtual Result<void> still() = 0;
  /// The light as it was before.
  virtual void give_back() = 0;
};
/// Over the API of the daemon on this port.
[[nodiscard]] std::unique_ptr<LevelLight> make_daemon_light(const Rig& rig, std::size_t fixture, int port,
                                                            const std::optional<std::filesystem::path>& token);

/// Takes a picture: the camera's own, or that of a simulated one.
using TakeRaw = std::function<Result<RawPicture>()>;

/// Level 0, then rising ones. Gives the light back, whatever happens.
[[nodiscard]] Result<LevelSeries> take_level_series(LevelLight& light, const TakeRaw& take, const SampleCurve& curve,
                                                    const LevelsWanted& wanted, const Progress& progress);

/// Of files whose names state levels in percent ("wall_40pct_3.png"); 0pct is needed.
[[nodiscard]] Result<LevelSeries> level_series_of_files(const PictureCamera& camera, const SampleCurve& curve);

/// The same over a simulated rig that is started for it and ended; its fixtures and its camera are truly what `seed`
/// makes of the rig file. Pictures are light: the simulated camera is linear.
[[nodiscard]] Result<LevelSeries> simulated_level_series(const Rig& rig, const std::filesystem::path& rig_path,
                                                         std::size_t camera, std::uint64_t seed,
                                                         const LevelsWanted& wanted, const Progress& progress);

}  // namespace luxrig
