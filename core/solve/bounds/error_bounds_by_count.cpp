#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/parallel.h"
#include "core/solve/bounds/blocked_lights.h"
#include "core/solve/least_squares/nnls_of_few.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Initial prices of light between blocks are a little above a good solution's residual. Otherwise blocks with fewer
/// lights than in that solution would get it for free.
constexpr double kPriceOfGoal = 0.1;

/// Least sum of the blocks' bounds, and the number of lights in each block there.
struct LightShares {
  double squared_error = 0;
  std::vector<std::size_t> lights;  ///< by block
};

LightShares share_out_lights(const std::vector<std::vector<double>>& value, std::size_t lights) {
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
  LightShares shares{least[lights], std::vector<std::size_t>(value.size(), 0)};
  for (std::size_t b = value.size(), left = lights; b-- > 0;) {
    shares.lights[b] = taken[b][left];
    left -= taken[b][left];
  }
  return shares;
}

constexpr std::size_t kNodesAtATime = 4;

/// Bounds for all numbers of lights at one set of prices.
class PricedBounds {
 public:
  PricedBounds(const BlockedLights& lights, const VectorXd& price_of_row, const CountBoundOptions& options)
      : bounds_(lights.priced(price_of_row, options.max_lights, options.threads)),
        options_(options),
        dark_(lights.dark) {
    value_.resize(bounds_.size());
    parallel_for(bounds_.size(), options.threads, [&](std::size_t b) {
      for (std::size_t count = 0; count <= std::min(bounds_[b]->lights(), options.max_lights); ++count)
        value_[b].push_back(bounds_[b]->value(count));
    });
  }

  [[nodiscard]] double squared_error(std::size_t lights) const {
    return share_out_lights(value_, lights).squared_error + dark_;
  }

  /// Refines the bounds at the minimum until they cannot improve.
  void refine(std::size_t lights, std::size_t max_nodes) {
    for (std::size_t nodes = 0; nodes < max_nodes && !options_.watch.stop.stop_requested();) {
      const LightShares shares = share_out_lights(value_, lights);
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

  /// By row: light that blocks take from others, minus light that these send. Where positive, light is scarce and
  /// prices should rise. Half the slope of the squared error by price at `lights`.
  VectorXd scarcity(std::size_t lights, const BlockedLights& all) {
    VectorXd scarce = VectorXd::Zero(all.goal.size());
    const LightShares shares = share_out_lights(value_, lights);
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
  std::vector<std::unique_ptr<BlockBound>> bounds_;
  std::vector<std::vector<double>> value_;  ///< by block and its number of lights; more than it has are no use
  const CountBoundOptions& options_;
  double dark_;
};

/// Solutions with max_lights, three quarters, half and a quarter of it; each step adds the light whose column is
/// nearest to the residual.
std::vector<PriceGuess> greedy_guesses(const BoundProblem& of, const BlockedLights& lights, std::size_t max_lights) {
  auto shared = share_problem({of.columns, of.goal, of.row_weight, {}});
  LUXRIG_CHECK(shared.has_value(), "{}", shared.has_value() ? "" : shared.error().detail);
  const ScaledColumns& scaled = (*shared)->scaled();
  NnlsOfFew few(*shared);
  const VectorXd weight = of.weights();
  std::vector<PriceGuess> guesses;
  VectorXd pull;
  for (std::size_t k = 0; k <= max_lights; ++k) {
    const VectorXd residual = few.residual();
    if (k == max_lights || k == (max_lights + 3) / 4 || k == max_lights / 2 || k == 3 * max_lights / 4)
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

constexpr double kMinTurn = 0.05;

/// Improves prices round by round: a step along the scarcity, of the length that would close the gap to the squared
/// error reached (Polyak 1969), shorter after each overshoot.
VectorXd better_prices(const BlockedLights& lights, VectorXd price, const PriceGuess& guess, double reached,
                       const CountBoundOptions& options, double& proven) {
  VectorXd best = price;
  double turn = 1;
  proven = 0;
  for (std::size_t round = 0; round < options.price_rounds && turn > kMinTurn; ++round) {
    if (options.watch.stop.stop_requested()) break;
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

std::vector<double> error_bounds_by_count(const BoundProblem& of, const CountBoundOptions& options) {
  LUXRIG_CHECK(of.complaint().empty(), "{}", of.complaint());
  std::vector<double> bounds(options.max_lights + 1, 0.0);
  const double goal_norm = of.weights().cwiseProduct(of.goal).norm();
  if (!(goal_norm > 0)) return bounds;
  const BlockedLights lights(of, goal_norm, options.min_similarity);
  const auto prove = [&](std::size_t k, double squared_error) {
    const double error =
        std::sqrt(std::max(0.0, squared_error - rounding_of_sums(of.goal.size()))) * (1 - rounding_of_sums(1));
    bounds[k] = std::max(bounds[k], std::min(1.0, error));
  };
  prove(0, lights.goal.squaredNorm());
  std::vector<PriceGuess> guesses = options.guesses;
  if (guesses.empty()) guesses = greedy_guesses(of, lights, options.max_lights);
  for (PriceGuess& guess : guesses) {
    LUXRIG_CHECK(guess.residual.size() == of.goal.size(), "{} residuals for {} rows", guess.residual.size(),
                 of.goal.size());
    guess.lights = std::min(guess.lights, options.max_lights);
    const VectorXd residual = guess.residual / goal_norm;
    if (!residual.allFinite()) continue;
    double proven = 0;
    const VectorXd price =
        better_prices(lights, residual + kPriceOfGoal * lights.goal, guess, residual.squaredNorm(), options, proven);
    prove(guess.lights, proven);
    PricedBounds priced(lights, price, options);
    priced.refine(guess.lights, options.nodes);
    for (std::size_t k = 0; k <= options.max_lights && !options.watch.stop.stop_requested(); ++k)
      prove(k, priced.squared_error(k));
  }
  for (std::size_t k = options.max_lights; k-- > 0;) bounds[k] = std::max(bounds[k], bounds[k + 1]);
  return bounds;
}

}  // namespace luxrig
