/// Distant lights by every method, and their number.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/check.h"
#include "core/highlight/distant/relief_lights.h"
#include "core/highlight/shadow/distant_lights.h"
#include "tools/bench/highlight/rows.h"
#include "tools/bench/methods/coverage_lights.h"

namespace luxrig {
namespace {

constexpr double kWithinExhaustive = 0.05;
constexpr int kRandomPlacements = 200, kMaxNumber = 12, kQuickNumber = 4;
constexpr std::size_t kCoveragePoints = 3000;

Vec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return Vec3(x, y, z).normalized();
}

/// Best of random placements, by the table; rays then measure it.
std::vector<Vec3> best_of_random(const ReliefLightSearch& search, int lights) {
  std::mt19937_64 random(static_cast<std::uint64_t>(lights));
  const TabledContrast contrast(search.samples(), search.table(), 1);
  std::vector<Vec3> best;
  double best_lx = -1;
  for (int k = 0; k < kRandomPlacements; ++k) {
    std::vector<Vec3> directions;
    std::vector<std::uint32_t> bins;
    for (int l = 0; l < lights; ++l) {
      directions.push_back(random_direction(random));
      bins.push_back(search.table().bins.bin_of(directions.back()));
    }
    const double lx = contrast.of(bins).local_contrast_lx;
    if (lx <= best_lx) continue;
    best_lx = lx;
    best = std::move(directions);
  }
  return best;
}

CallSeconds operator+(const CallSeconds& a, const CallSeconds& b) { return {a.wall + b.wall, a.cpu + b.cpu}; }

/// Shared by the methods, for any number of lights: votes, table, coverage.
struct LightMethods {
  std::optional<DirectionHistogram> votes;
  std::optional<ReliefLightSearch> search;
  std::vector<CoverageLight> coverage;
  CallSeconds votes_took, search_took, coverage_took;
  std::uint64_t votes_rays = 0;
};

LightMethods light_methods(const ReliefStudy& study, int threads) {
  LightMethods made;
  made.votes_took = timed([&] {
    ShadowEdgeOptions edges;
    edges.threads = threads;
    const auto found = find_shadow_edges(study.rays, study.points, edges);
    LUXRIG_CHECK(found, "{}", found.error().detail);
    made.votes_rays = found->rays;
    made.votes = vote_directions(*found, study.points, DirectionBins(), threads);
  });
  made.search_took = timed([&] {
    ReliefLightOptions options;
    options.threads = threads;
    auto search = ReliefLightSearch::make(study.surface, study.rays, study.interest, options);
    LUXRIG_CHECK(search, "{}", search.error().detail);
    made.search = std::move(*search);
  });
  made.coverage_took = timed([&] {
    made.coverage = coverage_lights(study.surface, study.rays, DirectionBins(), 8, kCoveragePoints, threads);
  });
  return made;
}

}  // namespace

void add_light_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows) {
  std::optional<LightMethods> made;
  for (const int lights : {1, 2, 4, 8}) {
    const std::string name = fmt::format("lights-{}-{}", object.name(), lights);
    if (!highlight_wanted(options, name) || (options.quick && lights > 2)) continue;
    const ReliefStudy& study = object.study();
    if (!made) made = light_methods(study, options.threads);
    std::vector<HighlightRow> set;
    const auto add = [&](const char* method, const std::vector<Vec3>& directions, const CallSeconds& took,
                         std::optional<std::uint64_t> rays, std::string note) {
      HighlightRow row{name, method};
      row.took = took;
      row.rays = rays;
      row.shown = shown_relief(study, directions, options.threads);
      row.note = std::move(note);
      set.push_back(std::move(row));
    };

    std::vector<Vec3> directions;
    CallSeconds took = timed([&] { directions = made->search->lights(lights)->directions; });
    add("luxrig", directions, made->search_took + took, made->search->table().rays,
        fmt::format("{:.3f} s of it without rays", took.wall));

    directions.clear();
    took = timed([&] {
      const auto found = distant_lights(*made->votes, {lights, 0.33});
      LUXRIG_CHECK(found, "{}", found.error().detail);
      for (const DistantLight& light : *found) directions.push_back(light.direction);
    });
    add("gp17", directions, made->votes_took + took, made->votes_rays, "");

    directions.clear();
    for (std::size_t k = 0; k < std::min(made->coverage.size(), static_cast<std::size_t>(lights)); ++k)
      directions.push_back(made->coverage[k].direction);
    add("coverage", directions, made->coverage_took, {}, "time of eight lights");

    took = timed([&] { directions = best_of_random(*made->search, lights); });
    add("random", directions, took, {}, fmt::format("best of {} by the table", kRandomPlacements));

    if (lights == 1) {
      std::uint64_t rays = 0;
      took = timed([&] {
        LitTableOptions every;
        every.every_ray = true;
        every.threads = options.threads;
        const auto table = find_lit_bins(study.rays, made->search->samples(), made->search->table().bins, every);
        rays = table->rays;
        const std::vector<double> lx =
            TabledContrast(made->search->samples(), *table, options.threads).with_each_bin({});
        const auto best = static_cast<std::uint32_t>(std::max_element(lx.begin(), lx.end()) - lx.begin());
        directions = {table->bins.direction_of(best)};
      });
      add("exhaustive", directions, took, rays, "every bin by every ray");
    }

    double best_lx = 0, coverage_lx = 0;
    for (const HighlightRow& row : set) {
      best_lx = std::max(best_lx, row.shown->local_contrast_lx);
      if (row.method == "coverage") coverage_lx = row.shown->local_contrast_lx;
    }
    for (HighlightRow& row : set) row.error = 1 - row.shown->local_contrast_lx / best_lx;
    // One light: nearly as good as all bins tried out. More lights cannot be tried out: better than coverage.
    set.front().target_error = lights == 1 ? kWithinExhaustive : 1 - coverage_lx / best_lx;
    for (const HighlightRow& row : set) rows.push_back(bench_row_of(row));
  }
}

void add_number_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::string name = "number-" + object.name();
  if (!highlight_wanted(options, name)) return;
  const ReliefStudy& study = object.study();
  ReliefLightOptions of_search;
  of_search.threads = options.threads;
  Result<ReliefLightCount> count = ReliefLightCount{};
  std::uint64_t rays = 0;
  const CallSeconds took = timed([&] {
    const auto search = ReliefLightSearch::make(study.surface, study.rays, study.interest, of_search);
    LUXRIG_CHECK(search, "{}", search.error().detail);
    count = search->count_lights(options.quick ? kQuickNumber : kMaxNumber);
    rays = search->table().rays;
  });
  LUXRIG_CHECK(count, "{}", count.error().detail);
  const double peak = *std::ranges::max_element(count->exposed_contrast);
  for (std::size_t k = 0; k < count->by_number.size(); ++k) {
    HighlightRow row{name, fmt::format("{}-lights", k + 1)};
    row.error = 1 - count->exposed_contrast[k] / peak;
    row.shown = shown_relief(study, count->by_number[k].directions, options.threads);
    row.note = fmt::format("exposed contrast {:.4f}", count->exposed_contrast[k]);
    rows.push_back(bench_row_of(row));
  }
  HighlightRow row{name, "automatic"};
  row.took = took;
  row.rays = rays;
  row.shown = shown_relief(study, count->by_number[count->best].directions, options.threads);
  row.error = 1 - count->exposed_contrast[count->best] / peak;
  row.note = fmt::format("exposed contrast {:.4f}; time of the whole curve", count->exposed_contrast[count->best]);
  rows.push_back(bench_row_of(row));
}

}  // namespace luxrig
