#include "core/calibration/beam_spot.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

constexpr double kLeastOverNoise = 10;
/// Reflected light is below this share of the brightest place, a beam above this share of its own peak.
constexpr double kOfBrightest = 0.1, kOfPeak = 0.2;
/// What counts for the middle. Above kOfPeak, so that a better known lamp still finds all of it in the spot.
constexpr double kCounts = 0.35;
constexpr double kLeastCosineAtLamp = 0.1;
constexpr std::size_t kFewestPixels = 16;
constexpr double kSecond = 0.25;    ///< of the light: a second spot with so much compares
constexpr double kCutShare = 0.05;  ///< of the spot's rim
constexpr double kJump_m = 0.1;     ///< between neighbours: an edge in depth
constexpr double kClippedShare = 0.03;
constexpr std::size_t kClippedPixels = 5;
constexpr double kStays = 0.1;
/// Standard errors of a centre that its pixels' scatter does not show: paint that differs from plane to plane,
/// relative; things that stand a little elsewhere; light that two planes throw at each other, and uneven paint, of its
/// radius; the rest.
constexpr double kPaintError = 0.15, kThingError_m = 0.03, kCorner = 0.15, kUnevenShare = 0.004, kFloor_rad = 1e-4;

double luminance_at(const Picture& picture, std::size_t i) {
  const Vec3f& rgb = picture.luminance_cd_m2[i];
  return 0.2126 * static_cast<double>(rgb.x()) + 0.7152 * static_cast<double>(rgb.y()) +
         0.0722 * static_cast<double>(rgb.z());
}

/// How a piece of surface lies to a lamp.
struct Seen {
  Vec3 direction;          ///< unit, from the lamp
  double candela_per_lux;  ///< 0 = it lies too slant, or with its back to the lamp
  double solid_angle_sr;   ///< seen from the lamp
};

Seen seen_from(const SeenSurface& surface, const SurfacePixel& pixel, const Vec3& pivot_world_m) {
  const Vec3 to_m = surface.position_world_m(pixel) - pivot_world_m;
  const double square_m2 = to_m.squaredNorm();
  if (!(square_m2 > 1e-6)) return {Vec3::UnitZ(), 0, 0};
  const Vec3 direction = to_m / std::sqrt(square_m2);
  const double cosine = -direction.dot(pixel.normal.cast<double>());
  if (!(cosine > kLeastCosineAtLamp)) return {direction, 0, 0};
  return {direction, square_m2 / cosine, static_cast<double>(pixel.area_m2) * cosine / square_m2};
}

/// Means of 3 × 3 pixels, over those that are seen.
std::vector<float> smoothed(const SeenSurface& surface, const std::vector<float>& of) {
  const int width = surface.camera.width_px, height = surface.camera.height_px;
  std::vector<float> mean(of.size(), 0.0F);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      int count = 0;
      for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
          if (!surface.at(u, v).seen()) continue;
          sum += of[static_cast<std::size_t>(v * width + u)];
          ++count;
        }
      if (count > 0) mean[static_cast<std::size_t>(y * width + x)] = sum / static_cast<float>(count);
    }
  return mean;
}

/// Standard deviation of a pixel's noise, where there is no light: differences of neighbours, so that slow changes do
/// not count, and their median, so that edges do not.
double noise_of(const SeenSurface& surface, const std::vector<float>& lux) {
  std::vector<float> steps;
  for (std::size_t i = 1; i < lux.size(); i += 2)
    if (surface.pixels[i].seen() && surface.pixels[i - 1].seen()) steps.push_back(std::abs(lux[i] - lux[i - 1]));
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return static_cast<double>(*middle) * 1.4826 / std::numbers::sqrt2;
}

/// Pixels that touch each other, from one of them; marks them as taken.
std::vector<std::size_t> region_of(std::size_t first, int width, int height, std::vector<std::uint8_t>& open) {
  std::vector<std::size_t> region{first};
  open[first] = 0;
  for (std::size_t k = 0; k < region.size(); ++k) {
    const int x = static_cast<int>(region[k]) % width, y = static_cast<int>(region[k]) / width;
    for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
        const auto i = static_cast<std::size_t>(v * width + u);
        if (!open[i]) continue;
        open[i] = 0;
        region.push_back(i);
      }
  }
  return region;
}

/// The share of its rim behind which it may go on unseen.
double cut_share(const SeenSurface& surface, const std::vector<std::size_t>& region) {
  const int width = surface.camera.width_px, height = surface.camera.height_px;
  std::vector<std::uint8_t> inside(surface.pixels.size(), 0);
  for (const std::size_t i : region) inside[i] = 1;
  std::size_t rim = 0, cut = 0;
  for (const std::size_t i : region) {
    const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
    for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
      const int u = x + dx, v = y + dy;
      const bool outside = u < 0 || v < 0 || u >= width || v >= height;
      const SurfacePixel* next = outside ? nullptr : &surface.at(u, v);
      const bool lost = !next || !next->seen();
      const bool jumps = !lost && next->plane != surface.pixels[i].plane &&
                         (next->position_m - surface.pixels[i].position_m).norm() > kJump_m;
      rim += outside || !inside[static_cast<std::size_t>(v * width + u)] || jumps;
      cut += lost || jumps;
    }
  }
  return rim > 0 ? static_cast<double>(cut) / static_cast<double>(rim) : 1;
}

