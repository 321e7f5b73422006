#include "tools/bench/cache/direction_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "tools/bench/cache/light_view.h"
#include "tools/bench/cache/volume/voxelise.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kLinkSamples = 0x64697265637473;

Vec3 direction_of(double u, double v) {
  const double z = 1 - 2 * u, r = std::sqrt(std::max(0.0, 1 - z * z));
  return Vec3(r * std::cos(2 * kPi * v), r * std::sin(2 * kPi * v), z).normalized();
}

/// Weighted by the triangles' area.
Vec3 mean_reflectance_rgb(const Scene& scene) {
  Vec3 sum = Vec3::Zero();
  double whole = 0;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const auto& corners = scene.triangles[t];
    const Vec3 a = scene.vertices_m[corners[0]].cast<double>();
    const double area =
        (scene.vertices_m[corners[1]].cast<double>() - a).cross(scene.vertices_m[corners[2]].cast<double>() - a).norm();
    sum += area * diffuse_equivalent_rgb(scene.materials[scene.material_of_triangle[t]]);
    whole += area;
  }
  return whole > 0 ? Vec3(sum / whole) : Vec3::Zero();
}

}  // namespace

DirectionCells::DirectionCells(const Scene& scene, const RayScene&, std::span<const Receiver> receivers,
                               const CacheSettings& settings)
    : origin_world_m_(scene.origin_world_m) {
  Eigen::AlignedBox3d box_m = triangle_bounds_m(scene);
  if (box_m.isEmpty()) {
    first_link_.assign(1, 0);
    return;
  }
  for (const Receiver& receiver : receivers) box_m.extend(Vec3(receiver.position_world_m - origin_world_m_));
  voxels_ = VoxelGrid::around(box_m, settings.voxels);
  cells_ = voxels_.coarser(settings.reduction);
  geometry_ = voxelise(scene, voxels_);
  if (settings.first_visibility == Traversal::distance || settings.link_traversal == Traversal::distance)
    field_ = DistanceField(geometry_);
  BitVolume occupied = geometry_.reduced(settings.reduction);
  // Receivers in mid-air also read cells.
  for (const Receiver& receiver : receivers)
    occupied.set(cells_.nearest_voxel(receiver.position_world_m - origin_world_m_));
  occupied = occupied.dilated();
  cell_of_.assign(cells_.count(), kNone);
  occupied.for_each([&](const Eigen::Vector3i& voxel) {
    cell_of_[cells_.index(voxel)] = static_cast<std::int32_t>(voxel_.size());
    voxel_.push_back(voxel);
  });
  needed_.assign(voxel_.size(), false);
  reader_.resize(voxel_.size());
  open_places_ = settings.open_places;
  mean_reflectance_rgb_ = mean_reflectance_rgb(scene);
  first_link_.assign(voxel_.size() + 1, 0);
}

void DirectionCells::need(std::int32_t cell, const Vec3& surface_m, const Vec3& normal) {
  const auto c = static_cast<std::size_t>(cell);
  if (!needed_[c]) reader_[c] = {surface_m, normal};
  needed_[c] = true;
}

Vec3 DirectionCells::place_m(std::size_t cell, double u, double v, double w) const {
  const Vec3 place = cells_.scene_from_grid(voxel_[cell].cast<double>() + Vec3(u, v, w));
  if (!open_places_) return place;
  // Places behind the reader's surface are mirrored to the front.
  const double height = (place - reader_[cell].surface_m).dot(reader_[cell].normal);
  return height < 0 ? Vec3(place - 2 * height * reader_[cell].normal) : place;
}

std::size_t DirectionCells::shares_at(const Vec3& place_m, const Vec3& side_normal, Shares& shares) const {
  if (voxel_.empty()) return 0;
  const Vec3 at = cells_.grid_from_scene(place_m) - Vec3::Constant(0.5);
  const Vec3 low = at.array().floor();
  const Vec3 part = at - low;
  std::size_t count = 0;
  float whole = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    const Eigen::Vector3i voxel = low.cast<int>() + step;
    const std::int32_t cell = cell_at(voxel);
    if (cell == kNone) continue;
    if (!side_normal.isZero(0) && (cells_.centre_m(voxel) - place_m).dot(side_normal) < -0.5 * cells_.voxel_m) continue;
    double weight = 1;
    for (int i = 0; i < 3; ++i) weight *= step[i] ? part[i] : 1 - part[i];
    if (!(weight > 0)) continue;
    shares[count++] = {cell, static_cast<float>(weight)};
    whole += static_cast<float>(weight);
  }
  for (std::size_t i = 0; i < count; ++i) shares[i].weight /= whole;
  return count;
}

bool DirectionCells::visible(const RayScene& rays, const CacheSettings& settings, const Vec3& from_m, const Vec3& to_m,
                             double jitter, std::uint64_t& cast) const {
  if (settings.first_visibility == Traversal::rays) {
    ++cast;
    return !rays.occluded(from_m + origin_world_m_, Vec3::Zero(), to_m + origin_world_m_);
  }
  // The ends are a cell off, so that the surfaces near them do not count.
  const Vec3 way = to_m - from_m;
  const double length_m = way.norm();
  if (length_m <= 2 * cells_.voxel_m) return true;
  const Vec3 end = way * (cells_.voxel_m / length_m);
  const Vec3 a = voxels_.grid_from_scene(from_m + end), b = voxels_.grid_from_scene(to_m - end);
  switch (settings.first_visibility) {
    case Traversal::walk:
      return !first_voxel_by_walk(geometry_, a, b);
    case Traversal::distance:
      return !first_voxel_by_distance(field_, a, b);
    default:
      return !first_voxel_by_march(geometry_, a, b, settings.first_steps, jitter);
  }
}

