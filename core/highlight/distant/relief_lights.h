#pragma once
/// Directions of distant lights that bring out an object's relief, judged by the contrast that they make.

#include "core/highlight/distant/bin_neighbours.h"
#include "core/highlight/distant/tabled_contrast.h"
#include "core/run.h"

namespace luxrig {

struct ReliefLightOptions : Run {
  int side = 16;  ///< of the sphere's bins: 3 072 of 3.7°
  /// Lights nearer to each other cast nearly the same shadows: they are one brighter light, and as contrast is convex
  /// in the lights' levels, nothing but this would keep the best of them apart.
  double least_angle_rad = rad_from_deg(30);
  /// A light is judged by the mean contrast around its direction, weighted by exp(-angle² / 2 spread²): no head is
  /// aimed better, and peaks narrower than it come of single facets. 0: by its direction alone.
  double spread_rad = rad_from_deg(4);
  double lift_m = 0;  ///< rays start so far off the surface; hides relief smaller than it
  /// Of directions that bring out nearly as much, the one nearer to this is taken: what one from the opposite side
  /// brings out counts less by the share `preference`. An object's symmetries make such directions. Zero: none.
  Vec3 preferred = Vec3::Zero();
  double preference = 0.05;
};

struct ReliefLights {
  std::vector<Vec3> directions;  ///< unit, from the object to the light; may be fewer than asked for
  double local_contrast_lx = 0;  ///< as `relief_contrast` has it, beams of 1 lx from the bins these lie in
};

/// Per number of lights, from one.
struct ReliefLightCount {
  std::vector<ReliefLights> by_number;
  std::size_t best = 0;  ///< index of the number to take: number_at_peak
  std::vector<double> exposed_contrast;
};

/// The table of lit directions is made once; then any number of lights is chosen without a ray.
class ReliefLightSearch {
 public:
  /// interest   indices of points of the surface, each once
  /// Refuses a target without interest points or one that no light from outside reaches (the inside of a closed
  /// box), and options that make no sense.
  [[nodiscard]] static Result<ReliefLightSearch> make(const TargetSurface& surface, const TargetRays& target,
                                                      std::span<const std::uint32_t> interest,
                                                      const ReliefLightOptions& options);

  /// Greedy, then each light in turn is put where it is best with the others as they are, until none gains 1 %; where a
  /// parabola through the bins around has its peak. One light is the best of all bins.
  /// start   directions to begin with, e.g. those of most votes; at most `lights`
  [[nodiscard]] Result<ReliefLights> lights(int lights, std::span<const Vec3> start = {}) const;

  /// From one to most_lights.
  [[nodiscard]] Result<ReliefLightCount> count_lights(int most_lights) const;

  /// Local contrast of one beam of 1 lx from each bin [lx].
  [[nodiscard]] const std::vector<double>& of_each_bin() const { return alone_lx_; }
  [[nodiscard]] const LitTable& table() const { return table_; }
  [[nodiscard]] const ContrastSamples& samples() const { return samples_; }

 private:
  ReliefLightSearch(ContrastSamples samples, LitTable table, const ReliefLightOptions& options);
  [[nodiscard]] TabledContrast sums() const { return {samples_, table_, options_.threads}; }
  [[nodiscard]] std::vector<double> smoothed(const std::vector<double>& values) const;
  [[nodiscard]] Vec3 peak_near(std::uint32_t bin, const std::vector<double>& smooth) const;

  ReliefLightOptions options_;
  ContrastSamples samples_;
  LitTable table_;
  BinNeighbours spread_, around_;
  std::vector<float> spread_weights_;  ///< one per entry of spread_
  std::vector<Vec3> directions_;       ///< of bins
  std::vector<double> liking_;         ///< of bins: 1 of the preferred one, less of others
  std::vector<double> alone_lx_, alone_smooth_;
};

}  // namespace luxrig
