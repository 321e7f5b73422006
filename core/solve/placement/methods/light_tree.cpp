#include "core/solve/placement/methods/light_tree.h"

#include <algorithm>

#include "core/check.h"

namespace luxrig {
namespace {

/// Share of the goal's norm below which a leaf is dropped.
constexpr double kMinLeaf = 1e-3;

std::vector<std::size_t> leaves_of(const CandidateLights& candidates, const std::stop_token& stop) {
  NnlsOptions options;
  options.stop = stop;
  const auto solution = solve_nnls(candidates.nnls(), options);
  LUXRIG_CHECK(solution.has_value(), "{}", solution.has_value() ? "" : solution.error().detail);
  const ScaledColumns& scaled = candidates.shared()->scaled();
  std::vector<std::size_t> leaves;
  for (const std::size_t candidate : candidates.lit())
    for (std::size_t e = 0; e < candidates.emitters(); ++e) {
      const auto column = static_cast<Eigen::Index>(candidate * candidates.emitters() + e);
      if (!(scaled.z_of(column, solution->x[column]) > kMinLeaf)) continue;
      leaves.push_back(candidate);
      break;
    }
  return leaves;
}

/// Products of the unit columns of chosen lights with each other, in their order.
class LightLikeness {
 public:
  explicit LightLikeness(const ChosenCandidates& chosen) {
    for (const std::size_t candidate : chosen.chosen()) add(chosen.candidates().unit_column(candidate));
  }
  void add(Eigen::VectorXd unit) {
    std::vector<double> with;
    for (const Eigen::VectorXd& other : units_) with.push_back(other.dot(unit));
    for (std::size_t i = 0; i < products_.size(); ++i) products_[i].push_back(with[i]);
    with.push_back(-1);
    products_.push_back(std::move(with));
    units_.push_back(std::move(unit));
  }
  void drop(std::size_t light) {
    const auto at = static_cast<std::ptrdiff_t>(light);
    units_.erase(units_.begin() + at);
    products_.erase(products_.begin() + at);
    for (auto& row : products_) row.erase(row.begin() + at);
  }
  /// first < second; needs at least two lights.
  [[nodiscard]] std::pair<std::size_t, std::size_t> nearest_two() const {
    std::pair<std::size_t, std::size_t> nearest = {0, 1};
    for (std::size_t a = 0; a < products_.size(); ++a)
      for (std::size_t b = a + 1; b < products_.size(); ++b)
        if (products_[a][b] > products_[nearest.first][nearest.second]) nearest = {a, b};
    return nearest;
  }

 private:
  std::vector<Eigen::VectorXd> units_;
  std::vector<std::vector<double>> products_;
};

}  // namespace

std::vector<TreeCut> light_tree_cuts(const std::shared_ptr<const CandidateLights>& candidates,
                                     const std::stop_token& stop) {
  ChosenCandidates state(candidates);
  state.choose(leaves_of(*candidates, stop));
  LightLikeness likeness(state);
  std::vector<TreeCut> cuts;
  while (state.size() > 0) {
    cuts.push_back({state.chosen(), state.error()});
    if (state.size() == 1 || stop.stop_requested()) break;
    const auto [first, second] = likeness.nearest_two();
    for (const std::size_t light : {second, first}) {
      state.drop(light);
      likeness.drop(light);
    }
    const auto joined = candidates->nearest(state.residual(), 1);
    if (joined.empty() || state.holds(joined.front())) continue;  // the two contributed nothing that is missed
    state.add(joined.front());
    likeness.add(candidates->unit_column(joined.front()));
  }
  std::reverse(cuts.begin(), cuts.end());
  return cuts;
}

}  // namespace luxrig
