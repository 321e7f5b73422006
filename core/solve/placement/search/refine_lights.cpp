#include "core/solve/placement/search/refine_lights.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>

namespace luxrig {
namespace {

constexpr double kFirstDamping = 1e-2, kMaxDamping = 1e8, kMinDamping = 1e-9;

/// Linear model at the present places.
struct PlaceModel {
  Eigen::Index freedoms;
  std::vector<std::size_t> lit;  ///< lights whose pose matters: a level is above 0
  Eigen::MatrixXd products;      ///< JᵀJ
  Eigen::VectorXd slope;         ///< Jᵀr

  explicit PlaceModel(const PlacedLights& lights) : freedoms(lights.freedoms()) {
    for (std::size_t k = 0; k < lights.size(); ++k)
      if (lights.lit(k)) lit.push_back(k);
    const Eigen::Index rows = lights.columns().rows();
    Eigen::MatrixXd jacobian(rows, freedoms * static_cast<Eigen::Index>(lit.size()));
    for (std::size_t i = 0; i < lit.size(); ++i)
      jacobian.middleCols(freedoms * static_cast<Eigen::Index>(i), freedoms) = lights.slopes(lit[i]);
    // Projects out the part that a change of levels can fit.
    Eigen::MatrixXd in_use(rows, lights.columns().cols());
    Eigen::Index count = 0;
    for (Eigen::Index k = 0; k < in_use.cols(); ++k)
      if (lights.levels()[k] > 0) in_use.col(count++) = lights.columns().col(k);
    const Eigen::HouseholderQR<Eigen::MatrixXd> factor(in_use.leftCols(count));
    const Eigen::MatrixXd basis = factor.householderQ() * Eigen::MatrixXd::Identity(rows, std::min(rows, count));
    jacobian -= basis * (basis.transpose() * jacobian);
    products = jacobian.transpose() * jacobian;
    slope = jacobian.transpose() * lights.residual();
  }

  /// Moves of the lit lights, as moved() takes them.
  [[nodiscard]] Eigen::VectorXd step(double damping) const {
    Eigen::MatrixXd damped = products;
    const double least = 1e-12 * std::max(products.diagonal().maxCoeff(), 1e-300);
    damped.diagonal() += damping * products.diagonal().cwiseMax(least);
    return damped.ldlt().solve(slope);
  }
};

}  // namespace

std::size_t refine_lights(PlacedLights& lights, const RefineOptions& options) {
  std::size_t columns = 0;
  double damping = kFirstDamping;
  int small = 0;
  for (int step = 0; step < options.max_steps && lights.error() > options.min_error; ++step) {
    const PlaceModel model(lights);
    columns += model.lit.size();
    if (model.lit.empty()) break;
    bool better = false;
    while (!better && damping <= kMaxDamping) {
      if (options.stop.stop_requested()) return columns;
      const Eigen::VectorXd moves = model.step(damping);
      if (!moves.allFinite()) {
        damping *= 10;
        continue;
      }
      std::vector<LightPose> poses = lights.poses();
      double longest = 0;
      for (std::size_t i = 0; i < model.lit.size(); ++i) {
        Eigen::VectorXd move = moves.segment(model.freedoms * static_cast<Eigen::Index>(i), model.freedoms);
        if (const double length_m = move.head<3>().norm(); length_m > options.longest_step_m)
          move *= options.longest_step_m / length_m;
        if (const double turn_rad = move.tail(model.freedoms - 3).norm(); turn_rad > options.longest_turn_rad)
          move *= options.longest_turn_rad / turn_rad;
        longest = std::max(longest, move.norm());
        poses[model.lit[i]] = luxrig::moved(poses[model.lit[i]], move);
      }
      PlacedLights moved = lights;
      moved.move(poses);
      columns += model.lit.size();
      if (moved.error() < lights.error()) {
        small = moved.error() > (1 - options.min_improvement) * lights.error() ? small + 1 : 0;
        lights = std::move(moved);
        damping = std::max(kMinDamping, damping / 5);
        better = true;
      } else {
        damping *= 6;
        if (longest < 1e-9) return columns;
      }
    }
    if (!better || small >= 2) break;
  }
  return columns;
}

}  // namespace luxrig
