#include "core/transport/sky/sky_opening_finder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/transport/bsdf.h"
#include "core/transport/sky/opening_fit.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

/// Paths that search for the sky: a few first, which distinguish open country from rooms, then more until enough see
/// it.
constexpr std::size_t kFirstPaths = 256, kPathsPerRound = 2048, kMaxFinderRounds = 8, kRoundsToBelieveNothing = 2;
constexpr std::uint32_t kLegs = 3;
constexpr std::size_t kWantedGlimpses = 400, kMinGlimpses = 12;
/// If more of the cosine-weighted hemisphere than this is sky, the whole sky is a good enough target.
constexpr double kOpenShare = 0.4;
constexpr std::uint32_t kOpenProbes = 12;
/// Glimpses whose opening's rim is probed, and directions of each.
constexpr std::size_t kFelt = 64;
constexpr int kSpokes = 8;
/// Margin added to the box from which an opening was seen, as a share of it.
constexpr double kFinderMargin = 0.02;

class Finder {
 public:
  Finder(const RayScene& scene, std::span<const Receiver> receivers, std::uint64_t seed, int threads,
         const Watch& watch)
      : scene_(scene), receivers_(receivers), seed_(seed), threads_(threads), watch_(watch) {}

  SkyOpenings run(std::uint64_t& rays) {
    const std::vector<SkyGlimpse> glimpses = look_around();
    rays += rays_;
    if (glimpses.size() < kMinGlimpses || watch_.stop.stop_requested()) return {};
    const std::vector<OpeningRim> rims = feel_rims(glimpses);
    rays += rays_;
    if (watch_.stop.stop_requested()) return {};
    FoundOpenings found = fit_openings(glimpses, rims);
    for (SkyOpening& opening : found.openings) look_through(opening);
    return {std::move(found.openings), found.missed_share};
  }

 private:
  struct Leg {
    Vec3 from_world_m, direction_world;
    double distance_m;  ///< infinite if nothing was met
  };

  /// Places from which a little of the sky is seen, with the direction.
  std::vector<SkyGlimpse> look_around() {
    std::vector<SkyGlimpse> glimpses;
    std::size_t paths = 0;
    for (std::size_t round = 0; round <= kMaxFinderRounds; ++round) {
      const std::size_t count = round == 0 ? kFirstPaths : kPathsPerRound;
      std::vector<std::optional<SkyGlimpse>> found(count);
      std::vector<std::uint8_t> open(count, 0);
      std::vector<std::vector<Leg>> legs(count);
      std::vector<std::uint64_t> rays(count, 0);
      parallel_for(count, threads_, [&](std::size_t i) {
        if (watch_.stop.stop_requested()) return;
        found[i] = look(paths + i, legs[i]);
        rays[i] += legs[i].size();
        if (found[i]) open[i] = in_the_open(*found[i], mixed(mixed(seed_, 0x0b3), paths + i), rays[i]);
      });
      for (const std::uint64_t n : rays) rays_ += n;
      if (watch_.stop.stop_requested()) return {};
      paths += count;
      std::size_t seen = 0, from_rooms = 0;
      for (std::size_t i = 0; i < count; ++i) {
        legs_.insert(legs_.end(), legs[i].begin(), legs[i].end());
        seen += found[i].has_value();
        if (!found[i] || open[i]) continue;
        ++from_rooms;
        glimpses.push_back(*found[i]);
      }
      if (round == 0 && seen > kMinGlimpses && 10 * from_rooms < seen) return {};
      if (glimpses.size() >= kWantedGlimpses) break;
      if (round >= kRoundsToBelieveNothing && glimpses.empty()) break;
    }
    return glimpses;
  }

  std::optional<SkyGlimpse> look(std::size_t path, std::vector<Leg>& legs) const {
    const SobolSequence samples(mixed(seed_, 0x5e3));
    Receiver from = receivers_[path % receivers_.size()];
    for (std::uint32_t leg = 0; leg < kLegs; ++leg) {
      const auto [u, v] = samples.pair(static_cast<std::uint32_t>(path), leg, 0);
      const Vec3 direction = cosine_direction(from.normal_world, u, v);
      const auto hit = scene_.nearest(from.position_world_m, direction, from.normal_world);
      legs.push_back({from.position_world_m, direction, hit ? hit->distance_m : HUGE_VAL});
      if (!hit) {
        if (!(direction.z() > 0)) return std::nullopt;
        return SkyGlimpse{from.position_world_m, from.normal_world, direction};
      }
      const Material& material = scene_.material_of(hit->triangle);
      if (!(material.reflectance_rgb.maxCoeff() > 0 || material.specular_reflectance > 0)) return std::nullopt;
      from = {hit->position_world_m, hit->normal_world};
    }
    return std::nullopt;
  }

