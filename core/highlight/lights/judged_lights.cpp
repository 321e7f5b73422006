#include "core/highlight/lights/judged_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/highlight/lights/mounted_lights.h"
#include "core/highlight/shadow/direction_modes.h"
#include "core/highlight/shadow/relief_contrast.h"
#include "core/parallel.h"
#include "core/photometry/beam.h"

namespace luxrig {
namespace {

constexpr double kJudgedBeamShare = 0.9;  ///< of the flux within the beam (thesis §6.5)
constexpr double kSeenOfReference = 0.02;
constexpr std::size_t kMaxAimsOfPlace = 3;
/// Most candidates kept within half the least angle of one another, and from one place.
constexpr std::size_t kMaxFromDirection = 12, kMaxFromPlace = 2;
constexpr int kMaxJudgedLights = 64;
/// Lights chosen by votes that are kept as a start, whatever their own score.
constexpr std::size_t kMaxBegun = 16;
constexpr int kAimsAround = 8;
/// As shares of the beam's angle.
constexpr double kFirstAimStep = 0.25, kLastAimStep = 1.0 / 64;
constexpr int kMaxMovesOfStep = 4;

struct PlaceOfAims {
  Vec3 position_world_m;
  std::vector<Vec3> voted;
};

std::vector<PlaceOfAims> places_of(std::span<const Vec3> places_world_m, const PotentialLights& voted) {
  std::vector<PlaceOfAims> places;
  for (const PotentialLight& light : voted.lights) {
    if (places.empty() || places.back().position_world_m != light.position_world_m)
      places.push_back({light.position_world_m, {}});
    places.back().voted.push_back(light.direction);
  }
  for (const Vec3& place_world_m : places_world_m) places.push_back({place_world_m, {}});
  return places;
}

void lux_along(const HeadSight& sight, const IntensityDistribution& intensity, const Vec3& direction,
               std::vector<double>& exact, std::vector<float>& lux) {
  exact.resize(sight.lux_per_cd.size());
  lux_of_aim(sight, intensity, {aimed_beam(Vec3::Zero(), direction, nullptr).world_from_lamp, Vec3::Zero()}, exact);
  lux.assign(exact.begin(), exact.end());
}

struct TriedAim {
  std::uint32_t place;
  Vec3 direction;
  double contrast_lx;
};

/// Aims that votes would choose, in their order.
std::vector<TriedAim> begun_aims(const PotentialLights& voted, const std::vector<PlaceOfAims>& places) {
  std::vector<TriedAim> begun;
  if (voted.lights.empty()) return begun;
  LightSelection selection(voted);
  while (begun.size() < kMaxBegun) {
    const auto light = selection.add();
    if (!light) break;
    const PotentialLight& taken = voted.lights[*light];
    const auto place = std::ranges::find(places, taken.position_world_m, &PlaceOfAims::position_world_m);
    begun.push_back({static_cast<std::uint32_t>(place - places.begin()), taken.direction, 0});
  }
  return begun;
}

/// Aims at one place, with the contrast of each at some samples.
std::vector<TriedAim> tried_aims(const PlaceOfAims& place, std::uint32_t index, const HeadSight& sight,
                                 const ContrastSamples& samples, const IntensityDistribution& intensity,
                                 double window_rad) {
  std::vector<Vec3f> directions;
  std::vector<double> weights;
  for (std::size_t i = 0; i < samples.interest; ++i) {
    const double mine = sight.lux_per_cd[i];
    double largest = 0;
    Vec3 way = sight.direction[i];
    for (const std::uint32_t n : samples.of(i)) {
      largest = std::max(largest, std::abs(mine - sight.lux_per_cd[n]));
      if (way.isZero(0)) way = sight.direction[n];
    }
    if (!(largest > 0)) continue;
    directions.push_back(way.cast<float>());
    weights.push_back(largest);
  }
  std::vector<Vec3> aims = place.voted;
  if (!directions.empty()) {
    const auto modes = direction_modes(directions, weights, window_rad);
    for (std::size_t m = 0; m < std::min(modes.size(), kMaxAimsOfPlace); ++m) aims.push_back(modes[m].direction);
  }
  std::vector<TriedAim> tried;
  std::vector<double> exact;
  std::vector<float> lux;
  for (const Vec3& aim : aims) {
    lux_along(sight, intensity, aim, exact, lux);
    const double contrast_lx = local_contrast_of(samples, lux);
    if (contrast_lx > 0) tried.push_back({index, aim, contrast_lx});
  }
  return tried;
}

/// The start aims, then the best ones, with limits per direction and place.
std::vector<TriedAim> kept_aims(std::vector<TriedAim> begun, std::vector<TriedAim> tried,
                                const std::vector<PlaceOfAims>& places, const Vec3& middle_world_m,
                                const JudgedLightOptions& options) {
  std::stable_sort(tried.begin(), tried.end(),
                   [](const TriedAim& a, const TriedAim& b) { return a.contrast_lx > b.contrast_lx; });
  const double cosine = std::cos(options.min_angle_rad / 2);
  std::vector<std::size_t> of_place(places.size(), 0);
  const auto is_begun = [&](const TriedAim& aim) {
    return std::ranges::any_of(
        begun, [&](const TriedAim& one) { return one.place == aim.place && one.direction == aim.direction; });
  };
  std::vector<TriedAim> kept;
  std::vector<Vec3> from;
  for (const TriedAim& aim : tried) {
    if (kept.size() == options.max_candidates) break;
    if (is_begun(aim)) continue;
    if (of_place[aim.place] == kMaxFromPlace) continue;
    const Vec3 mine = (places[aim.place].position_world_m - middle_world_m).normalized();
    const auto near = std::ranges::count_if(from, [&](const Vec3& other) { return other.dot(mine) > cosine; });
    if (static_cast<std::size_t>(near) >= kMaxFromDirection) continue;
    ++of_place[aim.place];
    kept.push_back(aim);
    from.push_back(mine);
  }
  begun.insert(begun.end(), kept.begin(), kept.end());
  return begun;
}

tl::unexpected<Fault> judged_search_stopped() {
  return tl::unexpected(Fault{Cause::cancelled, "", "the search for lights was stopped", {}});
}

std::string complaint_of(const JudgedLightOptions& options) {
  if (!(options.min_angle_rad >= 0 && options.min_angle_rad <= kPi))
    return fmt::format("lights cannot be {} rad apart", options.min_angle_rad);
  if (!(options.coverage_weight >= 0) || !std::isfinite(options.coverage_weight))
    return fmt::format("a coverage weight of {} is not 0 or more", options.coverage_weight);
  if (!(options.lift_m >= 0) || !std::isfinite(options.lift_m))
    return fmt::format("rays cannot start {} m off the surface", options.lift_m);
  if (options.first_points < 1 || options.max_candidates < 1) return "no points or no candidates to judge by";
  return "";
}

}  // namespace

struct JudgedLights::State {
  JudgedLightOptions options;
  Intensity intensity;
  double beam_rad = 0, seen_lx = 0;
  Vec3 middle_world_m = Vec3::Zero();  // of the interest points
  ContrastSamples samples;
  FeatureClusters features;
  std::vector<Vec3> places_world_m;  // of the candidates
  PlaceSights sights;
  std::vector<JudgedLight> candidates;
  std::uint32_t begun = 0;  // the first candidates: those that votes would choose
  std::uint64_t rays = 0;

