#include "core/transport/direct/emitter_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "core/transport/bsdf.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

/// Importance of a lamp that is off, relative to the brightest: its column is wanted, but should cost less.
constexpr double kMinImportance = 0.02;

auto kind_and_place_of(const Emitter& emitter) {
  const Vec3& p = emitter.world_from_lamp.translation_m;
  return std::tuple(emitter.sky != nullptr, p.x(), p.y(), p.z());
}

std::string text_of(const Vec3& v) { return fmt::format("({:g}, {:g}, {:g})", v.x(), v.y(), v.z()); }

}  // namespace

EmitterSampler::EmitterSampler(std::span<const Emitter> emitters, std::span<const double> levels,
                               const Eigen::AlignedBox3d& bounds_world_m, const SkyOpenings* openings)
    : openings_(openings && !openings->empty() ? openings : nullptr) {
  if (!bounds_world_m.isEmpty()) {
    centre_world_m_ = bounds_world_m.center();
    radius_m_ = 0.5 * bounds_world_m.diagonal().norm();
  }
  double brightest = 0;
  for (const double level : levels) brightest = std::max(brightest, level);
  const auto importance_of = [&](std::size_t e) {
    if (levels.empty() || !(brightest > 0)) return 1.0;
    return std::max(levels[e], kMinImportance * brightest);
  };
  std::vector<std::size_t> order(emitters.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return kind_and_place_of(emitters[a]) < kind_and_place_of(emitters[b]);
  });
  lamps_.reserve(order.size());
  place_of_emitter_.resize(emitters.size());
  colours_rgb_.resize(emitters.size());
  importances_.resize(emitters.size());
  for (const std::size_t e : order) {
    const Emitter& emitter = emitters[e];
    const bool sky = emitter.sky != nullptr;
    const bool point = !sky && emitter.shape.kind == LuminousShape::Kind::point;
    const Vec3& position_world_m = emitter.world_from_lamp.translation_m;
    have_size_ = have_size_ || !point;
    if (!point || places_.empty() || places_.back().kind != Kind::point ||
        places_.back().position_world_m != position_world_m) {
      Site place{sky     ? Kind::sky
                 : point ? Kind::point
                         : Kind::shape,
                 position_world_m,
                 lamps_.size(),
                 lamps_.size(),
                 emitter.shape,
                 0.5 * emitter.shape.size_m.norm(),
                 emitter.world_from_lamp.rotation,
                 sky ? only_direction(*emitter.sky) : std::nullopt};
      places_.push_back(place);
    }
    Lamp lamp{e, -Vec3::UnitZ(), -2, Mat3::Identity(), emitter.intensity.get(), emitter.sky.get(), importance_of(e), 0,
              0};
    if (!sky) {
      const double half_cone_rad = emitter.intensity->emission_cone_rad() / 2;
      // The margin keeps rounding from cutting off the rim of the cone, where intensity_cd() decides.
      lamp.cos_half_cone = half_cone_rad < kPi ? std::cos(half_cone_rad) - 1e-9 : -2.0;
      lamp.axis_world = emitter.world_from_lamp.direction(-Vec3::UnitZ());
      lamp.lamp_from_world = emitter.world_from_lamp.rotation.transpose();
    }
    lamps_.push_back(lamp);
    places_.back().end = lamps_.size();
    place_of_emitter_[e] = places_.size() - 1;
    colours_rgb_[e] = emitter.colour_rgb;
    importances_[e] = lamps_.back().importance;
  }
  for (std::size_t p = 0; p < places_.size(); ++p)
    if (places_[p].kind == Kind::shape) shapes_.push_back(p);
  form_groups();
  form_cells(bounds_world_m);
  share_out();
}

