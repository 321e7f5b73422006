#include "core/solve/placement/refine_lights.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>

namespace luxrig {
namespace {

constexpr double kFirstDamping = 1e-2, kMostDamping = 1e8, kLeastDamping = 1e-9;

/// One linear model about the present places.
struct PlaceModel {
  std::vector<std::size_t> lit;  ///< lights whose place matters: their level is above 0
  Eigen::MatrixXd products;      ///< JᵀJ
  Eigen::VectorXd slope;         ///< Jᵀr

  explicit PlaceModel(const PlacedLights& lights) {
    for (std::size_t k = 0; k < lights.size(); ++k)
      if (lights.levels()[static_cast<Eigen::Index>(k)] > 0) lit.push_back(k);
    const auto count = static_cast<Eigen::Index>(lit.size());
    const Eigen::Index points = lights.columns().rows();
    Eigen::MatrixXd lit_columns(points, count), jacobian(points, 3 * count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto k = static_cast<Eigen::Index>(lit[static_cast<std::size_t>(i)]);
      lit_columns.col(i) = lights.columns().col(k);
      jacobian.middleCols(3 * i, 3) = lights.levels()[k] * lights.derivatives(static_cast<std::size_t>(k));
    }
    // What a change of levels can do, is not a place's to do.
    const Eigen::HouseholderQR<Eigen::MatrixXd> factor(lit_columns);
    const Eigen::MatrixXd basis = factor.householderQ() * Eigen::MatrixXd::Identity(points, std::min(points, count));
    jacobian -= basis * (basis.transpose() * jacobian);
    products = jacobian.transpose() * jacobian;
    slope = jacobian.transpose() * lights.residual();
  }

  /// Moves of the lit lights, three numbers each.
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
  for (int step = 0; step < options.most_steps && lights.error() > options.least_error; ++step) {
    const PlaceModel model(lights);
    columns += model.lit.size();
    if (model.lit.empty()) break;
    bool better = false;
    while (!better && damping <= kMostDamping) {
      if (options.stop.stop_requested()) return columns;
      const Eigen::VectorXd moves_m = model.step(damping);
      if (!moves_m.allFinite()) {
        damping *= 10;
        continue;
      }
      std::vector<Vec3> places_m = lights.places_world_m();
      double longest_m = 0;
      for (std::size_t i = 0; i < model.lit.size(); ++i) {
        Vec3 move_m = moves_m.segment<3>(3 * static_cast<Eigen::Index>(i));
        if (const double length_m = move_m.norm(); length_m > options.longest_step_m)
          move_m *= options.longest_step_m / length_m;
        longest_m = std::max(longest_m, move_m.norm());
        places_m[model.lit[i]] += move_m;
      }
      PlacedLights moved = lights;
      moved.move(places_m);
      columns += model.lit.size();
      if (moved.error() < lights.error()) {
        small = moved.error() > (1 - options.least_improvement) * lights.error() ? small + 1 : 0;
        lights = std::move(moved);
        damping = std::max(kLeastDamping, damping / 5);
        better = true;
      } else {
        damping *= 6;
        if (longest_m < 1e-9) return columns;
      }
    }
    if (!better || small >= 2) break;
  }
  return columns;
}

}  // namespace luxrig
