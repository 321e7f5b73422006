#include "core/highlight/shadow/relief_contrast.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::size_t kPointsPerContrastTask = 256;
constexpr std::uint32_t kNotAsked = ~0u;

/// Illuminance of points by beam: rows of points, columns of beams.
struct LitPoints {
  std::size_t beams = 0;
  std::vector<std::uint8_t> lit;
  std::vector<double> illuminance_lx;
  [[nodiscard]] std::span<const std::uint8_t> row(std::size_t k) const {
    return std::span(lit).subspan(k * beams, beams);
  }
};

/// light(position_world_m, normal, lux) writes the lux of each beam there; 0 or less = none.
template <class Light>
LitPoints lit_points(const TargetSurface& surface, std::span<const std::uint32_t> asked, std::size_t beams,
                     const Light& light, int threads) {
  LitPoints points{beams, std::vector<std::uint8_t>(asked.size() * beams, 0), std::vector<double>(asked.size(), 0)};
  const std::size_t tasks = (asked.size() + kPointsPerContrastTask - 1) / kPointsPerContrastTask;
  parallel_for(tasks, threads, [&](std::size_t task) {
    std::vector<double> lux(beams);
    const std::size_t end = std::min(asked.size(), (task + 1) * kPointsPerContrastTask);
    for (std::size_t k = task * kPointsPerContrastTask; k < end; ++k) {
      const Vec3& normal = surface.normals[asked[k]];
      if (normal.isZero(0)) continue;
      light(surface.point_world_m(asked[k]), normal, std::span(lux));
      for (std::size_t b = 0; b < beams; ++b) {
        if (!(lux[b] > 0)) continue;
        points.lit[k * beams + b] = 1;
        points.illuminance_lx[k] += lux[b];
      }
    }
  });
  return points;
}

template <class Light>
ReliefContrast contrast_under(const TargetSurface& surface, std::span<const std::uint32_t> interest, std::size_t beams,
                              const Light& light, int threads, std::span<const std::uint32_t> feature_of_interest) {
  ReliefContrast result;
  if (interest.empty() || beams == 0) return result;
  LUXRIG_CHECK(feature_of_interest.empty() || feature_of_interest.size() == interest.size(),
               "features of {} points, {} points", feature_of_interest.size(), interest.size());
  std::vector<std::uint32_t> asked;  // interest points and their neighbours, each once
  for (const std::uint32_t i : interest) {
    LUXRIG_CHECK(i < surface.points_m.size(), "point {} of {}", i, surface.points_m.size());
    asked.push_back(i);
    asked.insert(asked.end(), surface.ring(i).begin(), surface.ring(i).end());
  }
  std::sort(asked.begin(), asked.end());
  asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
  std::vector<std::uint32_t> place(surface.points_m.size(), kNotAsked);
  for (std::uint32_t k = 0; k < asked.size(); ++k) place[asked[k]] = k;
  const LitPoints lit = lit_points(surface, asked, beams, light, threads);

  std::vector<std::uint8_t> feature_has_one;
  for (const std::uint32_t feature : feature_of_interest)
    feature_has_one.resize(std::max<std::size_t>(feature_has_one.size(), feature + std::size_t{1}), 0);
  double points = 0, pairs = 0, all_pairs = 0, contrast_lx = 0, reached = 0;
  for (std::size_t k = 0; k < interest.size(); ++k) {
    const std::uint32_t mine = place[interest[k]];
    bool any = false;
    double largest_lx = 0;
    for (const std::uint32_t neighbour : surface.ring(interest[k])) {
      const std::uint32_t theirs = place[neighbour];
      const bool differs = !std::ranges::equal(lit.row(mine), lit.row(theirs));
      any |= differs;
      pairs += differs ? 1 : 0;
      ++all_pairs;
      largest_lx = std::max(largest_lx, std::abs(lit.illuminance_lx[mine] - lit.illuminance_lx[theirs]));
    }
    points += any ? 1 : 0;
    if (any && !feature_of_interest.empty()) feature_has_one[feature_of_interest[k]] = 1;
    contrast_lx += largest_lx;
    reached += std::ranges::any_of(lit.row(mine), [](std::uint8_t one) { return one != 0; }) ? 1 : 0;
  }
  const auto count = static_cast<double>(interest.size());
  result.points_with_transition = points / count;
  result.pairs_with_transition = all_pairs > 0 ? pairs / all_pairs : 0;
  result.local_contrast_lx = contrast_lx / count;
  result.lit_points = reached / count;
  if (!feature_has_one.empty())
    result.features_with_transition =
        static_cast<double>(std::ranges::count(feature_has_one, 1)) / static_cast<double>(feature_has_one.size());
  return result;
}