void EmitterSampler::form_cells(const Eigen::AlignedBox3d& bounds_world_m) {
  std::vector<LampProfile> profiles;
  WeighedLamps w;
  std::map<const IntensityDistribution*, std::uint32_t> profile_of;
  for (std::size_t p = 0; p < places_.size(); ++p) {
    const Site& place = places_[p];
    if (place.kind == Kind::sky) continue;
    for (std::size_t i = place.begin; i < place.end; ++i) {
      const Lamp& lamp = lamps_[i];
      const auto [known, fresh] = profile_of.try_emplace(lamp.intensity, static_cast<std::uint32_t>(profiles.size()));
      if (fresh) profiles.push_back(LampProfile::of(*lamp.intensity, place.kind == Kind::shape));
      w.x_m.push_back(place.position_world_m.x());
      w.y_m.push_back(place.position_world_m.y());
      w.z_m.push_back(place.position_world_m.z());
      w.axis_x.push_back(static_cast<float>(lamp.axis_world.x()));
      w.axis_y.push_back(static_cast<float>(lamp.axis_world.y()));
      w.axis_z.push_back(static_cast<float>(lamp.axis_world.z()));
      // Margins keep rounding from cutting off what the intensity itself decides.
      w.cos_half_cone.push_back(place.kind == Kind::shape ? -2.0f : static_cast<float>(lamp.cos_half_cone) - 1e-5f);
      w.importance.push_back(static_cast<float>(lamp.importance));
      w.radius_m.push_back(static_cast<float>(place.radius_m));
      w.place.push_back(static_cast<std::uint32_t>(p));
      w.profile.push_back(known->second);
    }
  }
  cells_ = LampCells(std::move(w), std::move(profiles), places_.size(), bounds_world_m);
}

void EmitterSampler::form_groups() {
  const auto skies = static_cast<std::size_t>(
      std::count_if(places_.begin(), places_.end(), [](const Site& p) { return p.kind == Kind::sky; }));
  const std::size_t luminaires = luminous_places_ = places_.size() - skies;
  const std::size_t groups = std::min(luminaires, kMaxGroups);
  group_of_emitter_.resize(place_of_emitter_.size());
  for (std::size_t p = 0; p < places_.size(); ++p) {
    const std::size_t g = p < luminaires ? p * groups / luminaires : groups + p - luminaires;
    if (g == groups_.size()) groups_.push_back({0, places_[p].begin, places_[p].end});
    groups_[g].end = places_[p].end;
    for (std::size_t i = places_[p].begin; i < places_[p].end; ++i) group_of_emitter_[lamps_[i].emitter] = g;
  }
}

void EmitterSampler::share_out() {
  double luminaires = 0;
  std::size_t skies = 0;
  for (const Site& place : places_)
    for (std::size_t i = place.begin; i < place.end; ++i) {
      Lamp& lamp = lamps_[i];
      if (lamp.sky) ++skies;
      if (lamp.sky) continue;
      lamp.share = lamp.importance * lamp.intensity->flux_lm() * inward_share(lamp, place);
      luminaires += lamp.share;
    }
  // Most light of a sky falls outside: all skies together get half as much as the luminaires.
  const double per_sky = skies == 0 ? 0 : luminaires > 0 ? 0.5 * luminaires / static_cast<double>(skies) : 1.0;
  double sum = 0;
  for (Lamp& lamp : lamps_) sum += lamp.share = lamp.sky ? per_sky : lamp.share;
  if (!(sum > 0)) return;  // no light can be traced; paths find all of it
  for (Group& group : groups_) {
    double of_group = 0, before = 0;
    for (std::size_t i = group.begin; i < group.end; ++i) of_group += lamps_[i].share;
    group.share = of_group / sum;
    for (std::size_t i = group.begin; i < group.end; ++i) {
      if (of_group > 0) lamps_[i].share /= of_group;
      lamps_[i].share_begin = before;
      before += lamps_[i].share;
    }
  }
}

