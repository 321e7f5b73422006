/// Real luminaires around an object by every method, and their number.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/check.h"
#include "core/highlight/lights/judged_lights.h"
#include "core/highlight/lights/mounted_lights.h"
#include "core/highlight/shadow/relief_contrast.h"
#include "core/parallel.h"
#include "core/photometry/beam.h"
#include "tools/bench/highlight/rows.h"
#include "tools/bench/methods/coverage_votes.h"

namespace luxrig {
namespace {

constexpr double kMountedWithin = 0.05;  // below exhaustive
constexpr int kMountedRandom = 200, kMaxMounted = 12, kQuickMounted = 4;
constexpr double kMountedLumens = 1000, kMountedBeam_rad = rad_from_deg(20), kMountedField_rad = rad_from_deg(40);
constexpr double kBoxStep_m = 0.5;

struct AimedPlace {
  Vec3 position_world_m, direction;
};

/// Shared by all methods: the object, its domain, the luminaire.
struct MountedCase {
  HighlightObject object;
  const BenchOptions& options;
  LightDomain domain;
  std::vector<LightDomain::CellCentre> centres;
  std::vector<Vec3> places_world_m;
  Intensity intensity = make_spot(kMountedLumens, kMountedBeam_rad, kMountedField_rad);
  PotentialLightOptions of_lights;

  MountedCase(const HighlightObject& original, const BenchOptions& bench)
      : object(original.name(), scaled_to_one_metre(original.scene()), bench),
        options(bench),
        domain(boxes_around(object, bench.quick)) {
    centres = domain.cell_centres();
    for (const LightDomain::CellCentre& centre : centres) places_world_m.push_back(centre.position_world_m);
    of_lights.beam_angle_rad = cone_of_flux_rad(*intensity, 0.9);
    of_lights.threads = bench.threads;
  }
  static LightDomain boxes_around(HighlightObject& object, bool quick) {
    NestedBoxOptions boxes;
    boxes.margin_m = boxes.step_m = kBoxStep_m;
    boxes.cell_side = quick ? 8 : 16;
    auto made = nested_box_domain(object.study().surface, boxes);
    LUXRIG_CHECK(made, "{}", made.error().detail);
    return std::move(*made);
  }

