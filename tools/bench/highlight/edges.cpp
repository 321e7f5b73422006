/// Shadow edges by every ray and by search; curvature; feature clusters.

#include <fmt/format.h>

#include <cmath>
#include <random>

#include "core/highlight/shadow/direction_bins.h"
#include "tools/bench/highlight/rows.h"

namespace luxrig {
namespace {

constexpr int kEveryRay = 1, kJudgedStep = 4;
/// This many points make 10⁸ rays.
constexpr std::size_t kHundredMillionRays = 100'000'000 / (kScanAzimuths * kScanElevations) + 1;
constexpr double kEdgeError = 0.01, kEdgeSeconds = 2;

/// Recessed places of the mesh itself, evenly strided to the number that makes 10⁸ rays, if there are that many.
std::vector<OrientedPoint> voting_points(HighlightObject& object, const BenchOptions& options) {
  if (options.quick) return object.study().points;
  const ReliefStudy& study = object.study();
  InterestOptions more = options_of_study(options).interest;
  more.max_points = kHundredMillionRays * 3 / 2;
  const auto curvature = curvature_of(study.mesh, {{.threads = options.threads, .watch = {}}, study.scale_m});
  if (!curvature) return study.points;
  const auto interest = interest_points(study.mesh, *curvature, more);
  if (!interest) return study.points;
  std::vector<OrientedPoint> points;
  const std::size_t count = std::min(interest->size(), kHundredMillionRays);
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = (*interest)[k * interest->size() / count];
    points.push_back({study.mesh.point_world_m(i), study.mesh.normals[i]});
  }
  return points;
}

}  // namespace

void add_edge_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::string name = "edges-" + object.name();
  if (!highlight_wanted(options, name)) return;
  const std::vector<OrientedPoint> points = voting_points(object, options);
  const DirectionBins bins;
  std::optional<DirectionHistogram> truth;
  std::uint64_t all_rays = 0;
  for (const int step : {kEveryRay, 2, 3, kJudgedStep, 6}) {
    ShadowEdgeOptions search;
    search.step = step;
    search.threads = options.threads;
    Result<ShadowEdges> edges = ShadowEdges{};
    std::optional<DirectionHistogram> votes;
    HighlightRow row{name, step == kEveryRay ? "every-ray" : fmt::format("step-{}", step)};
    row.took = timed([&] {
      edges = find_shadow_edges(object.study().rays, points, search);
      if (edges) votes = vote_directions(*edges, points, bins, options.threads);
    });
    if (!edges) continue;
    row.rays = edges->rays;
    if (step == kEveryRay) {
      all_rays = edges->rays;
      truth = votes;
      row.note = fmt::format("{} points; {} votes", points.size(), votes->total());
    } else {
      row.error = histogram_error(*votes, *truth);
      row.note = fmt::format("{:.1f} % of the rays", 100.0 * static_cast<double>(edges->rays) /
                                                         static_cast<double>(std::max<std::uint64_t>(1, all_rays)));
      if (step == kJudgedStep) {
        row.target_error = kEdgeError;
        if (points.size() >= kHundredMillionRays) row.target_seconds = kEdgeSeconds;
      }
    }
    rows.push_back(bench_row_of(row));
  }
}

void add_curvature_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::string name = "curvature-" + object.name();
  if (!highlight_wanted(options, name)) return;
  const ReliefStudy& study = object.study();
  HighlightRow row{name, "quadric"};
  row.took = timed([&] { (void)curvature_of(study.mesh, {{.threads = options.threads, .watch = {}}, study.scale_m}); });
  const auto points = static_cast<double>(study.mesh.points_m.size());
  row.error = std::nan("");
  row.note = fmt::format("{} points; {:.1f} us of processor each; scale {:.4g} m", study.mesh.points_m.size(),
                         1e6 * row.took.cpu / points, study.scale_m);
  rows.push_back(bench_row_of(row));
}

void add_cluster_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  for (const int count : {3'000, 10'000, 30'000, 100'000}) {
    const std::string name = fmt::format("clusters-{}", count);
    if (!highlight_wanted(options, name)) continue;
    // On a sphere of 1 m, linked within three times their spacing.
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    std::vector<OrientedPoint> points;
    for (int k = 0; k < count; ++k) {
      const double x = normal(random), y = normal(random), z = normal(random);
      const Vec3 out = Vec3(x, y, z).normalized();
      points.push_back({out, out});
    }
    FeatureOptions features;
    features.link_m = 3 * std::sqrt(4 * kPi / count);
    std::vector<CallSeconds> runs;
    std::size_t clusters = 0;
    for (int run = 0; run < 3; ++run)
      runs.push_back(timed([&] { clusters = cluster_features(points, features)->sizes.size(); }));
    HighlightRow row{name, "single-linkage"};
    row.error = std::nan("");
    row.took = median_of(runs);
    row.note = fmt::format("{} clusters; median of three", clusters);
    rows.push_back(bench_row_of(row));
  }
}

}  // namespace luxrig
