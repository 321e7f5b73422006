#include "core/highlight/lights/mounted_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {

LightSelection::LightSelection(PotentialLights lights, double serving_share)
    : lights_(std::move(lights)),
      serving_share_(serving_share),
      feature_begin_(lights_.features + std::size_t{1}, 0),
      counts_(lights_.lights.size(), 0),
      served_by_(lights_.features, 0),
      is_taken_(lights_.lights.size(), 0) {
  LUXRIG_CHECK(serving_share >= 0 && serving_share <= 1, "share {}", serving_share);
  LUXRIG_CHECK(lights_.begin.size() == lights_.lights.size() + 1, "{} lights", lights_.lights.size());
  double sum = 0;
  for (const LightVote& vote : lights_.votes) {
    sum += vote.weight;
    ++feature_begin_[vote.feature + std::size_t{1}];
  }
  LUXRIG_CHECK(std::isfinite(sum) && sum >= 0, "weights add up to {}", sum);
  unit_ = sum > 0 ? std::ldexp(sum, -61) : 1;
  for (std::size_t f = 0; f < lights_.features; ++f) feature_begin_[f + 1] += feature_begin_[f];
  std::vector<std::uint64_t> next(feature_begin_.begin(), feature_begin_.end() - 1);
  entries_.resize(lights_.votes.size());
  for (std::uint32_t light = 0; light < lights_.lights.size(); ++light) {
    for (const LightVote& vote : lights_.of(light)) {
      const auto parts = static_cast<std::int64_t>(vote.weight / unit_);
      entries_[next[vote.feature]++] = {light, parts};
      counts_[light] += parts;
    }
  }
}

bool LightSelection::serves(const LightVote& vote) const {
  return vote.points >= serving_share_ * lights_.points_of_feature[vote.feature];
}

void LightSelection::change(std::uint32_t light, bool taken) {
  for (const LightVote& vote : lights_.of(light)) {
    if (!serves(vote)) continue;
    std::uint32_t& served_by = served_by_[vote.feature];
    const bool was_served = served_by > 0;
    served_by += taken ? 1 : -1;
    if (was_served == (served_by > 0)) continue;
    for (std::uint64_t e = feature_begin_[vote.feature]; e < feature_begin_[vote.feature + std::size_t{1}]; ++e)
      counts_[entries_[e].other] += taken ? -entries_[e].weight : entries_[e].weight;
    entries_changed_ += feature_begin_[vote.feature + std::size_t{1}] - feature_begin_[vote.feature];
  }
  is_taken_[light] = taken ? 1 : 0;
}

std::optional<std::uint32_t> LightSelection::add() {
  std::optional<std::uint32_t> best;
  for (std::uint32_t light = 0; light < counts_.size(); ++light)
    if (!is_taken_[light] && counts_[light] > (best ? counts_[*best] : 0)) best = light;
  if (best) add(*best);
  return best;
}

void LightSelection::add(std::uint32_t light) {
  LUXRIG_CHECK(light < is_taken_.size() && !is_taken_[light], "light {} of {}", light, is_taken_.size());
  change(light, true);
  taken_.push_back(light);
}

void LightSelection::remove(std::size_t i) {
  LUXRIG_CHECK(i < taken_.size(), "light {} of {} taken", i, taken_.size());
  change(taken_[i], false);
  taken_.erase(taken_.begin() + static_cast<std::ptrdiff_t>(i));
}

double LightSelection::count(std::uint32_t light) const { return static_cast<double>(counts_[light]) * unit_; }

double LightSelection::coverage() const {
  if (served_by_.empty()) return 0;
  const auto served = std::count_if(served_by_.begin(), served_by_.end(), [](std::uint32_t by) { return by > 0; });
  return static_cast<double>(served) / static_cast<double>(served_by_.size());
}

double LightSelection::point_coverage() const {
  double served = 0, all = 0;
  for (std::size_t f = 0; f < served_by_.size(); ++f) {
    all += lights_.points_of_feature[f];
    if (served_by_[f] > 0) served += lights_.points_of_feature[f];
  }
  return all > 0 ? served / all : 0;
}

Result<std::vector<double>> select_lights(LightSelection& selection, const LightNumber& number) {
  if (number.most < 1) return refusal(fmt::format("{} lights cannot bring out anything", number.most));
  if (number.coverage && !(*number.coverage >= 0 && *number.coverage <= 1))
    return refusal(fmt::format("a coverage of {} is not within 0 to 1", *number.coverage));
  if (number.patience < 1) return refusal(fmt::format("a patience of {} lights", number.patience));
  std::vector<double> contrasts;
  std::size_t best_size = selection.taken().size();
  const auto asked = static_cast<bool>(number.local_contrast);
  double best = asked && best_size > 0 ? number.local_contrast(selection.taken()) : 0;
  int failed = 0;
  while (selection.taken().size() < static_cast<std::size_t>(number.most)) {
    if (number.coverage && selection.coverage() >= *number.coverage) break;
    if (!selection.add()) break;
    if (!asked) continue;
    contrasts.push_back(number.local_contrast(selection.taken()));
    if (contrasts.back() > best) {
      best = contrasts.back();
      best_size = selection.taken().size();
      failed = 0;
    } else if (++failed == number.patience) {
      break;
    }
  }
  if (asked)
    while (selection.taken().size() > best_size) selection.remove(selection.taken().size() - 1);
  return contrasts;
}

}  // namespace luxrig
