#include "core/transport/direct/direct_sources.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/photometry/shapes/shape_sampling.h"
#include "core/transport/direct/shape_light.h"
#include "core/transport/paths/path_sampler.h"

namespace luxrig {
namespace {

auto place_of(const Emitter& emitter) {
  const Vec3& p = emitter.world_from_lamp.translation_m;
  return std::tuple(p.x(), p.y(), p.z());
}

bool is_point(const Emitter& emitter) { return !emitter.sky && emitter.shape.kind == LuminousShape::Kind::point; }

/// Points around a shape, in frame world: the four corners of a plane one in order, or the eight of a box.
std::vector<Vec3> corners_around(const Emitter& emitter, const Vec3& seen_from_world_m) {
  const Pose& pose = emitter.world_from_lamp;
  const Vec3 from_m = pose.inverse_direction(seen_from_world_m - pose.translation_m);
  Vec3 half_m = 0.5 * emitter.shape.size_m;
  // Boxes of round shapes may have any orientation: turned to the observer, the box looks smallest.
  Vec3 x = Vec3::UnitX();
  const double level = std::hypot(from_m.x(), from_m.y());
  using Kind = LuminousShape::Kind;
  const Kind kind = emitter.shape.kind;
  if (kind != Kind::rectangle && level > 0) x = Vec3(from_m.x() / level, from_m.y() / level, 0);
  const Vec3 y(-x.y(), x.x(), 0);
  if (kind == Kind::disk || kind == Kind::cylinder) half_m.y() = half_m.x();
  if (kind == Kind::sphere) half_m.setConstant(half_m.x());
  std::vector<Vec3> corners;
  const auto add = [&](double i, double j, double k) {
    corners.push_back(pose.point(i * half_m.x() * x + j * half_m.y() * y + Vec3(0, 0, k * half_m.z())));
  };
  if (kind == Kind::rectangle || kind == Kind::disk) {
    for (const auto& [i, j] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) add(i, j, 0);
  } else {
    for (const int i : {-1, 1})
      for (const int j : {-1, 1})
        for (const int k : {-1, 1}) add(i, j, k);
  }
  return corners;
}

/// A distance from a point beyond everything in the scene.
double beyond_m(const Eigen::AlignedBox3d& bounds, const Vec3& from_world_m) {
  return 2 * ((bounds.center() - from_world_m).norm() + bounds.diagonal().norm()) + 1e-3;
}

}  // namespace

DirectSources::DirectSources(std::span<const Emitter> emitters) : emitters_(emitters) {
  std::vector<std::size_t> points;
  for (std::size_t e = 0; e < emitters.size(); ++e) (is_point(emitters[e]) ? points : extended_).push_back(e);
  std::stable_sort(points.begin(), points.end(),
                   [&](std::size_t a, std::size_t b) { return place_of(emitters[a]) < place_of(emitters[b]); });
  lamps_.reserve(points.size());
  for (const std::size_t e : points) {
    const Emitter& emitter = emitters[e];
    const double half_cone_rad = emitter.intensity->emission_cone_rad() / 2;
    // The margin keeps rounding from cutting off the rim of the cone, where intensity_cd() decides.
    const double cos_half_cone = half_cone_rad < kPi ? std::cos(half_cone_rad) - 1e-9 : -2.0;
    if (groups_.empty() || groups_.back().position_world_m != emitter.world_from_lamp.translation_m)
      groups_.push_back({emitter.world_from_lamp.translation_m, lamps_.size(), lamps_.size()});
    lamps_.push_back({e, emitter.world_from_lamp.direction(-Vec3::UnitZ()), cos_half_cone,
                      emitter.world_from_lamp.rotation.transpose()});
    groups_.back().end = lamps_.size();
  }
}

void DirectSources::gather_points(const Receiver& receiver, Scratch& scratch) const {
  scratch.lit.clear();
  scratch.targets_world_m.clear();
  for (const Group& group : groups_) {
    const Vec3 towards_m = group.position_world_m - receiver.position_world_m;
    const double height_m = receiver.normal_world.dot(towards_m);
    if (!(height_m > 0)) continue;
    const double distance_squared_m2 = towards_m.squaredNorm();
    const double per_distance = 1 / std::sqrt(distance_squared_m2);
    const Vec3 direction_world = towards_m * per_distance;
    const double lux_per_candela = height_m * per_distance / distance_squared_m2;
    if (!std::isfinite(lux_per_candela)) continue;
    bool any = false;
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const Lamp& lamp = lamps_[i];
      if (-lamp.axis_world.dot(direction_world) < lamp.cos_half_cone) continue;
      const double lux =
          lux_per_candela * emitters_[lamp.emitter].intensity->intensity_cd(-(lamp.lamp_from_world * direction_world));
      if (!(lux > 0)) continue;
      if (!any) scratch.targets_world_m.push_back(group.position_world_m);
      any = true;
      scratch.lit.push_back({lamp.emitter, scratch.targets_world_m.size() - 1, lux});
    }
  }
}

