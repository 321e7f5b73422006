#include "tools/bench/rooms/surface_spread.h"

#include <algorithm>
#include <cmath>

#include "tools/bench/rooms/room_plan.h"

namespace luxrig {
namespace {

/// Random places per receiver to choose from, and the most tries for each of these places.
constexpr std::size_t kPlacesPerReceiver = 8, kTriesPerPlace = 300;

struct Facet {
  Vec3 a_m, ab_m, ac_m, normal;
  double area_until_m2;  ///< of this triangle and all before it
};

std::vector<Facet> facets_of(const Scene& scene, const SurfacePart& part) {
  std::vector<bool> wanted(scene.object_names.size());
  for (std::size_t o = 0; o < wanted.size(); ++o)
    wanted[o] = part.objects.empty() || std::count(part.objects.begin(), part.objects.end(), scene.object_names[o]);
  const double min_cos = std::cos(part.within_rad) - 1e-9;
  double area_m2 = 0;
  std::vector<Facet> facets;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    if (!wanted[scene.object_of_triangle[t]]) continue;
    const auto& [i, j, k] = scene.triangles[t];
    const Vec3 a_m = scene.vertex_world_m(i), b_m = scene.vertex_world_m(j), c_m = scene.vertex_world_m(k);
    Eigen::AlignedBox3d bounds_m(a_m);
    bounds_m.extend(b_m).extend(c_m);
    if (!bounds_m.intersects(part.box_world_m)) continue;
    const Vec3 twice_m2 = (b_m - a_m).cross(c_m - a_m);
    const double size_m2 = twice_m2.norm() / 2;
    if (!(size_m2 > 0)) continue;
    Vec3 normal = twice_m2 / (2 * size_m2);
    if (part.either_side && normal.dot(part.facing_world) < 0) normal = -normal;
    if (normal.dot(part.facing_world) < min_cos) continue;
    facets.push_back({a_m, b_m - a_m, c_m - a_m, normal, area_m2 += size_m2});
  }
  return facets;
}

/// Keeps `count` of the places, as far apart as possible: removes the place with the nearest neighbours, again and
/// again.
std::vector<Receiver> thinned(const std::vector<Receiver>& places, std::size_t count, double area_m2) {
  const double reach_m = 2 * std::sqrt(area_m2 / (2 * std::sqrt(3.0) * static_cast<double>(count)));
  const auto weight = [&](std::size_t i, std::size_t j) {
    const double d_m = (places[i].position_world_m - places[j].position_world_m).norm();
    return d_m < reach_m ? std::pow(1 - d_m / reach_m, 8) : 0;
  };
  std::vector<double> crowding(places.size(), 0);
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double w = weight(i, j);
      crowding[i] += w, crowding[j] += w;
    }
  std::vector<std::size_t> left(places.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  while (left.size() > count) {
    const auto most = std::max_element(left.begin(), left.end(),
                                       [&](std::size_t i, std::size_t j) { return crowding[i] < crowding[j]; });
    const std::size_t gone = *most;
    left.erase(most);
    for (const std::size_t i : left) crowding[i] -= weight(i, gone);
  }
  std::vector<Receiver> kept;
  for (const std::size_t i : left) kept.push_back(places[i]);
  return kept;
}

}  // namespace

SurfaceSpread::SurfaceSpread(const Scene& scene, const RayScene& rays, const Vec3& air_world_m)
    : scene_(scene), rays_(rays), regions_(scene), air_(regions_.mark(air_world_m)) {}

bool SurfaceSpread::in_air(const Vec3& point_world_m) const { return regions_.mark(point_world_m) == air_; }

bool SurfaceSpread::is_free(const Receiver& r, const SurfacePart& part) const {
  const auto free_for = [&](const Vec3& direction, double distance_m) {
    const auto hit = rays_.nearest(r.position_world_m, direction, Vec3::Zero());
    return !hit || hit->distance_m >= distance_m;
  };
  if (!in_air(r.position_world_m)) return false;
  if (r.normal_world.z() > 0.5 && !free_for(Vec3::UnitZ(), part.headroom_m)) return false;
  const Vec3 side = r.normal_world.unitOrthogonal(), other = r.normal_world.cross(side);
  for (const Vec3& direction : {r.normal_world, side, Vec3(-side), other, Vec3(-other)})
    if (!free_for(direction, part.elbow_room_m)) return false;
  return true;
}

std::vector<Receiver> SurfaceSpread::over(const SurfacePart& part, std::size_t count, std::uint64_t seed) const {
  const std::vector<Facet> facets = facets_of(scene_, part);
  if (facets.empty() || count == 0) return {};
  const double area_m2 = facets.back().area_until_m2;
  RoomDice dice(seed);
  std::vector<Receiver> places;
  const std::size_t wanted = count * kPlacesPerReceiver;
  std::size_t tries = 0;
  for (; places.size() < wanted && tries < wanted * kTriesPerPlace; ++tries) {
    const double at_m2 = dice.between(0, area_m2);
    const auto facet = std::upper_bound(facets.begin(), facets.end() - 1, at_m2,
                                        [](double m2, const Facet& f) { return m2 < f.area_until_m2; });
    double u = dice.between(0, 1), v = dice.between(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Receiver place{facet->a_m + u * facet->ab_m + v * facet->ac_m + kOffSurface_m * facet->normal, facet->normal};
    if (part.box_world_m.contains(place.position_world_m) && is_free(place, part)) places.push_back(place);
  }
  if (places.size() <= count) return places;
  return thinned(places, count, area_m2 * static_cast<double>(places.size()) / static_cast<double>(tries));
}

}  // namespace luxrig
