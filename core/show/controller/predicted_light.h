#pragma once
/// Predictions of the estimator, kept until it learns: a status ten times a second asks for the same ones, since levels
/// stand still nearly always.

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/estimation/gain_estimator.h"

namespace luxrig {

class PredictedLight {
 public:
  /// As estimator.at_point().
  Prediction at_point(const GainEstimator& estimator, std::size_t point, std::span<const double> level) {
    Kept& kept = kept_at(estimator, level);
    return one_of(kept.points, point, [&] { return estimator.at_point(point, level); });
  }
  /// As estimator.at_meter(). `level` holds what is known of lost lamps.
  Prediction at_meter(const GainEstimator& estimator, std::size_t luxmeter, std::span<const double> level) {
    Kept& kept = kept_at(estimator, level);
    return one_of(kept.meters, luxmeter, [&] { return estimator.at_meter(luxmeter, level); });
  }

 private:
  struct Kept {
    std::uint64_t knowledge = 0;  ///< 0: nothing
    std::vector<double> level;
    std::vector<std::optional<Prediction>> points, meters;
  };

  Kept& kept_at(const GainEstimator& estimator, std::span<const double> level) {
    for (Kept& kept : kept_)
      if (kept.knowledge == estimator.knowledge() &&
          std::equal(kept.level.begin(), kept.level.end(), level.begin(), level.end()))
        return kept;
    Kept& oldest = kept_[next_];
    next_ = (next_ + 1) % kept_.size();
    oldest = {estimator.knowledge(), {level.begin(), level.end()}, {}, {}};
    return oldest;
  }
  template <class Predict>
  static Prediction one_of(std::vector<std::optional<Prediction>>& all, std::size_t which, Predict predict) {
    if (which >= all.size()) all.resize(which + 1);
    if (!all[which]) all[which] = predict();
    return *all[which];
  }

  std::array<Kept, 3> kept_;  ///< as it is sent, and with lost lamps dark or full
  std::size_t next_ = 0;
};

}  // namespace luxrig