  [[nodiscard]] ReliefContrast measured(const std::vector<AimedPlace>& lights) {
    const ReliefStudy& study = object.study();
    std::vector<MountedBeam> beams;
    for (const AimedPlace& light : lights)
      beams.push_back(aimed_beam(light.position_world_m, light.direction, intensity));
    return relief_contrast(study.surface, study.rays, {}, study.interest, beams, 0, options.threads,
                           study.features.cluster_of_point);
  }
  [[nodiscard]] ShownRelief shown(const std::vector<AimedPlace>& lights) {
    const ReliefContrast contrast = measured(lights);
    return {lights.size(), contrast.points_with_transition, contrast.local_contrast_lx,
            contrast.features_with_transition};
  }
};

CallSeconds sum_of(const CallSeconds& a, const CallSeconds& b) { return {a.wall + b.wall, a.cpu + b.cpu}; }

/// Lights from votes, and the cost of finding them.
struct VotedLights {
  std::optional<PotentialLights> lights;
  CallSeconds took;
  std::uint64_t rays = 0;
};

VotedLights voted_by_edges(MountedCase& of) {
  VotedLights made;
  made.took = timed([&] {
    const ReliefStudy& study = of.object.study();
    ShadowEdgeOptions search;
    search.threads = of.options.threads;
    const auto edges = find_shadow_edges(study.rays, study.points, search);
    LUXRIG_CHECK(edges, "{}", edges.error().detail);
    DomainVoteOptions voting;
    voting.threads = of.options.threads;
    const auto votes = vote_on_domain(of.domain, *edges, study.points, study.features.cluster_of_point, voting);
    LUXRIG_CHECK(votes, "{}", votes.error().detail);
    auto lights = potential_lights(*votes, of.of_lights);
    LUXRIG_CHECK(lights, "{}", lights.error().detail);
    made.lights = std::move(*lights);
    made.rays = edges->rays + votes->counts.rays;
  });
  return made;
}

VotedLights voted_by_coverage(MountedCase& of) {
  VotedLights made;
  made.took = timed([&] {
    CoverageVoteOptions voting;
    voting.threads = of.options.threads;
    const auto votes = vote_for_coverage(of.domain, of.object.study().surface, of.object.study().rays, voting);
    LUXRIG_CHECK(votes, "{}", votes.error().detail);
    auto lights = potential_lights(votes->votes, of.of_lights);
    LUXRIG_CHECK(lights, "{}", lights.error().detail);
    made.lights = std::move(*lights);
    made.rays = votes->votes.counts.rays;
  });
  return made;
}

std::vector<AimedPlace> selected(const LightSelection& selection) {
  std::vector<AimedPlace> lights;
  for (const std::uint32_t light : selection.taken())
    lights.push_back({selection.all().lights[light].position_world_m, selection.all().lights[light].direction});
  return lights;
}

std::vector<AimedPlace> placed(std::span<const JudgedLight> lights) {
  std::vector<AimedPlace> places;
  for (const JudgedLight& light : lights) places.push_back({light.position_world_m, light.direction});
  return places;
}

std::vector<AimedPlace> best_random_mounted(MountedCase& of, int lights) {
  std::mt19937_64 random(static_cast<std::uint64_t>(lights));
  const std::vector<OrientedPoint>& points = of.object.study().points;
  std::uniform_int_distribution<std::size_t> any_place(0, of.places_world_m.size() - 1),
      any_point(0, points.size() - 1);
  std::vector<AimedPlace> best;
  double best_lx = -1;
  for (int k = 0; k < kMountedRandom; ++k) {
    std::vector<AimedPlace> tried;
    for (int l = 0; l < lights; ++l) {
      const Vec3& place_m = of.places_world_m[any_place(random)];
      tried.push_back({place_m, (points[any_point(random)].position_world_m - place_m).normalized()});
    }
    const double lx = of.measured(tried).local_contrast_lx;
    if (lx <= best_lx) continue;
    best_lx = lx;
    best = std::move(tried);
  }
  return best;
}

JudgedLights judged_lights_of(MountedCase& of, const PotentialLights& voted) {
  const ReliefStudy& study = of.object.study();
  JudgedLightOptions judging;
  judging.threads = of.options.threads;
  auto judged = JudgedLights::make(study.surface, study.rays, study.interest, study.features, of.places_world_m, voted,
                                   of.intensity, judging);
  LUXRIG_CHECK(judged, "{}", judged.error().detail);
  return std::move(*judged);
}

/// Illuminance from lights at the samples, from the sights of their places.
std::vector<float> lux_of_light(const MountedCase& of, const PlaceSights& sights, std::size_t place,
                                const ContrastSamples& samples, const AimedPlace& light) {
  const HeadSight sight = sight_from(sights, place, light.position_world_m, samples.points);
  std::vector<double> lux(samples.points.size());
  lux_of_aim(sight, *of.intensity, {aimed_beam(Vec3::Zero(), light.direction, nullptr).world_from_lamp, Vec3::Zero()},
             lux);
  return {lux.begin(), lux.end()};
}

/// The best of all potential lights of the votes, at every cell, by all interest points, without preselection.
std::vector<AimedPlace> exhaustive_mounted(MountedCase& of, const PotentialLights& voted, std::uint64_t& rays) {
  const ReliefStudy& study = of.object.study();
  const ContrastSamples samples = one_ring_samples(study.surface, study.interest);
  std::vector<AimedPlace> all;
  std::vector<Vec3> places_m;
  std::vector<std::size_t> place_of;
  for (const PotentialLight& light : voted.lights) {
    all.push_back({light.position_world_m, light.direction});
    if (places_m.empty() || places_m.back() != light.position_world_m) places_m.push_back(light.position_world_m);
    place_of.push_back(places_m.size() - 1);
  }
  const PlaceSights sights = sights_of_places(study.rays, {}, samples.points, places_m, 0, of.options.threads);
  rays = sights.rays;
  std::vector<double> contrast_lx(all.size(), 0);
  parallel_for(all.size(), of.options.threads, [&](std::size_t k) {
    contrast_lx[k] = local_contrast_of(samples, lux_of_light(of, sights, place_of[k], samples, all[k]));
  });
  const auto best = std::max_element(contrast_lx.begin(), contrast_lx.end()) - contrast_lx.begin();
  return {all[static_cast<std::size_t>(best)]};
}

/// After each light of a list: contrast in lux, and its remainder in an exposed picture.
std::vector<SampleContrast> contrast_curve(MountedCase& of, const std::vector<AimedPlace>& lights) {
  const ReliefStudy& study = of.object.study();
  const ContrastSamples samples = one_ring_samples(study.surface, study.interest);
  std::vector<Vec3> places_m;
  for (const AimedPlace& light : lights) places_m.push_back(light.position_world_m);
  const PlaceSights sights = sights_of_places(study.rays, {}, samples.points, places_m, 0, of.options.threads);
  std::vector<float> sum_lx(samples.points.size(), 0);
  std::vector<SampleContrast> curve;
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const std::vector<float> mine = lux_of_light(of, sights, k, samples, lights[k]);
    for (std::size_t s = 0; s < sum_lx.size(); ++s) sum_lx[s] += mine[s];
    curve.push_back(contrast_of(samples, sum_lx));
  }
  return curve;
}

}  // namespace

