#pragma once
/// Moves out of local optima: lights are removed and put back elsewhere, singly or in pairs.
///
/// Refinement ends in basins bounded by shadow edges. To leave one, a light is removed and put where it reduces the
/// residual most (the thesis's mutation, §5.4.2, but for every light in turn instead of a random one): at any
/// candidate, or at a new place nearby, perhaps beyond a shadow edge. Two lights that compensate each other's errors
/// hold each other in place, so they move together.

#include <cstdint>
#include <optional>
#include <random>
#include <stop_token>
#include <utility>

#include "core/run.h"
#include "core/solve/placement/search/complement_search.h"
#include "core/solve/placement/search/refine_lights.h"

namespace luxrig {

struct ExchangeOptions : Run {
  std::size_t complements = 6;   ///< candidates tried for a removed light
  std::size_t near_places = 48;  ///< places tried around it
  double apart_m = 0.5;          ///< between tried candidates
  double near_m = 0.4;           ///< standard deviation of those places along each axis
  double near_rad = 0.3;         ///< and of their aims, about each of two axes
  double longest_step_m = 0.5;   ///< of a light in one step of refinement

  /// Lengths that suit candidates at this spacing.
  [[nodiscard]] static ExchangeOptions for_spacing(double spacing_m) {
    ExchangeOptions options;
    options.apart_m = options.longest_step_m = 5.0 / 3 * spacing_m;
    options.near_m = 4.0 / 3 * spacing_m;
    return options;
  }
};

class LightExchange {
 public:
  /// Must outlive it.
  LightExchange(const ComplementSearch& candidates, const ExchangeOptions& options)
      : candidates_(candidates), options_(options) {}

  /// One round: every light is removed and put back. The best move is kept, then each other move that improves on it in
  /// turn, so that lights in separate rooms need not wait for each other. False, and nothing changed, when no move is
  /// better.
  bool singly(PlacedLights& lights, std::mt19937_64& random);
  /// The same with pairs of lights that share points.
  bool by_twos(PlacedLights& lights);
  /// Detour through more lights: `beyond` lights are added one by one, and each time the least useful light is removed
  /// while the others follow. With more lights fewer basins are dead ends.
  bool through_more(PlacedLights& lights, std::size_t beyond, std::mt19937_64& random);
  /// The best set without one of the lights, refined a little. Needs at least one light.
  [[nodiscard]] PlacedLights without_one(const PlacedLights& lights);
  /// Adds a light at the best candidate (or at a random one of the `choice` best) and refines all. False when none
  /// gains.
  bool with_one_more(PlacedLights& lights, std::size_t choice, std::mt19937_64& random);
  /// Moves all places to the bottom of their basin.
  void refine(PlacedLights& lights) { columns_ += refine_lights(lights, steps(RefineOptions{}.max_steps)); }

  /// Columns computed by all of these calls so far.
  [[nodiscard]] std::size_t columns() const { return columns_; }

 private:
  struct Trial {
    std::optional<PlacedLights> lights;
    std::size_t columns = 0;
  };
  [[nodiscard]] RefineOptions steps(int most) const;
  [[nodiscard]] Trial exchanged(const ComplementSearch::About& about, std::size_t light, std::uint64_t seed) const;
  [[nodiscard]] Trial pair_exchanged(const ComplementSearch::About& about,
                                     std::pair<std::size_t, std::size_t> pair) const;

  const ComplementSearch& candidates_;
  const ExchangeOptions& options_;
  std::size_t columns_ = 0;
};

}  // namespace luxrig
