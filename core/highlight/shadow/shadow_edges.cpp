#include "core/highlight/shadow/shadow_edges.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "core/transport/progress.h"

namespace luxrig {
namespace {

constexpr std::size_t kPointsPerScanTask = 8;

}  // namespace

HorizonMask scan_every_direction(const TargetRays& target, const OrientedPoint& point, double lift_m) {
  const ScanFrame frame(point.normal);
  HorizonMask blocked;
  // Sixteen rays at once are faster if they are close together: 4 × 4.
  std::array<Vec3f, 16> directions;
  std::array<std::uint8_t, 16> answers{};
  for (int j = 0; j < kScanElevations; j += 4) {
    const int rows = std::min(4, kScanElevations - j);
    for (int i = 0; i < kScanAzimuths; i += 4) {
      const auto count = static_cast<std::size_t>(4 * rows);
      for (int k = 0; k < 4 * rows; ++k)
        directions[static_cast<std::size_t>(k)] = frame.direction(i + k % 4, j + k / 4);
      target.blocked(point.position_world_m, point.normal, lift_m, std::span(directions).first(count),
                     std::span(answers).first(count));
      for (int k = 0; k < 4 * rows; ++k) blocked.set(i + k % 4, j + k / 4, answers[static_cast<std::size_t>(k)] != 0);
    }
  }
  return blocked;
}

void append_edges(const HorizonMask& blocked, std::vector<ShadowEdge>& edges) {
  // Rows first, one word at a time to skip empty ones; then a counting sort by azimuth.
  std::array<std::uint16_t, kScanAzimuths + 1> begin{};
  std::array<ShadowEdge, kScanAzimuths * kScanElevations> found;
  std::size_t count = 0;
  for (int j = 0; j + 1 < kScanElevations; ++j) {
    const auto& low = blocked.rows[static_cast<std::size_t>(j)];
    const auto& high = blocked.rows[static_cast<std::size_t>(j + 1)];
    for (int w = 0; w < HorizonMask::kWords; ++w) {
      std::uint64_t changed = low[static_cast<std::size_t>(w)] ^ high[static_cast<std::size_t>(w)];
      for (; changed != 0; changed &= changed - 1) {
        const int bit = std::countr_zero(changed);
        const bool low_is_blocked = low[static_cast<std::size_t>(w)] >> bit & 1u;
        found[count++] = {static_cast<std::uint16_t>(64 * w + bit),
                          static_cast<std::uint16_t>(low_is_blocked ? j + 1 : j)};
        ++begin[static_cast<std::size_t>(64 * w + bit) + 1];
      }
    }
  }
  for (std::size_t i = 0; i < kScanAzimuths; ++i) begin[i + 1] = static_cast<std::uint16_t>(begin[i + 1] + begin[i]);
  const std::size_t base = edges.size();
  edges.resize(base + count);
  for (std::size_t k = 0; k < count; ++k) edges[base + begin[found[k].azimuth]++] = found[k];
}

Result<ShadowEdges> find_shadow_edges(const TargetRays& target, std::span<const OrientedPoint> points,
                                      const ShadowEdgeOptions& options) {
  if (options.step < 1 || options.step > 8)
    return refusal(fmt::format("first rays of a shadow edge search are 1 to 8 degrees apart, not {}", options.step));
  if (!(options.lift_m >= 0) || !std::isfinite(options.lift_m))
    return refusal(fmt::format("rays cannot start {} m off the surface", options.lift_m));
  struct Part {
    std::vector<ShadowEdge> edges;
    std::array<std::size_t, kPointsPerScanTask> counts{};
    std::uint64_t rays = 0;
  };
  std::vector<Part> parts((points.size() + kPointsPerScanTask - 1) / kPointsPerScanTask);
  CallingThreadProgress progress(options.watch, 0, 1, std::max<std::size_t>(1, parts.size()));
  parallel_for(parts.size(), options.threads, [&](std::size_t p) {
    if (options.watch.stop.stop_requested()) return;
    Part& part = parts[p];
    for (std::size_t k = 0; k < kPointsPerScanTask; ++k) {
      const std::size_t i = p * kPointsPerScanTask + k;
      if (i >= points.size() || points[i].normal.isZero(0)) continue;
      const std::size_t before = part.edges.size();
      if (options.step == 1) {
        append_edges(scan_every_direction(target, points[i], options.lift_m), part.edges);
        part.rays += kScanAzimuths * kScanElevations;
      } else {
        append_edges(search_horizon(target, points[i], options.lift_m, options.step, part.rays), part.edges);
      }
      part.counts[k] = part.edges.size() - before;
    }
    progress.one_done();
  });
  if (options.watch.stop.stop_requested())
    return tl::unexpected(Fault{Cause::cancelled, "", "the search for shadow edges was stopped", {}});
  progress.report_end();
  ShadowEdges all;
  for (std::size_t i = 0; i < points.size(); ++i)
    all.begin.push_back(
        static_cast<std::uint32_t>(all.begin.back() + parts[i / kPointsPerScanTask].counts[i % kPointsPerScanTask]));
  all.edges.reserve(all.begin.back());
  for (const Part& part : parts) {
    all.edges.insert(all.edges.end(), part.edges.begin(), part.edges.end());
    all.rays += part.rays;
  }
  return all;
}

ShadowEdges reachable_edges(const ShadowEdges& edges, std::span<const OrientedPoint> points,
                            const RayScene& surroundings, double reach_m, int threads) {
  LUXRIG_CHECK(edges.begin.size() == points.size() + 1, "edges of {} points, {} points", edges.begin.size() - 1,
               points.size());
  LUXRIG_CHECK(reach_m > 0, "reach {} m", reach_m);
  const Eigen::AlignedBox3d box = surroundings.bounds_world_m();
  std::vector<std::vector<ShadowEdge>> left(points.size());
  parallel_for(points.size(), threads, [&](std::size_t i) {
    const std::span<const ShadowEdge> mine = edges.of(i);
    if (mine.empty()) return;
    const Vec3& from_m = points[i].position_world_m;
    double far_m = reach_m;
    if (!std::isfinite(far_m)) {  // slightly beyond the farthest corner
      far_m = 0;
      if (!box.isEmpty())
        far_m = 1.01 * (from_m - box.center()).cwiseAbs().cwiseMax(box.sizes() / 2).norm() + box.diagonal().norm();
    }
    std::vector<Vec3> to_m;
    std::vector<std::uint8_t> stopped(mine.size(), 0);
    const ScanFrame frame(points[i].normal);
    for (const ShadowEdge& edge : mine)
      to_m.push_back(from_m + far_m * frame.direction(edge.azimuth, edge.elevation).cast<double>().normalized());
    if (far_m > 0) surroundings.occluded_many(from_m, Vec3::Zero(), to_m, stopped);
    for (std::size_t k = 0; k < mine.size(); ++k)
      if (!stopped[k]) left[i].push_back(mine[k]);
  });
  ShadowEdges result;
  result.rays = edges.rays + edges.edges.size();
  for (const auto& mine : left) {
    result.edges.insert(result.edges.end(), mine.begin(), mine.end());
    result.begin.push_back(static_cast<std::uint32_t>(result.edges.size()));
  }
  return result;
}

}  // namespace luxrig
