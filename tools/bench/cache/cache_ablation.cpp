#include "tools/bench/cache/cache_ablation.h"

#include <fmt/format.h>

#include <cmath>

#include "core/transport/sobol.h"
#include "tools/bench/cache/volume/voxel_walk.h"
#include "tools/bench/cache/volume/voxelise.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

constexpr int kCellVoxels = 4;

struct SightLine {
  Vec3 from_m, to_m;        ///< relative to the scene's origin
  Vec3 from_grid, to_grid;  ///< of the shortened line
};

double unit_number_of(std::uint64_t seed, std::uint64_t key) {
  return static_cast<double>(mixed(seed, key) >> 11) * 0x1p-53;
}

/// Between places half a cell off random surfaces, where the cache has its cells.
std::vector<SightLine> lines_in(const Scene& scene, const VoxelGrid& grid, std::size_t count, std::uint64_t seed) {
  const Eigen::AlignedBox3d box_m = triangle_bounds_m(scene);
  const auto near = spread_over_walls(scene, 2 * count, scene.origin_world_m + box_m.center());
  std::vector<SightLine> lines;
  const double cell_m = kCellVoxels * grid.voxel_m;
  for (std::size_t i = 0; i < count; ++i) {
    const auto place = [&](std::size_t k) -> Vec3 {
      const WallPoint& p = near[k];
      return p.position_m - scene.origin_world_m + 0.5 * cell_m * p.normal;
    };
    const auto other = static_cast<std::size_t>(unit_number_of(seed, i) * static_cast<double>(near.size()));
    SightLine line{place(2 * i), place(std::min(other, near.size() - 1)), {}, {}};
    const Vec3 way = line.to_m - line.from_m;
    if (way.norm() <= 2.5 * cell_m) continue;
    const Vec3 end = way.normalized() * cell_m;
    line.from_grid = grid.grid_from_scene(line.from_m + end);
    line.to_grid = grid.grid_from_scene(line.to_m - end);
    lines.push_back(line);
  }
  return lines;
}

}  // namespace

std::vector<NamedCacheSettings> cache_ablation_settings() {
  std::vector<NamedCacheSettings> list;
  const auto variant = [&](const std::string& name, CacheSettings settings, auto&& change) {
    change(settings);
    list.push_back({name, settings});
    return settings;
  };
  const CacheSettings sides;
  using S = CacheSettings&;
  variant("sides", sides, [](S) {});
  variant("sides, cells everywhere", sides, [](S s) { s.only_needed = false; });
  variant("sides, bright sides by rays alone", sides, [](S s) { s.bright_sides = false; });
  variant("sides, half the voxels", sides, [](S s) { s.voxels /= 2; });
  variant("sides, a quarter of the gather rays", sides, [](S s) { s.gather_rays /= 4; });
  variant("sides, a quarter of the light samples", sides, [](S s) { s.light_samples /= 4; });
  variant("sides, groups of two cells", sides, [](S s) { s.group_cells = 2; });
  variant("sides, groups of eight cells", sides, [](S s) { s.group_cells = 8; });
  variant("sides, one reflection", sides, [](S s) { s.reflections = 1; });
  variant("sides, two reflections", sides, [](S s) { s.reflections = 2; });

  const CacheSettings thesis = CacheSettings::of_thesis();
  variant("thesis", thesis, [](S) {});
  variant("thesis, cells everywhere", thesis, [](S s) { s.only_needed = false; });
  variant("thesis, one reflection", thesis, [](S s) { s.reflections = 1; });
  variant("thesis, half the voxels", thesis, [](S s) { s.voxels /= 2; });
  variant("thesis, RGB", thesis, [](S s) { s.ycocg = false; });
  variant("thesis, chrominance of order 1", thesis, [](S s) { s.chrominance_order = 1; });
  variant("thesis, luminance of order 2", thesis, [](S s) { s.luminance_order = s.chrominance_order = 2; });
  variant("thesis, 50 light samples", thesis, [](S s) { s.light_samples = 50; });
  CacheSettings now = variant("+ DDA", thesis, [](S s) { s.first_visibility = s.link_traversal = Traversal::walk; });
  now = variant("+ distance field", now, [](S s) { s.first_visibility = s.link_traversal = Traversal::distance; });
  now = variant("+ exact rays", now, [](S s) { s.first_visibility = s.link_traversal = Traversal::rays; });
  now = variant("+ met surfaces", now, [](S s) { s.link_surface = LinkSurface::met; });
  now = variant("+ open places", now, [](S s) { s.open_places = true; });
  now = variant("+ gather", now, [](S s) {
    s.reconstruction = Reconstruction::gather;
    s.gather_rays = 512;
  });
  variant("+ exact first reflection", now, [](S s) { s.first_reflection = FirstReflection::exact; });
  return list;
}

