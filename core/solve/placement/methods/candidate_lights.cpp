#include "core/solve/placement/methods/candidate_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {

std::string PlacementProblem::complaint() const {
  if (!light || !goal) return "no light or no goal";
  if (goal->channels() < 1 || goal->emitters.cols() < 1) return "no channel or no emitter";
  if (goal->lux.size() != light->points() * goal->channels())
    return fmt::format("{} goals for {} points of {} channels", goal->lux.size(), light->points(), goal->channels());
  if (goal->fixed_lux.size() != 0 && goal->fixed_lux.size() != goal->lux.size())
    return fmt::format("{} goals, {} values of fixed light", goal->lux.size(), goal->fixed_lux.size());
  if (goal->row_weight.size() != 0 && goal->row_weight.size() != goal->lux.size())
    return fmt::format("{} goals, {} weights", goal->lux.size(), goal->row_weight.size());
  if (goal->row_weight.size() != 0 && (!goal->row_weight.allFinite() || goal->row_weight.minCoeff() < 0))
    return "a weight is negative or not finite";
  if (!goal->fixed_lux.allFinite() || !goal->lux.allFinite()) return "a goal or fixed light is not finite";
  if (!goal->emitters.allFinite() || goal->emitters.minCoeff() < 0)
    return "an emitter's colour is negative or not finite";
  if (!(goal->max_level >= 0)) return fmt::format("a highest level of {}", goal->max_level);
  if (columns.columns() > 0 && columns.rows() != light->points())
    return fmt::format("candidates light {} points, the light {}", columns.rows(), light->points());
  if (static_cast<std::size_t>(columns.columns()) != poses.size())
    return fmt::format("{} columns, {} poses", columns.columns(), poses.size());
  for (const LightPose& pose : poses)
    if (!pose.position_world_m.allFinite() || !pose.aim_world.allFinite()) return "a candidate's pose is not finite";
  if (!(spacing_m > 0) || !std::isfinite(spacing_m)) return fmt::format("candidates {} m apart", spacing_m);
  return columns.complaint();
}

Result<std::shared_ptr<const CandidateLights>> CandidateLights::make(const PlacementProblem& problem) {
  std::string text = problem.complaint();
  if (text.empty()) {
    const std::shared_ptr<CandidateLights> made(new CandidateLights(problem));
    auto shared = share_problem(made->nnls_);
    if (shared) {
      made->shared_ = std::move(*shared);
      const ScaledColumns& scaled = made->shared_->scaled();
      made->inverse_norm_.resize(scaled.columns());
      for (Eigen::Index j = 0; j < scaled.columns(); ++j)
        made->inverse_norm_[j] = scaled.upper(j) > 0 ? scaled.inverse_norm(j) : 0;
      for (std::size_t c = 0; c < problem.poses.size(); ++c)
        for (std::size_t e = 0; e < made->emitters_; ++e)
          if (made->inverse_norm_[static_cast<Eigen::Index>(c * made->emitters_ + e)] > 0) {
            made->lit_.push_back(c);
            break;
          }
      return made;
    }
    text = shared.error().detail;
  }
  Fault fault;
  fault.cause = Cause::invalid;
  fault.detail = std::move(text);
  return tl::unexpected(fault);
}

CandidateLights::CandidateLights(const PlacementProblem& problem)
    : problem_(problem),
      emitters_(static_cast<std::size_t>(problem.goal->emitters.cols())),
      goal_norm_(problem.goal->weighted(problem.goal->lux).norm()) {
  const LightingGoal& goal = *problem.goal;
  if (goal.emitters.size() == 1 && goal.emitters(0, 0) == 1 && problem.columns.columns() > 0)
    nnls_.columns = problem.columns;
  else
    expand();
  nnls_.goal = goal.fixed_lux.size() == 0 ? goal.lux : Eigen::VectorXd(goal.lux - goal.fixed_lux);
  nnls_.row_weight = goal.row_weight;
  if (std::isfinite(goal.max_level)) nnls_.upper = Eigen::VectorXd::Constant(nnls_.columns.columns(), goal.max_level);
}

void CandidateLights::expand() {
  const LightingGoal& goal = *problem_.goal;
  const Eigen::Index points = problem_.light->points();
  Eigen::VectorXd lux = Eigen::VectorXd::Zero(points);
  begin_.push_back(0);
  for (Eigen::Index c = 0; c < problem_.columns.columns(); ++c) {
    problem_.columns.add(c, 1.0, lux.data());
    for (Eigen::Index e = 0; e < goal.emitters.cols(); ++e) {
      for (Eigen::Index channel = 0; channel < goal.channels(); ++channel)
        for (Eigen::Index i = 0; i < points; ++i)
          if (const double value = goal.emitters(channel, e) * lux[i]; value != 0) {
            row_.push_back(static_cast<std::uint32_t>(channel * points + i));
            value_.push_back(value);
          }
      begin_.push_back(value_.size());
    }
    problem_.columns.clear(c, lux.data());
  }
  nnls_.columns = ColumnsView(goal.lux.size(), begin_, row_, value_);
}

Eigen::VectorXd CandidateLights::unit_column(std::size_t candidate) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(nnls_.goal.size());
  for (std::size_t e = 0; e < emitters_; ++e)
    nnls_.columns.add(static_cast<Eigen::Index>(candidate * emitters_ + e), 1.0, sum.data());
  return problem_.goal->weighted(sum).normalized();
}

std::vector<std::size_t> CandidateLights::nearest(const Eigen::VectorXd& residual, std::size_t count) const {
  Eigen::VectorXd likeness(nnls_.columns.columns());
  const Eigen::VectorXd weighted = shared_->scaled().weighted(residual);
  nnls_.columns.dot_all(weighted.data(), inverse_norm_.data(), likeness.data());
  // The best so far, worst in front: one comparison rejects nearly every candidate.
  using Found = std::pair<double, std::size_t>;
  const auto better = [](const Found& a, const Found& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  };
  std::vector<Found> found;
  found.reserve(count + 1);
  for (const std::size_t candidate : lit_) {
    double like = 0;
    if (emitters_ == 1) {
      like = likeness[static_cast<Eigen::Index>(candidate)];
    } else {
      for (std::size_t e = 0; e < emitters_; ++e) {
        const double of = std::max(0.0, likeness[static_cast<Eigen::Index>(candidate * emitters_ + e)]);
        like += of * of;
      }
    }
    if (!(like > 0) || (found.size() == count && !(like > found.front().first))) continue;
    found.emplace_back(like, candidate);
    std::push_heap(found.begin(), found.end(), better);
    if (found.size() <= count) continue;
    std::pop_heap(found.begin(), found.end(), better);
    found.pop_back();
  }
  std::sort_heap(found.begin(), found.end(), better);
  std::vector<std::size_t> candidates;
  candidates.reserve(found.size());
  for (const Found& one : found) candidates.push_back(one.second);
  return candidates;
}

}  // namespace luxrig
