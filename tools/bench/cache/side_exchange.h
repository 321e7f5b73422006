#pragma once
/// The exchange of light between groups of sides: every reflection after the first.

#include <functional>

#include "core/transport/evaluator.h"
#include "tools/bench/cache/surface_sides.h"

namespace luxrig {

/// With radiosity B [lm/m²] of groups, group g has illuminance E_g = Σ F_gh B_h and reflects ρ_g E_g. F_gh is the share
/// of g's hemisphere (cosine-weighted, mean over its places) that shows group h.
class SideExchange {
 public:
  /// Only these groups have rows: those that a receiver sees (`seen`, by group), those that these see, and so on.
  /// reflections   the number that matters, without the first; 0 = all. Rows of the last ones need not exist.
  SideExchange(const Scene& scene, const RayScene& rays, const SurfaceSides& sides, std::vector<bool> seen,
               bool only_needed, int reflections, int rays_per_group, int channels, std::uint64_t seed, int threads,
               const std::stop_token& stop);

  [[nodiscard]] std::size_t rows() const { return group_of_row_.size(); }
  /// SurfaceSides::kNone for groups that cannot matter.
  [[nodiscard]] std::uint32_t row_of_group(std::size_t group) const { return row_of_group_[group]; }

  /// All reflections after the first. With b the radiosity of the first reflection by row,
  ///   A b + A² b + …, A = diag(ρ) F, as many terms as there are reflections.
  [[nodiscard]] Eigen::VectorXd later(const Eigen::VectorXd& first, int channel) const;

  /// later() for every b at once: the rows of `reads` (what receivers read of each row) times A + A² + … By an LU
  /// factorisation, so only for moderate numbers of rows.
  [[nodiscard]] Eigen::MatrixXf reads_of_later(const Eigen::MatrixXf& reads, int channel) const;

  [[nodiscard]] std::size_t links() const { return share_.size(); }
  [[nodiscard]] std::uint64_t rays() const { return cast_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  std::vector<std::uint32_t> row_of_group_, group_of_row_;
  std::vector<std::size_t> first_link_;  ///< per row, and one more
  std::vector<std::uint32_t> seen_row_;
  std::vector<float> share_;
  std::vector<Eigen::VectorXd> reflectance_;  ///< per channel, by row
  int reflections_;
  std::uint64_t cast_ = 0;
};

}  // namespace luxrig
