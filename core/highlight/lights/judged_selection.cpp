#include "core/highlight/lights/judged_selection.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

/// Least gain for which a light is replaced: less is rounding, and could make two alternate for ever.
constexpr double kMinJudgedGain = 1e-6;
/// Possible excess of a sum's contrast over that of its parts, by float rounding.
constexpr double kBoundSlack = 1e-5;

}  // namespace

JudgedSelection::JudgedSelection(const ContrastSamples& samples, const FeatureClusters& features,
                                 std::span<const JudgedLight> candidates, const Vec3& middle_world_m,
                                 JudgedWishes wishes)
    : samples_(samples),
      features_(features),
      candidates_(candidates),
      middle_world_m_(middle_world_m),
      wishes_(std::move(wishes)) {
  LUXRIG_CHECK(features.cluster_of_point.size() == samples.interest, "{} features' points, {} interest points",
               features.cluster_of_point.size(), samples.interest);
  LUXRIG_CHECK(wishes_.fixed_lux.empty() || wishes_.fixed_lux.size() == samples.points.size(),
               "fixed light at {} of {} samples", wishes_.fixed_lux.size(), samples.points.size());
  LUXRIG_CHECK(wishes_.coverage_weight >= 0, "coverage weight {}", wishes_.coverage_weight);
  for (const JudgedLight& light : candidates_) {
    alone_lx_.push_back(local_contrast_of(samples_, light.lux));
    shown_.push_back(shown_by(light));
  }
}

JudgedSelection::Shown JudgedSelection::shown_by(const JudgedLight& light) const {
  Shown shown((features_.sizes.size() + 63) / 64, 0);
  for (std::size_t i = 0; i < samples_.interest; ++i) {
    const std::uint32_t feature = features_.cluster_of_point[i];
    const float mine = light.lux[i];
    for (const std::uint32_t n : samples_.of(i)) {
      const float theirs = light.lux[n];
      if ((mine > 0) != (theirs > 0) && static_cast<double>(std::max(mine, theirs)) > wishes_.seen_lx)
        shown[feature / 64] |= std::uint64_t{1} << (feature % 64);
    }
  }
  return shown;
}

Vec3 JudgedSelection::from(const JudgedLight& light) const {
  const Vec3 way_m = light.position_world_m - middle_world_m_;
  return way_m.isZero(0) ? Vec3(-light.direction) : Vec3(way_m.normalized());
}

JudgedSelection::Others JudgedSelection::others_than(std::size_t left_out) const {
  Others others;
  others.lux = wishes_.fixed_lux.empty() ? std::vector<float>(samples_.points.size(), 0) : wishes_.fixed_lux;
  others.shown.assign((features_.sizes.size() + 63) / 64, 0);
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    if (i == left_out) continue;
    for (std::size_t s = 0; s < others.lux.size(); ++s) others.lux[s] += taken_[i].lux[s];
    for (std::size_t w = 0; w < others.shown.size(); ++w) others.shown[w] |= taken_shown_[i][w];
    others.from.push_back(from(taken_[i]));
  }
  others.contrast_lx = local_contrast_of(samples_, others.lux);
  return others;
}

double JudgedSelection::judged(double contrast_lx, const Shown& a, const Shown& b) const {
  int shown = 0;
  for (std::size_t w = 0; w < a.size(); ++w) shown += std::popcount(a[w] | b[w]);
  return contrast_lx *
         (1 + wishes_.coverage_weight * shown / static_cast<double>(std::max<std::size_t>(1, features_.sizes.size())));
}

double JudgedSelection::beside(const Others& others, const JudgedLight& light, const Shown& shown) const {
  std::vector<float> sum_lx = others.lux;
  for (std::size_t s = 0; s < sum_lx.size(); ++s) sum_lx[s] += light.lux[s];
  return judged(local_contrast_of(samples_, sum_lx), others.shown, shown);
}

