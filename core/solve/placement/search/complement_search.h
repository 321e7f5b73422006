#pragma once
/// Candidates that best reduce the residual of chosen lights: an exact search through all of them.
///
/// With all levels free to follow, a candidate with column a lowers the squared error by
///   (aᵀr)² / (‖a‖² − ‖Qᵀa‖²),
/// where r is the residual and Q an orthonormal basis of the columns in use (orthogonal least squares: Chen, Cowan &
/// Grant 1991). This holds as long as no level would have to fall below 0. For a candidate with several emitters it is
/// the sum over them, which is exact if no two share a channel.
///
/// The thesis picks the candidate whose normalised column is nearest to the residual, the largest aᵀr/‖a‖: the same
/// without the chosen lights in the denominator.

#include <initializer_list>
#include <span>
#include <vector>

#include "core/solve/least_squares/columns_view.h"
#include "core/solve/placement/placed_lights.h"

namespace luxrig {

struct Complement {
  std::size_t candidate = 0;
  double gain = 0;  ///< fall of the squared error
};

class ComplementSearch {
 public:
  /// All must outlive it. columns: lux per unit emittance, one row per point; one pose per column.
  ComplementSearch(const ColumnsView& columns, std::span<const LightPose> poses, const LightingGoal& goal);

  [[nodiscard]] std::size_t candidates() const { return poses_.size(); }
  [[nodiscard]] const LightPose& pose(std::size_t candidate) const { return poses_[candidate]; }

  using ByCandidate = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// Products of all candidates with `lights`: one pass through the columns, which serves every search about some of
  /// the lights. The lights must outlive it.
  struct About {
    const PlacedLights* lights = nullptr;
    std::vector<ByCandidate> products;  ///< per emitter of a candidate: W a with W A, and last with the residual
  };
  [[nodiscard]] About about(const PlacedLights& lights) const;

  /// The best by falling gain; fewer when no more candidates gain. None within `apart_m` of a better one that points
  /// the same way (to 30°).
  [[nodiscard]] std::vector<Complement> best(const PlacedLights& chosen, std::size_t count, double apart_m) const;
  /// The same for `chosen`, which must be about.lights except those in `without`, in the same order and poses.
  [[nodiscard]] std::vector<Complement> best(const About& about, std::initializer_list<std::size_t> without,
                                             const PlacedLights& chosen, std::size_t count, double apart_m) const;

 private:
  [[nodiscard]] Eigen::VectorXd gains(const About& about, std::initializer_list<std::size_t> without,
                                      const PlacedLights& chosen) const;
  [[nodiscard]] ByCandidate products(const Eigen::MatrixXd& vectors) const;

  ColumnsView columns_;
  std::span<const LightPose> poses_;
  const LightingGoal* goal_;
  Eigen::VectorXd row_weight_;           ///< W
  std::vector<ColumnsView::Index> lit_;  ///< candidates with any light
  Eigen::MatrixXd squared_norm_;         ///< of W a: lit_ × emitters
};

}  // namespace luxrig
