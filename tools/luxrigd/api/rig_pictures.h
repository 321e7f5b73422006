#pragma once
/// Pictures from the rig's cameras, kept as files and measured: the effect of an aim on an object's relief.

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
  std::optional<PictureContrast> contrast;  ///< none if no task of the rig brings out an object
};

class RigPictures {
 public:
  /// session: must outlive this; only its heads' aims may change. control: the simulator's.
  RigPictures(const Session& session, Redirect control, std::filesystem::path folder)
      : session_(session), control_(std::move(control)), folder_(std::move(folder)) {}

  /// Takes one picture with each camera, as `CAMERA-LABEL.png`. Takes seconds.
  [[nodiscard]] Result<std::vector<TakenByCamera>> take(const std::string& label);

 private:
  const Session& session_;
  Redirect control_;
  std::filesystem::path folder_;
  std::vector<OrientedPoint> relief_;  ///< of the first object to bring out; found at the first picture
  double scale_m_ = 0;
  bool studied_ = false;
};

}  // namespace luxrig