  [[nodiscard]] JudgedLight light(std::uint32_t place, const Vec3& direction, const HeadSight& sight) const {
    JudgedLight made{places_world_m[place], direction, place, {}};
    std::vector<double> exact;
    lux_along(sight, *intensity, direction, exact, made.lux);
    return made;
  }
  [[nodiscard]] HeadSight sight(std::uint32_t place) const {
    return sight_from(sights, place, places_world_m[place], samples.points);
  }
};

JudgedLights::JudgedLights(std::unique_ptr<State> state) : state_(std::move(state)) {}
JudgedLights::~JudgedLights() = default;
JudgedLights::JudgedLights(JudgedLights&&) noexcept = default;
JudgedLights& JudgedLights::operator=(JudgedLights&&) noexcept = default;

std::span<const JudgedLight> JudgedLights::candidates() const { return state_->candidates; }
const ContrastSamples& JudgedLights::samples() const { return state_->samples; }
std::uint64_t JudgedLights::rays() const { return state_->rays; }

Result<JudgedLights> JudgedLights::make(const TargetSurface& surface, const TargetRays& target,
                                        std::span<const std::uint32_t> interest, const FeatureClusters& features,
                                        std::span<const Vec3> places_world_m, const PotentialLights& voted,
                                        Intensity intensity, const JudgedLightOptions& options) {
  if (interest.empty()) return refusal("no interest points: there is no relief that a light could bring out");
  if (features.cluster_of_point.size() != interest.size())
    return refusal(
        fmt::format("features of {} points, {} interest points", features.cluster_of_point.size(), interest.size()));
  if (!intensity) return refusal("the luminaire has no distribution of light");
  if (const std::string text = complaint_of(options); !text.empty()) return refusal(text);
  const std::vector<PlaceOfAims> places = places_of(places_world_m, voted);
  if (places.empty()) return refusal("there is no place for a luminaire");
  for (const PlaceOfAims& place : places)
    if (!place.position_world_m.allFinite()) return refusal("a place for a luminaire is not finite");

  auto state = std::make_unique<State>();
  state->options = options;
  state->intensity = std::move(intensity);
  state->beam_rad = cone_of_flux_rad(*state->intensity, kJudgedBeamShare);
  state->features = features;
  state->samples = one_ring_samples(surface, interest);
  for (std::size_t i = 0; i < interest.size(); ++i)
    state->middle_world_m += state->samples.points[i].position_world_m / static_cast<double>(interest.size());

  std::vector<std::uint32_t> first;
  for (std::size_t k = 0; k < std::min(interest.size(), options.first_points); ++k)
    first.push_back(interest[k * interest.size() / std::min(interest.size(), options.first_points)]);
  const ContrastSamples first_samples = one_ring_samples(surface, first);
  std::vector<Vec3> all_world_m;
  for (const PlaceOfAims& place : places) all_world_m.push_back(place.position_world_m);
  std::vector<std::vector<TriedAim>> tried(places.size());
  {
    const PlaceSights sights = sights_of_places(target, options.surroundings, first_samples.points, all_world_m,
                                                options.lift_m, options.threads);
    state->rays += sights.rays;
    if (options.watch.stop.stop_requested()) return judged_search_stopped();
    parallel_for(places.size(), options.threads, [&](std::size_t p) {
      if (options.watch.stop.stop_requested()) return;
      tried[p] = tried_aims(places[p], static_cast<std::uint32_t>(p),
                            sight_from(sights, p, all_world_m[p], first_samples.points), first_samples,
                            *state->intensity, std::min(kPi, state->beam_rad / 2));
    });
  }
  if (options.watch.stop.stop_requested()) return judged_search_stopped();
  std::vector<TriedAim> all;
  for (const auto& of_place : tried) all.insert(all.end(), of_place.begin(), of_place.end());
  if (all.empty())
    return refusal(
        fmt::format("light from none of {} places makes any contrast at the interest points: something stands between "
                    "them, or they turn away from all places",
                    places.size()));
  std::vector<TriedAim> begun = begun_aims(voted, places);
  state->begun = static_cast<std::uint32_t>(begun.size());
  const std::vector<TriedAim> kept =
      kept_aims(std::move(begun), std::move(all), places, state->middle_world_m, options);

  std::vector<std::uint32_t> place_of(kept.size());
  std::vector<std::uint32_t> new_index(places.size(), TargetSurface::kNone);
  double nearest_m2 = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < kept.size(); ++c) {
    std::uint32_t& index = new_index[kept[c].place];
    if (index == TargetSurface::kNone) {
      index = static_cast<std::uint32_t>(state->places_world_m.size());
      state->places_world_m.push_back(all_world_m[kept[c].place]);
      nearest_m2 = std::min(nearest_m2, (all_world_m[kept[c].place] - state->middle_world_m).squaredNorm());
    }
    place_of[c] = index;
  }
  state->seen_lx = nearest_m2 > 0 ? kSeenOfReference * state->intensity->max_intensity_cd() / nearest_m2 : 0;
  state->sights = sights_of_places(target, options.surroundings, state->samples.points, state->places_world_m,
                                   options.lift_m, options.threads);
  state->rays += state->sights.rays;
  state->candidates.resize(kept.size());
  parallel_for(kept.size(), options.threads, [&](std::size_t c) {
    state->candidates[c] = state->light(place_of[c], kept[c].direction, state->sight(place_of[c]));
  });
  return JudgedLights(std::move(state));
}

