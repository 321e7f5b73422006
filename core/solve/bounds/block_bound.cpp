#include "core/solve/bounds/block_bound.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Goal of the price row, in norms of the block's goal. It is so large that the row's own residual hardly changes, like
/// a linear term.
constexpr double kPriceGoal = 300;
/// A column that pulls less than this, in norms of the goal, is not taken up: its charge is negligible.
constexpr double kMinPull = 1e-6;
constexpr int kMaxTakenUp = 400;

bool later(double a, double b) { return a > b; }

}  // namespace

BlockBound::BlockBound(const VectorXd& goal, std::vector<BlockLight> home, const std::vector<BlockLight>& foreign,
                       std::size_t max_foreign, double rounding)
    : goal_(goal), home_(home.size()), max_foreign_(max_foreign), rounding_(rounding) {
  sort_into_cells(home);
  const auto prices_row = static_cast<std::uint32_t>(goal.size());
  const auto is_priced = [](const BlockLight& light) {
    return std::any_of(light.price.begin(), light.price.end(), [](double price) { return price != 0; });
  };
  const bool priced =
      std::any_of(home.begin(), home.end(), is_priced) || std::any_of(foreign.begin(), foreign.end(), is_priced);
  price_goal_ = priced ? kPriceGoal * std::max(goal.norm(), 1e-3) : 0;
  const auto take = [&](const BlockLight& light, double sign) {
    column_begin_.push_back(static_cast<std::uint32_t>(max_.size()));
    for (std::size_t c = 0; c < light.row.size(); ++c) {
      double squares = 0;
      for (std::size_t k = 0; k < light.row[c].size(); ++k) {
        row_.push_back(light.row[c][k]);
        value_.push_back(light.value[c][k]);
        squares += light.value[c][k] * light.value[c][k];
      }
      if (priced) {
        row_.push_back(prices_row);
        value_.push_back(sign * light.price[c] / price_goal_);
        price_norm_ = std::max(price_norm_, std::abs(light.price[c]));
      }
      begin_.push_back(row_.size());
      max_.push_back(light.most[c]);
      number_.push_back(light.column[c]);
      inverse_norm_.push_back(squares > 0 ? 1 / std::sqrt(squares) : 0);
    }
  };
  for (const BlockLight& light : home) take(light, 1);
  home_columns_ = max_.size();
  for (const BlockLight& light : foreign) take(light, -1);
  column_begin_.push_back(static_cast<std::uint32_t>(max_.size()));

  NnlsProblem problem;
  problem.columns = ColumnsView(goal.size() + (priced ? 1 : 0), begin_, row_, std::span<const double>(value_));
  problem.goal = goal;
  if (priced) {
    problem.goal.conservativeResize(goal.size() + 1);
    problem.goal[goal.size()] = price_goal_;
  }
  auto shared = share_problem(problem);
  LUXRIG_CHECK(shared.has_value(), "{}", shared.has_value() ? "" : shared.error().detail);
  few_ = std::make_unique<NnlsOfFew>(*shared);
  product_.resize(static_cast<Index>(max_.size()));
}

/// Recursive halving: each light goes to the nearer of two lights that are far apart.
std::uint32_t BlockBound::cell_of(std::vector<std::uint32_t>& order, std::uint32_t first, std::uint32_t count) {
  const auto index = static_cast<std::uint32_t>(cells_.size());
  cells_.push_back({first, count});
  if (count < 2) return index;
  const auto begin = order.begin() + first;
  // The view shows the lights' first columns, of norm 1, in their own order; sort_into_cells made it.
  const ColumnsView lights(goal_.size(), begin_, row_, std::span<const double>(value_));
  const auto dots_with = [&](std::uint32_t light) {
    VectorXd dense = VectorXd::Zero(goal_.size()), result(static_cast<Index>(count));
    lights.add(light, 1.0, dense.data());
    for (std::uint32_t k = 0; k < count; ++k) result[k] = lights.dot(*(begin + k), dense.data());
    return result;
  };
  const auto farthest = [&](std::uint32_t light) {
    Index at = 0;
    dots_with(light).minCoeff(&at);
    return *(begin + at);
  };
  const std::uint32_t one = farthest(*begin), other = farthest(one);
  const VectorXd side = dots_with(one) - dots_with(other);
  std::vector<std::pair<double, std::uint32_t>> sorted;
  for (std::uint32_t k = 0; k < count; ++k) sorted.emplace_back(side[k], *(begin + k));
  std::sort(sorted.begin(), sorted.end());
  std::transform(sorted.begin(), sorted.end(), begin, [](const auto& s) { return s.second; });
  const std::uint32_t left = cell_of(order, first, count / 2);
  const std::uint32_t right = cell_of(order, first + count / 2, count - count / 2);
  cells_[index].left = left;
  cells_[index].right = right;
  return index;
}

