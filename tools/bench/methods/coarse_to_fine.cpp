#include "tools/bench/methods/coarse_to_fine.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace luxrig {
namespace {

constexpr double kWeakest = 0.05;
constexpr double kCellsAlong = 8;

using GridCell = std::array<std::int64_t, 3>;

/// Candidates by cells whose sides halve from level to level.
class CandidateGrid {
 public:
  explicit CandidateGrid(const CandidateLights& candidates) : candidates_(candidates) {
    Eigen::AlignedBox3d box_m;
    for (const std::size_t c : candidates.lit()) box_m.extend(candidates.pose(c).position_world_m);
    const double spacing_m = candidates.problem().spacing_m;
    corner_m_ = box_m.min() - Vec3::Constant(spacing_m / 2);
    const double longest_m = box_m.sizes().maxCoeff() + spacing_m;
    halvings_ = std::clamp(static_cast<int>(std::lround(std::log2(longest_m / (kCellsAlong * spacing_m)))), 0, 30);
    side_m_ = std::ldexp(spacing_m, halvings_);
    std::map<std::array<double, 3>, std::size_t> aims;
    for (const std::size_t c : candidates.lit()) {
      const Vec3& aim = candidates.pose(c).aim_world;
      aim_.push_back(aims.try_emplace({aim.x(), aim.y(), aim.z()}, aims.size()).first->second);
    }
  }

  [[nodiscard]] int halvings() const { return halvings_; }
  [[nodiscard]] GridCell cell(std::size_t candidate, int level) const {
    const Vec3 at = (candidates_.pose(candidate).position_world_m - corner_m_) / std::ldexp(side_m_, -level);
    return {static_cast<std::int64_t>(std::floor(at.x())), static_cast<std::int64_t>(std::floor(at.y())),
            static_cast<std::int64_t>(std::floor(at.z()))};
  }
  /// For each cell at this level and each aim, the candidate nearest to the cell's middle. Only within `kept` cells of
  /// the level above.
  [[nodiscard]] std::vector<std::size_t> middles(int level, const std::set<GridCell>* kept) const {
    std::map<std::pair<GridCell, std::size_t>, std::pair<double, std::size_t>> nearest;
    const double side_m = std::ldexp(side_m_, -level);
    for (std::size_t i = 0; i < candidates_.lit().size(); ++i) {
      const std::size_t c = candidates_.lit()[i];
      if (kept && !kept->contains(cell(c, level - 1))) continue;
      const GridCell in = cell(c, level);
      const Vec3 middle_m =
          corner_m_ + side_m * Vec3(static_cast<double>(in[0]) + 0.5, static_cast<double>(in[1]) + 0.5,
                                    static_cast<double>(in[2]) + 0.5);
      const std::pair<double, std::size_t> off = {(candidates_.pose(c).position_world_m - middle_m).squaredNorm(), c};
      const auto [there, fresh] = nearest.try_emplace({in, aim_[i]}, off);
      if (!fresh) there->second = std::min(there->second, off);
    }
    std::vector<std::size_t> found;
    for (const auto& [where, off] : nearest) found.push_back(off.second);
    return found;
  }

 private:
  const CandidateLights& candidates_;
  Vec3 corner_m_;
  double side_m_ = 0;  ///< of cells at level 0
  int halvings_ = 0;
  std::vector<std::size_t> aim_;  ///< index of the aim of each lit candidate
};

/// Light of each light alone at its level: W A x.
Eigen::MatrixXd contributions_of(const ChosenCandidates& state) {
  const NnlsProblem& nnls = state.candidates().nnls();
  const std::size_t emitters = state.candidates().emitters();
  const Eigen::VectorXd levels = state.levels();
  Eigen::MatrixXd of = Eigen::MatrixXd::Zero(nnls.goal.size(), static_cast<Eigen::Index>(state.size()));
  for (std::size_t k = 0; k < state.size(); ++k)
    for (std::size_t e = 0; e < emitters; ++e)
      nnls.columns.add(static_cast<Eigen::Index>(state.chosen()[k] * emitters + e),
                       levels[static_cast<Eigen::Index>(k * emitters + e)],
                       of.col(static_cast<Eigen::Index>(k)).data());
  return nnls.row_weight.size() == 0 ? of : Eigen::MatrixXd(nnls.row_weight.asDiagonal() * of);
}

void drop_weak(ChosenCandidates& state) {
  const Eigen::VectorXd strength = contributions_of(state).colwise().norm();
  const double least = kWeakest * (strength.size() > 0 ? strength.maxCoeff() : 0);
  std::vector<std::size_t> strong;
  for (std::size_t k = 0; k < state.size(); ++k)
    if (const double of = strength[static_cast<Eigen::Index>(k)]; of > 0 && of >= least)
      strong.push_back(state.chosen()[k]);
  state.choose(std::move(strong));
}

/// Index of the light to drop when two are joined: of all pairs, the light whose partner, scaled, can replace both with
/// the least difference to the goal.
std::size_t light_to_join(const ChosenCandidates& state) {
  const Eigen::MatrixXd of = contributions_of(state);
  const Eigen::VectorXd rest = state.candidates().problem().goal->weighted(state.residual());
  const Eigen::MatrixXd products = of.transpose() * of;
  const Eigen::VectorXd pull = of.transpose() * rest;
  double least = std::numeric_limits<double>::infinity();
  std::size_t gone = 0;
  for (Eigen::Index a = 0; a < of.cols(); ++a) {
    if (!(products(a, a) > 0)) return static_cast<std::size_t>(a);
    for (Eigen::Index b = 0; b < of.cols(); ++b) {
      if (a == b) continue;
      // The residual plus the light of both, which a, scaled, would have to replace.
      const double whole = products(a, a) + products(b, b) + 2 * (products(a, b) + pull[a] + pull[b]);
      const double along = std::max(0.0, products(a, a) + products(a, b) + pull[a]);
      const double left = whole - along * along / products(a, a);
      if (!(left < least)) continue;
      least = left;
      gone = static_cast<std::size_t>(b);
    }
  }
  return gone;
}

}  // namespace

std::vector<TreeCut> coarse_to_fine_cuts(const std::shared_ptr<const CandidateLights>& candidates,
                                         const std::stop_token& stop) {
  ChosenCandidates state(candidates);
  if (candidates->lit().empty()) return {};
  const CandidateGrid grid(*candidates);
  state.choose(grid.middles(0, nullptr));
  drop_weak(state);
  for (int level = 1; level <= grid.halvings() && !stop.stop_requested(); ++level) {
    std::set<GridCell> kept;
    for (const std::size_t candidate : state.chosen()) kept.insert(grid.cell(candidate, level - 1));
    state.choose(grid.middles(level, &kept));
    drop_weak(state);
  }
  std::vector<TreeCut> cuts;
  for (; state.size() > 0; state.drop(light_to_join(state))) {
    cuts.push_back({state.chosen(), state.error()});
    if (state.size() == 1 || stop.stop_requested()) break;
  }
  std::reverse(cuts.begin(), cuts.end());
  return cuts;
}

}  // namespace luxrig
