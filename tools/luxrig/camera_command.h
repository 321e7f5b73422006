#pragma once
/// camera: take a picture with one of a rig's cameras, and see whether its pictures say how much light there is.

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace luxrig {

struct CameraArguments {
  std::filesystem::path rig;
  std::string camera;                           ///< its name; empty: the only one with a source
  std::optional<std::filesystem::path> output;  ///< shot: the picture; check: the measured response
  std::optional<double> shortest_ms, longest_ms;
  int steps = 9, frames = 5;
  bool json = false;
};
int run_camera_shot(const CameraArguments& arguments);
int run_camera_check(const CameraArguments& arguments);

/// The subcommands and their options; the chosen one's exit code goes to `code`.
void add_camera_command(CLI::App& command, CameraArguments& arguments, int& code);

}  // namespace luxrig
