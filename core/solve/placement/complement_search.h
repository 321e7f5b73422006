#pragma once
/// Which candidates would do most for what chosen lights leave over: an exact search through all of them.
///
/// A candidate with column a lowers the squared error, when all levels are free to follow, by
///   (aᵀr)² / (‖a‖² − ‖Qᵀa‖²),
/// with r the residual and Q an orthonormal basis of the columns in use (orthogonal least squares: Chen, Cowan & Grant
/// 1991). It holds as long as no level would have to fall below 0.
///
/// The thesis asks for the candidate whose normalised column is nearest to the residual, that is the largest aᵀr/‖a‖:
/// the same without the chosen lights in the denominator.

#include <span>
#include <vector>

#include "core/solve/columns_view.h"
#include "core/solve/placement/placed_lights.h"

namespace luxrig {

struct Complement {
  std::size_t candidate = 0;
  double gain = 0;  ///< by how much the squared error falls
};

class ComplementSearch {
 public:
  /// The matrix and the places must outlive it. columns: lux per unit emittance, one row per point; a place per column.
  ComplementSearch(const ColumnsView& columns, std::span<const Vec3> places_world_m, const LightingGoal& goal);

  [[nodiscard]] std::size_t candidates() const { return places_m_.size(); }
  [[nodiscard]] const Vec3& place_world_m(std::size_t candidate) const { return places_m_[candidate]; }

  /// The best by gain, falling, none within `apart_m` of a better one; fewer when no more gain anything.
  [[nodiscard]] std::vector<Complement> best(const PlacedLights& chosen, std::size_t count, double apart_m) const;

 private:
  [[nodiscard]] Eigen::VectorXd gains(const PlacedLights& chosen) const;

  ColumnsView columns_;
  std::span<const Vec3> places_m_;
  Eigen::VectorXd row_weight_;           ///< W
  Eigen::VectorXd squared_norm_;         ///< of W a
  Eigen::VectorXd lit_scale_;            ///< 1 for candidates with any light, 0 for others
  std::vector<ColumnsView::Index> lit_;  ///< candidates with any light
};

}  // namespace luxrig
