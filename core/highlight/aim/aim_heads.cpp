#include "core/highlight/aim/aim_heads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/highlight/aim/aim_heads_state.h"
#include "core/parallel.h"
#include "core/photometry/beam.h"

namespace luxrig {
namespace {

constexpr double kBeamShare = 0.9;  ///< of the flux within the beam (thesis §6.5)

bool is_finite_pose(const Pose& pose) { return pose.rotation.allFinite() && pose.translation_m.allFinite(); }

std::string complaint_of_head(const HangingHead& head) {
  if (!is_finite_pose(head.world_from_mount) || !std::isfinite(head.roll_rad) || !std::isfinite(head.present.pan_rad) ||
      !std::isfinite(head.present.tilt_rad))
    return "its place or joints are not finite";
  if (head.zoom.empty() || std::any_of(head.zoom.begin(), head.zoom.end(), [](const ZoomStop& stop) {
        return !stop.intensity || !std::isfinite(stop.beam_rad);
      }))
    return "it has no distribution of light";
  if (!(head.max_level >= 0 && head.max_level <= 1)) return "its highest level is not 0 to 1";
  if (!(head.pan_speed_rad_s > 0) || !(head.tilt_speed_rad_s > 0) || !(head.zoom_speed_rad_s > 0))
    return "its speeds are not positive";
  if (!(head.watts >= 0) || !std::isfinite(head.watts)) return "its power is not 0 or more";
  if (!(head.reflected_lx >= 0) || !std::isfinite(head.reflected_lx)) return "its reflected light is not 0 lx or more";
  return "";
}

std::string complaint_of_seen(const AimWishes& wishes) {
  if ((wishes.measure == AimMeasure::seen) != (wishes.seen != nullptr))
    return wishes.seen ? "what is seen is given, but does not count" : "what is seen of the object is not given";
  if (wishes.seen_quick && !wishes.seen) return "a coarser picture is given, but no fine one";
  const auto fits = [](const std::vector<float>& lux, const std::shared_ptr<const SeenContrast>& seen) {
    return lux.empty() || (seen && lux.size() == seen->samples().size() &&
                           std::ranges::all_of(lux, [](float one) { return one >= 0 && std::isfinite(one); }));
  };
  const auto is_for = [](const SeenRole& role, const std::shared_ptr<const SeenContrast>& seen) {
    return !role.asks() || (seen && role.wanted.size() == seen->samples().size() &&
                            (role.spared.empty() || role.spared.size() == role.wanted.size()));
  };
  if (!is_for(wishes.role, wishes.seen) || !is_for(wishes.quick_role, wishes.seen_quick))
    return "a role needs one weight per sample of what is seen";
  if (!fits(wishes.seen_fixed_lux, wishes.seen) || !fits(wishes.seen_quick_fixed_lux, wishes.seen_quick))
    return "fixed light on what is seen must be 0 lx or more, one per sample";
  return "";
}

std::string complaint_of_wishes(const AimWishes& wishes, const ContrastSamples& samples, std::size_t heads) {
  for (const AimLimit& limit : wishes.limits) {
    if (!limit.at.position_world_m.allFinite() || !limit.at.normal.allFinite() || !(limit.max_lx >= 0) ||
        !(limit.fixed_lx >= 0))
      return fmt::format("limit \"{}\": place, lux or light that stays is not a usable number", limit.name);
    if (limit.fixed_lx > limit.max_lx)
      return fmt::format("limit \"{}\": light that stays gives {:.4g} lx there, {:.4g} lx are allowed", limit.name,
                         limit.fixed_lx, limit.max_lx);
  }
  if (!(wishes.max_object_lx > 0)) return "max_object_lx must be above 0";
  if (!(wishes.max_watts >= 0)) return "max_watts must be 0 or more";
  if (wishes.key && *wishes.key >= heads) return fmt::format("key light {} of {} heads", *wishes.key, heads);
  if (!(wishes.max_key_to_fill > 0) || !(wishes.min_key_to_fill >= 0) ||
      wishes.min_key_to_fill > wishes.max_key_to_fill)
    return "key to fill must be above 0, and its least not above its most";
  for (const double weight :
       {wishes.coverage_weight, wishes.energy_weight, wishes.base_weight, wishes.travel_weight, wishes.base_lx})
    if (!(weight >= 0) || !std::isfinite(weight)) return "weights and base_lx must be 0 or more";
  if (!wishes.fixed_lux.empty() && wishes.fixed_lux.size() != samples.points.size())
    return fmt::format("{} of fixed_lux, {} samples", wishes.fixed_lux.size(), samples.points.size());
  for (const double lux : wishes.fixed_lux) {
    if (!(lux >= 0) || !std::isfinite(lux)) return "fixed_lux must be 0 or more";
    if (lux > wishes.max_object_lx)
      return fmt::format("light that stays gives the object {:.4g} lx, {:.4g} lx are allowed", lux,
                         wishes.max_object_lx);
  }
  return "";
}

/// Every n-th interest point, with its neighbours.
AimJudge thinned_judge(const AimJudge& full, std::size_t n) {
  AimJudge judge;
  judge.wishes = full.wishes;
  judge.wishes.fixed_lux.clear();
  judge.features.sizes.assign(full.features.sizes.size(), 0);
  std::vector<std::uint32_t> kept, place(full.samples.points.size(), TargetSurface::kNone);
  const auto keep = [&](std::uint32_t i) {
    if (place[i] != TargetSurface::kNone) return;
    place[i] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(i);
  };
  for (std::uint32_t i = 0; i < full.samples.interest; i += static_cast<std::uint32_t>(n)) keep(i);
  judge.samples.interest = kept.size();
  for (std::size_t k = 0; k < judge.samples.interest; ++k) {
    for (const std::uint32_t j : full.samples.of(kept[k])) {
      keep(j);
      judge.samples.neighbours.push_back(place[j]);
    }
    judge.samples.begin.push_back(static_cast<std::uint32_t>(judge.samples.neighbours.size()));
    const std::uint32_t feature = full.features.cluster_of_point[kept[k]];
    judge.features.cluster_of_point.push_back(feature);
    ++judge.features.sizes[feature];
  }
  for (const std::uint32_t i : kept) {
    judge.samples.points.push_back(full.samples.points[i]);
    if (!full.wishes.fixed_lux.empty()) judge.wishes.fixed_lux.push_back(full.wishes.fixed_lux[i]);
  }
  for (const HeadSight& sight : full.sights) {
    HeadSight of_kept;
    for (const std::uint32_t i : kept) {
      of_kept.direction.push_back(sight.direction[i]);
      of_kept.lux_per_cd.push_back(sight.lux_per_cd[i]);
    }
    judge.sights.push_back(std::move(of_kept));
  }
  judge.limit_sights = full.limit_sights;
  judge.seen_sights = full.seen_sights;
  return judge;
}

/// The search judged only some of the samples, but all must keep the limits. Dims all heads by the same share, then the
/// key light to its ratio.
void keep_limits(const HeadAims::State& state, std::vector<HeadSetting>& settings) {
  const AimWishes& wishes = state.full.wishes;
  const AimSum fixed = state.full.objective->nothing(), sum = state.sum(state.full, settings);
  double share = 1;
  const auto keep = [&](double max_lx, double lux, double fixed_lx) {
    if (lux > max_lx) share = std::min(share, (max_lx - fixed_lx) / (lux - fixed_lx));
  };
  for (std::size_t i = 0; i < wishes.limits.size(); ++i)
    keep(wishes.limits[i].max_lx, sum.limit_lux[i], fixed.limit_lux[i]);
  for (std::size_t i = 0; i < sum.sample_lux.size(); ++i)
    keep(wishes.max_object_lx, sum.sample_lux[i], fixed.sample_lux[i]);
  keep(wishes.max_watts, sum.watts, 0);
  if (wishes.role.asks() && wishes.role.wanted_lx > 0)
    keep(wishes.role.wanted_lx, state.full.objective->own_wanted_lx(sum), 0);
  for (HeadSetting& setting : settings) setting.level *= share;
  if (!wishes.key) return;
  const double key_lx = share * sum.key_mean_lux,
               fill_lx = fixed.mean_lux + share * (sum.mean_lux - fixed.mean_lux - sum.key_mean_lux);
  if (key_lx > wishes.max_key_to_fill * fill_lx)
    settings[*wishes.key].level *= wishes.max_key_to_fill * fill_lx / key_lx;
  const double fixed_lx = fixed.mean_lux, fill_heads_lx = fill_lx - fixed_lx;
  if (key_lx < wishes.min_key_to_fill * fill_lx && fill_heads_lx > 0) {
    const double left = std::clamp((key_lx / wishes.min_key_to_fill - fixed_lx) / fill_heads_lx, 0.0, 1.0);
    for (std::size_t k = 0; k < settings.size(); ++k)
      if (k != *wishes.key) settings[k].level *= left;
  }
}

/// Brightens all heads by one factor, as far as their levels and the limits allow.
void brighten(const HeadAims::State& state, std::vector<HeadSetting>& settings) {
  const AimWishes& wishes = state.full.wishes;
  const AimSum fixed = state.full.objective->nothing(), sum = state.sum(state.full, settings);
  double factor = std::numeric_limits<double>::infinity();
  const auto keep = [&](double most, double is, double stays) {
    if (is > stays) factor = std::min(factor, (most - stays) / (is - stays));
  };
  for (std::size_t k = 0; k < settings.size(); ++k) keep(state.heads[k].max_level, settings[k].level, 0);
  for (std::size_t i = 0; i < wishes.limits.size(); ++i)
    keep(wishes.limits[i].max_lx, sum.limit_lux[i], fixed.limit_lux[i]);
  for (std::size_t i = 0; i < sum.sample_lux.size(); ++i)
    keep(wishes.max_object_lx, sum.sample_lux[i], fixed.sample_lux[i]);
  keep(wishes.max_watts, sum.watts, 0);
  if (wishes.role.asks() && wishes.role.wanted_lx > 0)
    keep(wishes.role.wanted_lx, state.full.objective->own_wanted_lx(sum), 0);
  if (!std::isfinite(factor) || factor <= 1) return;
  for (std::size_t k = 0; k < settings.size(); ++k)
    settings[k].level = std::min(factor * settings[k].level, state.heads[k].max_level);
}

/// Heads of one kind share their distributions, and each cone evaluates a quarter of a million values.
std::vector<std::vector<double>> cones_of(const std::vector<HangingHead>& heads, int threads) {
  std::vector<const IntensityDistribution*> kinds;
  for (const HangingHead& head : heads)
    for (const ZoomStop& stop : head.zoom) kinds.push_back(stop.intensity.get());
  std::sort(kinds.begin(), kinds.end());
  kinds.erase(std::unique(kinds.begin(), kinds.end()), kinds.end());
  std::vector<double> of_kind(kinds.size());
  parallel_for(kinds.size(), threads, [&](std::size_t k) { of_kind[k] = cone_of_flux_rad(*kinds[k], kBeamShare); });
  std::vector<std::vector<double>> cones;
  for (const HangingHead& head : heads) {
    cones.emplace_back();
    for (const ZoomStop& stop : head.zoom) {
      const auto at = std::lower_bound(kinds.begin(), kinds.end(), stop.intensity.get());
      cones.back().push_back(of_kind[static_cast<std::size_t>(at - kinds.begin())]);
    }
  }
  return cones;
}

/// AimResult::gain_if_lit of a dark head.
double gain_if_lit(const HeadAims::State& state, std::span<const HeadSetting> settings, std::size_t k,
                   std::span<const Vec3> aims) {
  const AimSum others = state.sum(state.full, settings);
  const AimObjective& objective = *state.full.objective;
  const HangingHead& head = state.heads[k];
  const double was = objective.objective(others);
  std::vector<double> gains(aims.size(), -std::numeric_limits<double>::infinity());
  parallel_for(aims.size(), state.options.threads, [&](std::size_t a) {
    HeadSetting setting{head.present, 0, 0};
    if (head.moves) {
      const auto joints = pan_tilt_towards(head.world_from_mount, aims[a], head.range, head.present);
      if (!joints) return;
      setting.joints = *joints;
      setting.joints.beam_rad = head.zoom[0].beam_rad;
    }
    if (!may_light(head, setting.joints)) return;
    const AimColumn column = state.full.column(head, k, setting);
    const HeadRole role = role_in(state.full.wishes, k);
    const double most = objective.highest_level(others, column, role, head.max_level, head.watts);
    for (const double share : {1.0, 0.5, 0.2, 0.05}) {
      if (!(share * most > 0)) continue;
      AimSum sum = others;
      objective.add(sum, column, share * most, role, head.watts, travel_s(head, head.present, setting.joints));
      gains[a] = std::max(gains[a], objective.objective(sum) - was);
    }
  });
  const auto most = std::max_element(gains.begin(), gains.end());
  return most != gains.end() && std::isfinite(*most) ? *most : std::numeric_limits<double>::quiet_NaN();
}

std::vector<HeadSight> seen_sights_of(const HeadAims::State& state, const RayScene& room, const SeenContrast& seen) {
  std::vector<HeadSight> sights;
  for (const HangingHead& head : state.heads)
    sights.push_back(sight_of(room, head.world_from_mount.translation_m, seen.samples(), state.options.threads));
  return sights;
}

}  // namespace

AimColumn AimJudge::column(const HangingHead& head, std::size_t index, const HeadSetting& setting) const {
  const IntensityDistribution& intensity = *head.zoom[setting.zoom].intensity;
  const Pose lamp = lamp_pose(head, setting.joints);
  std::vector<double> sample_lux(samples.points.size()), limit_lux(wishes.limits.size());
  lux_of_aim(sights[index], intensity, lamp, sample_lux);
  lux_of_aim(limit_sights[index], intensity, lamp, limit_lux);
  std::vector<float> seen_lux;
  if (wishes.seen) {
    std::vector<double> lux(wishes.seen->samples().size());
    lux_of_aim(seen_sights[index], intensity, lamp, lux);
    for (const double lx : lux) seen_lux.push_back(static_cast<float>(lx + head.reflected_lx));
  }
  return objective->column(std::move(sample_lux), std::move(limit_lux), std::move(seen_lux));
}

AimSum HeadAims::State::sum(const AimJudge& judge, std::span<const HeadSetting> settings) const {
  LUXRIG_CHECK(settings.size() == heads.size(), "{} settings of {} heads", settings.size(), heads.size());
  AimSum sum = judge.objective->nothing();
  for (std::size_t k = 0; k < heads.size(); ++k) {
    if (!(settings[k].level > 0)) continue;
    judge.objective->add(sum, judge.column(heads[k], k, settings[k]), settings[k].level, role_in(judge.wishes, k),
                         heads[k].watts, travel_s(heads[k], heads[k].present, settings[k].joints));
  }
  return sum;
}

HeadAims::HeadAims(std::unique_ptr<State> state) : state_(std::move(state)) {}
HeadAims::~HeadAims() = default;
HeadAims::HeadAims(HeadAims&&) noexcept = default;
HeadAims& HeadAims::operator=(HeadAims&&) noexcept = default;

Result<HeadAims> HeadAims::make(const ContrastSamples& samples, const FeatureClusters& features, const RayScene& room,
                                std::vector<HangingHead> heads, AimWishes wishes, const AimOptions& options) {
  if (samples.interest == 0) return refusal("the object has no interest points: there is no relief to aim at");
  if (features.cluster_of_point.size() != samples.interest)
    return refusal(
        fmt::format("features of {} points, {} interest points", features.cluster_of_point.size(), samples.interest));
  if (heads.empty()) return refusal("there is no head to aim");
  for (std::size_t k = 0; k < heads.size(); ++k)
    if (const std::string text = complaint_of_head(heads[k]); !text.empty())
      return refusal(fmt::format("head {}: {}", k, text));
  if (const std::string text = complaint_of_wishes(wishes, samples, heads.size()); !text.empty()) return refusal(text);
  if (const std::string text = complaint_of_seen(wishes); !text.empty()) return refusal(text);

  auto state = std::make_unique<State>();
  state->heads = std::move(heads);
  state->options = options;
  state->cone_rad = cones_of(state->heads, options.threads);
  AimJudge& full = state->full;
  full.samples = samples;
  full.features = features;
  full.wishes = std::move(wishes);
  std::vector<OrientedPoint> limited;
  for (const AimLimit& limit : full.wishes.limits) limited.push_back(limit.at);
  for (std::size_t i = 0; i < samples.interest; ++i)
    state->middle_world_m += samples.points[i].position_world_m / static_cast<double>(samples.interest);
  for (const HangingHead& head : state->heads) {
    const Vec3& place_m = head.world_from_mount.translation_m;
    full.sights.push_back(sight_of(room, place_m, samples.points, options.threads));
    full.limit_sights.push_back(sight_of(room, place_m, limited, 1));
    const auto& sees = full.sights.back().lux_per_cd;
    state->all_watts += head.watts;
    if (std::none_of(sees.begin(), sees.end(), [](double one) { return one > 0; })) continue;
    const double distance2_m2 = (state->middle_world_m - place_m).squaredNorm();
    for (const ZoomStop& stop : head.zoom)
      state->reference_lx =
          std::max(state->reference_lx, stop.intensity->max_intensity_cd() * head.max_level / distance2_m2);
  }
  if (!(state->reference_lx > 0) || !std::isfinite(state->reference_lx))
    return refusal("no head sees any of the object: something stands between them, or it turns away from them all");
  full.objective =
      std::make_unique<AimObjective>(full.samples, full.features, full.wishes, state->reference_lx, state->all_watts);
  if (full.wishes.seen) full.seen_sights = seen_sights_of(*state, room, *full.wishes.seen);
  const std::size_t stride =
      options.search_points > 0 ? (samples.interest + options.search_points - 1) / options.search_points : 1;
  if (stride > 1 || full.wishes.seen_quick) {
    state->thinned = std::make_unique<AimJudge>(thinned_judge(full, std::max<std::size_t>(1, stride)));
    AimJudge& judge = *state->thinned;
    if (full.wishes.seen_quick) {
      judge.wishes.seen = full.wishes.seen_quick;
      judge.wishes.seen_fixed_lux = full.wishes.seen_quick_fixed_lux;
      judge.wishes.role = full.wishes.quick_role;
      judge.seen_sights = seen_sights_of(*state, room, *judge.wishes.seen);
    }
    judge.objective = std::make_unique<AimObjective>(judge.samples, judge.features, judge.wishes, state->reference_lx,
                                                     state->all_watts);
  }
  return HeadAims(std::move(state));
}

double HeadAims::reference_lx() const { return state_->reference_lx; }

AimScore HeadAims::score(std::span<const HeadSetting> settings) const {
  return state_->full.objective->score(state_->sum(state_->full, settings));
}

Result<AimResult> HeadAims::solve() const {
  const State& state = *state_;
  const std::size_t count = state.heads.size();
  std::vector<std::vector<Vec3>> first_aims;
  for (std::size_t k = 0; k < count; ++k)
    first_aims.push_back(voted_aims(state.heads[k],
                                    *std::min_element(state.cone_rad[k].begin(), state.cone_rad[k].end()),
                                    state.full.sights[k], state.full.samples, state.options.max_aims));
  if (std::all_of(first_aims.begin(), first_aims.end(), [](const std::vector<Vec3>& aims) { return aims.empty(); }))
    return refusal("no head can be turned to anything that it sees of the object: move one, or widen its range");
  SearchedAims found = search_aims(state, first_aims);

  AimResult result;
  result.tried = found.tried;
  keep_limits(state, found.settings);
  if (state.full.wishes.measure != AimMeasure::lux && !(state.full.wishes.energy_weight > 0)) {
    brighten(state, found.settings);
    keep_limits(state, found.settings);  // fixed light may have shifted the ratio of key to fill
  }
  for (std::size_t k = 0; k < count; ++k) {
    AimedHead head;
    head.setting = found.settings[k];
    head.reaches = !first_aims[k].empty();
    const Pose lamp = lamp_pose(state.heads[k], head.setting.joints);
    head.aim_world_m = lamp.point({0, 0, -(state.middle_world_m - lamp.translation_m).norm()});
    result.heads.push_back(head);
  }
  result.score = score(found.settings);
  // Every head's share in it.
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<HeadSetting> others = found.settings;
    others[k].level = 0;
    result.gain_if_lit.push_back(found.settings[k].level > 0 ? std::numeric_limits<double>::quiet_NaN()
                                                             : gain_if_lit(state, found.settings, k, first_aims[k]));
    result.without.push_back(found.settings[k].level > 0 ? score(others) : result.score);
  }
  return result;
}

}  // namespace luxrig