void add_mounted_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows) {
  std::optional<MountedCase> of;
  std::optional<VotedLights> edges, coverage;
  std::optional<JudgedLights> judged;
  CallSeconds judged_took;
  for (const int lights : {1, 2, 4, 8}) {
    const std::string name = fmt::format("mounted-{}-{}", object.name(), lights);
    if (!highlight_wanted(options, name) || (options.quick && lights > 2)) continue;
    if (!of) {
      of.emplace(object, options);
      edges = voted_by_edges(*of);
      coverage = voted_by_coverage(*of);
      judged_took = timed([&] { judged = judged_lights_of(*of, *edges->lights); });
    }
    std::vector<HighlightRow> set;
    const auto add = [&](const char* method, const std::vector<AimedPlace>& found, const CallSeconds& took,
                         std::optional<std::uint64_t> rays, std::string note) {
      HighlightRow row{name, method};
      row.took = took;
      row.rays = rays;
      row.shown = of->shown(found);
      row.note = std::move(note);
      set.push_back(std::move(row));
    };

    std::optional<JudgedLightSet> chosen;
    CallSeconds took = timed([&] { chosen = std::move(*judged->lights(lights)); });
    add("luxrig", placed(chosen->lights), sum_of(sum_of(judged_took, edges->took), took), edges->rays + judged->rays(),
        fmt::format("{:.2f} s of it votes; {:.2f} s judging places; {:.3f} s the rest", edges->took.wall,
                    judged_took.wall, took.wall));
    for (const auto& [method, voted] : {std::pair("gp18", &edges), std::pair("coverage", &coverage)}) {
      LightSelection selection(*(*voted)->lights);
      took = timed([&] {
        const auto done = select_lights(selection, {lights, {}, {}, 1});
        LUXRIG_CHECK(done, "{}", done.error().detail);
      });
      add(method, selected(selection), sum_of((*voted)->took, took), (*voted)->rays,
          fmt::format("{} potential lights", selection.all().lights.size()));
    }
    std::vector<AimedPlace> found;
    took = timed([&] { found = best_random_mounted(*of, lights); });
    add("random", found, took, {}, fmt::format("best of {}", kMountedRandom));
    if (lights == 1) {
      std::uint64_t rays = 0;
      took = timed([&] { found = exhaustive_mounted(*of, *edges->lights, rays); });
      add("exhaustive", found, took, rays,
          fmt::format("all of {} potential lights by all points", edges->lights->lights.size()));
    }

    double best_lx = 0, coverage_lx = 0;
    for (const HighlightRow& row : set) {
      best_lx = std::max(best_lx, row.shown->local_contrast_lx);
      if (row.method == "coverage") coverage_lx = row.shown->local_contrast_lx;
    }
    for (HighlightRow& row : set) row.error = 1 - row.shown->local_contrast_lx / best_lx;
    set.front().target_error = lights == 1 ? kMountedWithin : 1 - coverage_lx / best_lx;
    for (const HighlightRow& row : set) rows.push_back(bench_row_of(row));
  }
}

void add_mounted_number_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::string name = "mounted-number-" + object.name();
  if (!highlight_wanted(options, name)) return;
  const int most = options.quick ? kQuickMounted : kMaxMounted;
  MountedCase of(object, options);
  const auto add = [&](std::string method, const std::vector<AimedPlace>& lights, const SampleContrast& contrast,
                       double peak, const CallSeconds& took) {
    HighlightRow row{name, std::move(method)};
    row.error = 1 - contrast.exposed_contrast / peak;
    row.took = took;
    row.shown = of.shown(lights);
    row.note = fmt::format("exposed contrast {:.4f}", contrast.exposed_contrast);
    rows.push_back(bench_row_of(row));
  };

  const VotedLights edges = voted_by_edges(of);
  std::optional<JudgedLightCount> count;
  const CallSeconds took = timed([&] {
    const JudgedLights judged = judged_lights_of(of, *edges.lights);
    auto made = judged.count_lights(most);
    LUXRIG_CHECK(made, "{}", made.error().detail);
    count = std::move(*made);
  });
  double peak = 0;
  for (const JudgedLightSet& set : count->by_number) peak = std::max(peak, set.score.exposed_contrast);
  for (const JudgedLightSet& set : count->by_number)
    add(fmt::format("{}-lights", set.lights.size()), placed(set.lights),
        {set.score.local_contrast_lx, set.score.exposed_contrast}, peak, {});
  const JudgedLightSet& best = count->by_number[count->best];
  add("automatic", placed(best.lights), {best.score.local_contrast_lx, best.score.exposed_contrast}, peak,
      sum_of(edges.took, took));

  LightSelection selection(*edges.lights);
  const auto done = select_lights(selection, {most, {}, {}, 1});
  LUXRIG_CHECK(done, "{}", done.error().detail);
  std::vector<AimedPlace> by_votes = selected(selection);
  const std::vector<SampleContrast> curve = contrast_curve(of, by_votes);
  double votes_peak = 0;
  for (const SampleContrast& contrast : curve) votes_peak = std::max(votes_peak, contrast.exposed_contrast);
  for (std::size_t k = 0; k < curve.size(); ++k)
    add(fmt::format("gp18-{}-lights", k + 1), {by_votes.begin(), by_votes.begin() + static_cast<std::ptrdiff_t>(k + 1)},
        curve[k], votes_peak, {});
}

}  // namespace luxrig
