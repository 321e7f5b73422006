#pragma once
/// Real luminaires that bring out an object's relief, judged by the contrast that they make.

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
  double coverage_weight = 0.1, least_angle_rad = rad_from_deg(30);  ///< as JudgedWishes
  /// All places are judged first by so many of the interest points, evenly strided; then the best candidates, as
  /// many as this but not too many from one direction, by all.
  std::size_t first_points = 150, most_candidates = 480;
  double lift_m = 0;  ///< rays start so far off the surface; hides relief smaller than it
};

struct JudgedLightSet {
  std::vector<JudgedLight> lights;  ///< may be fewer than asked for
  JudgedScore score;
};

/// Per number of lights, from one.
struct JudgedLightCount {
  std::vector<JudgedLightSet> by_number;
  std::size_t best = 0;  ///< index of the number to take: number_at_peak
};

/// What each place sees is found once; then any number of lights is chosen without a ray.
class JudgedLights {
 public:
  /// At each place lights are tried that shine where its own light would make most contrast: along modes of the
  /// directions to interest points, weighted by the contrast that an even light there would make at them
  /// (direction_modes, with half the beam as window); and along those of votes.
  /// interest    indices of points of the surface, each once
  /// features    of them
  /// places_world_m   where a luminaire may be: cell_centres() of a LightDomain
  /// voted       potential_lights of votes, tried too; may be empty. Those that votes would take (LightSelection) are a
  ///             second beginning for the choice of several
  /// intensity   of all of them, at rated flux, turned as by aimed_beam
  /// Refuses: no interest points, no place, a place from which light reaches none of them, numbers that make no sense.
  [[nodiscard]] static Result<JudgedLights> make(const TargetSurface& surface, const TargetRays& target,
                                                 std::span<const std::uint32_t> interest,
                                                 const FeatureClusters& features, std::span<const Vec3> places_world_m,
                                                 const PotentialLights& voted, Intensity intensity,
                                                 const JudgedLightOptions& options);
  ~JudgedLights();
  JudgedLights(JudgedLights&&) noexcept;
  JudgedLights& operator=(JudgedLights&&) noexcept;

  /// None taken yet; must not outlive this. A light more is selection.add(), one less remove(): a step each.
  [[nodiscard]] JudgedSelection selection() const;
  /// Aims of the lights taken, refined between the candidates, each in turn, down to a sixty-fourth of the beam.
  void refine_aims(JudgedSelection& selection) const;

  /// Begun one by one by contrast, and once more with those that votes would take; settled and refined, the better of
  /// both. Refuses a number outside 1…64.
  [[nodiscard]] Result<JudgedLightSet> lights(int lights) const;
  /// From one to most_lights, each from the one before, or from those that votes would take.
  [[nodiscard]] Result<JudgedLightCount> count_lights(int most_lights) const;

  [[nodiscard]] std::span<const JudgedLight> candidates() const;
  [[nodiscard]] const ContrastSamples& samples() const;
  [[nodiscard]] std::uint64_t rays() const;  ///< cast

 private:
  struct State;
  /// `lights` of them, the taken ones first, as far as there are enough; settled and refined. False when stopped.
  bool complete(JudgedSelection& selection, int lights) const;
  /// None when votes take too few, or one light is wanted, which is judged by trying all.
  [[nodiscard]] std::optional<JudgedSelection> begun_by_votes(int lights) const;
  explicit JudgedLights(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