JudgedSelection JudgedLights::selection() const {
  JudgedWishes wishes;
  wishes.coverage_weight = state_->options.coverage_weight;
  wishes.min_angle_rad = state_->options.min_angle_rad;
  wishes.seen_lx = state_->seen_lx;
  return {state_->samples, state_->features, state_->candidates, state_->middle_world_m, std::move(wishes)};
}

void JudgedLights::refine_aims(JudgedSelection& selection) const {
  const auto count = static_cast<std::size_t>(kAimsAround);
  for (std::size_t i = 0; i < selection.taken().size(); ++i) {
    const std::uint32_t place = selection.taken()[i].place;
    const HeadSight sight = state_->sight(place);
    for (double step = kFirstAimStep; step >= kLastAimStep; step /= 2) {
      for (int move = 0; move < kMaxMovesOfStep; ++move) {
        const Vec3 middle = selection.taken()[i].direction;
        const Vec3 x = middle.unitOrthogonal(), y = middle.cross(x);
        const double off_rad = std::min(rad_from_deg(20), step * state_->beam_rad);
        std::vector<JudgedLight> around(count);
        parallel_for(count, state_->options.threads, [&](std::size_t k) {
          const double turn_rad = 2 * kPi * static_cast<double>(k) / static_cast<double>(count);
          const Vec3 aim =
              std::cos(off_rad) * middle + std::sin(off_rad) * (std::cos(turn_rad) * x + std::sin(turn_rad) * y);
          around[k] = state_->light(place, aim.normalized(), sight);
        });
        bool better = false;
        for (const JudgedLight& light : around) better |= selection.improve(i, light);
        if (!better) break;
      }
    }
  }
}

