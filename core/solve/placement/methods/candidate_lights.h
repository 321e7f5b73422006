#pragma once
/// Candidates as columns for least squares, and the search for those most similar to a residual. Shared by all searches
/// over candidates.

#include <memory>
#include <span>

#include "core/solve/least_squares/nnls_of_few.h"
#include "core/solve/placement/methods/placement_method.h"

namespace luxrig {

class CandidateLights {
 public:
  /// Cause::invalid with the problem's complaint(). The problem must outlive it.
  [[nodiscard]] static Result<std::shared_ptr<const CandidateLights>> make(const PlacementProblem& problem);
  CandidateLights(const CandidateLights&) = delete;
  CandidateLights& operator=(const CandidateLights&) = delete;

  [[nodiscard]] const PlacementProblem& problem() const { return problem_; }
  /// Candidates that light any point with weight, rising.
  [[nodiscard]] std::span<const std::size_t> lit() const { return lit_; }
  [[nodiscard]] const LightPose& pose(std::size_t candidate) const { return problem_.poses[candidate]; }
  [[nodiscard]] std::size_t emitters() const { return emitters_; }
  /// Columns of a candidate's emitters in nnls() and shared() start at candidate · emitters().
  [[nodiscard]] const NnlsProblem& nnls() const { return nnls_; }
  [[nodiscard]] const std::shared_ptr<const SharedProblem>& shared() const { return shared_; }
  /// PlacedLights::error() for a residual's norm.
  [[nodiscard]] double error_of(double residual_norm) const {
    return goal_norm_ > 0 ? residual_norm / goal_norm_ : residual_norm;
  }
  /// W times the column of all emitters of a candidate together, scaled to norm 1.
  [[nodiscard]] Eigen::VectorXd unit_column(std::size_t candidate) const;

  /// The `count` candidates whose normalised columns are nearest to the normalised residual (b − f − A x), nearest
  /// first; only those that reduce it. One pass over all columns. Several emitters: by their joint effect, exact if no
  /// two share a channel.
  [[nodiscard]] std::vector<std::size_t> nearest(const Eigen::VectorXd& residual, std::size_t count) const;

 private:
  explicit CandidateLights(const PlacementProblem& problem);
  void expand();

  const PlacementProblem& problem_;
  std::size_t emitters_;
  double goal_norm_;
  // Columns of emitters, unless each candidate has one emitter with the candidate's own column.
  std::vector<std::uint64_t> begin_;
  std::vector<std::uint32_t> row_;
  std::vector<double> value_;
  NnlsProblem nnls_;
  std::shared_ptr<const SharedProblem> shared_;
  Eigen::VectorXd inverse_norm_;  ///< 0 for dark columns
  std::vector<std::size_t> lit_;
};

}  // namespace luxrig
