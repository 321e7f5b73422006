#pragma once
/// Real luminaires that bring out an object's relief, judged by measured contrast.

#include <memory>
#include <optional>

#include "core/highlight/lights/judged_selection.h"
#include "core/highlight/lights/place_sights.h"
#include "core/highlight/lights/potential_lights.h"
#include "core/photometry/intensity.h"
#include "core/run.h"

namespace luxrig {

struct JudgedLightOptions : Run {
  Surroundings surroundings;
  double coverage_weight = 0.1, min_angle_rad = rad_from_deg(30);  ///< as JudgedWishes
  /// All places are first judged by this many interest points, evenly strided. Then the max_candidates best, but not
  /// too many from one direction, are judged by all interest points.
  std::size_t first_points = 150, max_candidates = 480;
  double lift_m = 0;  ///< rays start this far off the surface; hides smaller relief
};

struct JudgedLightSet {
  std::vector<JudgedLight> lights;  ///< may be fewer than requested
  JudgedScore score;
};

/// Results for one light, two, and so on.
struct JudgedLightCount {
  std::vector<JudgedLightSet> by_number;
  std::size_t best = 0;  ///< index of the recommended number: number_at_peak
};

/// Visibility from each place is found once; any number of lights is then chosen without rays.
class JudgedLights {
 public:
  /// At each place, lights are tried in the directions of most contrast: modes of the directions to interest points,
  /// weighted by the contrast that an even light there would make at them (direction_modes, with half the beam as
  /// window); and modes of the votes.
  /// interest    indices of points of the surface, each once
  /// features    of the interest points
  /// places_world_m   possible places of a luminaire: cell_centres() of a LightDomain
  /// voted       potential_lights of votes, also tried; may be empty. Those that votes would choose (LightSelection)
  ///             are a second start for choosing several
  /// intensity   of all lights, at rated flux, turned as by aimed_beam
  /// Refuses: no interest points, no place, a place from which light reaches no interest point, invalid numbers.
  [[nodiscard]] static Result<JudgedLights> make(const TargetSurface& surface, const TargetRays& target,
                                                 std::span<const std::uint32_t> interest,
                                                 const FeatureClusters& features, std::span<const Vec3> places_world_m,
                                                 const PotentialLights& voted, Intensity intensity,
                                                 const JudgedLightOptions& options);
  ~JudgedLights();
  JudgedLights(JudgedLights&&) noexcept;
  JudgedLights& operator=(JudgedLights&&) noexcept;

  /// An empty selection; must not outlive this. selection.add() and remove() change it by one light each.
  [[nodiscard]] JudgedSelection selection() const;
  /// Refines the aims of the chosen lights between the candidates, each in turn, down to a sixty-fourth of the beam.
  void refine_aims(JudgedSelection& selection) const;

  /// The better of two starts, both settled and refined: one by one by contrast, and with the lights that votes would
  /// choose. Refuses a number outside 1…64.
  [[nodiscard]] Result<JudgedLightSet> lights(int lights) const;
  /// For one light up to max_lights, each started from the one before or from the lights that votes would choose.
  [[nodiscard]] Result<JudgedLightCount> count_lights(int max_lights) const;

  [[nodiscard]] std::span<const JudgedLight> candidates() const;
  [[nodiscard]] const ContrastSamples& samples() const;
  [[nodiscard]] std::uint64_t rays() const;  ///< cast

 private:
  struct State;
  /// Fills up to `lights` lights, keeping the chosen ones first, as far as there are enough; settled and refined. False
  /// when stopped.
  bool complete(JudgedSelection& selection, int lights) const;
  /// Empty when votes choose too few, or for a single light, which is found by trying all.
  [[nodiscard]] std::optional<JudgedSelection> begun_by_votes(int lights) const;
  explicit JudgedLights(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