bool is_clipped(const Picture& lit, const std::vector<std::size_t>& region) {
  float most = 0;
  for (const Vec3f& pixel : lit.luminance_cd_m2) most = std::max(most, pixel.maxCoeff());
  const auto full = static_cast<std::size_t>(std::count_if(
      region.begin(), region.end(), [&](std::size_t i) { return lit.luminance_cd_m2[i].maxCoeff() >= most; }));
  return full >= kClippedPixels && static_cast<double>(full) > kClippedShare * static_cast<double>(region.size());
}

void check_sizes(const SeenSurface& surface, const Picture& picture) {
  LUXRIG_CHECK(picture.luminance_cd_m2.size() == surface.pixels.size() && picture.width_px == surface.camera.width_px,
               "a picture of {} × {} pixels for a surface of {} × {}", picture.width_px, picture.height_px,
               surface.camera.width_px, surface.camera.height_px);
}

/// Light per pixel, lit less dark; 0 where no surface is seen.
std::vector<float> lux_of(const SeenSurface& surface, const Picture& lit, const Picture& dark) {
  std::vector<float> lux(surface.pixels.size(), 0.0F);
  for (std::size_t i = 0; i < lux.size(); ++i) {
    const SurfacePixel& pixel = surface.pixels[i];
    if (!pixel.seen()) continue;
    const double more_cd_m2 = luminance_at(lit, i) - luminance_at(dark, i);
    if (std::isfinite(more_cd_m2))
      lux[i] = static_cast<float>(kPi * more_cd_m2 / static_cast<double>(pixel.reflectance));
  }
  return lux;
}

}  // namespace

const char* words_of(NoBeam why) {
  switch (why) {
    case NoBeam::dark:
      return "no light stands out of the noise";
    case NoBeam::small:
      return "the light is of too few pixels";
    case NoBeam::cut:
      return "part of the light is out of sight";
    case NoBeam::several:
      return "there are two spots that compare: one may be a reflection";
    case NoBeam::clipped:
      return "the light is brighter than the camera can tell";
    case NoBeam::stays:
      return "the light is there without the lamp too";
  }
  return "";
}

tl::expected<BeamSpot, NoBeam> beam_spot(const SeenSurface& surface, const Picture& lit, const Picture& dark,
                                         const Vec3& pivot_world_m) {
  check_sizes(surface, lit);
  check_sizes(surface, dark);
  const std::vector<float> lux = lux_of(surface, lit, dark);
  const std::vector<float> mean_lux = smoothed(surface, lux);
  const float brightest = *std::max_element(mean_lux.begin(), mean_lux.end());
  const double noise_lx = noise_of(surface, lux);
  if (!(brightest > kLeastOverNoise * noise_lx) || !(brightest > 0)) return tl::unexpected(NoBeam::dark);

  std::vector<float> candela(lux.size(), 0.0F);
  float peak = 0;
  for (std::size_t i = 0; i < lux.size(); ++i) {
    if (!(mean_lux[i] > kOfBrightest * brightest) || !surface.pixels[i].seen()) continue;
    candela[i] = static_cast<float>(static_cast<double>(mean_lux[i]) *
                                    seen_from(surface, surface.pixels[i], pivot_world_m).candela_per_lux);
    peak = std::max(peak, candela[i]);
  }
  if (!(peak > 0)) return tl::unexpected(NoBeam::cut);
  std::vector<std::uint8_t> open(lux.size(), 0);
  for (std::size_t i = 0; i < lux.size(); ++i) open[i] = candela[i] > kOfPeak * peak;
  std::vector<std::size_t> best;
  double most_lm = 0, second_lm = 0;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (!open[i]) continue;
    std::vector<std::size_t> region = region_of(i, surface.camera.width_px, surface.camera.height_px, open);
    double lumens = 0;
    for (const std::size_t k : region)
      lumens += static_cast<double>(mean_lux[k]) * static_cast<double>(surface.pixels[k].area_m2);
    second_lm = std::max(second_lm, std::min(lumens, most_lm));
    if (lumens <= most_lm) continue;
    most_lm = lumens;
    best = std::move(region);
  }
  if (best.size() < kFewestPixels) return tl::unexpected(NoBeam::small);
  if (second_lm > kSecond * most_lm) return tl::unexpected(NoBeam::several);
  if (is_clipped(lit, best)) return tl::unexpected(NoBeam::clipped);
  if (cut_share(surface, best) > kCutShare) return tl::unexpected(NoBeam::cut);
  BeamSpot spot{&surface, {}};
  for (const std::size_t i : best) spot.pixels.push_back({i, lux[i]});
  return spot;
}

