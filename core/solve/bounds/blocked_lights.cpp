#include "core/solve/bounds/blocked_lights.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kShortestCandidate = 1e-140;

}  // namespace

BlockedLights::BlockedLights(const BoundProblem& of, double goal_norm, double min_similarity) {
  const VectorXd weight = of.weights();
  goal = weight.cwiseProduct(of.goal) / goal_norm;
  std::vector<std::uint32_t> light = of.light_of_column;
  if (light.empty()) {
    light.resize(static_cast<std::size_t>(of.columns.columns()));
    std::iota(light.begin(), light.end(), 0u);
  }
  std::size_t lights = 0;
  for (const std::uint32_t l : light) lights = std::max<std::size_t>(lights, l + std::size_t{1});
  blocks = light_blocks(of.columns, weight, light, lights, min_similarity);
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
  // With no light the error is 1. A solution that is no worse lights these points by at most goal and error together.
  column.most = (1 + std::sqrt(goal_squares)) * (1 + 1e-9);
  return column;
}

double BlockedLights::price(const Piece& piece, const VectorXd& price_of_row) const {
  double sum = 0;
  for (std::size_t k = 0; k < piece.row.size(); ++k)
    sum += piece.value[k] * price_of_row[rows_of_block[piece.block][piece.row[k]]];
  return sum;
}

std::vector<std::unique_ptr<BlockBound>> BlockedLights::priced(const VectorXd& price_of_row, std::size_t max_lights,
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
        // An emitter that does not reach its home block saves nothing there, so it pays nothing elsewhere.
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
    bounds[b] = std::make_unique<BlockBound>(block_goal, std::move(home[b]), foreign[b], max_lights,
                                             rounding_of_sums(goal.size()));
  });
  return bounds;
}

}  // namespace luxrig
