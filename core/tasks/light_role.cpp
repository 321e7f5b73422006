#include "core/tasks/light_role.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luxrig {
namespace {

constexpr double kRimEdgeWeight = 6;
/// What faces the camera is turned from it by at most this.
const double kFrontCosine = std::cos(rad_from_deg(60));

void make_sum_one(std::vector<float>& weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(sum > 0)) weights.clear();
  for (float& one : weights) one = static_cast<float>(one / sum);
}

template <class Is>
std::vector<float> weights_where(const SeenContrast& seen, const Is& is) {
  std::vector<float> weights(seen.samples().size(), 0);
  for (std::size_t s = 0; s < weights.size(); ++s) weights[s] = is(s) ? 1 : 0;
  make_sum_one(weights);
  return weights;
}

/// The object's places that light leaves dark, and the light of those that it does not.
struct KeyLight {
  double mean_lx = 0, lx = 0;
  std::vector<float> dark;
};
KeyLight key_light_of(const SeenContrast& seen, std::span<const float> lux) {
  KeyLight key;
  const auto lux_at = [&](std::size_t s) { return lux.empty() ? 0.0f : lux[s]; };
  std::vector<float> of_object;
  for (std::size_t s = 0; s < seen.samples().size(); ++s)
    if (seen.of_object(s)) of_object.push_back(lux_at(s));
  key.mean_lx = std::accumulate(of_object.begin(), of_object.end(), 0.0) / static_cast<double>(of_object.size());
  const auto at_least =
      of_object.begin() + static_cast<std::ptrdiff_t>(kLeastDark * static_cast<double>(of_object.size()));
  std::nth_element(of_object.begin(), at_least, of_object.end());
  const double dark_lx = std::max(key.mean_lx / 2, static_cast<double>(*at_least));
  key.dark = weights_where(seen, [&](std::size_t s) { return seen.of_object(s) && lux_at(s) <= dark_lx; });
  key.lx = mean_lx_of(
      weights_where(seen, [&](std::size_t s) { return seen.of_object(s) && lux_at(s) >= key.mean_lx * (1 - 1e-6); }),
      lux);
  return key;
}

}  // namespace

SeenWishes wishes_of(const ReliefSpec& relief) {
  SeenWishes wishes;
  if (relief.role == LightRole::rim) wishes = {0, 0, 0, kRimEdgeWeight, 0};
  const SeenWeights& weights = relief.weights;
  wishes.even_weight = weights.even * SeenWishes{}.lit_weight;
  wishes.shadows_weight = weights.shadows * SeenWishes{}.lit_weight;
  wishes.fine_weight *= weights.fine;
  wishes.form_weight *= weights.form;
  wishes.lit_weight *= weights.lit;
  wishes.edge_weight *= weights.edge;
  wishes.max_clipped = weights.max_clipped;
  return wishes;
}

Result<AskedOfLight> asked_of_light(const ReliefSpec& relief, const SeenContrast& seen, const Vec3& middle_world_m,
                                    const Vec3& eye_world_m, std::span<const float> fixed_lux) {
  AskedOfLight asked;
  SeenRole& role = asked.role;
  const KeyLight key = key_light_of(seen, fixed_lux);
  const auto of_object = [&](std::size_t s) { return seen.of_object(s); };
  const auto towards_eye = [&](std::size_t s) {
    const OrientedPoint& at = seen.samples()[s];
    return at.normal.dot((eye_world_m - at.position_world_m).normalized());
  };
  if (!(key.lx > 0) && (relief.ratio || relief.role == LightRole::fill))
    return refusal(
        relief.role == LightRole::key
            ? "no other light reaches the object, so the key has no ratio: remove ratio, or put a task with "
              "other light before it"
            : fmt::format("no light reaches the object that a {} could go with: put the key's task before it",
                          name_of(relief.role)));
  const auto as_bright_as = [&](double ratio) {
    if (!(key.lx > 0)) return;
    asked.other_lx = key.lx;
    role.wanted_lx = key.lx / ratio;
  };
  switch (relief.role) {
    case LightRole::any:
      break;
    case LightRole::key:
      if (!relief.ratio) break;
      role.wanted = weights_where(seen, of_object);
      asked.other_lx = key.mean_lx;
      role.wanted_lx = *relief.ratio * key.mean_lx;
      break;
    case LightRole::fill: {
      role.wanted = key.dark;
      const double ratio = relief.ratio.value_or(kFillRatio);
      asked.there_lx = mean_lx_of(role.wanted, fixed_lux);
      as_bright_as(ratio);
      if (!(role.wanted_lx > asked.there_lx))
        return refusal(
            fmt::format("key to fill is {:.2f} by the light that is there, and {:g} is wanted: lower ratio, or "
                        "leave the fill out",
                        key.lx / asked.there_lx, ratio));
      role.wanted_lx -= asked.there_lx;
      break;
    }
    case LightRole::rim: {
      std::vector<bool> along(seen.samples().size(), false);
      for (const std::uint32_t s : seen.outline()) along[s] = true;
      role.wanted = weights_where(seen, [&](std::size_t s) { return along[s]; });
      role.spared = weights_where(
          seen, [&](std::size_t s) { return seen.of_object(s) && !along[s] && towards_eye(s) > kFrontCosine; });
      role.max_spill = kRimSpill;
      as_bright_as(relief.ratio.value_or(kRimRatio));
      break;
    }
    case LightRole::background: {
      const Vec3 ahead = (middle_world_m - eye_world_m).normalized();
      role.wanted = weights_where(seen, [&](std::size_t s) {
        return !seen.of_object(s) && (seen.samples()[s].position_world_m - middle_world_m).dot(ahead) > 0;
      });
      if (role.wanted.empty()) return refusal("its camera sees nothing behind the object");
      role.spared = weights_where(seen, of_object);
      role.max_spill = kBackgroundSpill;
      role.evenly = true;
      as_bright_as(relief.ratio.value_or(kBackgroundRatio));
      break;
    }
  }
  if (relief.set_up == SetUp::copy) {
    role.wanted = weights_where(seen, of_object);
    role.evenly = true;
  }
  return asked;
}

std::optional<double> ratio_of(LightRole role, const AskedOfLight& asked, double own_lx) {
  if (!(asked.other_lx > 0) || !(own_lx > 0)) return std::nullopt;
  return role == LightRole::key ? own_lx / asked.other_lx : asked.other_lx / (asked.there_lx + own_lx);
}

WantedPlaces wanted_places(const SeenContrast& seen, const SeenRole& role, std::size_t most) {
  std::vector<std::size_t> all;
  for (std::size_t s = 0; s < role.wanted.size(); ++s)
    if (role.wanted[s] > 0) all.push_back(s);
  WantedPlaces places;
  const std::size_t count = std::min(most, all.size());
  for (std::size_t k = 0; k < count; ++k) places.samples.points.push_back(seen.samples()[all[k * all.size() / count]]);
  places.samples.interest = count;
  places.samples.begin.assign(count + 1, 0);
  places.features.cluster_of_point.assign(count, 0);
  places.features.sizes = {static_cast<std::uint32_t>(count)};
  return places;
}

}  // namespace luxrig