Result<std::vector<AblationRow>> run_cache_ablation(const Scene& scene, const RayScene& rays,
                                                    std::span<const Receiver> receivers,
                                                    std::span<const Emitter> emitters,
                                                    const Eigen::VectorXd& reference_lux,
                                                    std::span<const NamedCacheSettings> settings,
                                                    const StopWatch& seconds, const EvaluateOptions& options) {
  if (reference_lux.size() != static_cast<Eigen::Index>(receivers.size()))
    return tl::unexpected(
        Fault{Cause::invalid,
              "",
              fmt::format("{} reference values for {} receivers", reference_lux.size(), receivers.size()),
              {}});
  std::vector<AblationRow> rows;
  for (const NamedCacheSettings& one : settings) {
    RadianceCache::BuildOptions build;
    build.run() = options.of_part();
    EvaluateOptions evaluate = options;
    evaluate.watch.progress = {};
    evaluate.levels.clear();
    AblationRow row;
    row.setting = one.name;
    const double begin = seconds();
    const auto cache = RadianceCache::build(scene, rays, receivers, one.settings, build);
    if (!cache) return tl::unexpected(cache.error());
    row.build_seconds = seconds() - begin;
    const double built = seconds();
    const auto matrix = cache->evaluate(emitters, evaluate);
    if (!matrix) return tl::unexpected(matrix.error());
    row.evaluate_seconds = seconds() - built;
    const double evaluated = seconds();
    if (!emitters.empty())
      if (const auto lamp = cache->evaluate(emitters.first(1), evaluate); !lamp) return tl::unexpected(lamp.error());
    row.changed_lamp_seconds = seconds() - evaluated;
    row.report = cache->report();
    const Eigen::VectorXd levels = Eigen::VectorXd::Ones(matrix->emitters());
    const Eigen::VectorXd lux = matrix->lux(levels), error_lx = matrix->standard_error_lux(levels);
    double count = 0, squares = 0, reported = 0;
    for (Eigen::Index r = 0; r < lux.size(); ++r) {
      if (!(reference_lux[r] > 0)) continue;
      const double error = (lux[r] - reference_lux[r]) / reference_lux[r];
      ++count;
      squares += error * error;
      row.mean_error += error;
      reported += std::pow(error_lx[r] / reference_lux[r], 2);
    }
    if (count > 0) {
      row.rms_error = std::sqrt(squares / count);
      row.mean_error /= count;
      row.reported_error = std::sqrt(reported / count);
    }
    rows.push_back(std::move(row));
    if (options.watch.progress)
      options.watch.progress(static_cast<double>(rows.size()) / static_cast<double>(settings.size()));
  }
  return rows;
}

std::vector<TraversalRow> compare_traversals(const Scene& scene, const RayScene& rays, int voxels, std::size_t lines,
                                             std::uint64_t seed, const StopWatch& seconds) {
  if (scene.triangles.empty()) return {};
  const VoxelGrid grid = VoxelGrid::around(triangle_bounds_m(scene), voxels);
  const BitVolume geometry = voxelise(scene, grid);
  const DistanceField field(geometry);
  const std::vector<SightLine> all = lines_in(scene, grid, lines, seed);
  if (all.empty()) return {};
  std::vector<TraversalRow> rows;
  std::vector<bool> right(all.size()), answer(all.size());
  const auto measure = [&](const std::string& name, auto&& blocked) {
    const double begin = seconds();
    for (std::size_t i = 0; i < all.size(); ++i) answer[i] = blocked(all[i], i);
    const double took = seconds() - begin;
    if (rows.empty()) right = answer;
    double missed = 0, invented = 0, blocks = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      blocks += right[i];
      missed += right[i] && !answer[i];
      invented += !right[i] && answer[i];
    }
    const double free = static_cast<double>(all.size()) - blocks;
    rows.push_back({name, took / static_cast<double>(all.size()), blocks > 0 ? missed / blocks : 0,
                    free > 0 ? invented / free : 0});
  };
  measure("exact rays", [&](const SightLine& line, std::size_t) {
    return rays.occluded(line.from_m + scene.origin_world_m, Vec3::Zero(), line.to_m + scene.origin_world_m);
  });
  measure("DDA", [&](const SightLine& line, std::size_t) {
    return first_voxel_by_walk(geometry, line.from_grid, line.to_grid).has_value();
  });
  measure("distance field", [&](const SightLine& line, std::size_t) {
    return first_voxel_by_distance(field, line.from_grid, line.to_grid).has_value();
  });
  for (const int steps : {6, 12, 48})
    measure(fmt::format("march of {} looks", steps), [&](const SightLine& line, std::size_t i) {
      return first_voxel_by_march(geometry, line.from_grid, line.to_grid, steps, unit_number_of(seed, ~i)).has_value();
    });
  return rows;
}

}  // namespace luxrig
