#include "core/solve/placement/error_bound.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "core/check.h"
#include "core/parallel.h"
#include "core/solve/nnls_of_few.h"
#include "core/solve/placement/block_bound.h"
#include "core/solve/placement/light_blocks.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kRoundingUnit = std::numeric_limits<double>::epsilon();
constexpr double kShortestCandidate = 1e-140;
/// Light between blocks is worth a little more than a good solution's residual says, before prices are improved: else
/// blocks that have fewer lights than there get it for nothing.
constexpr double kPriceOfGoal = 0.1;

double rounding_of(Index rows) { return 4 * static_cast<double>(rows + 16) * kRoundingUnit; }

VectorXd weights_of(const CandidateLights& of) {
  return of.row_weight.size() > 0 ? of.row_weight : VectorXd::Ones(of.goal.size());
}

}  // namespace

std::string CandidateLights::complaint() const {
  if (goal.size() != columns.rows()) return fmt::format("{} goals for {} rows", goal.size(), columns.rows());
  if (row_weight.size() != 0 && row_weight.size() != goal.size())
    return fmt::format("{} weights for {} rows", row_weight.size(), goal.size());
  if (!light_of_column.empty() && light_of_column.size() != static_cast<std::size_t>(columns.columns()))
    return fmt::format("{} lights for {} columns", light_of_column.size(), columns.columns());
  if (std::string text = columns.complaint(); !text.empty()) return text;
  std::vector<std::uint32_t> rows;
  std::vector<double> values;
  for (Index j = 0; j < columns.columns(); ++j) {
    columns.entries(j, rows, values);
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (values[k] < 0) return fmt::format("entry ({}, {}) is {}", rows[k], j, values[k]);
  }
  for (Index i = 0; i < goal.size(); ++i) {
    if (!(std::abs(goal[i]) <= ColumnsView::kLargestEntry)) return fmt::format("goal {} is {}", i, goal[i]);
    if (row_weight.size() > 0 && !(row_weight[i] >= 0 && row_weight[i] <= 1e70))
      return fmt::format("weight {} is {}", i, row_weight[i]);
  }
  return {};
}

std::vector<Index> unreachable_rows(const CandidateLights& of) {
  std::vector<char> reached(static_cast<std::size_t>(of.goal.size()), 0);
  std::vector<std::uint32_t> rows;
  std::vector<double> values;
  for (Index j = 0; j < of.columns.columns(); ++j) {
    of.columns.entries(j, rows, values);
    for (const std::uint32_t i : rows) reached[i] = 1;
  }
  std::vector<Index> dark;
  for (Index i = 0; i < of.goal.size(); ++i)
    if (!reached[static_cast<std::size_t>(i)] && (of.row_weight.size() == 0 || of.row_weight[i] > 0)) dark.push_back(i);
  return dark;
}

double error_bound(const CandidateLights& of, const VectorXd& x) {
  LUXRIG_CHECK(of.complaint().empty(), "{}", of.complaint());
  LUXRIG_CHECK(x.size() == of.columns.columns(), "{} levels for {} columns", x.size(), of.columns.columns());
  const VectorXd weight = weights_of(of);
  const Index rows = of.goal.size();
  const double goal_norm = weight.cwiseProduct(of.goal).norm();
  if (!(goal_norm > 0)) return 0;
  const VectorXd goal = weight.cwiseProduct(of.goal) / goal_norm;

  using Long = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  Long exact = of.goal.cast<long double>();
  for (Index j = 0; j < x.size(); ++j)
    if (x[j] > 0 && std::isfinite(x[j])) of.columns.add(j, -static_cast<long double>(x[j]), exact.data());
  VectorXd y = (weight.cast<long double>().cwiseProduct(exact) / static_cast<long double>(goal_norm)).cast<double>();
  if (!y.allFinite()) y = goal;

  // Aᵀ W y ≤ 0 is what makes y a proof. It is nearly so; y lowered by the same everywhere makes it so: a column of norm
  // 1 sums to 1 at least.
  VectorXd reached = VectorXd::Ones(rows);
  for (const Index i : unreachable_rows(of)) reached[i] = 0;
  const VectorXd vector = weight.cwiseProduct(y), sum = weight.cwiseProduct(reached), size = vector.cwiseAbs();
  const VectorXd ones = VectorXd::Ones(x.size());
  VectorXd pull(x.size()), sums(x.size()), sizes(x.size());
  of.columns.dot_all(vector.data(), ones.data(), pull.data());
  of.columns.dot_all(sum.data(), ones.data(), sums.data());
  of.columns.dot_all(size.data(), ones.data(), sizes.data());
  const double rounding = rounding_of(rows);
  double lower = 0;
  for (Index j = 0; j < x.size(); ++j)
    if (sums[j] > 0) lower = std::max(lower, (pull[j] + rounding * sizes[j]) / sums[j]);
  y -= lower * (1 + 4 * rounding) * reached;

  // Any multiple of y proves as well; the best proves yᵀb / ‖y‖.
  const double norm = y.norm();
  if (!(norm > 0)) return 0;
  const double proven = (y.dot(goal) - rounding * y.cwiseAbs().dot(goal.cwiseAbs())) / norm;
  return std::clamp(proven * (1 - rounding), 0.0, 1.0);
}

