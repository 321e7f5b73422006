#pragma once
/// Shared by the tests of error_bound.

#include <algorithm>
#include <cmath>

#include "core/solve/bounds/error_bound.h"
#include "core/solve/least_squares/nnls.h"
#include "tests/random.h"

namespace luxrig::error_bound_fixture {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Lights with one or three emitters, in rooms that share a little light, with every degenerate case.
struct TinyLights {
  MatrixXd A;
  VectorXd goal, weight;
  std::vector<std::uint32_t> light;
  std::size_t lights = 0;

  explicit TinyLights(unsigned seed) {
    Random random(seed);
    const auto rows = static_cast<Index>(1 + random.below(12));
    const std::size_t emitters = seed % 5 == 0 ? 3 : 1;
    lights = 1 + random.below(emitters == 3 ? 5 : 12);
    const std::size_t rooms = 1 + random.below(4);
    A = MatrixXd::Zero(rows, static_cast<Index>(lights * emitters));
    goal.resize(rows);
    for (double& g : goal) g = random.between(0, 1) < 0.1 ? 0 : random.between(0.2, 2);
    if (seed % 7 == 1) goal.setOnes();
    for (std::size_t l = 0; l < lights; ++l)
      for (std::size_t e = 0; e < emitters; ++e) {
        auto column = A.col(static_cast<Index>(l * emitters + e));
        for (Index i = 0; i < rows; ++i) {
          const bool same_room = static_cast<std::size_t>(i) % rooms == l % rooms;
          if (same_room || random.between(0, 1) < 0.15)
            column[i] = std::pow(random.between(0, 1), 2) * (same_room ? 1 : 0.2);
          if (random.between(0, 1) < 0.2) column[i] = 0;
        }
        light.push_back(static_cast<std::uint32_t>(l));
      }
    if (seed % 6 == 2) A.col(static_cast<Index>(random.below(static_cast<std::size_t>(A.cols())))).setZero();
    if (seed % 6 == 3) A.col(0) = 2 * A.col(A.cols() - 1);
    if (seed % 6 == 4) A.row(0).setZero();  // no light reaches it
    if (seed % 6 == 5) {                    // extreme units
      for (Index j = 0; j < A.cols(); ++j) A.col(j) *= std::pow(10, random.between(-12, 12));
      goal *= std::pow(10, random.between(-12, 12));
    }
    if (seed % 11 == 0) {
      VectorXd x = VectorXd::Zero(A.cols());
      x[0] = 1;
      x[A.cols() - 1] = 2;
      goal = A * x;  // two lights suffice
    }
    if (seed % 13 == 0) goal.setZero();
    if (seed % 4 == 1) {
      weight.resize(rows);
      for (double& w : weight) w = random.between(0, 1) < 0.1 ? 0 : random.between(0.1, 3);
    }
  }

  [[nodiscard]] BoundProblem candidates() const { return {ColumnsView(A), goal, weight, light}; }
  [[nodiscard]] MatrixXd weighted() const { return weight.size() > 0 ? MatrixXd(weight.asDiagonal() * A) : A; }
  [[nodiscard]] VectorXd weighted_goal() const {
    return weight.size() > 0 ? VectorXd(weight.cwiseProduct(goal)) : goal;
  }

  /// Least errors with at most 0 … most lights, by trying all choices.
  [[nodiscard]] std::vector<double> min_errors(std::size_t most) const {
    const VectorXd b = weighted_goal();
    const MatrixXd all = weighted();
    std::vector<double> least(most + 1, b.norm() > 0 ? 1.0 : 0.0);
    for (unsigned choice = 1; choice < 1u << lights && b.norm() > 0; ++choice) {
      const auto count = static_cast<std::size_t>(std::popcount(choice));
      if (count > most) continue;
      MatrixXd some(all.rows(), 0);
      for (Index j = 0; j < all.cols(); ++j)
        if (choice >> light[static_cast<std::size_t>(j)] & 1u) {
          some.conservativeResize(Eigen::NoChange, some.cols() + 1);
          some.rightCols(1) = all.col(j);
        }
      const double error = solve_nnls(some, b).residual_norm / b.norm();
      for (std::size_t k = count; k <= most; ++k) least[k] = std::min(least[k], error);
    }
    return least;
  }
};

}  // namespace luxrig::error_bound_fixture
