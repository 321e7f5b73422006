#include "core/highlight/aim/aim_objective.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

/// Share of reference_lx that a head must give the lit side of its shadow edge to make it visible.
constexpr double kSeenShare = 0.02;
/// For each head at full level, of what is seen. Under limits a head that lights the object by the edge of its beam, past
/// it, would be as good as one that is dimmed.
constexpr double kLevelCost = 0.02;
/// Unit of movement time: about the time a head takes from one aim to the next.
constexpr double kUsualMove_s = 4;
/// Share of the mean illuminance below which relative contrast fades to zero.
constexpr double kDarkShare = 0.1;
/// Share of the lux that the strongest head can give or the limit allows: an eye does not adapt to a darker object.
/// Without it, in a dark room, the faint edge of a beam that misses the object would score best.
constexpr double kDarkestAdaptation = 0.02;
/// The same for what is seen. Reflected light shows an object as evenly as any, so beams would leave it for the wall.
constexpr double kDarkestSeen = 0.1;
/// Rounding may lift a level that was scaled to a limit slightly over it.
constexpr double kLimitSlack = 1e-9;

}  // namespace

AimObjective::AimObjective(const ContrastSamples& samples, const FeatureClusters& features, const AimWishes& wishes,
                           double reference_lx, double all_watts)
    : samples_(samples), features_(features), wishes_(wishes), reference_lx_(reference_lx), all_watts_(all_watts) {
  LUXRIG_CHECK(features.cluster_of_point.size() == samples.interest, "{} features' points, {} interest points",
               features.cluster_of_point.size(), samples.interest);
  LUXRIG_CHECK(reference_lx > 0, "reference of {} lx", reference_lx);
  LUXRIG_CHECK(!wishes.role.asks() || (wishes.seen && wishes.role.wanted.size() == wishes.seen->samples().size()),
               "a role of {} samples", wishes.role.wanted.size());
  LUXRIG_CHECK((wishes.measure == AimMeasure::seen) == (wishes.seen != nullptr), "{} what is seen",
               wishes.seen ? "unused" : "no");
}

AimSum AimObjective::nothing() const {
  AimSum sum;
  sum.sample_lux = wishes_.fixed_lux.empty() ? std::vector<double>(samples(), 0) : wishes_.fixed_lux;
  for (const AimLimit& limit : wishes_.limits) sum.limit_lux.push_back(limit.fixed_lx);
  if (wishes_.seen) sum.seen_lux = wishes_.seen_fixed_lux;
  if (wishes_.seen) sum.seen_lux.resize(wishes_.seen->samples().size(), 0);
  if (wishes_.seen && wishes_.seen->wishes().shadows_weight > 0) sum.seen_lux_of_each.push_back(sum.seen_lux);
  sum.covered.assign(features_.sizes.size(), 0);
  for (std::size_t i = 0; i < samples_.interest; ++i) sum.mean_lux += sum.sample_lux[i];
  sum.mean_lux /= static_cast<double>(samples_.interest);
  return sum;
}

AimColumn AimObjective::column(std::vector<double> sample_lux, std::vector<double> limit_lux,
                               std::vector<float> seen_lux) const {
  AimColumn column{std::move(sample_lux), std::move(limit_lux), {}, 0, std::move(seen_lux)};
  column.feature_lux.assign(features_.sizes.size(), 0);
  for (std::size_t i = 0; i < samples_.interest; ++i) {
    const double mine = column.sample_lux[i];
    column.mean_lux += mine;
    double& best = column.feature_lux[features_.cluster_of_point[i]];
    for (const std::uint32_t j : samples_.of(i))
      if (const double theirs = column.sample_lux[j]; (mine > 0) != (theirs > 0)) best = std::max({best, mine, theirs});
  }
  column.mean_lux /= static_cast<double>(samples_.interest);
  return column;
}

void AimObjective::add(AimSum& sum, const AimColumn& column, double level, HeadRole role, double watts,
                       double travel_s) const {
  if (!(level > 0)) return;
  for (std::size_t i = 0; i < sum.sample_lux.size(); ++i) sum.sample_lux[i] += level * column.sample_lux[i];
  for (std::size_t i = 0; i < sum.limit_lux.size(); ++i) sum.limit_lux[i] += level * column.limit_lux[i];
  const auto share = static_cast<float>(level);
  for (std::size_t i = 0; i < sum.seen_lux.size(); ++i) sum.seen_lux[i] += share * column.seen_lux[i];
  if (!sum.seen_lux_of_each.empty()) {
    sum.seen_lux_of_each.push_back(column.seen_lux);
    for (float& lx : sum.seen_lux_of_each.back()) lx *= share;
  }
  for (std::size_t f = 0; f < sum.covered.size(); ++f)
    if (level * column.feature_lux[f] >= kSeenShare * reference_lx_) sum.covered[f] = 1;
  sum.mean_lux += level * column.mean_lux;
  if (role == HeadRole::key) sum.key_mean_lux += level * column.mean_lux;
  sum.levels += level;
  sum.watts += level * watts;
  sum.travel_s = std::max(sum.travel_s, travel_s);
  sum.travel_total_s += travel_s;
}

