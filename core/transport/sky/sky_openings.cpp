#include "core/transport/sky/sky_openings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/photometry/shapes/shape_sampling.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

/// Least share of directions drawn over the whole sky if openings are known.
constexpr double kMinWholeShare = 0.12;
/// Least share of the sky that counts as visible if no opening shows any.
constexpr double kMinLitShare = 0.02;

/// The part of an opening above or below a point's horizon, as a shape around its own centre.
struct SeenPart {
  Vec3 from_m;  ///< the point relative to that centre, in the opening's frame
  LuminousShape shape;
};

std::optional<SeenPart> part_of(const SkyOpening& opening, const Vec3& position_world_m, bool above) {
  Vec3 from_m = opening.local_m(position_world_m);
  if (!(from_m.z() < 0)) return std::nullopt;
  double low_m = -opening.half_y_m, high_m = opening.half_y_m;
  const double rise = opening.world_from_opening(2, 1), above_m = opening.centre_world_m.z() - position_world_m.z();
  if (rise > 1e-9) {
    (above ? low_m : high_m) = std::clamp(-above_m / rise, low_m, high_m);
  } else if ((above_m > 0) != above) {
    return std::nullopt;
  }
  if (!(low_m < high_m)) return std::nullopt;
  from_m.y() -= 0.5 * (low_m + high_m);
  return SeenPart{from_m, {LuminousShape::Kind::rectangle, {2 * opening.half_x_m, high_m - low_m, 0}}};
}

/// Mean cosine over those of the corners and the centre that the surface faces.
double mean_cosine(const SeenPart& part, const Vec3& normal) {
  const double x = 0.5 * part.shape.size_m.x(), y = 0.5 * part.shape.size_m.y();
  double sum = 0;
  for (const auto& [i, j] : {std::pair{0, 0}, {-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const Vec3 to_m = Vec3(i * x, j * y, 0) - part.from_m;
    const double height_m = normal.dot(to_m);
    if (height_m > 0) sum += height_m / to_m.norm();
  }
  return sum / 5;
}

/// Approximate ∫ cosθ dω over a part.
double weight_of(const SeenPart& part, const Vec3& normal) {
  const double area_m2 = part.shape.size_m.x() * part.shape.size_m.y(), distance_m = part.from_m.norm();
  // As for a disk of that area seen from its axis, times the slope: at most the half space.
  const double solid_angle =
      area_m2 * -part.from_m.z() / (distance_m * (distance_m * distance_m + area_m2 / (2 * kPi)));
  const double weight = solid_angle * mean_cosine(part, normal);
  return weight > 0 && std::isfinite(weight) ? weight : 0;
}

/// Chooses by weights and replaces `number` by its remainder, which is again uniform.
std::size_t chosen_by(std::span<const double> weights, double sum, double& number) {
  double left = number * sum;
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!(weights[i] > 0)) continue;
    chosen = i;
    if (left < weights[i]) break;
    left -= weights[i];
  }
  number = std::clamp(left / weights[chosen], 0.0, 1 - 0x1p-53);
  return chosen;
}

}  // namespace

bool SkyOpening::passed_by(const Vec3& position_world_m, const Vec3& direction_world, double margin_m) const {
  const Vec3 from_m = local_m(position_world_m), d = world_from_opening.transpose() * direction_world;
  const double x_m = from_m.x() * d.z() - from_m.z() * d.x(), y_m = from_m.y() * d.z() - from_m.z() * d.y();
  const double slope = std::abs(d.z());
  return slope > 0 && std::abs(x_m) <= (half_x_m + margin_m) * slope && std::abs(y_m) <= (half_y_m + margin_m) * slope;
}

SkyOpenings::SkyOpenings(std::vector<SkyOpening> openings, double missed_share)
    : openings_(std::move(openings)),
      missed_share_(missed_share),
      inside_whole_share_(std::clamp(2 * missed_share, kMinWholeShare, 1.0)) {}

void SkyOpenings::view(const Vec3& position_world_m, const Vec3& normal_world, View& view) const {
  view.within = false;
  view.sum = 0;
  view.weights.assign(openings_.size(), 0.0);
  for (std::size_t i = 0; i < openings_.size(); ++i) {
    const SkyOpening& opening = openings_[i];
    if (!opening.seen_from_world_m.contains(position_world_m)) continue;
    if (!(opening.outwards_world().dot(position_world_m - opening.centre_world_m) < 0)) continue;
    view.within = true;
    const auto above = part_of(opening, position_world_m, true);
    if (!above) continue;
    view.weights[i] = weight_of(*above, opening.world_from_opening.transpose() * normal_world);
    view.sum += view.weights[i];
  }
}

DirectionSample SkyOpenings::sample(const View& view, const Vec3& position_world_m, double select, double u,
                                    double v) const {
  const SkyOpening& opening = openings_[chosen_by(view.weights, view.sum, select)];
  const auto above = part_of(opening, position_world_m, true);
  if (!above) return {};
  const ShapeSample seen = sample_seen_from(above->shape, above->from_m, u, v);
  if (!(seen.density_per_sr > 0)) return {};
  const Vec3 direction_world = opening.world_from_opening * seen.direction;
  return {direction_world, density_per_sr(view, position_world_m, direction_world)};
}