std::optional<JudgedSelection::Choice> JudgedSelection::best_beside(const Others& others) const {
  struct Bound {
    double judged;
    std::uint32_t candidate;
  };
  std::vector<Bound> bounds;
  for (std::uint32_t c = 0; c < candidates_.size(); ++c) {
    if (!(alone_lx_[c] > 0) || !stands_apart(candidates_[c], others.from)) continue;
    bounds.push_back({judged(others.contrast_lx + alone_lx_[c], others.shown, shown_[c]), c});
  }
  std::stable_sort(bounds.begin(), bounds.end(), [](const Bound& a, const Bound& b) { return a.judged > b.judged; });
  std::optional<Choice> best;
  for (const Bound& bound : bounds) {
    if (best && bound.judged * (1 + kBoundSlack) <= best->judged) break;
    ++added_up_;
    const double value = beside(others, candidates_[bound.candidate], shown_[bound.candidate]);
    if (!best || value > best->judged) best = {bound.candidate, value};
  }
  return best;
}

std::optional<std::uint32_t> JudgedSelection::add() {
  const auto best = best_beside(others_than(taken_.size()));
  if (!best) return std::nullopt;
  add(best->candidate);
  return best->candidate;
}

void JudgedSelection::add(std::uint32_t candidate) {
  LUXRIG_CHECK(candidate < candidates_.size(), "candidate {} of {}", candidate, candidates_.size());
  taken_.push_back(candidates_[candidate]);
  taken_shown_.push_back(shown_[candidate]);
}

bool JudgedSelection::stands_apart(const JudgedLight& light, std::span<const Vec3> from_others) const {
  const Vec3 mine = from(light);
  const double max_cosine = std::cos(wishes_.min_angle_rad);
  return std::ranges::none_of(from_others, [&](const Vec3& theirs) { return mine.dot(theirs) > max_cosine; });
}

bool JudgedSelection::stands_apart(std::uint32_t candidate) const {
  LUXRIG_CHECK(candidate < candidates_.size(), "candidate {} of {}", candidate, candidates_.size());
  return stands_apart(candidates_[candidate], others_than(taken_.size()).from);
}

void JudgedSelection::remove(std::size_t i) {
  LUXRIG_CHECK(i < taken_.size(), "light {} of {} taken", i, taken_.size());
  taken_.erase(taken_.begin() + static_cast<std::ptrdiff_t>(i));
  taken_shown_.erase(taken_shown_.begin() + static_cast<std::ptrdiff_t>(i));
}

bool JudgedSelection::settle(int max_rounds) {
  bool any = false;
  std::size_t settled = 0;  // lights in a row that cannot be improved
  for (std::size_t step = 0; settled < taken_.size() && step < static_cast<std::size_t>(max_rounds) * taken_.size();
       ++step) {
    const std::size_t k = step % taken_.size();
    const Others others = others_than(k);
    ++settled;
    const auto best = best_beside(others);
    if (!best || !(best->judged > (1 + kMinJudgedGain) * beside(others, taken_[k], taken_shown_[k]))) continue;
    taken_[k] = candidates_[best->candidate];
    taken_shown_[k] = shown_[best->candidate];
    settled = 1;
    any = true;
  }
  return any;
}

bool JudgedSelection::improve(std::size_t i, const JudgedLight& light) {
  LUXRIG_CHECK(i < taken_.size(), "light {} of {} taken", i, taken_.size());
  const Others others = others_than(i);
  Shown shown = shown_by(light);
  if (!(beside(others, light, shown) > (1 + kMinJudgedGain) * beside(others, taken_[i], taken_shown_[i]))) return false;
  taken_[i] = light;
  taken_shown_[i] = std::move(shown);
  return true;
}

JudgedScore JudgedSelection::score() const {
  const Others all = others_than(taken_.size());
  const SampleContrast contrast = contrast_of(samples_, all.lux);
  JudgedScore score{contrast.local_contrast_lx, contrast.exposed_contrast, 0,
                    judged(contrast.local_contrast_lx, all.shown, all.shown)};
  int shown = 0;
  for (const std::uint64_t word : all.shown) shown += std::popcount(word);
  score.coverage = shown / static_cast<double>(std::max<std::size_t>(1, features_.sizes.size()));
  return score;
}

}  // namespace luxrig