double EmitterSampler::inward_share(const Lamp& lamp, const Site& place) const {
  if ((place.position_world_m - centre_world_m_).norm() <= radius_m_) return 1;
  constexpr std::uint32_t kProbes = 64;
  const SobolSequence probes(0x1a4b);
  int inward = 0;
  for (std::uint32_t k = 0; k < kProbes; ++k) {
    const auto [u, v] = probes.pair(k, 0, 0);
    const DirectionSample sample = lamp.intensity->sample(u, v);
    if (!(sample.density_per_sr > 0)) continue;
    // Whether the ray passes the sphere around all geometry, widened by the lamp's size.
    const Vec3 direction_world = lamp.lamp_from_world.transpose() * sample.direction;
    const Vec3 to_centre_m = centre_world_m_ - place.position_world_m;
    const double along_m = to_centre_m.dot(direction_world);
    inward += along_m > 0 && (to_centre_m - along_m * direction_world).norm() <= radius_m_ + place.radius_m;
  }
  return static_cast<double>(inward) / kProbes;
}

double EmitterSampler::weigh(const Vec3& position_world_m, const Vec3& normal_world, Weights& weights) const {
  weights.cell = &cells_.at(position_world_m);
  weights.places.assign(weights.cell->places.size(), 0.0);
  constexpr std::size_t kAtOnce = 32;
  std::array<float, kAtOnce> weight, half_sine;
  const double at_x = position_world_m.x(), at_y = position_world_m.y(), at_z = position_world_m.z();
  const Vec3f normal = normal_world.cast<float>();
  const float normal_x = normal.x(), normal_y = normal.y(), normal_z = normal.z();
  const WeighedLamps& w = weights.cell->lamps;
  for (std::size_t begin = 0; begin < w.place.size(); begin += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, w.place.size() - begin);
    // No branches and no calls, so that the compiler vectorises it.
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = begin + k;
      const auto x = static_cast<float>(w.x_m[i] - at_x), y = static_cast<float>(w.y_m[i] - at_y),
                 z = static_cast<float>(w.z_m[i] - at_z);
      const float radius_m = w.radius_m[i];
      const float distance_m = std::max(std::sqrt(x * x + y * y + z * z), radius_m);
      const float per_distance = 1 / distance_m;
      const float height_m = normal_x * x + normal_y * y + normal_z * z + radius_m + 1e-6f * distance_m;
      const float cosine = -(w.axis_x[i] * x + w.axis_y[i] * y + w.axis_z[i] * z) * per_distance;
      const bool sees = height_m > 0 && cosine >= w.cos_half_cone[i];
      weight[k] = sees ? w.importance[i] * height_m * per_distance * per_distance * per_distance : 0;
      half_sine[k] = std::sqrt(std::max(0.0f, 0.5f - 0.5f * cosine));
    }
    for (std::size_t k = 0; k < count; ++k) {
      if (!(weight[k] > 0)) continue;
      const float candela = cells_.profile(w.profile[begin + k]).candela[LampProfile::bin_of(half_sine[k])];
      const double product = static_cast<double>(weight[k]) * static_cast<double>(candela);
      if (std::isfinite(product)) weights.places[w.place[begin + k]] += product;
    }
  }
  if (any_sky()) weigh_skies(position_world_m, normal_world, weights);
  double sum = weights.cell->rest_sum_lx;
  for (const double one : weights.places) sum += one;
  return sum;
}

