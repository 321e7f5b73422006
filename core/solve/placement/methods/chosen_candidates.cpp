#include "core/solve/placement/methods/chosen_candidates.h"

#include <algorithm>

#include "core/check.h"

namespace luxrig {

ChosenCandidates::ChosenCandidates(std::shared_ptr<const CandidateLights> candidates)
    : candidates_(std::move(candidates)), few_(candidates_->shared()) {
  few_.choose({});
}

bool ChosenCandidates::holds(std::size_t candidate) const {
  return std::find(chosen_.begin(), chosen_.end(), candidate) != chosen_.end();
}

Eigen::VectorXd ChosenCandidates::levels() const {
  Eigen::VectorXd levels(static_cast<Eigen::Index>(few_.columns().size()));
  for (std::size_t i = 0; i < few_.columns().size(); ++i) levels[static_cast<Eigen::Index>(i)] = few_.level(i);
  return levels;
}

std::vector<LightPose> ChosenCandidates::poses() const {
  std::vector<LightPose> poses;
  for (const std::size_t candidate : chosen_) poses.push_back(candidates_->pose(candidate));
  return poses;
}

void ChosenCandidates::choose(std::vector<std::size_t> candidates) {
  chosen_ = std::move(candidates);
  std::vector<Eigen::Index> columns;
  for (const std::size_t candidate : chosen_)
    for (std::size_t e = 0; e < candidates_->emitters(); ++e)
      columns.push_back(static_cast<Eigen::Index>(candidate * candidates_->emitters() + e));
  few_.choose(columns);
}

void ChosenCandidates::add(std::size_t candidate) {
  chosen_.push_back(candidate);
  for (std::size_t e = 0; e < candidates_->emitters(); ++e)
    few_.add(static_cast<Eigen::Index>(candidate * candidates_->emitters() + e));
}

void ChosenCandidates::drop(std::size_t light) {
  LUXRIG_CHECK(light < size(), "light {} of {}", light, size());
  chosen_.erase(chosen_.begin() + static_cast<std::ptrdiff_t>(light));
  for (std::size_t e = 0; e < candidates_->emitters(); ++e) few_.drop(light * candidates_->emitters());
}

void ChosenCandidates::exchange(std::size_t light, std::size_t candidate) {
  LUXRIG_CHECK(light < size(), "light {} of {}", light, size());
  chosen_[light] = candidate;
  for (std::size_t e = 0; e < candidates_->emitters(); ++e)
    few_.exchange(light * candidates_->emitters() + e,
                  static_cast<Eigen::Index>(candidate * candidates_->emitters() + e));
}

PlacedLights ChosenCandidates::placed(std::size_t& columns) const {
  PlacedLights lights(*candidates_->problem().light, *candidates_->problem().goal);
  for (const std::size_t candidate : chosen_) {
    ++columns;
    lights.add(candidates_->pose(candidate));
  }
  return lights;
}

void pursue(ChosenCandidates& chosen, std::size_t lights, double error, const std::stop_token& stop,
            const std::function<void(const ChosenCandidates&)>& added) {
  while (chosen.size() < lights && chosen.error() > error && !stop.stop_requested()) {
    const double was = chosen.error();
    const auto next = chosen.candidates().nearest(chosen.residual(), 1);
    if (next.empty() || chosen.holds(next.front())) return;
    chosen.add(next.front());
    if (!(chosen.error() < was)) {  // its pull was only rounding
      chosen.drop(chosen.size() - 1);
      return;
    }
    if (added) added(chosen);
  }
}

std::vector<std::size_t> drawn_candidates(const CandidateLights& candidates, std::size_t count,
                                          std::mt19937_64& random) {
  std::vector<std::size_t> drawn;
  std::sample(candidates.lit().begin(), candidates.lit().end(), std::back_inserter(drawn), count, random);
  return drawn;
}

}  // namespace luxrig