  bool in_the_open(const SkyGlimpse& glimpse, std::uint64_t key, std::uint64_t& rays) const {
    const SobolSequence samples(key);
    double seen = 0;
    for (std::uint32_t i = 0; i < kOpenProbes; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      const Vec3 direction = cosine_direction(glimpse.normal_world, u, v);
      if (!(direction.z() > 0)) continue;
      ++rays;
      seen += !scene_.nearest(glimpse.from_world_m, direction, glimpse.normal_world);
    }
    return seen > kOpenShare * kOpenProbes;
  }

  /// Completes an opening with the view through it, sky or surfaces, and the box it is seen from.
  void look_through(SkyOpening& opening) const {
    std::array<double, 2> surfaces{}, all{};
    Eigen::AlignedBox3d from_m;
    for (const Leg& leg : legs_) {
      const double slope = opening.outwards_world().dot(leg.direction_world);
      const double before_m = opening.outwards_world().dot(opening.centre_world_m - leg.from_world_m);
      if (!(slope > 0) || !(before_m > 0) || !(leg.distance_m * slope > 1.001 * before_m)) continue;
      if (!opening.passed_by(leg.from_world_m, leg.direction_world)) continue;
      from_m.extend(leg.from_world_m);
      const std::size_t above = leg.direction_world.z() > 0 ? 1 : 0;
      all[above] += 1;
      surfaces[above] += std::isfinite(leg.distance_m);
    }
    if (from_m.isEmpty()) return;
    opening.surfaces_below = surfaces[0] / std::max(all[0], 1.0);
    opening.surfaces_above = surfaces[1] / std::max(all[1], 1.0);
    const Vec3 margin_m = Vec3::Constant(kFinderMargin * from_m.diagonal().norm());
    opening.seen_from_world_m = {from_m.min() - margin_m, from_m.max() + margin_m};
  }

  std::vector<OpeningRim> feel_rims(const std::vector<SkyGlimpse>& glimpses) {
    const std::size_t count = std::min(kFelt, glimpses.size());
    std::vector<OpeningRim> rims(count);
    std::vector<std::uint64_t> rays(count, 0);
    parallel_for(count, threads_, [&](std::size_t i) {
      if (watch_.stop.stop_requested()) return;
      rims[i].glimpse = i * glimpses.size() / count;
      const SkyGlimpse& glimpse = glimpses[rims[i].glimpse];
      const Frame frame(glimpse.direction_world);
      for (int spoke = 0; spoke < kSpokes; ++spoke)
        feel(glimpse, frame, 2 * kPi * (spoke + 0.5) / kSpokes, rims[i], rays[i]);
    });
    rays_ = 0;
    for (const std::uint64_t n : rays) rays_ += n;
    return rims;
  }

  /// Turns away from a glimpse until something stops the ray, then bisects the angle.
  void feel(const SkyGlimpse& glimpse, const Frame& frame, double azimuth_rad, OpeningRim& rim,
            std::uint64_t& rays) const {
    const Vec3 aside = std::cos(azimuth_rad) * frame.tangent + std::sin(azimuth_rad) * frame.bitangent;
    const auto towards = [&](double angle_rad) {
      return Vec3((std::cos(angle_rad) * frame.normal + std::sin(angle_rad) * aside).normalized());
    };
    std::optional<Hit> stopped;
    const auto free = [&](const Vec3& direction) {
      stopped.reset();
      if (!(direction.z() > 0) || !(direction.dot(glimpse.normal_world) > 0)) return false;
      ++rays;
      stopped = scene_.nearest(glimpse.from_world_m, direction, glimpse.normal_world);
      return !stopped;
    };
    double low_rad = 0, high_rad = rad_from_deg(1.25);
    while (free(towards(high_rad))) {
      low_rad = high_rad;
      high_rad *= 2;
      if (high_rad > rad_from_deg(85)) return;
    }
    std::optional<Hit> rim_hit = stopped;
    for (int halved = 0; halved < 7; ++halved) {
      const double middle_rad = 0.5 * (low_rad + high_rad);
      if (free(towards(middle_rad))) {
        low_rad = middle_rad;
      } else {
        high_rad = middle_rad;
        rim_hit = stopped;
      }
    }
    rim.free_world.push_back(towards(low_rad));
    if (rim_hit) rim.stops.push_back({rim_hit->position_world_m, rim_hit->normal_world});
  }

  const RayScene& scene_;
  std::span<const Receiver> receivers_;
  std::uint64_t seed_;
  int threads_;
  const Watch& watch_;
  std::vector<Leg> legs_;
  std::uint64_t rays_ = 0;
};

}  // namespace

SkyOpenings find_sky_openings(const RayScene& scene, std::span<const Receiver> receivers,
                              std::span<const Emitter> emitters, std::uint64_t seed, int threads, const Watch& watch,
                              std::uint64_t& rays) {
  const bool sky = std::any_of(emitters.begin(), emitters.end(), [](const Emitter& e) { return e.sky != nullptr; });
  if (!sky || receivers.empty() || scene.bounds_world_m().isEmpty()) return {};
  return Finder(scene, receivers, mixed(seed, 0x5e1f), threads, watch).run(rays);
}

}  // namespace luxrig
