#pragma once
/// Lights at some of the candidates, with optimal levels. An exchange costs microseconds and no column.

#include <memory>
#include <random>

#include "core/solve/placement/methods/candidate_lights.h"

namespace luxrig {

class ChosenCandidates {
 public:
  explicit ChosenCandidates(std::shared_ptr<const CandidateLights> candidates);

  [[nodiscard]] const CandidateLights& candidates() const { return *candidates_; }
  [[nodiscard]] const std::vector<std::size_t>& chosen() const { return chosen_; }
  [[nodiscard]] std::size_t size() const { return chosen_.size(); }
  [[nodiscard]] bool holds(std::size_t candidate) const;
  [[nodiscard]] double error() const { return candidates_->error_of(few_.residual_norm()); }
  [[nodiscard]] Eigen::VectorXd residual() const { return few_.residual(); }  ///< b − f − A x, without W
  [[nodiscard]] Eigen::VectorXd levels() const;                               ///< ordered as PlacedLights::levels()
  [[nodiscard]] std::vector<LightPose> poses() const;

  void choose(std::vector<std::size_t> candidates);
  void add(std::size_t candidate);
  void drop(std::size_t light);
  void exchange(std::size_t light, std::size_t candidate);

  /// The lights at their places with newly computed and counted columns; without those that may not hang there after
  /// all.
  [[nodiscard]] PlacedLights placed(std::size_t& columns) const;

 private:
  std::shared_ptr<const CandidateLights> candidates_;
  std::vector<std::size_t> chosen_;
  NnlsOfFew few_;
};

/// Adds lights one by one, each the candidate most similar to the residual, until there are `lights`, `error` is
/// reached or no candidate reduces it: non-negative orthogonal matching pursuit (Bruckstein, Elad & Zibulevsky 2008).
void pursue(ChosenCandidates& chosen, std::size_t lights, double error, const std::stop_token& stop,
            const std::function<void(const ChosenCandidates&)>& added = {});

/// `count` different random lit candidates; all of them if there are no more.
[[nodiscard]] std::vector<std::size_t> drawn_candidates(const CandidateLights& candidates, std::size_t count,
                                                        std::mt19937_64& random);

}  // namespace luxrig
