#pragma once
/// camera: takes a picture with one of a rig's cameras, and checks whether its pictures measure light.

#include <filesystem>
#include <optional>
#include <string>

#include "drivers/camera/camera_source.h"

namespace luxrig {

struct CameraArguments {
  std::filesystem::path rig;
  std::string camera;                           ///< its name; empty = the only one with a source
  std::optional<std::filesystem::path> output;  ///< shot: the picture; check: the measured response
  std::optional<double> shortest_ms, longest_ms;
  int steps = 9, frames = 5;
  bool json = false;
  bool levels = false;  ///< check: by known dimmer levels of the rig, instead of by exposures
  bool sim = false;     ///< the same with a simulated rig and its camera
  std::uint64_t sim_seed = 1;
  std::string fixture;                         ///< the fixture that lights the scene; empty = the only one
  int port = 9620;                             ///< of the daemon that drives the rig
  std::optional<std::filesystem::path> token;  ///< of a daemon of another user
};

/// requires `camera` to be a camera of the rig, and `source` unless arguments.sim.
int run_camera_levels(const CameraArguments& arguments, const Rig& rig, std::size_t camera, CameraSource* source);

}  // namespace luxrig
