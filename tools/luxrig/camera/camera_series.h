#pragma once
/// A series of exposures to judge a camera by: taken now, or read from files.

#include <optional>

#include "core/radiometry/camera_check.h"
#include "core/run.h"
#include "drivers/camera/camera_source.h"

namespace luxrig {

struct SeriesWanted {
  /// Default: a sixteenth of the camera's exposure in the rig file, and sixteen times it.
  std::optional<double> shortest_s, longest_s;
  int steps = 9, frames = 5;
};

/// Activates the camera, takes the pictures, and deactivates it. A colour camera is judged by its green samples.
[[nodiscard]] Result<ExposureSeries> take_series(CameraSource& source, const PictureCamera& camera,
                                                 const SeriesWanted& wanted, const Progress& progress);

/// The samples to judge by: green or grey. If there are many pixels, evenly chosen ones.
[[nodiscard]] std::vector<float> judged_samples(const RawPicture& picture);

/// From files whose names state exposures ("wall_12.5ms_3.png").
[[nodiscard]] Result<ExposureSeries> series_of_files(const PictureCamera& camera);

}  // namespace luxrig
