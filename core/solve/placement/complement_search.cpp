#include "core/solve/placement/complement_search.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.h"

namespace luxrig {
namespace {

/// A column with less than this left of its square is a mix of the chosen ones: nothing but rounding to gain.
constexpr double kLeastLeft = 1e-4;

const double kSameWay = std::cos(rad_from_deg(30));

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

ComplementSearch::ComplementSearch(const ColumnsView& columns, std::span<const LightPose> poses,
                                   const LightingGoal& goal)
    : columns_(columns), poses_(poses), goal_(&goal), row_weight_(goal.row_weight) {
  LUXRIG_CHECK(static_cast<std::size_t>(columns.columns()) == poses.size(), "{} columns, {} poses", columns.columns(),
               poses.size());
  LUXRIG_CHECK(columns.rows() * goal.channels() == goal.lux.size(), "{} rows, {} goals", columns.rows(),
               goal.lux.size());
  if (row_weight_.size() == 0) row_weight_ = Eigen::VectorXd::Ones(goal.lux.size());
  const Eigen::MatrixXd emitters = goal.emitters.cwiseAbs2();
  Eigen::VectorXd of_channel(goal.channels());
  squared_norm_.resize(columns.columns(), emitters.cols());
  const Eigen::MatrixXd squared_weight = row_weight_.cwiseAbs2().reshaped(columns.rows(), goal.channels());
  for (ColumnsView::Index c = 0; c < columns.columns(); ++c) {
    for (Eigen::Index k = 0; k < of_channel.size(); ++k)
      of_channel[k] = columns.squared_norm(c, squared_weight.col(k).data());
    const auto row = static_cast<Eigen::Index>(lit_.size());
    squared_norm_.row(row) = of_channel.transpose() * emitters;
    if (squared_norm_.row(row).maxCoeff() > 0) lit_.push_back(c);
  }
  squared_norm_.conservativeResize(static_cast<Eigen::Index>(lit_.size()), Eigen::NoChange);
}

/// With vectors over points: columns × vectors.
Eigen::MatrixXd ComplementSearch::products(const std::vector<ColumnsView::Index>& columns,
                                           const Eigen::MatrixXd& vectors) const {
  constexpr Eigen::Index kTile = ColumnsView::kTile;
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd of_all(count, vectors.cols());
  std::vector<double> tile(static_cast<std::size_t>(kTile * vectors.rows()));
  std::vector<double> of_tile(static_cast<std::size_t>(kTile * count));
  for (Eigen::Index first = 0; first < vectors.cols(); first += kTile) {
    const Eigen::Index used = std::min(kTile, vectors.cols() - first);
    for (Eigen::Index row = 0; row < vectors.rows(); ++row)
      for (Eigen::Index k = 0; k < kTile; ++k)
        tile[static_cast<std::size_t>(kTile * row + k)] = k < used ? vectors(row, first + k) : 0;
    columns_.dot_tile(columns, tile.data(), of_tile.data());
    for (Eigen::Index k = 0; k < used; ++k)
      for (Eigen::Index i = 0; i < count; ++i) of_all(i, first + k) = of_tile[static_cast<std::size_t>(kTile * i + k)];
  }
  return of_all;
}

Eigen::VectorXd ComplementSearch::gains(const PlacedLights& chosen) const {
  const auto lit = static_cast<Eigen::Index>(lit_.size());
  const Eigen::Index points = columns_.rows(), channels = goal_->channels(), emitters = goal_->emitters.cols();
  // Levels cannot fall below 0: an emitter that does not pull gains nothing, whatever the chosen lights do.
  const Eigen::VectorXd weighted_residual = row_weight_.cwiseProduct(chosen.residual());
  const Eigen::MatrixXd pull = products(lit_, weighted_residual.reshaped(points, channels)) * goal_->emitters;
  std::vector<Eigen::Index> place;
  std::vector<ColumnsView::Index> pulling;
  for (Eigen::Index i = 0; i < lit; ++i) {
    if (!(pull.row(i).maxCoeff() > 0)) continue;
    place.push_back(i);
    pulling.push_back(lit_[static_cast<std::size_t>(i)]);
  }

  const Eigen::MatrixXd basis = row_weight_.asDiagonal() * basis_of(chosen);
  const auto count = static_cast<Eigen::Index>(pulling.size());
  Eigen::MatrixXd left(count, emitters);
  for (Eigen::Index i = 0; i < count; ++i) left.row(i) = squared_norm_.row(place[static_cast<std::size_t>(i)]);
  if (basis.cols() == 0) {
    // Nothing is chosen yet.
  } else if (channels == 1) {
    const Eigen::VectorXd of_basis = products(pulling, basis).rowwise().squaredNorm();
    left -= of_basis * goal_->emitters.cwiseAbs2();
  } else {
    std::vector<Eigen::MatrixXd> of_channel;
    for (Eigen::Index c = 0; c < channels; ++c)
      of_channel.push_back(products(pulling, basis.middleRows(c * points, points)));
    for (Eigen::Index e = 0; e < emitters; ++e) {
      Eigen::MatrixXd of_emitter = Eigen::MatrixXd::Zero(count, basis.cols());
      for (Eigen::Index c = 0; c < channels; ++c)
        if (goal_->emitters(c, e) != 0) of_emitter += goal_->emitters(c, e) * of_channel[static_cast<std::size_t>(c)];
      left.col(e) -= of_emitter.rowwise().squaredNorm();
    }
  }
  Eigen::VectorXd gain = Eigen::VectorXd::Zero(lit);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index at = place[static_cast<std::size_t>(i)];
    for (Eigen::Index e = 0; e < emitters; ++e)
      if (pull(at, e) > 0 && left(i, e) > kLeastLeft * squared_norm_(at, e))
        gain[at] += pull(at, e) * pull(at, e) / left(i, e);
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
      const LightPose &first = poses_[better.candidate], &second = poses_[candidate];
      return (first.position_world_m - second.position_world_m).norm() >= apart_m ||
             first.aim_world.dot(second.aim_world) < kSameWay;
    });
    if (apart) found.push_back({candidate, of});
  }
  return found;
}

}  // namespace luxrig
