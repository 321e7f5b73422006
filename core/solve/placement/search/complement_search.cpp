#include "core/solve/placement/search/complement_search.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.h"

namespace luxrig {
namespace {

using ByCandidate = ComplementSearch::ByCandidate;

/// A column with less than this share of its square left is a mix of the chosen ones: it gains only rounding.
constexpr double kMinLeft = 1e-4;

/// Columns per block: a megabyte with 300 points.
constexpr std::size_t kBlock = 512;

const double kSameWay = std::cos(rad_from_deg(30));

/// Columns nearer than this to a mix of the others add nothing to the span: their products would be rounding.
constexpr double kOwnShare = 1e-6;

/// ‖Qᵀa‖² for any a from its products g = Aᵀa, where Q is an orthonormal basis of columns A. With A P = Q R it is ‖R⁻ᵀ
/// Pᵀ g‖².
class SquareWithin {
 public:
  explicit SquareWithin(const Eigen::MatrixXd& columns) {
    if (columns.cols() == 0) return;
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor;
    factor.setThreshold(kOwnShare);
    factor.compute(columns);
    const Eigen::Index rank = factor.rank();
    order_ = factor.colsPermutation().indices().head(rank).cast<Eigen::Index>();
    inverse_ = factor.matrixR()
                   .topLeftCorner(rank, rank)
                   .triangularView<Eigen::Upper>()
                   .solve(Eigen::MatrixXd::Identity(rank, rank));
    within_.resize(rank);
  }
  /// Where walls separate them, most lights share no points with most candidates.
  [[nodiscard]] double of(const double* products, std::span<const Eigen::Index> column) {
    const Eigen::Index rank = within_.size();
    within_.setZero();
    for (Eigen::Index k = 0; k < rank; ++k) {
      const double product = products[column[static_cast<std::size_t>(order_[k])]];
      if (product != 0) within_.tail(rank - k) += product * inverse_.row(k).tail(rank - k).transpose();
    }
    return within_.squaredNorm();
  }

 private:
  Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1> order_;
  ByCandidate inverse_;
  Eigen::VectorXd within_;
};

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

/// Products of each lit candidate's column with vectors over points: candidates × vectors. A block of columns stays in
/// the cache while all vectors pass over it.
ComplementSearch::ByCandidate ComplementSearch::products(const Eigen::MatrixXd& vectors) const {
  constexpr Eigen::Index kTile = ColumnsView::kTile;
  const Eigen::Index tiles = (vectors.cols() + kTile - 1) / kTile, tile_size = kTile * vectors.rows();
  std::vector<double> in_tiles(static_cast<std::size_t>(tiles * tile_size), 0.0);
  for (Eigen::Index k = 0; k < vectors.cols(); ++k)
    for (Eigen::Index row = 0; row < vectors.rows(); ++row)
      in_tiles[static_cast<std::size_t>(k / kTile * tile_size + kTile * row + k % kTile)] = vectors(row, k);
  ByCandidate of_all(static_cast<Eigen::Index>(lit_.size()), vectors.cols());
  std::vector<double> of_block(kTile * kBlock);
  for (std::size_t first = 0; first < lit_.size(); first += kBlock) {
    const auto block = std::span(lit_).subspan(first, std::min(kBlock, lit_.size() - first));
    for (Eigen::Index tile = 0; tile < tiles; ++tile) {
      columns_.dot_tile(block, in_tiles.data() + tile * tile_size, of_block.data());
      const Eigen::Index used = std::min(kTile, vectors.cols() - kTile * tile);
      for (std::size_t i = 0; i < block.size(); ++i)
        for (Eigen::Index k = 0; k < used; ++k)
          of_all(static_cast<Eigen::Index>(first + i), kTile * tile + k) =
              of_block[static_cast<std::size_t>(kTile) * i + static_cast<std::size_t>(k)];
    }
  }
  return of_all;
}

ComplementSearch::About ComplementSearch::about(const PlacedLights& lights) const {
  const Eigen::Index points = columns_.rows(), channels = goal_->channels(), emitters = goal_->emitters.cols();
  Eigen::MatrixXd vectors(points * channels, lights.columns().cols() + 1);
  vectors << lights.columns(), lights.residual();
  vectors = row_weight_.asDiagonal() * vectors;
  About about{&lights, {}};
  for (Eigen::Index c = 0; c < channels; ++c) {
    const ByCandidate of_channel = products(vectors.middleRows(c * points, points));
    for (Eigen::Index e = 0; e < emitters; ++e) {
      if (c == 0)
        about.products.push_back(goal_->emitters(c, e) * of_channel);
      else if (goal_->emitters(c, e) != 0)
        about.products[static_cast<std::size_t>(e)] += goal_->emitters(c, e) * of_channel;
    }
  }
  return about;
}

Eigen::VectorXd ComplementSearch::gains(const About& about, std::initializer_list<std::size_t> without,
                                        const PlacedLights& chosen) const {
  const auto lit = static_cast<Eigen::Index>(lit_.size());
  const Eigen::Index of_each = chosen.emitters(), all = about.lights->columns().cols();
  LUXRIG_CHECK(about.lights->size() == chosen.size() + without.size(), "{} lights, {} of them chosen, {} not",
               about.lights->size(), chosen.size(), without.size());
  // Over all lights' columns: differences of levels, and the columns in use.
  Eigen::RowVectorXd less = Eigen::RowVectorXd::Zero(all + 1);
  less.head(all) = about.lights->levels().transpose();
  less[all] = 1;
  std::vector<Eigen::Index> used_of_all, used;
  for (Eigen::Index k = 0, of_chosen = 0; k < all; ++k) {
    if (std::find(without.begin(), without.end(), static_cast<std::size_t>(k / of_each)) != without.end()) continue;
    less[k] -= chosen.levels()[of_chosen];
    if (chosen.levels()[of_chosen] > 0) {
      used_of_all.push_back(k);
      used.push_back(of_chosen);
    }
    ++of_chosen;
  }
  SquareWithin used_lights(chosen.columns()(Eigen::all, used));
  Eigen::VectorXd gain = Eigen::VectorXd::Zero(lit);
  for (std::size_t e = 0; e < about.products.size(); ++e) {
    const ByCandidate& products = about.products[e];
    for (Eigen::Index i = 0; i < lit; ++i) {
      // Levels cannot fall below 0: an emitter without a pull gains nothing, whatever the chosen lights do.
      const double pull = products.row(i).dot(less);
      if (!(pull > 0)) continue;
      const double whole = squared_norm_(i, static_cast<Eigen::Index>(e));
      const double left = whole - used_lights.of(products.row(i).data(), used_of_all);
      if (left > kMinLeft * whole) gain[i] += pull * pull / left;
    }
  }
  return gain;
}

std::vector<Complement> ComplementSearch::best(const PlacedLights& chosen, std::size_t count, double apart_m) const {
  return best(about(chosen), {}, chosen, count, apart_m);
}

std::vector<Complement> ComplementSearch::best(const About& about, std::initializer_list<std::size_t> without,
                                               const PlacedLights& chosen, std::size_t count, double apart_m) const {
  const Eigen::VectorXd gain = gains(about, without, chosen);
  std::vector<std::size_t> order(lit_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Nearly always enough for `count` that stand apart; the rest is sorted only if needed.
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
