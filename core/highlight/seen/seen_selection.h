#pragma once
/// Places for new lights, chosen by what is seen in their light together. Arithmetic on the light of each.

#include <span>
#include <vector>

#include "core/highlight/seen/seen_contrast.h"
#include "core/highlight/seen/seen_role.h"
#include "core/photometry/intensity.h"

namespace luxrig {

/// A luminaire as it could hang.
struct SeenCandidate {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();  ///< unit, of its beam; turned as by aimed_beam
  int side = 0;                     ///< of each side but 0 at most one is chosen
};

struct SeenSelectionOptions : Run {
  double reflected_lx = 0;    ///< by way of the room, everywhere on the object, by each light at full level
  double min_apart_m = 1e-6;  ///< of two lights that are both chosen
  SeenRole role{};            ///< of the new lights together
};

struct SeenChoice {
  std::vector<std::size_t> candidates;  ///< may be fewer than asked for
  std::vector<double> levels;           ///< 0…1, one each
  SeenScore score;                      ///< with a role, its objective is the role's
};

class SeenSelection {
 public:
  /// seen        must outlive it
  /// room        everything that blocks light, including the object
  /// candidates  at least one; intensity of all of them, at rated flux
  /// fixed_lux   light that stays, at each of the samples; empty = darkness
  SeenSelection(const SeenContrast& seen, const RayScene& room, std::vector<SeenCandidate> candidates,
                const IntensityDistribution& intensity, std::vector<float> fixed_lux,
                const SeenSelectionOptions& options);

  [[nodiscard]] std::span<const SeenCandidate> candidates() const { return candidates_; }
  /// For one light, two, … `most`: the best one is added to those before; then each in turn is exchanged for a better
  /// one, and its level changed, until nothing gains. A stop ends it with what it has.
  [[nodiscard]] std::vector<SeenChoice> up_to(int most) const;
  [[nodiscard]] SeenScore score(std::span<const std::size_t> candidates, std::span<const double> levels) const;

 private:
  struct Taken {
    std::size_t candidate = 0;
    double level = 0, objective = 0;
  };
  /// lights: of each alone, if shadows count.
  [[nodiscard]] SeenScore scored(std::span<const float> lux, std::span<const std::vector<float>> lights) const;
  /// The light that stays, and that of each chosen one but `without`; empty if shadows do not count.
  [[nodiscard]] std::vector<std::vector<float>> light_of_each(const SeenChoice& choice, std::size_t without) const;
  [[nodiscard]] std::vector<float> light_of(const SeenChoice& choice, std::size_t without) const;
  /// The best light beside all chosen ones but one.
  [[nodiscard]] Taken best_beside(const SeenChoice& choice, std::size_t without) const;
  void settle(SeenChoice& choice) const;

  const SeenContrast& seen_;
  std::vector<SeenCandidate> candidates_;
  std::vector<std::vector<float>> lux_;  ///< per candidate at full level
  std::vector<float> fixed_lux_;
  /// A quarter of the mean of the best candidate's light: an object that all beams miss is seen badly.
  double darkest_lx_ = 0;
  double fixed_wanted_lx_ = 0;  ///< mean over what the role wants lit
  SeenSelectionOptions options_;
};

}  // namespace luxrig
