#pragma once
/// Directions of distant lights that bring out an object's relief, judged by measured contrast.

#include <functional>

#include "core/highlight/distant/bin_neighbours.h"
#include "core/highlight/distant/tabled_contrast.h"
#include "core/run.h"

namespace luxrig {

struct ReliefLightOptions : Run {
  int side = 16;  ///< of the sphere's bins: 3 072 of 3.7°
  /// Closer lights cast nearly the same shadows and act as one brighter light. Contrast is convex in the lights'
  /// levels, so only this limit keeps the best lights apart.
  double min_angle_rad = rad_from_deg(30);
  /// A light is judged by the mean contrast around its direction, weighted by exp(-angle² / 2 spread²): heads cannot be
  /// aimed more exactly, and narrower peaks come from single facets. 0 = by its direction alone.
  double spread_rad = rad_from_deg(4);
  double lift_m = 0;  ///< rays start this far off the surface; hides smaller relief
  /// Of directions with nearly equal contrast, the one nearer to this wins: the contrast from the opposite side is
  /// reduced by the share `preference`. Symmetric objects have such directions. Zero = none.
  Vec3 preferred = Vec3::Zero();
  double preference = 0.05;
  /// Whether a light may stand in this direction (unit, from the object); empty: anywhere. Asked once per bin.
  std::function<bool(const Vec3& towards)> may_light{};
};

struct ReliefLights {
  std::vector<Vec3> directions;  ///< unit, from the object to the light; may be fewer than requested
  double local_contrast_lx = 0;  ///< as in `relief_contrast`, with beams of 1 lx from the bins of these directions
};

/// Results for one light, two, and so on.
struct ReliefLightCount {
  std::vector<ReliefLights> by_number;
  std::size_t best = 0;  ///< index of the recommended number: number_at_peak
  std::vector<double> exposed_contrast;
};

/// The table of lit directions is made once; any number of lights is then chosen without rays.
class ReliefLightSearch {
 public:
  /// interest   indices of points of the surface, each once
  /// Refuses a target without interest points, one that no outside light reaches (the inside of a closed box), and
  /// invalid options.
  [[nodiscard]] static Result<ReliefLightSearch> make(const TargetSurface& surface, const TargetRays& target,
                                                      std::span<const std::uint32_t> interest,
                                                      const ReliefLightOptions& options);

  /// Greedy; then each light in turn moves to its best place with the others fixed, until none gains 1 %. Directions
  /// are the peak of a parabola through the surrounding bins. A single light is the best of all bins.
  /// start   directions to begin with, such as those with most votes; at most `lights`
  [[nodiscard]] Result<ReliefLights> lights(int lights, std::span<const Vec3> start = {}) const;

  /// For one light up to max_lights.
  [[nodiscard]] Result<ReliefLightCount> count_lights(int max_lights) const;

  /// Of beams of 1 lx from the bins of these directions (contrast_samples.h), 0…1.
  [[nodiscard]] double exposed_contrast_of(std::span<const Vec3> directions) const;

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
  std::vector<double> liking_;         ///< per bin: 1 for the preferred direction, less for others
  std::vector<double> alone_lx_, alone_smooth_;
};

}  // namespace luxrig
