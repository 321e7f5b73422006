#include "core/solve/placement/complement_search.h"

#include <Eigen/QR>
#include <algorithm>
#include <numeric>

#include "core/check.h"

namespace luxrig {
namespace {

/// A column with less than this left of its square is a mix of the chosen ones: nothing but rounding to gain.
constexpr double kLeastLeft = 1e-4;

/// Orthonormal, of the columns whose level is above 0.
Eigen::MatrixXd basis_of(const PlacedLights& chosen) {
  Eigen::MatrixXd used(chosen.columns().rows(), chosen.columns().cols());
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < used.cols(); ++k)
    if (chosen.levels()[k] > 0) used.col(count++) = chosen.columns().col(k);
  used.conservativeResize(Eigen::NoChange, count);
  if (count == 0) return used;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(used);
  return factor.householderQ() * Eigen::MatrixXd::Identity(used.rows(), factor.rank());
}

}  // namespace

ComplementSearch::ComplementSearch(const ColumnsView& columns, std::span<const Vec3> places_world_m,
                                   const LightingGoal& goal)
    : columns_(columns), places_m_(places_world_m), row_weight_(goal.row_weight) {
  LUXRIG_CHECK(static_cast<std::size_t>(columns.columns()) == places_world_m.size(), "{} columns, {} places",
               columns.columns(), places_world_m.size());
  LUXRIG_CHECK(columns.rows() == goal.lux.size(), "{} rows, {} goals", columns.rows(), goal.lux.size());
  if (row_weight_.size() == 0) row_weight_ = Eigen::VectorXd::Ones(columns.rows());
  const Eigen::VectorXd squared_weight = row_weight_.cwiseAbs2();
  squared_norm_.resize(columns.columns());
  lit_scale_ = Eigen::VectorXd::Zero(columns.columns());
  for (ColumnsView::Index c = 0; c < columns.columns(); ++c) {
    squared_norm_[c] = columns.squared_norm(c, squared_weight.data());
    if (!(squared_norm_[c] > 0)) continue;
    lit_.push_back(c);
    lit_scale_[c] = 1;
  }
}

Eigen::VectorXd ComplementSearch::gains(const PlacedLights& chosen) const {
  constexpr Eigen::Index kTile = ColumnsView::kTile;
  const Eigen::VectorXd residual = row_weight_.cwiseProduct(chosen.residual());
  Eigen::VectorXd all(columns_.columns());
  columns_.dot_all(residual.data(), lit_scale_.data(), all.data());
  const auto lit = static_cast<Eigen::Index>(lit_.size());
  Eigen::VectorXd gain = Eigen::VectorXd::Zero(lit);
  // Levels cannot fall below 0: a candidate that does not pull gains nothing, whatever the chosen lights do.
  std::vector<Eigen::Index> place;
  std::vector<ColumnsView::Index> pulling;
  for (Eigen::Index i = 0; i < lit; ++i)
    if (const auto candidate = lit_[static_cast<std::size_t>(i)]; all[candidate] > 0) {
      place.push_back(i);
      pulling.push_back(candidate);
    }

  const auto count = static_cast<Eigen::Index>(pulling.size());
  const Eigen::MatrixXd basis = basis_of(chosen);
  Eigen::VectorXd left(count);
  for (Eigen::Index i = 0; i < count; ++i) left[i] = squared_norm_[pulling[static_cast<std::size_t>(i)]];
  std::vector<double> tile(static_cast<std::size_t>(kTile * basis.rows()));
  std::vector<double> products(static_cast<std::size_t>(kTile * count));
  for (Eigen::Index first = 0; first < basis.cols(); first += kTile) {
    const Eigen::Index used = std::min(kTile, basis.cols() - first);
    for (Eigen::Index row = 0; row < basis.rows(); ++row)
      for (Eigen::Index k = 0; k < kTile; ++k)
        tile[static_cast<std::size_t>(kTile * row + k)] = k < used ? row_weight_[row] * basis(row, first + k) : 0;
    columns_.dot_tile(pulling, tile.data(), products.data());
    for (Eigen::Index i = 0; i < count; ++i)
      for (Eigen::Index k = 0; k < used; ++k) {
        const double product = products[static_cast<std::size_t>(kTile * i + k)];
        left[i] -= product * product;
      }
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto candidate = pulling[static_cast<std::size_t>(i)];
    if (left[i] > kLeastLeft * squared_norm_[candidate])
      gain[place[static_cast<std::size_t>(i)]] = all[candidate] * all[candidate] / left[i];
  }
  return gain;
}

std::vector<Complement> ComplementSearch::best(const PlacedLights& chosen, std::size_t count, double apart_m) const {
  const Eigen::VectorXd gain = gains(chosen);
  std::vector<std::size_t> order(lit_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Enough for `count` that stand apart in nearly every case; the rest is sorted only when it is needed.
  const auto by_gain = [&](std::size_t a, std::size_t b) {
    const double of_a = gain[static_cast<Eigen::Index>(a)], of_b = gain[static_cast<Eigen::Index>(b)];
    return of_a != of_b ? of_a > of_b : a < b;
  };
  std::vector<Complement> found;
  std::size_t sorted = 0;
  for (std::size_t i = 0; i < order.size() && found.size() < count; ++i) {
    if (i == sorted) {
      const std::size_t next = std::min(order.size(), std::max<std::size_t>(256, 4 * sorted));
      const auto begin = order.begin() + static_cast<std::ptrdiff_t>(sorted);
      std::partial_sort(begin, order.begin() + static_cast<std::ptrdiff_t>(next), order.end(), by_gain);
      sorted = next;
    }
    const double of = gain[static_cast<Eigen::Index>(order[i])];
    if (!(of > 0)) break;
    const auto candidate = static_cast<std::size_t>(lit_[order[i]]);
    const bool apart = std::all_of(found.begin(), found.end(), [&](const Complement& better) {
      return (places_m_[better.candidate] - places_m_[candidate]).norm() >= apart_m;
    });
    if (apart) found.push_back({candidate, of});
  }
  return found;
}

}  // namespace luxrig
