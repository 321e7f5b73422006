#pragma once
/// Scenes with goals to measure light placement on. Structure and numbers of lights are as in the thesis (§5.4.3,
/// §5.5.5), whose own scenes are not public.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/run.h"
#include "core/transport/evaluator.h"

namespace luxrig {

struct PlacementCase {
  std::string name;
  Scene scene;
  std::vector<Receiver> receivers;  ///< 200 … 500, none in a solid
  /// receivers × 1, or × 3 in linear Rec. 709, where white of E lux is (E, E, E).
  Eigen::MatrixXd goal_lux;
  /// Of goal_lux [lx] if it was sampled; else empty.
  Eigen::VectorXd goal_standard_error_lux;
  bool global = false;                     ///< lights are judged with their reflected light, not by direct light alone
  std::vector<Vec3> known_places_world_m;  ///< of the isotropic lights that made the goal; else empty
  std::vector<double> known_lumens;
  Eigen::AlignedBox3d lights_in_world_m;  ///< where lights may hang
  double clearance_m = 0.1;               ///< of a light from surfaces
  std::optional<double> near_surfaces_m;  ///< lights hang no farther than this from a surface
  /// The thesis's figures for its scene of this name: number of lights, and error as a fraction.
  std::optional<std::size_t> thesis_lights;
  std::optional<double> thesis_error;
};

struct PlacementCaseOptions : Run {
  /// Holds office-scan.obj and apartment.glb (data/README.md). A case with a missing file is refused.
  std::filesystem::path data_folder;
  /// Wanted standard error of the goal of a `…-known-global` case, relative as in EvaluateOptions.
  double goal_error = 0.02;
};

[[nodiscard]] std::vector<std::string> placement_case_names();

/// The same for a name and a seed. The seed furnishes the room; in rooms from files it only moves receivers.
/// Cause::invalid for an unknown name, or a file that is missing or not as expected.
[[nodiscard]] Result<PlacementCase> make_placement_case(const std::string& name, std::uint64_t seed,
                                                        const PlacementCaseOptions& options = {});

}  // namespace luxrig
