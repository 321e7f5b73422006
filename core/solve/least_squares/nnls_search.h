#pragma once
/// Active-set search for the columns in use, in which many columns may come and go in one round. Internal to the NNLS
/// family.

#include <cstdint>
#include <memory>
#include <unordered_set>
#include <vector>

#include "core/solve/least_squares/passive_columns.h"

namespace luxrig {

class NnlsSearch {
 public:
  using Index = Eigen::Index;
  using VectorXd = Eigen::VectorXd;

  NnlsSearch(const ScaledColumns& problem, std::unique_ptr<PassiveColumns> passive);

  void allow(Index column, bool allowed);
  void allow_as(const NnlsSearch& other);
  void start_from(const VectorXd& x);
  [[nodiscard]] VectorXd x() const;
  /// The goal of the problem has changed; x is the solution so far.
  void goal_changed(const VectorXd& x);

  void run(const NnlsOptions& options);
  [[nodiscard]] NnlsSolution solution() const;
  [[nodiscard]] bool stopped() const { return stopped_; }

 private:
  enum class VariableState : char { lower, upper, passive };

  [[nodiscard]] std::vector<Index> entering(std::size_t most);
  bool enter(const std::vector<Index>& columns);
  bool descend();
  bool leave_at_bounds(const VectorXd& d);
  void renew_residual();
  [[nodiscard]] std::vector<Index> support() const;
  void after_round(const std::vector<Index>& columns);
  void polish();

  const ScaledColumns& p_;
  std::unique_ptr<PassiveColumns> passive_;
  VectorXd z_, residual_, gradient_;
  std::vector<VariableState> place_;
  std::vector<char> allowed_, refused_;
  std::vector<Index> at_upper_;
  std::unordered_set<std::uint64_t> visited_;
  std::uint64_t key_ = 0;
  std::size_t block_ = 1, max_ = 1;  ///< columns to enter at a time, now and at most
  double min_ = 0;                   ///< smallest error reached
  int iterations_ = 0;
  bool converged_ = false, stopped_ = false, careful_ = false;
};

}  // namespace luxrig