/// Lux from each mounted beam at a point.
class BeamsAtPoints {
 public:
  BeamsAtPoints(const TargetRays& target, const Surroundings& surroundings, std::span<const MountedBeam> beams,
                double lift_m)
      : target_(target), surroundings_(surroundings), beams_(beams), lift_m_(lift_m) {
    for (const MountedBeam& beam : beams) {
      LUXRIG_CHECK(beam.intensity != nullptr && beam.position_world_m.allFinite() && beam.level >= 0, "a beam of {}",
                   beam.level);
      places_world_m_.push_back(beam.position_world_m);
    }
  }

  void operator()(const Vec3& at_world_m, const Vec3& normal, std::span<double> lux) const {
    bool any = false;
    for (std::size_t b = 0; b < beams_.size(); ++b) {
      lux[b] = 0;
      const Vec3 way_m = at_world_m - places_world_m_[b];
      const double squared_m2 = way_m.squaredNorm(), cosine = -way_m.dot(normal);
      if (!(cosine > 0)) continue;
      const Vec3 direction = way_m / std::sqrt(squared_m2);
      lux[b] = beams_[b].level * beams_[b].intensity->intensity_cd(beams_[b].world_from_lamp.transpose() * direction) *
               cosine / (squared_m2 * std::sqrt(squared_m2));
      any |= lux[b] > 0;
    }
    if (!any) return;
    std::vector<std::uint8_t> shaded(beams_.size());
    std::vector<Blocked> blocked(beams_.size());
    target_.blocked_before(at_world_m, normal, lift_m_, places_world_m_, shaded);
    find_blocked(surroundings_, at_world_m, places_world_m_, blocked);
    for (std::size_t b = 0; b < beams_.size(); ++b)
      if (shaded[b] || blocked[b] != Blocked::by_nothing) lux[b] = 0;
  }

 private:
  const TargetRays& target_;
  const Surroundings& surroundings_;
  std::span<const MountedBeam> beams_;
  double lift_m_;
  std::vector<Vec3> places_world_m_;
};

}  // namespace

MountedBeam aimed_beam(const Vec3& position_world_m, const Vec3& direction_world, Intensity intensity, double level) {
  return {position_world_m, shortest_rotation(-Vec3::UnitZ(), direction_world), std::move(intensity), level};
}

ReliefContrast relief_contrast(const TargetSurface& surface, const TargetRays& target,
                               std::span<const std::uint32_t> interest, std::span<const DistantBeam> beams,
                               double lift_m, int threads, std::span<const std::uint32_t> feature_of_interest) {
  std::vector<Vec3f> directions;
  for (const DistantBeam& beam : beams) directions.push_back(beam.direction.cast<float>());
  const auto light = [&](const Vec3& at_world_m, const Vec3& normal, std::span<double> lux) {
    std::vector<std::uint8_t> blocked(beams.size());
    target.blocked(at_world_m, normal, lift_m, directions, blocked);
    for (std::size_t b = 0; b < beams.size(); ++b)
      lux[b] = blocked[b] ? 0 : beams[b].illuminance_lx * normal.dot(beams[b].direction);
  };
  return contrast_under(surface, interest, beams.size(), light, threads, feature_of_interest);
}

ReliefContrast relief_contrast(const TargetSurface& surface, const TargetRays& target, const Surroundings& surroundings,
                               std::span<const std::uint32_t> interest, std::span<const MountedBeam> beams,
                               double lift_m, int threads, std::span<const std::uint32_t> feature_of_interest) {
  const BeamsAtPoints light(target, surroundings, beams, lift_m);
  return contrast_under(surface, interest, beams.size(), light, threads, feature_of_interest);
}

std::vector<double> illuminance_lx(const TargetSurface& surface, const TargetRays& target,
                                   const Surroundings& surroundings, std::span<const std::uint32_t> points,
                                   std::span<const MountedBeam> beams, double lift_m, int threads) {
  const BeamsAtPoints light(target, surroundings, beams, lift_m);
  return lit_points(surface, points, beams.size(), light, threads).illuminance_lx;
}

}  // namespace luxrig