bool vanished(const BeamSpot& spot, const Picture& dark_before, const Picture& dark_after) {
  check_sizes(*spot.surface, dark_before);
  check_sizes(*spot.surface, dark_after);
  double of_lamp = 0, left = 0;
  for (const SpotPixel& at : spot.pixels) {
    const double lux_per_cd_m2 = kPi / static_cast<double>(spot.surface->pixels[at.pixel].reflectance);
    of_lamp += static_cast<double>(at.lux);
    left += lux_per_cd_m2 * (luminance_at(dark_after, at.pixel) - luminance_at(dark_before, at.pixel));
  }
  return std::abs(left) < kStays * of_lamp;
}

SpotCentre centre_of(const BeamSpot& spot, const Vec3& pivot_world_m) {
  LUXRIG_CHECK(spot.surface && !spot.pixels.empty(), "an empty spot");
  const SeenSurface& surface = *spot.surface;
  struct Part {
    std::uint32_t plane;
    double weight = 0;
    Vec3 direction = Vec3::Zero(), position_m = Vec3::Zero(), normal = Vec3::Zero();
  };
  std::vector<Seen> seen;
  std::vector<double> candela;
  for (const SpotPixel& at : spot.pixels) {
    seen.push_back(seen_from(surface, surface.pixels[at.pixel], pivot_world_m));
    candela.push_back(static_cast<double>(at.lux) * seen.back().candela_per_lux);
  }
  // Not the brightest pixel, which is the one with most noise.
  std::vector<double> sorted = candela;
  const auto high = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 19 / 20);
  std::nth_element(sorted.begin(), high, sorted.end());
  const double counts_cd = kCounts * *high;
  std::vector<Part> parts;
  Part all{0};
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const double weight = (candela[k] - counts_cd) * seen[k].solid_angle_sr;
    if (!(weight > 0)) continue;
    const SurfacePixel& pixel = surface.pixels[spot.pixels[k].pixel];
    auto part = std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.plane == pixel.plane; });
    if (part == parts.end()) part = parts.insert(parts.end(), Part{pixel.plane});
    part->weight += weight;
    part->direction += weight * seen[k].direction;
    part->position_m += weight * surface.position_world_m(pixel);
    part->normal += weight * pixel.normal.cast<double>();
  }
  for (const Part& part : parts) {
    all.weight += part.weight;
    all.direction += part.direction;
  }
  SpotCentre centre;
  const SurfacePixel& any = surface.pixels[spot.pixels.front().pixel];
  centre.position_world_m = surface.position_world_m(any);
  centre.normal_world = any.normal.cast<double>();
  centre.standard_error_rad = kPi;
  if (!(all.weight > 0)) return centre;  // the lamp cannot be there: nothing faces it
  const Vec3 middle = all.direction.normalized();
  const auto most =
      std::max_element(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.weight < b.weight; });
  centre.normal_world = most->normal.normalized();
  const Vec3 on_plane_m = most->position_m / most->weight;
  const double towards = middle.dot(centre.normal_world);
  centre.position_world_m =
      std::abs(towards) > 1e-3
          ? Vec3(pivot_world_m + middle * (on_plane_m - pivot_world_m).dot(centre.normal_world) / towards)
          : on_plane_m;
  double scatter = 0, spread = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const double weight = (candela[k] - counts_cd) * seen[k].solid_angle_sr;
    if (!(weight > 0)) continue;
    spread += weight * (seen[k].direction - middle).squaredNorm();
    // The next pixel of the list mostly is its neighbour, so half of their squared difference is noise.
    const std::size_t next = k + 1 < seen.size() ? k + 1 : k > 0 ? k - 1 : k;
    const double noise_lm = (candela[k] - candela[next]) * seen[k].solid_angle_sr;
    scatter += 0.5 * noise_lm * noise_lm * (seen[k].direction - middle).squaredNorm() / 2;
  }
  centre.radius_rad = std::sqrt(spread / all.weight);
  double paint = 0, of_things = 0;
  for (const Part& part : parts) {
    if (!surface.is_large(part.plane)) of_things += part.weight / all.weight;
    paint += (part.direction / all.weight - part.weight / all.weight * middle).squaredNorm() / 2;
  }
  const double thing_rad = of_things * kThingError_m / (on_plane_m - pivot_world_m).norm();
  const double across = kCorner * std::min(1.0, 4 * (1 - most->weight / all.weight));
  const double variance =
      scatter / (all.weight * all.weight) + kPaintError * kPaintError * paint + thing_rad * thing_rad +
      (across * across + kUnevenShare * kUnevenShare) * spread / all.weight + kFloor_rad * kFloor_rad;
  centre.standard_error_rad = std::sqrt(variance);
  return centre;
}

}  // namespace luxrig