namespace {

/// All columns with norm 1 and a goal of norm 1, in W; lights in blocks.
struct BlockedLights {
  /// What one column does in one block.
  struct Piece {
    std::uint32_t block = 0;
    std::vector<std::uint32_t> row;  ///< of the block
    std::vector<double> value;
  };
  struct Column {
    std::vector<Piece> pieces;
    double most = 0;  ///< level
    std::uint32_t number = 0;
  };
  LightBlocks blocks;
  VectorXd goal;
  std::vector<std::vector<Column>> of_light;
  std::vector<std::uint32_t> light_of;  ///< of each column
  std::vector<std::vector<Index>> rows_of_block;
  std::vector<std::uint32_t> row_in_block;
  double dark = 0;  ///< squared error of what nothing reaches

  BlockedLights(const CandidateLights& of, double goal_norm, double least_similarity);
  [[nodiscard]] Column cut(std::span<const std::uint32_t> rows, std::span<const double> values) const;
  [[nodiscard]] double price(const Piece& piece, const VectorXd& price_of_row) const;
  [[nodiscard]] std::vector<std::unique_ptr<BlockBound>> priced(const VectorXd& price_of_row, std::size_t most_lights,
                                                                int threads) const;
};

BlockedLights::BlockedLights(const CandidateLights& of, double goal_norm, double least_similarity) {
  const VectorXd weight = weights_of(of);
  goal = weight.cwiseProduct(of.goal) / goal_norm;
  std::vector<std::uint32_t> light = of.light_of_column;
  if (light.empty()) {
    light.resize(static_cast<std::size_t>(of.columns.columns()));
    std::iota(light.begin(), light.end(), 0u);
  }
  std::size_t lights = 0;
  for (const std::uint32_t l : light) lights = std::max<std::size_t>(lights, l + std::size_t{1});
  blocks = light_blocks(of.columns, weight, light, lights, least_similarity);
  rows_of_block.resize(blocks.count);
  row_in_block.assign(static_cast<std::size_t>(goal.size()), 0);
  for (Index i = 0; i < goal.size(); ++i) {
    const std::uint32_t block = blocks.of_row[static_cast<std::size_t>(i)];
    if (block == kNoBlock) {
      dark += goal[i] * goal[i];
      continue;
    }
    row_in_block[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(rows_of_block[block].size());
    rows_of_block[block].push_back(i);
  }
  of_light.resize(lights);
  light_of.assign(light.size(), 0);
  std::vector<std::uint32_t> rows;
  std::vector<double> values;
  for (Index j = 0; j < of.columns.columns(); ++j) {
    of.columns.entries(j, rows, values);
    double largest = 0, squares = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      values[k] *= weight[rows[k]];
      largest = std::max(largest, values[k]);
    }
    if (!(largest > kShortestCandidate)) continue;
    for (double& value : values) {
      value /= largest;
      squares += value * value;
    }
    for (double& value : values) value /= std::sqrt(squares);
    of_light[light[static_cast<std::size_t>(j)]].push_back(cut(rows, values));
    of_light[light[static_cast<std::size_t>(j)]].back().number = static_cast<std::uint32_t>(j);
    light_of[static_cast<std::size_t>(j)] = light[static_cast<std::size_t>(j)];
  }
}

BlockedLights::Column BlockedLights::cut(std::span<const std::uint32_t> rows, std::span<const double> values) const {
  Column column;
  double goal_squares = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!(values[k] > 0)) continue;
    goal_squares += std::pow(std::max(0.0, goal[rows[k]]), 2);
    const std::uint32_t block = blocks.of_row[rows[k]];
    auto piece =
        std::find_if(column.pieces.begin(), column.pieces.end(), [&](const Piece& p) { return p.block == block; });
    if (piece == column.pieces.end()) piece = column.pieces.insert(piece, Piece{block, {}, {}});
    piece->row.push_back(row_in_block[rows[k]]);
    piece->value.push_back(values[k]);
  }
  // Dark, the error is 1. What is no worse does not light these points by more than goal and error together.
  column.most = (1 + std::sqrt(goal_squares)) * (1 + 1e-9);
  return column;
}