bool JudgedLights::complete(JudgedSelection& selection, int lights) const {
  while (selection.taken().size() < static_cast<std::size_t>(lights) && selection.add())
    if (state_->options.watch.stop.stop_requested()) return false;
  selection.settle();
  refine_aims(selection);
  return true;
}

std::optional<JudgedSelection> JudgedLights::begun_by_votes(int lights) const {
  if (lights < 2) return std::nullopt;
  JudgedSelection begun = selection();
  for (std::uint32_t c = 0; c < state_->begun && begun.taken().size() < static_cast<std::size_t>(lights); ++c)
    if (begun.stands_apart(c)) begun.add(c);
  if (begun.taken().size() < 2) return std::nullopt;
  return begun;
}

Result<JudgedLightSet> JudgedLights::lights(int lights) const {
  if (lights < 1 || lights > kMaxJudgedLights)
    return refusal(fmt::format("1 to {} lights can be placed, not {}", kMaxJudgedLights, lights));
  std::optional<JudgedSelection> chosen = selection(), begun = begun_by_votes(lights);
  if (!complete(*chosen, lights) || (begun && !complete(*begun, lights))) return judged_search_stopped();
  if (begun && begun->score().judged > chosen->score().judged) chosen.emplace(*begun);
  return JudgedLightSet{{chosen->taken().begin(), chosen->taken().end()}, chosen->score()};
}

Result<JudgedLightCount> JudgedLights::count_lights(int max_lights) const {
  if (max_lights < 1 || max_lights > kMaxJudgedLights)
    return refusal(fmt::format("1 to {} lights can be placed, not {}", kMaxJudgedLights, max_lights));
  JudgedLightCount count;
  std::optional<JudgedSelection> chosen = selection();
  for (int n = 1; n <= max_lights; ++n) {
    std::optional<JudgedSelection> begun = begun_by_votes(n);
    if (!complete(*chosen, n) || (begun && !complete(*begun, n))) return judged_search_stopped();
    if (begun && begun->taken().size() >= chosen->taken().size() && begun->score().judged > chosen->score().judged)
      chosen.emplace(*begun);
    if (chosen->taken().size() < static_cast<std::size_t>(n)) break;  // no room for more
    count.by_number.push_back({{chosen->taken().begin(), chosen->taken().end()}, chosen->score()});
  }
  std::vector<double> exposed;
  for (const JudgedLightSet& set : count.by_number) exposed.push_back(set.score.exposed_contrast);
  count.best = number_at_peak(exposed);
  return count;
}

}  // namespace luxrig
