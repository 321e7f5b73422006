#pragma once
/// A placement task in a scene: candidates where lights may hang, their transport, the search, and the number of lights
/// worth hanging.

#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/result.h"
#include "core/run.h"
#include "core/solve/placement/placed_lights.h"
#include "core/solve/placement/scene/mounting.h"
#include "core/solve/placement/search/correct_lights.h"
#include "core/transport/evaluator.h"

namespace luxrig {

struct LightInScene {
  Vec3 position_world_m = Vec3::Zero();
  std::optional<Vec3> aim_world_m;  ///< a point it looks at; empty = straight down
  double level = 0;                 ///< emittance factor of its brightest emitter, 0…max_level
  std::vector<double> levels{};     ///< of each emitter of the goal
};

/// A stop ends the search with the best so far.
struct PlaceInSceneOptions : Run {
  std::optional<std::size_t> lights;  ///< empty = as few as will do
  std::size_t max_lights = 20;        ///< without `lights`
  double error_wanted = 0.001;        ///< normalised, weighted (PlacedLights::error()); ends the search
  double improvement = 0.05;          ///< without `lights`: least share of the error that one more light must take away
  double max_level = 1;               ///< of each light
  const char* method = "luxrig";      ///< a name in placement_methods.h
  bool aimed = false;                 ///< also search what the lights look at
  bool indirect = true;
  /// Corrects the found lights (correct_lights.h) if there is reflected light or a luminaire with size. Empty = the
  /// search's own model, which is accurate to a few per cent.
  LuxOfLights lux_of;
  /// Also search with this many power limits, evenly spaced below the power of the found lights (energy_front.h). Needs
  /// the goal's watts.
  std::size_t front_limits = 0;
  bool bound_of_number = false;  ///< also prove PlacedInScene::lower_bound_of_number
  /// Called from the calling thread when there is a better result with this number of lights.
  std::function<void(std::size_t lights, double error)> better;
};

/// The best result with this number of lights.
struct LightsAndError {
  std::size_t lights = 0;
  double error = 0;
};

/// The best result within a power limit.
struct PowerAndError {
  double max_watts = 0, watts = 0;
  double error = 0;
};

struct PlacedInScene {
  std::vector<LightInScene> lights;
  double error = 0;                     ///< of these lights, at these levels
  std::vector<LightsAndError> numbers;  ///< the numbers tried, rising; one if the number was given
  /// Proven with the search's own light: no lights at its candidates have a smaller error, with any number and with at
  /// most the number of these lights. Set only if these lights missed the wanted error.
  std::optional<double> lower_bound, lower_bound_of_number;
  /// With front_limits: the power of the found lights, then each limit. Errors never fall along it.
  std::vector<PowerAndError> front{};
  std::size_t candidates = 0, columns = 0;
  bool stopped = false;  ///< before the search ended
};

/// luminaire   at rated flux, hung with its own rotation unless aimed; one with size is searched as its centre point
/// receivers   one per point of the goal
/// returns     Cause::cancelled when stopped before any light was placed; Cause::invalid as Mounting::candidates and
///             candidate_transport, for an unknown method, and when no candidate lights any receiver
[[nodiscard]] Result<PlacedInScene> place_in_scene(const Scene& scene, const RayScene& rays, const Mounting& mounting,
                                                   const Emitter& luminaire, std::span<const Receiver> receivers,
                                                   const LightingGoal& goal, const PlaceInSceneOptions& options);

}  // namespace luxrig