double BlockedLights::price(const Piece& piece, const VectorXd& price_of_row) const {
  double sum = 0;
  for (std::size_t k = 0; k < piece.row.size(); ++k)
    sum += piece.value[k] * price_of_row[rows_of_block[piece.block][piece.row[k]]];
  return sum;
}

std::vector<std::unique_ptr<BlockBound>> BlockedLights::priced(const VectorXd& price_of_row, std::size_t most_lights,
                                                               int threads) const {
  std::vector<std::vector<BlockLight>> home(blocks.count), foreign(blocks.count);
  for (std::size_t l = 0; l < of_light.size(); ++l) {
    std::vector<BlockLight> in(blocks.count);
    const std::uint32_t at_home = blocks.of_light[l];
    for (const Column& column : of_light[l]) {
      const bool is_home = std::any_of(column.pieces.begin(), column.pieces.end(),
                                       [&](const Piece& piece) { return piece.block == at_home; });
      double elsewhere = 0;
      for (const Piece& piece : column.pieces) {
        BlockLight& there = in[piece.block];
        there.row.push_back(piece.row);
        there.value.push_back(piece.value);
        there.most.push_back(column.most);
        there.column.push_back(column.number);
        // An emitter that is not seen at home saves nothing there, so it pays nothing elsewhere.
        const double paid = is_home && piece.block != at_home ? price(piece, price_of_row) : 0;
        there.price.push_back(paid);
        elsewhere += paid;
      }
      if (is_home) in[at_home].price.back() = elsewhere;
    }
    for (std::size_t b = 0; b < blocks.count; ++b)
      if (!in[b].row.empty()) (b == at_home ? home : foreign)[b].push_back(std::move(in[b]));
  }
  std::vector<std::unique_ptr<BlockBound>> bounds(blocks.count);
  parallel_for(blocks.count, threads, [&](std::size_t b) {
    VectorXd block_goal(static_cast<Index>(rows_of_block[b].size()));
    for (std::size_t i = 0; i < rows_of_block[b].size(); ++i)
      block_goal[static_cast<Index>(i)] = goal[rows_of_block[b][i]];
    bounds[b] =
        std::make_unique<BlockBound>(block_goal, std::move(home[b]), foreign[b], most_lights, rounding_of(goal.size()));
  });
  return bounds;
}

/// Squared error, and how many lights each block has, where the blocks' bounds are least together.
struct Shares {
  double squared_error = 0;
  std::vector<std::size_t> lights;  ///< by block
};

Shares share_out(const std::vector<std::vector<double>>& value, std::size_t lights) {
  std::vector<double> least(lights + 1, 0.0);
  std::vector<std::vector<std::size_t>> taken(value.size(), std::vector<std::size_t>(lights + 1, 0));
  for (std::size_t b = 0; b < value.size(); ++b) {
    std::vector<double> next(lights + 1, std::numeric_limits<double>::infinity());
    for (std::size_t all = 0; all <= lights; ++all)
      for (std::size_t here = 0; here <= all && here < value[b].size(); ++here)
        if (const double sum = least[all - here] + value[b][here]; sum < next[all]) {
          next[all] = sum;
          taken[b][all] = here;
        }
    least.swap(next);
  }
  Shares shares{least[lights], std::vector<std::size_t>(value.size(), 0)};
  for (std::size_t b = value.size(), left = lights; b-- > 0;) {
    shares.lights[b] = taken[b][left];
    left -= taken[b][left];
  }
  return shares;
}