void DirectionCells::link_one(const Scene& scene, const RayScene& rays, const CacheSettings& settings, std::size_t cell,
                              std::uint64_t seed, std::vector<Link>& links, std::vector<Reader>& readers,
                              std::uint64_t& cast) const {
  const SobolSequence samples(mixed(mixed(seed, kLinkSamples), cell));
  const double reach_m = cells_.voxel_m * cells_.size.cast<double>().norm();
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(settings.link_rays); ++i) {
    const auto [u, v, a, b] = samples.set(i, 0);
    const auto [c, jitter] = samples.pair(i, 1, 0);
    const Vec3 from_m = place_m(cell, a, b, c), direction = direction_of(u, v);
    std::int32_t met = kNone;
    Reader reader;
    Vec3 normal = -direction, reflectance = mean_reflectance_rgb_;
    if (settings.link_traversal == Traversal::rays) {
      ++cast;
      const auto hit = rays.nearest(from_m + origin_world_m_, direction, Vec3::Zero());
      if (!hit) continue;
      const Vec3 hit_m = hit->position_world_m - origin_world_m_;
      met = cell_at(cells_.nearest_voxel(hit_m));
      reader = {hit_m, hit->normal_world};
      if (settings.link_surface == LinkSurface::met) {
        normal = hit->normal_world;
        reflectance = diffuse_equivalent_rgb(scene.materials[scene.material_of_triangle[hit->triangle]]);
        const std::int32_t before = cell_at(cells_.nearest_voxel(hit_m + 0.5 * cells_.voxel_m * normal));
        if (before != kNone) met = before;
      }
    } else {
      const Vec3 start = voxels_.grid_from_scene(from_m + cells_.voxel_m * direction);
      const Vec3 end = voxels_.grid_from_scene(from_m + reach_m * direction);
      std::optional<VoxelHit> hit;
      if (settings.link_traversal == Traversal::walk) {
        hit = first_voxel_by_walk(geometry_, start, end);
      } else if (settings.link_traversal == Traversal::distance) {
        hit = first_voxel_by_distance(field_, start, end);
      } else {
        // The march's samples are spread over the part of the way within the volume.
        double rim = 1;
        for (int k = 0; k < 3; ++k) {
          const double way = end[k] - start[k];
          if (way > 0) rim = std::min(rim, (voxels_.size[k] - start[k]) / way);
          if (way < 0) rim = std::min(rim, -start[k] / way);
        }
        if (rim > 0)
          hit = first_voxel_by_march(geometry_, start, start + rim * (end - start), settings.link_steps, jitter);
      }
      if (hit) met = cell_at(hit->voxel / settings.reduction);
    }
    if (met == kNone) continue;
    readers.push_back(reader);
    links.push_back({met, direction.cast<float>(), normal.cast<float>(), reflectance.cast<float>()});
  }
}

void DirectionCells::link(const Scene& scene, const RayScene& rays, const CacheSettings& settings, int reflections,
                          std::uint64_t seed, int threads, const std::stop_token& stop) {
  std::vector<std::vector<Link>> links(size());
  std::vector<std::vector<Reader>> readers(size());
  std::vector<bool> linked(size(), false);
  const auto link_needed = [&] {
    std::vector<std::size_t> todo;
    for (std::size_t c = 0; c < size(); ++c)
      if (needed_[c] && !linked[c]) todo.push_back(c);
    std::vector<std::uint64_t> cast(todo.size(), 0);
    parallel_for(todo.size(), threads, [&](std::size_t i) {
      if (!stop.stop_requested())
        link_one(scene, rays, settings, todo[i], seed, links[todo[i]], readers[todo[i]], cast[i]);
    });
    cast_ = std::accumulate(cast.begin(), cast.end(), cast_);
    for (const std::size_t c : todo) {
      linked[c] = true;
      for (std::size_t i = 0; i < links[c].size(); ++i)
        need(links[c][i].from, readers[c][i].surface_m, readers[c][i].normal);
      readers[c] = {};
    }
    return !todo.empty() && !stop.stop_requested();
  };
  for (int wave = 1; (reflections == 0 || wave < reflections) && link_needed(); ++wave) {
  }
  if (!settings.only_needed) {
    needed_.assign(size(), true);
    if (reflections != 1) link_needed();
  }
  if (stop.stop_requested()) return;
  for (std::size_t c = 0; c < size(); ++c) {
    links_.insert(links_.end(), links[c].begin(), links[c].end());
    first_link_[c + 1] = links_.size();
  }
}

std::size_t DirectionCells::bytes() const {
  return geometry_.bytes() + field_.bytes() + cell_of_.size() * 4 + voxel_.size() * sizeof(Eigen::Vector3i) +
         links_.size() * sizeof(Link) + first_link_.size() * sizeof(std::size_t);
}

}  // namespace luxrig