void BlockBound::sort_into_cells(std::vector<BlockLight>& home) {
  for (const BlockLight& light : home) {
    if (!light.row.empty()) {
      const double norm =
          Eigen::Map<const VectorXd>(light.value[0].data(), static_cast<Index>(light.value[0].size())).norm();
      for (std::size_t k = 0; k < light.row[0].size(); ++k) {
        row_.push_back(light.row[0][k]);
        value_.push_back(light.value[0][k] / std::max(norm, 1e-300));
      }
    }
    begin_.push_back(row_.size());
  }
  std::vector<std::uint32_t> order(home.size());
  std::iota(order.begin(), order.end(), 0u);
  if (!home.empty()) root_ = cell_of(order, 0, static_cast<std::uint32_t>(home.size()));
  std::vector<BlockLight> sorted;
  for (const std::uint32_t light : order) sorted.push_back(std::move(home[light]));
  home.swap(sorted);
  begin_ = {0};
  row_.clear();
  value_.clear();
}

/// Writes product_ for a range of columns.
void BlockBound::products(std::size_t first, std::size_t columns, const VectorXd& vector) {
  if (columns == 0) return;
  static constexpr std::size_t kPart = 4096;
  static const std::vector<double> ones(kPart, 1.0);
  for (std::size_t at = first; at < first + columns; at += kPart) {
    const std::size_t part = std::min(kPart, first + columns - at);
    const ColumnsView range(vector.size(), std::span(begin_).subspan(at, part + 1), row_,
                            std::span<const double>(value_));
    range.dot_all(vector.data(), ones.data(), product_.data() + at);
  }
}

double BlockBound::proven(const Node& node, const VectorXd& residual) {
  const VectorXd y = residual.head(goal_.size());
  VectorXd vector = residual;
  if (price_goal_ > 0) vector[goal_.size()] = price_goal_;  // the price itself
  const double slack = rounding_ * (y.norm() + price_norm_ + 1);
  double charge = 0;
  const auto worst_of = [&](std::size_t first_light, std::size_t end_light) {
    const std::size_t first = column_begin_[first_light], end = column_begin_[end_light];
    products(first, end - first, vector);
    double worst = 0;
    for (std::size_t light = first_light; light < end_light; ++light) {
      double of = 0;
      for (std::size_t c = column_begin_[light]; c < column_begin_[light + 1]; ++c)
        of += max_[c] * std::max(0.0, product_[static_cast<Index>(c)] + slack);
      worst = std::max(worst, of);
    }
    return worst;
  };
  double last = 0;
  for (std::size_t k = 0; k < node.cells.size(); ++k) {
    const Cell& cell = cells_[node.cells[k]];
    if (k == 0 || node.cells[k] != node.cells[k - 1]) last = worst_of(cell.first, cell.first + cell.count);
    charge += last;
  }
  if (column_begin_.size() - 1 > home_)
    charge += static_cast<double>(max_foreign_) * worst_of(home_, column_begin_.size() - 1);
  const double gain = 2 * y.dot(goal_), cost = y.squaredNorm();
  const double sums = 2 * y.cwiseAbs().dot(goal_.cwiseAbs()) + cost + 2 * charge;
  return gain - cost - 2 * charge - rounding_ * sums;
}

void BlockBound::evaluate(Node& node, std::span<const Index> start) {
  ++evaluated_;
  std::vector<std::pair<std::size_t, std::size_t>> ranges;
  for (std::size_t k = 0; k < node.cells.size(); ++k)
    if (k == 0 || node.cells[k] != node.cells[k - 1])
      ranges.emplace_back(first_column(cells_[node.cells[k]]), end_column(cells_[node.cells[k]]));
  const auto allowed = [&](Index j) {
    const auto c = static_cast<std::size_t>(j);
    return c >= home_columns_ ||
           std::any_of(ranges.begin(), ranges.end(), [&](const auto& r) { return c >= r.first && c < r.second; });
  };
  std::vector<Index> columns;
  std::copy_if(start.begin(), start.end(), std::back_inserter(columns), allowed);
  few_->choose(columns);
  VectorXd residual = few_->residual();
  const double least = kMinPull * std::max(goal_.norm(), 1e-3);
  const auto steepest = [&](std::size_t first, std::size_t end, double& most, Index& at) {
    products(first, end - first, residual);
    for (std::size_t c = first; c < end; ++c)
      if (const double pull = product_[static_cast<Index>(c)] * inverse_norm_[c]; pull > most) {
        most = pull;
        at = static_cast<Index>(c);
      }
  };
  Index last = -1;
  for (int taken = 0; taken < kMaxTakenUp; ++taken) {
    double most = least;
    Index at = -1;
    for (const auto& [first, end] : ranges) steepest(first, end, most, at);
    if (at < 0) steepest(home_columns_, max_.size(), most, at);
    if (at < 0 || at == last) break;
    last = at;
    few_->add(at);
    residual = few_->residual();
  }
  node.support.clear();
  node.level.clear();
  for (std::size_t place = 0; place < few_->columns().size(); ++place)
    if (few_->level(place) > 0) {
      node.support.push_back(few_->columns()[place]);
      node.level.push_back(few_->level(place));
    }
  node.bound = proven(node, residual);
  node.closed = is_integral(node);
}

