#pragma once
/// Moves through what places alone cannot leave: lights taken out and put back elsewhere, singly or by twos.
///
/// Refinement ends in basins which shadows cut off. A light that is taken out and put where it does most for what is
/// left over (the thesis's mutation, §5.4.2, with every light in turn instead of one at random) leaves them: at a
/// candidate anywhere, or at a fresh place near by, which may lie beyond an edge of a shadow. Two lights that make up
/// for each other's faults hold each other there, and go together.

#include <cstdint>
#include <optional>
#include <random>
#include <stop_token>
#include <utility>

#include "core/run.h"
#include "core/solve/placement/complement_search.h"
#include "core/solve/placement/refine_lights.h"

namespace luxrig {

struct ExchangeOptions : Run {
  std::size_t complements = 6;   ///< candidates tried for a light that was taken out
  std::size_t near_places = 48;  ///< places tried about it
  double apart_m = 0.5;          ///< between candidates that are tried
  double near_m = 0.4;           ///< of those places: standard deviation along each axis
  double near_rad = 0.3;         ///< and of their aims, about each of two axes
  double longest_step_m = 0.5;   ///< of a light in one step of refinement

  /// Lengths that suit candidates so far apart.
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

  /// One round: every light is taken out and put back; the best of these is kept, and of the others what improves that
  /// in turn: lights in rooms of their own do not wait for each other. False, and nothing changed, when none is better.
  bool singly(PlacedLights& lights, std::mt19937_64& random);
  /// The same by twos that share points.
  bool by_twos(PlacedLights& lights);
  /// Through lights more than are wanted: as many as `beyond` are added and, each time the one that is missed least,
  /// taken out again, the others following. With more lights fewer basins are dead ends.
  bool through_more(PlacedLights& lights, std::size_t beyond, std::mt19937_64& random);
  /// The best of the lights without one of them, refined a little. At least one light.
  [[nodiscard]] PlacedLights without_one(const PlacedLights& lights);
  /// A light more, at the best candidate (or, drawn, one of the `choice` best), all refined. False when none gains.
  bool with_one_more(PlacedLights& lights, std::size_t choice, std::mt19937_64& random);
  /// All places to the end of the basin.
  void refine(PlacedLights& lights) { columns_ += refine_lights(lights, steps(RefineOptions{}.most_steps)); }

  /// Columns worked out by all of these so far.
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