constexpr std::size_t kNodesAtATime = 4;

/// The bounds of all numbers of lights under one set of prices.
class PricedBounds {
 public:
  PricedBounds(const BlockedLights& lights, const VectorXd& price_of_row, const CountBoundOptions& options)
      : bounds_(lights.priced(price_of_row, options.most_lights, options.threads)),
        options_(options),
        dark_(lights.dark) {
    value_.resize(bounds_.size());
    parallel_for(bounds_.size(), options.threads, [&](std::size_t b) { learn(b, 1); });
  }

  double squared_error(std::size_t lights) {
    for (;;) {
      const Shares shares = share_out(value_, lights);
      std::vector<char> unknown(bounds_.size(), 0);
      parallel_for(bounds_.size(), options_.threads, [&](std::size_t b) {
        unknown[b] = shares.lights[b] + 1 == value_[b].size() && learn(b, value_[b].size()) ? 1 : 0;
      });
      if (std::count(unknown.begin(), unknown.end(), 1) == 0) return shares.squared_error + dark_;
    }
  }

  /// Where the least is, is looked into, until nothing there can be told better.
  void refine(std::size_t lights, std::size_t most_nodes) {
    for (std::size_t nodes = 0; nodes < most_nodes && !options_.stop.stop_requested();) {
      squared_error(lights);
      const Shares shares = share_out(value_, lights);
      std::vector<std::size_t> before(bounds_.size()), after(bounds_.size());
      parallel_for(bounds_.size(), options_.threads, [&](std::size_t b) {
        before[b] = bounds_[b]->nodes();
        bounds_[b]->refine(shares.lights[b], kNodesAtATime);
        after[b] = bounds_[b]->nodes();
        value_[b][shares.lights[b]] = bounds_[b]->value(shares.lights[b]);
      });
      std::size_t done = 0;
      for (std::size_t b = 0; b < bounds_.size(); ++b) done += after[b] - before[b];
      if (done == 0) return;
      nodes += done;
    }
  }

  /// By how much, by row, light that blocks take from others exceeds what these send: where it is scarce, and prices
  /// should rise. Half the slope of the squared error by price, where `lights` are.
  VectorXd scarcity(std::size_t lights, const BlockedLights& all) {
    VectorXd scarce = VectorXd::Zero(all.goal.size());
    const Shares shares = share_out(value_, lights);
    for (std::size_t b = 0; b < bounds_.size(); ++b)
      for (const BurningColumn& burning : bounds_[b]->burning(shares.lights[b])) {
        const std::uint32_t light = all.light_of[burning.column];
        const auto& columns = all.of_light[light];
        const auto column =
            std::find_if(columns.begin(), columns.end(), [&](const auto& c) { return c.number == burning.column; });
        const std::uint32_t at_home = all.blocks.of_light[light];
        if (std::none_of(column->pieces.begin(), column->pieces.end(),
                         [&](const auto& piece) { return piece.block == at_home; }))
          continue;  // it has no price
        for (const auto& piece : column->pieces) {
          if (piece.block == at_home || (!burning.home && piece.block != b)) continue;
          for (std::size_t k = 0; k < piece.row.size(); ++k)
            scarce[all.rows_of_block[piece.block][piece.row[k]]] +=
                (burning.home ? -1 : 1) * burning.level * piece.value[k];
        }
      }
    return scarce;
  }

 private:
  /// False when the block has no more lights. value_[b][c] is known for c below its size; more lights than that are
  /// taken as those, after a look whether one more pays.
  bool learn(std::size_t b, std::size_t count) {
    while (value_[b].size() <= count) {
      if (value_[b].size() > std::min(bounds_[b]->lights(), options_.most_lights)) return false;
      value_[b].push_back(bounds_[b]->value(value_[b].size()));
    }
    return true;
  }

  std::vector<std::unique_ptr<BlockBound>> bounds_;
  std::vector<std::vector<double>> value_;
  const CountBoundOptions& options_;
  double dark_;
};