/// Whether the burning lights are no more than each cell allows.
bool BlockBound::is_integral(const Node& node) const {
  std::size_t single = 0;
  for (const std::uint32_t cell : node.cells) single += cells_[cell].count == 1 ? 1 : 0;
  if (single == node.cells.size()) return true;
  std::vector<std::size_t> lights;
  for (const Index j : node.support) {
    const auto c = static_cast<std::size_t>(j);
    if (c >= home_columns_) continue;
    lights.push_back(static_cast<std::size_t>(
        std::upper_bound(column_begin_.begin(), column_begin_.end(), static_cast<std::uint32_t>(c)) -
        column_begin_.begin() - 1));
  }
  std::sort(lights.begin(), lights.end());
  lights.erase(std::unique(lights.begin(), lights.end()), lights.end());
  return lights.size() <= node.cells.size();
}

void BlockBound::push(Tree& tree, Node node) {
  tree.open.push_back(std::move(node));
  std::push_heap(tree.open.begin(), tree.open.end(),
                 [](const Node& a, const Node& b) { return later(a.bound, b.bound); });
}

BlockBound::Tree& BlockBound::tree(std::size_t count) {
  if (trees_.size() <= count) trees_.resize(count + 1);
  Tree& tree = trees_[count];
  if (tree.made) return tree;
  tree.made = true;
  Node node;
  node.cells.assign(count, root_);
  if (count == 0) {
    evaluate(node, {});
  } else {  // for any count, the first node lets any number burn
    if (root_residual_.size() == 0) {
      evaluate(node, {});
      anywhere_ = node;
      root_residual_ = few_->residual();
    }
    node.support = anywhere_.support;
    node.level = anywhere_.level;
    node.bound = proven(node, root_residual_);
    node.closed = is_integral(node);
  }
  push(tree, std::move(node));
  return tree;
}

double BlockBound::value(std::size_t count) { return tree(std::min(count, home_)).open.front().bound; }

std::vector<BurningColumn> BlockBound::burning(std::size_t count) {
  const Node& least = tree(std::min(count, home_)).open.front();
  std::vector<BurningColumn> burning;
  for (std::size_t k = 0; k < least.support.size(); ++k) {
    const auto c = static_cast<std::size_t>(least.support[k]);
    burning.push_back({number_[c], least.level[k], c < home_columns_});
  }
  return burning;
}

/// Halves the largest cell in which more lights burn than allowed. A cell shared by several lights is halved for all of
/// them, so that no arrangement comes twice.
void BlockBound::split(const Node& node, Tree& tree) {
  std::uint32_t cell = 0;
  std::size_t most = 0;
  for (const std::uint32_t other : node.cells) {
    const Cell& of = cells_[other];
    if (of.count < 2) continue;
    const auto allowed = static_cast<std::size_t>(std::count(node.cells.begin(), node.cells.end(), other));
    const auto used = static_cast<std::size_t>(std::count_if(node.support.begin(), node.support.end(), [&](Index j) {
      return static_cast<std::size_t>(j) >= first_column(of) && static_cast<std::size_t>(j) < end_column(of);
    }));
    const std::size_t size = (used > allowed ? home_ + 1 : 0) + of.count;
    if (size > most) {
      most = size;
      cell = other;
    }
  }
  LUXRIG_CHECK(most > 0, "a node of single lights is not split");
  std::vector<std::uint32_t> rest;
  std::copy_if(node.cells.begin(), node.cells.end(), std::back_inserter(rest), [&](auto c) { return c != cell; });
  const std::size_t shared = node.cells.size() - rest.size();
  for (std::size_t left = 0; left <= shared; ++left) {
    Node child;
    child.cells = rest;
    child.cells.insert(child.cells.end(), left, cells_[cell].left);
    child.cells.insert(child.cells.end(), shared - left, cells_[cell].right);
    std::sort(child.cells.begin(), child.cells.end());
    if (left > cells_[cells_[cell].left].count || shared - left > cells_[cells_[cell].right].count) continue;
    evaluate(child, node.support);
    child.bound = std::max(child.bound, node.bound);  // fewer arrangements
    push(tree, std::move(child));
  }
}

bool BlockBound::refine(std::size_t count, std::size_t nodes) {
  Tree& of = tree(std::min(count, home_));
  for (std::size_t n = 0; n < nodes; ++n) {
    if (of.open.front().closed) return false;
    std::pop_heap(of.open.begin(), of.open.end(), [](const Node& a, const Node& b) { return later(a.bound, b.bound); });
    const Node worst = std::move(of.open.back());
    of.open.pop_back();
    split(worst, of);
  }
  return !of.open.front().closed;
}

}  // namespace luxrig