double AimObjective::highest_level(const AimSum& others, const AimColumn& column, HeadRole role, double max_level,
                                   double watts, bool ratios) const {
  double most = max_level;
  const auto keep = [&](double room, double per_level) {
    if (per_level > 0) most = std::min(most, std::max(0.0, room / per_level));
  };
  for (std::size_t i = 0; i < wishes_.limits.size(); ++i)
    keep(wishes_.limits[i].max_lx - others.limit_lux[i], column.limit_lux[i]);
  if (std::isfinite(wishes_.max_object_lx))
    for (std::size_t i = 0; i < others.sample_lux.size(); ++i)
      keep(wishes_.max_object_lx - others.sample_lux[i], column.sample_lux[i]);
  if (std::isfinite(wishes_.max_watts)) keep(wishes_.max_watts - others.watts, watts);
  const double fill_lux = others.mean_lux - others.key_mean_lux;
  if (ratios && role == HeadRole::key && std::isfinite(wishes_.max_key_to_fill))
    keep(wishes_.max_key_to_fill * fill_lux - others.key_mean_lux, column.mean_lux);
  if (ratios && role == HeadRole::fill)
    keep(others.key_mean_lux - wishes_.min_key_to_fill * fill_lux, wishes_.min_key_to_fill * column.mean_lux);
  if (ratios && wishes_.role.asks() && wishes_.role.wanted_lx > 0)
    keep(wishes_.role.wanted_lx - own_wanted_lx(others), mean_lx_of(wishes_.role.wanted, column.seen_lux));
  return most;
}

double AimObjective::own_wanted_lx(const AimSum& sum) const {
  return mean_lx_of(wishes_.role.wanted, sum.seen_lux) - mean_lx_of(wishes_.role.wanted, wishes_.seen_fixed_lux);
}

void AimObjective::measure_contrast(const AimSum& sum, AimScore& score) const {
  const std::vector<double>& lux = sum.sample_lux;
  const double bright_lx = std::min(reference_lx_, wishes_.max_object_lx);
  const double dark_lx = kDarkShare * std::max(sum.mean_lux, kDarkestAdaptation * bright_lx);
  for (std::size_t i = 0; i < samples_.interest; ++i) {
    double largest = 0, relative = 0;
    for (const std::uint32_t j : samples_.of(i)) {
      const double difference = std::abs(lux[i] - lux[j]);
      largest = std::max(largest, difference);
      // In the dark nothing is visible.
      if (difference > 0) relative = std::max(relative, difference / (lux[i] + lux[j] + dark_lx));
    }
    score.local_contrast_lx += largest;
    score.relative_contrast += relative;
  }
  score.local_contrast_lx /= static_cast<double>(samples_.interest);
  score.relative_contrast /= static_cast<double>(samples_.interest);
}

AimScore AimObjective::scored(const AimSum& sum, bool all) const {
  AimScore score;
  const auto interest = static_cast<double>(samples_.interest);
  if (all || !wishes_.seen) measure_contrast(sum, score);
  if (wishes_.seen)
    score.seen = wishes_.seen->score(sum.seen_lux, kDarkestSeen * std::min(reference_lx_, wishes_.max_object_lx),
                                     sum.seen_lux_of_each);
  if (wishes_.seen && wishes_.role.asks())
    score.role = score_role(wishes_.role, sum.seen_lux, wishes_.seen_fixed_lux,
                            kDarkestSeen * std::min(reference_lx_, wishes_.max_object_lx), score.seen->objective);
  score.coverage = static_cast<double>(std::count(sum.covered.begin(), sum.covered.end(), 1)) /
                   static_cast<double>(std::max<std::size_t>(1, sum.covered.size()));
  score.mean_lx = sum.mean_lux;
  if (wishes_.base_lx > 0)
    for (std::size_t i = 0; i < samples_.interest; ++i)
      score.below_base += std::max(0.0, 1 - sum.sample_lux[i] / wishes_.base_lx) / interest;
  score.watts = sum.watts;
  score.travel_s = sum.travel_s;
  score.object_lx = sum.sample_lux.empty() ? 0 : *std::max_element(sum.sample_lux.begin(), sum.sample_lux.end());
  score.limit_lx = sum.limit_lux;
  score.within_limits = score.object_lx <= wishes_.max_object_lx * (1 + kLimitSlack) &&
                        score.watts <= wishes_.max_watts * (1 + kLimitSlack);
  for (std::size_t i = 0; i < sum.limit_lux.size(); ++i)
    score.within_limits &= sum.limit_lux[i] <= wishes_.limits[i].max_lx * (1 + kLimitSlack);
  score.objective = -wishes_.base_weight * score.below_base - wishes_.travel_weight * sum.travel_total_s / kUsualMove_s;
  if (score.seen)
    score.objective += (score.role ? score.role->objective : score.seen->objective) -
                       (wishes_.limited() ? kLevelCost * sum.levels : 0);
  else
    score.objective +=
        (wishes_.measure == AimMeasure::relative ? score.relative_contrast : score.local_contrast_lx / reference_lx_) +
        wishes_.coverage_weight * score.coverage;
  if (all_watts_ > 0) score.objective -= wishes_.energy_weight * sum.watts / all_watts_;
  if (wishes_.key) {
    const double fill = sum.mean_lux - sum.key_mean_lux;
    // A key light without fill exceeds every ratio. With no light at all every ratio holds.
    score.key_to_fill =
        fill > 0 ? sum.key_mean_lux / fill : (sum.key_mean_lux > 0 ? std::numeric_limits<double>::infinity() : 0);
    if (score.key_to_fill > wishes_.max_key_to_fill * (1 + kLimitSlack) ||
        (sum.mean_lux > 0 && score.key_to_fill < wishes_.min_key_to_fill * (1 - kLimitSlack))) {
      score.within_limits = false;
      score.objective -= 1;  // so that a head with less fill than the key light needs is not preferred
    }
  }
  return score;
}

}  // namespace luxrig
