#include "core/tasks/surface_goals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rig/frames.h"

namespace luxrig {
namespace {

/// From farther away, it is not clear which surface is meant.
constexpr double kReach_m = 1;

std::string text_of(const Vec3& place) { return fmt::format("({:g}, {:g}, {:g})", place.x(), place.y(), place.z()); }

/// Where somebody or something is that looks at the room.
std::vector<Vec3> viewers_of(const Rig& rig) {
  std::vector<Vec3> viewers;
  for (const Fixture& fixture : rig.fixtures) viewers.push_back(fixture.world_from_mount.translation_m);
  for (const PictureCamera& camera : rig.cameras) viewers.push_back(camera.position_world_m);
  for (const Point& point : rig.points) viewers.push_back(point.position_world_m);
  return viewers;
}

bool is_seen(const RayScene& rays, const SurfacePlace& place, std::span<const Vec3> viewers) {
  return std::any_of(viewers.begin(), viewers.end(), [&](const Vec3& viewer) {
    return place.normal_world.dot(viewer - place.position_world_m) > 0 &&
           !rays.occluded(place.position_world_m, place.normal_world, viewer);
  });
}

bool sees_what_is_seen(const RayScene& rays, const SurfacePlace& place, std::span<const Vec3> viewers) {
  for (int towards = 0; towards < 27; ++towards) {
    const Vec3 direction = Vec3(towards % 3 - 1, towards / 3 % 3 - 1, towards / 9 - 1).stableNormalized();
    if (!(direction.dot(place.normal_world) > 0.1)) continue;
    const auto hit = rays.nearest(place.position_world_m, direction, place.normal_world);
    if (hit && is_seen(rays, {hit->position_world_m, hit->normal_world}, viewers)) return true;
  }
  return false;
}

}  // namespace

Result<SurfacePlace> place_on_surface(const Session& session, const Vec3& near_world_m,
                                      const std::optional<Vec3>& from_world_m) {
  const RayScene& rays = *session.rays;
  const auto refuse = [](std::string why) { return refusal(std::move(why)); };
  const auto nearest = rays.nearest_surface(near_world_m, kReach_m);
  if (!nearest)
    return refuse(fmt::format("no surface is within {:g} m of {}: point at one", kReach_m, text_of(near_world_m)));
  const auto corner = rays.corners_world_m(nearest->triangle);
  const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).stableNormalized();
  const std::vector<Vec3> viewers = from_world_m ? std::vector{*from_world_m} : viewers_of(session.rig);
  const SurfacePlace sides[] = {{nearest->position_world_m, normal}, {nearest->position_world_m, -normal}};
  std::vector<SurfacePlace> seen;
  for (const SurfacePlace& side : sides)
    if (is_seen(rays, side, viewers)) seen.push_back(side);
  // A place that only reflected light reaches, as below a table, sees one that they see.
  if (seen.empty() && !from_world_m)
    for (const SurfacePlace& side : sides)
      if (sees_what_is_seen(rays, side, viewers)) seen.push_back(side);
  if (seen.size() == 1) return seen.front();
  const std::string where = fmt::format("the surface at {}", text_of(nearest->position_world_m));
  if (from_world_m) return refuse(fmt::format("{} is hidden from {}", where, text_of(*from_world_m)));
  return refuse(fmt::format("{} is {}: say with --from x y z from where you look at it", where,
                            seen.empty() ? "seen by no lamp, camera or point of the rig" : "seen from both its sides"));
}

double SurfacePainter::Painted::area_m2() const {
  double area_m2 = 0;
  for (std::uint32_t p = 0; p < surface->size(); ++p)
    if (!std::isnan(painting->lux()[p])) area_m2 += static_cast<double>(surface->patches[p].area_m2);
  return area_m2;
}

std::optional<std::pair<double, double>> SurfacePainter::Painted::lux_range() const {
  std::optional<std::pair<double, double>> range;
  for (const float lux : painting->lux()) {
    if (std::isnan(lux)) continue;
    const auto lx = static_cast<double>(lux);
    range = range ? std::pair(std::min(range->first, lx), std::max(range->second, lx)) : std::pair(lx, lx);
  }
  return range;
}

Result<SurfacePainter::Painted> SurfacePainter::paint(const SurfaceGoalSpec& goal, std::span<const Stroke> strokes) {
  auto diced = surfaces_.find(goal.patch_m);
  if (diced == surfaces_.end()) {
    auto surface = make_surface_patches(session_->scene, *session_->rays, {goal.patch_m, threads_});
    if (!surface) return tl::unexpected(surface.error());
    diced = surfaces_.emplace(goal.patch_m, std::move(*surface)).first;
  }
  Painted painted{&diced->second, std::make_unique<Painting>(diced->second, *session_->rays)};
  for (const Stroke& stroke : strokes) painted.painting->add(stroke);
  return painted;
}

std::vector<Point> points_of(const SurfaceGoalSpec& goal, const SurfacePainter::Painted& painted) {
  const SurfaceGoal wanted{goal.name, goal.max_lx, goal.weight};
  GoalSampling sampling;
  sampling.min_spacing_m = goal.min_spacing_m;
  sampling.max_spacing_m = goal.max_spacing_m;
  std::vector<Point> points;
  for (const GoalPoint& found : goal_points(*painted.surface, painted.painting->lux(), wanted, sampling)) {
    Point point;
    point.name = found.name;
    point.position_world_m = found.place.position_world_m;
    point.normal_world = found.place.normal_world;
    // As for points, a wish for 0 lx is no goal: max_lx keeps a place dark.
    if (found.goal_lx > 0) {
      point.goal_lx = found.goal_lx;
      point.goal_rgb = goal.goal_rgb;
    }
    point.weight = found.weight;
    point.max_lx = found.max_lx;
    point.goal_tolerance = goal.goal_tolerance;
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace luxrig