/// Solutions of most_lights, three quarters, half and a quarter of it: each time the light whose column is nearest to
/// what is left over.
std::vector<PriceGuess> greedy_guesses(const CandidateLights& of, const BlockedLights& lights,
                                       std::size_t most_lights) {
  auto shared = share_problem({of.columns, of.goal, of.row_weight, {}});
  LUXRIG_CHECK(shared.has_value(), "{}", shared.has_value() ? "" : shared.error().detail);
  const ScaledColumns& scaled = (*shared)->scaled();
  NnlsOfFew few(*shared);
  const VectorXd weight = weights_of(of);
  std::vector<PriceGuess> guesses;
  VectorXd pull;
  for (std::size_t k = 0; k <= most_lights; ++k) {
    const VectorXd residual = few.residual();
    if (k == most_lights || k == (most_lights + 3) / 4 || k == most_lights / 2 || k == 3 * most_lights / 4)
      guesses.push_back({k, weight.cwiseProduct(residual)});
    scaled.gradient(residual, pull);
    double best = 0;
    const std::vector<BlockedLights::Column>* taken = nullptr;
    for (const auto& columns : lights.of_light) {
      double squares = 0;
      for (const auto& column : columns) squares += std::pow(std::max(0.0, pull[column.number]), 2);
      if (!(squares > best)) continue;
      best = squares;
      taken = &columns;
    }
    if (taken == nullptr) break;
    for (const auto& column : *taken) few.add(column.number);
  }
  return guesses;
}

constexpr double kLeastTurn = 0.05;

/// Prices that prove more, from round to round: a step along the scarcity, as long as would close the gap to the
/// squared error that was reached (Polyak 1969), shorter each time that it went too far.
VectorXd better_prices(const BlockedLights& lights, VectorXd price, const PriceGuess& guess, double reached,
                       const CountBoundOptions& options, double& proven) {
  VectorXd best = price;
  double turn = 1;
  proven = 0;
  for (std::size_t round = 0; round < options.price_rounds && turn > kLeastTurn; ++round) {
    if (options.stop.stop_requested()) break;
    PricedBounds priced(lights, price, options);
    priced.refine(guess.lights, options.nodes_a_round);
    const double value = priced.squared_error(guess.lights);
    const VectorXd scarce = priced.scarcity(guess.lights, lights);
    if (round == 0 || value > proven) {
      proven = value;
      best = price;
    } else {
      turn *= 0.7;
    }
    const double slope = 2 * scarce.squaredNorm();
    if (!(slope > 0) || !(reached > value)) break;
    price += turn * (reached - value) / slope * scarce;
  }
  return best;
}

}  // namespace

std::vector<double> error_bounds_by_count(const CandidateLights& of, const CountBoundOptions& options) {
  LUXRIG_CHECK(of.complaint().empty(), "{}", of.complaint());
  std::vector<double> bounds(options.most_lights + 1, 0.0);
  const double goal_norm = weights_of(of).cwiseProduct(of.goal).norm();
  if (!(goal_norm > 0)) return bounds;
  const BlockedLights lights(of, goal_norm, options.least_similarity);
  const auto prove = [&](std::size_t k, double squared_error) {
    const double error = std::sqrt(std::max(0.0, squared_error)) * (1 - rounding_of(1));
    bounds[k] = std::max(bounds[k], std::min(1.0, error));
  };
  prove(0, lights.goal.squaredNorm() - rounding_of(of.goal.size()));
  std::vector<PriceGuess> guesses = options.guesses;
  if (guesses.empty()) guesses = greedy_guesses(of, lights, options.most_lights);
  for (PriceGuess& guess : guesses) {
    LUXRIG_CHECK(guess.residual.size() == of.goal.size(), "{} residuals for {} rows", guess.residual.size(),
                 of.goal.size());
    guess.lights = std::min(guess.lights, options.most_lights);
    const VectorXd residual = guess.residual / goal_norm;
    if (!residual.allFinite()) continue;
    double proven = 0;
    const VectorXd price =
        better_prices(lights, residual + kPriceOfGoal * lights.goal, guess, residual.squaredNorm(), options, proven);
    prove(guess.lights, proven);
    PricedBounds priced(lights, price, options);
    priced.refine(guess.lights, options.nodes);
    for (std::size_t k = 0; k <= options.most_lights && !options.stop.stop_requested(); ++k)
      prove(k, priced.squared_error(k));
  }
  for (std::size_t k = options.most_lights; k-- > 0;) bounds[k] = std::max(bounds[k], bounds[k + 1]);
  return bounds;
}

}  // namespace luxrig