EmitterChoice EmitterSampler::choose(const Vec3& position_world_m, const Vec3& normal_world, const Weights& weights,
                                     double sum, double select, double u, double v) const {
  EmitterChoice choice;
  if (!(sum > 0)) return choice;
  double left = select * sum, weight = 0;
  const auto taken = [&](std::size_t p, double lx) {
    if (!(lx > 0)) return false;
    choice.place = p;
    weight = lx;
    if (left < lx) return true;
    left -= lx;
    return false;
  };
  const LampCells::Cell& cell = *weights.cell;
  std::size_t k = 0;
  while (k < cell.places.size() && !taken(cell.places[k], weights.places[k])) ++k;
  if (k == cell.places.size())
    for (std::size_t r = 0; r < cell.rest.size() && !taken(cell.rest[r], static_cast<double>(cell.rest_lx[r])); ++r) {
    }
  const Site& place = places_[choice.place];
  const double probability = weight / sum;
  if (place.kind != Kind::sky) return ask_place(choice.place, probability, position_world_m, normal_world, u, v);
  const double whole = whole_sky_share(place, weights);
  // The remainder of the number after each choice is again uniform.
  const double rest = std::clamp(left / weight, 0.0, 1 - 0x1p-53);
  DirectionSample sample = rest < whole
                               ? lamps_[place.begin].sky->sample(u, v)
                               : openings_->sample(weights.view, position_world_m, (rest - whole) / (1 - whole), u, v);
  const double cosine = normal_world.dot(sample.direction);
  if (!(sample.density_per_sr > 0) || !(cosine > 0)) return choice;
  if (whole < 1) sample.density_per_sr = sky_density_per_sr(place, position_world_m, sample.direction, weights);
  choice.direction_world = sample.direction;
  choice.target_world_m = beyond_world_m(position_world_m, sample.direction);
  choice.factor = cosine;
  choice.hit_factor = cosine * line_density_per_m2(sample.direction, position_world_m);
  choice.in_place = sample.density_per_sr;
  choice.density = probability * sample.density_per_sr;
  return choice;
}

EmitterChoice EmitterSampler::ask_place(std::size_t which, double probability, const Vec3& position_world_m,
                                        const Vec3& normal_world, double u, double v) const {
  EmitterChoice choice;
  choice.place = which;
  const Site& place = places_[which];
  if (place.kind == Kind::point) {
    const Vec3 towards_m = place.position_world_m - position_world_m;
    const double distance_m = towards_m.norm();
    choice.direction_world = towards_m / distance_m;
    choice.target_world_m = place.position_world_m;
    choice.factor = normal_world.dot(choice.direction_world) / (distance_m * distance_m);
    choice.hit_factor = choice.factor;
    choice.density = choice.factor > 0 ? probability : 0;
  } else {
    const ShapeSample seen = sample_seen_from(place.shape, at_lamp_m(place, position_world_m), u, v);
    if (seen.density_per_sr > 0)
      fill_in(choice, position_world_m, seen.distance_m, seen.density_per_sr, normal_world,
              place.world_from_lamp * seen.direction);
    choice.density *= probability;
  }
  return choice;
}

EmitterChoice EmitterSampler::place_towards(std::size_t which, const Vec3& position_world_m, const Vec3& normal_world,
                                            const Vec3& direction_world) const {
  EmitterChoice choice;
  choice.place = which;
  const Site& place = places_[which];
  const Vec3 from_m = at_lamp_m(place, position_world_m);
  const Vec3 direction = place.world_from_lamp.transpose() * direction_world;
  const double density = density_seen_from(place.shape, from_m, direction);
  if (density > 0)
    fill_in(choice, position_world_m, distance_towards_m(place.shape, from_m, direction), density, normal_world,
            direction_world);
  return choice;
}

void EmitterSampler::fill_in(EmitterChoice& choice, const Vec3& position_world_m, double distance_m,
                             double density_per_sr, const Vec3& normal_world, const Vec3& direction_world) const {
  const Site& place = places_[choice.place];
  const double cosine = normal_world.dot(direction_world);
  const double area_m2 = projected_area_m2(place.shape, -(place.world_from_lamp.transpose() * direction_world));
  if (!(cosine > 0) || !(area_m2 > 0)) return;
  choice.direction_world = direction_world;
  choice.target_world_m = position_world_m + distance_m * direction_world;
  choice.factor = choice.hit_factor = cosine / area_m2;
  choice.in_place = choice.density = density_per_sr;
}

