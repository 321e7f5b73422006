#pragma once
/// A placement task done in a scene: candidates where lights may hang, their transport, the search, and how many lights
/// are worth hanging.

#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/result.h"
#include "core/run.h"
#include "core/solve/placement/correct_lights.h"
#include "core/solve/placement/mounting.h"
#include "core/solve/placement/placed_lights.h"
#include "core/transport/evaluator.h"

namespace luxrig {

struct LightInScene {
  Vec3 position_world_m = Vec3::Zero();
  std::optional<Vec3> aim_world_m;  ///< a place it looks at; none: straight down
  double level = 0;                 ///< emittance factor, 0…max_level; of its brightest emitter
  std::vector<double> levels{};     ///< of each emitter of the goal
};

/// A stop ends the search with the best so far.
struct PlaceInSceneOptions : Run {
  std::optional<std::size_t> lights;  ///< else as few as will do
  std::size_t max_lights = 20;        ///< without `lights`
  double error_wanted = 0.001;        ///< normalised, weighted (PlacedLights::error()), at which the search ends
  double improvement = 0.05;          ///< without `lights`: share of the error that one more light must take away
  double max_level = 1;               ///< of each light
  const char* method = "luxrig";      ///< a name in placement_methods.h
  bool aimed = false;                 ///< what lights look at is searched, too
  bool indirect = true;
  /// With reflected light or a luminaire with size: what the lights found are corrected by (correct_lights.h); none:
  /// the search's own model, which is good to a few per cent.
  LuxOfLights lux_of;
  /// So many power limits below what the lights found take, falling evenly, are searched with, too (energy_front.h).
  /// Needs the goal's watts.
  std::size_t front_limits = 0;
  bool bound_of_number = false;  ///< prove PlacedInScene::lower_bound_of_number, too
  /// Called from the calling thread when there is something better of so many lights.
  std::function<void(std::size_t lights, double error)> better;
};

/// The best that was found with so many lights.
struct LightsAndError {
  std::size_t lights = 0;
  double error = 0;
};

/// The best that was found within a limit of power.
struct PowerAndError {
  double max_watts = 0, watts = 0;
  double error = 0;
};

struct PlacedInScene {
  std::vector<LightInScene> lights;
  double error = 0;                     ///< of these lights, at these levels
  std::vector<LightsAndError> numbers;  ///< that were tried, rising; one when the number was given
  /// Proven by the search's own light: no number of lights at its candidates comes closer, and none up to the number
  /// of these lights. Only where these did not reach the wanted error.
  std::optional<double> lower_bound, lower_bound_of_number;
  /// With front_limits: what the lights found take, then each limit. Errors never fall along it.
  std::vector<PowerAndError> front{};
  std::size_t candidates = 0, columns = 0;
  bool stopped = false;  ///< before the search was at its end
};

/// luminaire   at rated flux, hung with its own rotation unless aimed; one with size is searched as a point in its middle
/// receivers   one per point of the goal
/// returns     Cause::cancelled when stopped before any light was placed; Cause::invalid as Mounting::candidates and
///             candidate_transport, for an unknown method, and when no candidate lights any receiver
[[nodiscard]] Result<PlacedInScene> place_in_scene(const Scene& scene, const RayScene& rays, const Mounting& mounting,
                                                   const Emitter& luminaire, std::span<const Receiver> receivers,
                                                   const LightingGoal& goal, const PlaceInSceneOptions& options);

}  // namespace luxrig
