#pragma once
/// Pictures by the rig's cameras, kept as files and measured: what an aim has made of an object's relief.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/highlight/picture/picture_contrast.h"
#include "core/tasks/session.h"
#include "tools/process/sim_process.h"

namespace luxrig {

struct TakenByCamera {
  std::string camera;
  std::filesystem::path file;
  std::optional<PictureContrast> contrast;  ///< none in a rig that brings out no object
};

class RigPictures {
 public:
  /// session outlives this, and changes only in where its heads look; control: of the simulator
  RigPictures(const Session& session, Redirect control, std::filesystem::path folder)
      : session_(session), control_(std::move(control)), folder_(std::move(folder)) {}

  /// One picture by each camera, as `CAMERA-LABEL.png`. Takes seconds.
  [[nodiscard]] Result<std::vector<TakenByCamera>> take(const std::string& label);

 private:
  const Session& session_;
  Redirect control_;
  std::filesystem::path folder_;
  std::vector<OrientedPoint> relief_;  ///< of the first object to be brought out; found at the first picture
  double scale_m_ = 0;
  bool studied_ = false;
};

}  // namespace luxrig