bool DirectSources::may_light(std::size_t e, const Receiver& receiver) const {
  const Emitter& emitter = emitters_[e];
  if (emitter.sky) return true;
  const Vec3 towards_m = emitter.world_from_lamp.translation_m - receiver.position_world_m;
  const double radius_m = bounding_radius_m(emitter.shape), distance_m = towards_m.norm();
  if (!(receiver.normal_world.dot(towards_m) > -radius_m)) return false;
  const double half_cone_rad = 0.5 * emitter.intensity->emission_cone_rad();
  if (half_cone_rad >= kPi || distance_m <= radius_m) return true;
  const double off_axis_rad =
      std::acos(std::clamp(emitter.world_from_lamp.direction(Vec3::UnitZ()).dot(towards_m) / distance_m, -1.0, 1.0));
  return off_axis_rad <= half_cone_rad + std::asin(radius_m / distance_m) + 1e-6;
}

Way way_between(const RayScene& scene, const Receiver& receiver, const Emitter& emitter, std::uint64_t& rays) {
  if (scene.has_panes()) return Way::unknown;  // their loss must be sampled
  const Eigen::AlignedBox3d bounds = scene.bounds_world_m();
  if (bounds.isEmpty()) return Way::clear;
  const Vec3& from = receiver.position_world_m;
  if (emitter
          .sky) {  // everything above the receiver's horizon; beyond the scene, since the light comes from there
    Shaft above{{{receiver.normal_world, receiver.normal_world.dot(from)}}, {}};
    Eigen::AlignedBox3d all = bounds;
    all.extend(from);
    const Vec3 margin_m = Vec3::Constant(all.diagonal().norm());
    all = Eigen::AlignedBox3d(all.min() - margin_m, all.max() + margin_m);
    for (int i = 0; i < 8; ++i) above.corners_world_m.push_back(all.corner(Eigen::AlignedBox3d::CornerType(i)));
    return scene.surely_clear(above) ? Way::clear : Way::unknown;
  }
  const std::vector<Vec3> corners = corners_around(emitter, from);
  const Shaft shaft = corners.size() == 4
                          ? shaft_to_quad(from, receiver.normal_world, std::span<const Vec3, 4>(corners))
                          : shaft_to_hull(from, receiver.normal_world, corners);
  if (scene.surely_clear(shaft)) return Way::clear;
  return scene.surely_blocked(from, receiver.normal_world, corners, rays) ? Way::blocked : Way::unknown;
}