double SkyOpenings::density_per_sr(const View& view, const Vec3& position_world_m, const Vec3& direction_world) const {
  double density = 0;
  for (std::size_t i = 0; i < openings_.size(); ++i) {
    if (!(view.weights[i] > 0)) continue;
    const SkyOpening& opening = openings_[i];
    // Cheap test first: most directions miss most openings.
    if (!opening.passed_by(position_world_m, direction_world, 1e-9 * opening.half_x_m)) continue;
    if (const auto above = part_of(opening, position_world_m, true))
      density +=
          view.weights[i] / view.sum *
          density_seen_from(above->shape, above->from_m, opening.world_from_opening.transpose() * direction_world);
  }
  return density;
}

void SkyOpenings::look_outside(const Vec3& position_world_m, const Vec3& normal_world, Outside& outside) const {
  outside.sum = 0;
  outside.weights.assign(2 * openings_.size(), 0.0);
  for (std::size_t i = 0; i < openings_.size(); ++i) {
    const SkyOpening& opening = openings_[i];
    if (!opening.seen_from_world_m.contains(position_world_m)) continue;
    for (const bool above : {false, true}) {
      const double surfaces = above ? opening.surfaces_above : opening.surfaces_below;
      if (!(surfaces > 0)) continue;
      const auto part = part_of(opening, position_world_m, above);
      if (!part) continue;
      const double weight = surfaces * weight_of(*part, opening.world_from_opening.transpose() * normal_world);
      outside.weights[2 * i + above] = weight;
      outside.sum += weight;
    }
  }
}

DirectionSample SkyOpenings::sample_outside(const Outside& outside, const Vec3& position_world_m, double u,
                                            double v) const {
  const std::size_t chosen = chosen_by(outside.weights, outside.sum, u);
  const SkyOpening& opening = openings_[chosen / 2];
  const auto part = part_of(opening, position_world_m, chosen % 2 == 1);
  if (!part) return {};
  const ShapeSample seen = sample_seen_from(part->shape, part->from_m, u, v);
  if (!(seen.density_per_sr > 0)) return {};
  const Vec3 direction_world = opening.world_from_opening * seen.direction;
  return {direction_world, outside_density_per_sr(outside, position_world_m, direction_world)};
}

double SkyOpenings::outside_density_per_sr(const Outside& outside, const Vec3& position_world_m,
                                           const Vec3& direction_world) const {
  double density = 0;
  for (std::size_t i = 0; i < openings_.size(); ++i) {
    const SkyOpening& opening = openings_[i];
    if (!(outside.weights[2 * i] + outside.weights[2 * i + 1] > 0)) continue;
    if (!opening.passed_by(position_world_m, direction_world, 1e-9 * opening.half_x_m)) continue;
    for (const bool above : {false, true})
      if (const auto part = part_of(opening, position_world_m, above); part && outside.weights[2 * i + above] > 0)
        density +=
            outside.weights[2 * i + above] / outside.sum *
            density_seen_from(part->shape, part->from_m, opening.world_from_opening.transpose() * direction_world);
  }
  return density;
}

double SkyOpenings::lit_share(const View& view, const Vec3& position_world_m, const Vec3* towards_world) const {
  if (!view.within) return 1;
  const double least = std::max(kMinLitShare, missed_share_);
  if (!towards_world) return std::min(1.0, least + view.sum / kPi);
  for (const SkyOpening& opening : openings_) {
    // The light is not from exactly one direction: beyond the rim some of it still enters.
    const double distance_m = (opening.centre_world_m - position_world_m).norm();
    if (opening.passed_by(position_world_m, *towards_world, 0.01 * distance_m)) return 1;
  }
  return least;
}

double SkyOpenings::facing_area_m2(const Vec3& towards_world) const {
  double area_m2 = 0;
  for (const SkyOpening& opening : openings_)
    area_m2 += opening.area_m2() * std::max(0.0, opening.outwards_world().dot(towards_world));
  return area_m2;
}

bool SkyOpenings::sample_line(const Vec3& towards_world, double s, double t, Vec3& on_line_world_m) const {
  double left = s * facing_area_m2(towards_world);
  for (const SkyOpening& opening : openings_) {
    const double area_m2 = opening.area_m2() * std::max(0.0, opening.outwards_world().dot(towards_world));
    if (!(area_m2 > 0)) continue;
    // The remainder of the number after the choice is again uniform.
    const double rest = std::min(left / area_m2, 1.0);
    on_line_world_m = opening.centre_world_m + opening.world_from_opening * Vec3((2 * rest - 1) * opening.half_x_m,
                                                                                 (2 * t - 1) * opening.half_y_m, 0);
    if (left < area_m2) return true;
    left -= area_m2;
  }
  return facing_area_m2(towards_world) > 0;
}

double SkyOpenings::line_density_per_m2(const Vec3& towards_world, const Vec3& position_world_m) const {
  int passed = 0;
  for (const SkyOpening& opening : openings_)
    passed += opening.outwards_world().dot(towards_world) > 0 && opening.passed_by(position_world_m, towards_world);
  return passed > 0 ? passed / facing_area_m2(towards_world) : 0;
}

std::optional<Vec3> only_direction(const SkyLuminance& sky) {
  constexpr std::uint32_t kDrawn = 16;
  constexpr double kWithin = 1e-3;  // of the cosine: 2.6°
  const SobolSequence samples(0x5c9);
  Vec3 sum = Vec3::Zero();
  std::array<Vec3, kDrawn> drawn;
  for (std::uint32_t i = 0; i < kDrawn; ++i) {
    const auto [u, v] = samples.pair(i, 0, 0);
    sum += drawn[i] = sky.sample(u, v).direction;
  }
  if (!(sum.norm() > 0)) return std::nullopt;
  sum.normalize();
  for (const Vec3& one : drawn)
    if (one.dot(sum) < 1 - kWithin) return std::nullopt;
  return sum;
}

}  // namespace luxrig