Vec3 EmitterSampler::beyond_world_m(const Vec3& position_world_m, const Vec3& direction_world) const {
  return position_world_m + (2 * radius_m_ + (position_world_m - centre_world_m_).norm()) * direction_world;
}

double EmitterSampler::choice_density(std::size_t emitter, const Vec3& position_world_m, const Vec3& direction_world,
                                      const Weights& weights, double sum) const {
  const std::size_t p = place_of_emitter_[emitter];
  const double probability = place_probability(p, weights, sum);
  if (!(probability > 0)) return 0;
  const Site& place = places_[p];
  if (place.kind == Kind::sky)
    return probability * sky_density_per_sr(place, position_world_m, direction_world, weights);
  return probability * density_in_place(p, position_world_m, direction_world);
}

double EmitterSampler::place_probability(std::size_t p, const Weights& weights, double sum) const {
  const std::size_t slot = weights.cell->slot_of(p);
  const double weight = slot < weights.places.size() ? weights.places[slot] : weights.cell->rest_of(p);
  return weight > 0 ? weight / sum : 0;
}

double EmitterSampler::density_in_place(std::size_t which, const Vec3& position_world_m,
                                        const Vec3& direction_world) const {
  const Site& place = places_[which];
  if (place.kind == Kind::point) return 1;
  return density_seen_from(place.shape, at_lamp_m(place, position_world_m),
                           place.world_from_lamp.transpose() * direction_world);
}

double EmitterSampler::importance_cd(std::size_t which, const Vec3& leaving_world) const {
  const Site& place = places_[which];
  double candela = 0;
  for (std::size_t i = place.begin; i < place.end; ++i) {
    const Lamp& lamp = lamps_[i];
    if (lamp.axis_world.dot(leaving_world) < lamp.cos_half_cone) continue;
    candela += lamp.importance * lamp.intensity->intensity_cd(lamp.lamp_from_world * leaving_world);
  }
  return candela;
}

double EmitterSampler::place_share(std::size_t which) const {
  const Site& place = places_[which];
  double share = 0;
  for (std::size_t i = place.begin; i < place.end; ++i)
    share += lamps_[i].share * groups_[group_of_emitter_[lamps_[i].emitter]].share;
  return share;
}

EmitterRay EmitterSampler::emit(std::size_t group, double u, double v, double s, double t) const {
  EmitterRay ray;
  const auto begin = lamps_.begin() + static_cast<std::ptrdiff_t>(groups_[group].begin);
  const auto end = lamps_.begin() + static_cast<std::ptrdiff_t>(groups_[group].end);
  const auto after = std::upper_bound(begin, end, u, [](double at, const Lamp& lamp) { return at < lamp.share_begin; });
  const Lamp& lamp = *(after - 1);
  if (!(lamp.share > 0)) return ray;
  // The remainder of u after the choice is again uniform.
  const double rest = std::clamp((u - lamp.share_begin) / lamp.share, 0.0, 1 - 0x1p-53);
  ray.emitter = lamp.emitter;
  const Site& place = places_[place_of_emitter_[lamp.emitter]];
  if (place.kind == Kind::sky) return emit_sky(lamp, rest, v, s, t);
  const DirectionSample sample = lamp.intensity->sample(rest, v);
  if (!(sample.density_per_sr > 0)) return ray;
  ray.direction_world = lamp.lamp_from_world.transpose() * sample.direction;
  ray.from_world_m = place.position_world_m;
  ray.density = lamp.share * sample.density_per_sr;
  ray.flux_lm = lamp.intensity->intensity_cd(sample.direction) / ray.density;
  if (place.kind == Kind::shape) {
    const double area_m2 = projected_area_m2(place.shape, sample.direction);
    if (!(area_m2 > 0)) {
      ray.flux_lm = 0;
      return ray;
    }
    ray.per_area = 1 / area_m2;
    ray.from_world_m += place.world_from_lamp * sample_leaving_place_m(place.shape, sample.direction, s, t);
  }
  return ray;
}