namespace {

/// If openings show the sky, one in this many samples goes to the rest of it.
constexpr std::uint32_t kSeldom = 4;

/// Directions towards a sky, as add(direction, weight / density [sr] per sample, part). The sky's own directions and
/// cosine-weighted ones are combined by the balance heuristic. If openings show the sky, there is a third strategy, by
/// far the best where it applies: it is combined with the other two by the power heuristic (E. Veach, 1997, §9.2.3),
/// since even a few of their samples there would be most of the noise.
template <class Add>
void draw_sky_directions(const SkyLuminance& sky, const Receiver& receiver, const SkyOpenings& openings, bool through,
                         const SobolSequence& samples, std::uint32_t begin, std::uint32_t end,
                         const SkyOpenings::View& view, Add&& add) {
  const Vec3& normal = receiver.normal_world;
  const std::uint32_t seldom = through ? kSeldom : 1;
  const auto add_direction = [&](const Vec3& d, bool from_opening) {
    const double cosine = normal.dot(d);
    if (!(cosine > 0)) return;
    const double whole = (sky.density_per_sr(d) + cosine / kPi) / seldom;
    if (!through) return add(d, 1 / whole, 0);
    const double opening = openings.density_per_sr(view, receiver.position_world_m, d);
    const double own = from_opening ? opening : whole;
    add(d, own / (opening * opening + whole * whole), opening > 0 ? 0 : 1);
  };
  for (std::uint32_t i = begin; i < end; ++i) {
    if (through) {
      const auto uv = samples.set(i, 1);
      const DirectionSample drawn = openings.sample(view, receiver.position_world_m, uv[2], uv[0], uv[1]);
      if (drawn.density_per_sr > 0) add_direction(drawn.direction, true);
      if (i % kSeldom != 0) continue;
    }
    const auto uv = samples.set(i / seldom, 0);
    const DirectionSample drawn = sky.sample(uv[0], uv[1]);
    if (drawn.density_per_sr > 0) add_direction(drawn.direction, false);
    add_direction(cosine_direction(normal, uv[2], uv[3]), false);
  }
}

}  // namespace

DirectSum sample_direct(const RayScene& scene, const Receiver& receiver, const Emitter& emitter, Way way,
                        const SkyOpenings& openings, const SobolSequence& samples, std::uint32_t begin,
                        std::uint32_t end, DirectSources::Scratch& scratch) {
  const Vec3 &from = receiver.position_world_m, &normal = receiver.normal_world;
  scratch.targets_world_m.clear();
  scratch.values.clear();
  scratch.parts.clear();
  DirectSum sum;
  sum.parts[0].samples = end - begin;
  const auto add = [&](const Vec3& target_world_m, double lux, std::uint8_t part = 0) {
    if (!(lux > 0) || !std::isfinite(lux)) return;
    if (scene.has_panes()) lux *= scene.transmittance(from, target_world_m);
    scratch.parts.push_back(part);
    scratch.targets_world_m.push_back(target_world_m);
    scratch.values.push_back(lux);
  };
  if (emitter.sky) {
    const SkyLuminance& sky = *emitter.sky;
    const double far_m = way == Way::clear ? 1 : beyond_m(scene.bounds_world_m(), from);
    bool through = false;
    if (!openings.empty() && way != Way::clear && !only_direction(sky)) {
      openings.view(from, normal, scratch.view);
      through = openings.whole_sky_share(scratch.view) < 0.5;
    }
    if (through) sum.parts[1].samples = (end - begin) / kSeldom;
    draw_sky_directions(sky, receiver, openings, through, samples, begin, end, scratch.view,
                        [&](const Vec3& d, double per_density, std::uint8_t part) {
                          add(from + far_m * d, sky.luminance_cd_m2(d) * normal.dot(d) * per_density, part);
                        });
  } else {
    const Pose& pose = emitter.world_from_lamp;
    const Vec3 from_lamp = pose.inverse_direction(from - pose.translation_m), n = pose.inverse_direction(normal);
    for (std::uint32_t i = begin; i < end; ++i) {
      const auto uv = samples.pair(i, 0, 0);
      const ShapeSample s = sample_seen_from(emitter.shape, from_lamp, uv[0], uv[1]);
      const double cosine = n.dot(s.direction);
      if (!(s.density_per_sr > 0) || !(cosine > 0)) continue;
      const double luminance_cd_m2 =
          emitter.intensity->intensity_cd(-s.direction) / projected_area_m2(emitter.shape, s.direction);
      add(from + s.distance_m * pose.direction(s.direction), luminance_cd_m2 * cosine / s.density_per_sr);
    }
  }
  scratch.occluded.assign(scratch.values.size(), 0);
  if (way != Way::clear && !scratch.values.empty()) {
    scene.occluded_many(from, normal, scratch.targets_world_m, scratch.occluded);
    sum.rays = scratch.values.size();
  }
  for (std::size_t i = 0; i < scratch.values.size(); ++i) {
    DirectSum::Part& part = sum.parts[scratch.parts[i]];
    part.unobstructed_lux += scratch.values[i];
    if (!scratch.occluded[i]) part.lux += scratch.values[i];
  }
  return sum;
}

}  // namespace luxrig