double smallest_distance_m(const Vec3& a_world_m, const Vec3& b_world_m) {
  const double size_m = std::max(a_world_m.cwiseAbs().maxCoeff(), b_world_m.cwiseAbs().maxCoeff());
  // Error of d: each point is off by size·ε/2, so 2·size·ε/2; error of d⁻²: twice the relative error.
  return std::max(2e6 * size_m * std::numeric_limits<double>::epsilon(), 1e-100);
}

Result<void> check_evaluation(std::span<const Receiver> receivers, std::span<const Emitter> emitters,
                              const EvaluateOptions& options) {
  if (!(options.wanted_relative_error > 0) || !std::isfinite(options.wanted_relative_error))
    return refusal(fmt::format("wanted relative error is {:g}; it must be above 0", options.wanted_relative_error));
  if (!(options.wanted_rms_error >= 0) || !std::isfinite(options.wanted_rms_error))
    return refusal(fmt::format("wanted rms error is {:g}; it must be 0 or above", options.wanted_rms_error));
  if (!options.levels.empty() && options.levels.size() != emitters.size())
    return refusal(fmt::format("{} levels for {} emitters", options.levels.size(), emitters.size()));
  for (std::size_t e = 0; e < options.levels.size(); ++e)
    if (!(options.levels[e] >= 0) || !std::isfinite(options.levels[e]))
      return refusal(
          fmt::format("level of emitter {} is {:g}; it must be finite and at least 0", e, options.levels[e]));
  for (std::size_t r = 0; r < receivers.size(); ++r) {
    const Receiver& receiver = receivers[r];
    if (!receiver.position_world_m.allFinite() || !receiver.normal_world.allFinite())
      return refusal(fmt::format("receiver {} is not finite: position {}, normal {}", r,
                                 text_of(receiver.position_world_m), text_of(receiver.normal_world)));
    if (std::abs(receiver.normal_world.norm() - 1) > 1e-6)
      return refusal(fmt::format("normal of receiver {} has length {:g}, not 1", r, receiver.normal_world.norm()));
  }
  for (std::size_t e = 0; e < emitters.size(); ++e) {
    const Emitter& emitter = emitters[e];
    if (!emitter.colour_rgb.allFinite() || emitter.colour_rgb.minCoeff() < 0)
      return refusal(fmt::format("colour of emitter {} is {}", e, text_of(emitter.colour_rgb)));
    if (emitter.sky) continue;
    if (!emitter.shape.size_m.allFinite() || emitter.shape.size_m.minCoeff() < 0)
      return refusal(fmt::format("size of emitter {} is {}", e, text_of(emitter.shape.size_m)));
    if (!emitter.intensity) return refusal(fmt::format("emitter {} has no intensity distribution", e));
    const Pose& pose = emitter.world_from_lamp;
    if (!pose.rotation.allFinite() || !pose.translation_m.allFinite())
      return refusal(fmt::format("pose of emitter {} is not finite", e));
    if (!(pose.rotation.transpose() * pose.rotation).isIdentity(1e-6))
      return refusal(fmt::format("rotation of emitter {} is not a rotation", e));
    if (emitter.shape.kind != LuminousShape::Kind::point) continue;  // its lux is finite everywhere
    for (std::size_t r = 0; r < receivers.size(); ++r) {
      const Vec3& at = receivers[r].position_world_m;
      const double distance_m = (at - pose.translation_m).norm();
      if (distance_m <= smallest_distance_m(at, pose.translation_m))
        return refusal(fmt::format("emitter {} lies in receiver {} at {} (distance {:g} m): its lux there is infinite",
                                   e, r, text_of(at), distance_m));
    }
  }
  return {};
}

}  // namespace luxrig
