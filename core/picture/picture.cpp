#include "core/picture/picture.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "core/parallel.h"
#include "core/photometry/light_colour.h"
#include "core/transport/paths/irradiance_cache.h"
#include "core/transport/paths/path_sampler.h"
#include "core/transport/sky/sky_opening_finder.h"

namespace luxrig {
namespace {

/// Light vertices of a pass, and how many of them each path is joined with.
constexpr std::uint32_t kHitsPerPass = 1u << 14;
constexpr std::uint32_t kPictureHitsPerPath = 4;
/// Initial irradiance records, and those added each time the passes double.
constexpr std::size_t kFirstPictureRecords = 6000, kMoreRecords = 2000;
constexpr std::uint32_t kPictureRecordPaths = 8;
/// Connections worth less than this share of the mean reflected light are made only occasionally.
constexpr double kPictureCut = 0.05;

std::vector<Emitter> of_kind(const std::vector<Emitter>& emitters, bool point) {
  std::vector<Emitter> some;
  for (const Emitter& e : emitters)
    if ((!e.sky && e.shape.kind == LuminousShape::Kind::point) == point) some.push_back(e);
  return some;
}

std::vector<double> light_of(const EmitterSampler& lamps) {
  std::vector<double> shares;
  for (std::size_t g = 0; g < lamps.groups(); ++g) shares.push_back(lamps.group_share(g));
  return shares;
}

/// Openings through which the surfaces in view see the sky.
SkyOpenings openings_in_view(const RayScene& scene, const std::vector<Emitter>& emitters, const Camera& camera,
                             const PictureOptions& options) {
  constexpr int kAcross = 16;
  std::vector<Receiver> in_view;
  for (int i = 0; i < kAcross * kAcross; ++i) {
    const double x_px = (i % kAcross + 0.5) / kAcross * camera.width_px;
    const double y_px = (i / kAcross + 0.5) / kAcross * camera.height_px;
    if (const auto hit = scene.nearest(camera.eye_world_m, ray_direction(camera, x_px, y_px), Vec3::Zero()))
      in_view.push_back({hit->position_world_m, hit->normal_world});
  }
  std::uint64_t rays = 0;
  return find_sky_openings(scene, in_view, emitters, options.seed, options.threads, options.watch, rays);
}

class Renderer {
 public:
  /// emitters at their levels: colour_rgb times level
  Renderer(const RayScene& scene, std::vector<Emitter> emitters, const Camera& camera, const PictureOptions& options)
      : scene_(scene),
        emitters_(std::move(emitters)),
        points_(of_kind(emitters_, true)),
        sized_(of_kind(emitters_, false)),
        bsdfs_(bsdfs_of(scene)),
        openings_(openings_in_view(scene, emitters_, camera, options)),
        lamps_(emitters_, {}, scene.bounds_world_m(), &openings_),
        point_lamps_(points_, {}, scene.bounds_world_m()),
        sized_lamps_(sized_, {}, scene.bounds_world_m(), &openings_),
        importance_(emitters_.size(), 1.0),
        by_light_(light_of(lamps_)),
        plan_(LightVertexPlan::of(lamps_, by_light_, kPictureHitsPerPath, 1)),
        images_(scene, lamps_),
        sampler_(scene, lamps_, bsdfs_, images_, importance_),
        tails_(scene, sampler_, bsdfs_, emitters_.size(), 1, options.seed),
        camera_(camera),
        options_(options) {}

  Result<Picture> run() {
    picture_.width_px = camera_.width_px;
    picture_.height_px = camera_.height_px;
    const auto pixels = static_cast<std::size_t>(camera_.width_px) * static_cast<std::size_t>(camera_.height_px);
    sums_.assign(pixels, {});
    bool more = true;
    while (more && picture_.passes < options_.max_passes) {
      if (!pass()) return tl::unexpected(Fault{Cause::cancelled, "", "stopped while rendering", {}});
      ++picture_.passes;
      picture_.relative_error = noise();
      more = picture_.passes < 4 || picture_.relative_error > options_.wanted_relative_error;
      if (options_.after_pass) {
        const double by_passes = static_cast<double>(picture_.passes) / options_.max_passes;
        const double by_noise = std::pow(options_.wanted_relative_error / std::max(picture_.relative_error, 1e-9), 2);
        more =
            options_.after_pass(more ? std::min(1.0, std::max(by_passes, by_noise)) : 1.0, picture_.relative_error) &&
            more;
      }
    }
    finish();
    return std::move(picture_);
  }

 private:
  struct PixelSum {
    Vec3f luminance_cd_m2 = Vec3f::Zero();
    float lux = 0, squares = 0;
    int seen = 0;
  };

  std::optional<Hit> seen_at(double x_px, double y_px) const {
    return scene_.nearest(camera_.eye_world_m, ray_direction(camera_, x_px, y_px), Vec3::Zero());
  }

  /// One sample of every pixel. False when stopped.
  bool pass() {
    const auto index = static_cast<std::uint32_t>(picture_.passes);
    const bool lit = lamps_.any();
    if (lit) trace_lights();
    if (lit && std::has_single_bit(index + 1)) grow_tails(index);
    const auto rows = static_cast<std::size_t>(camera_.height_px);
    std::vector<double> reflected_lx(rows, 0.0);
    parallel_for(rows, options_.threads, [&](std::size_t row) {
      Scratch scratch;
      scratch.sums.resize(3 * emitters_.size());
      for (int x = 0; x < camera_.width_px; ++x) {
        if (options_.watch.stop.stop_requested()) return;
        reflected_lx[row] += sample_pixel(x, static_cast<int>(row), index, scratch);
      }
    });
    double sum_lx = 0;
    for (const double lx : reflected_lx) sum_lx += lx;
    mean_reflected_lx_ = sum_lx / static_cast<double>(sums_.size());
    return !options_.watch.stop.stop_requested();
  }

  void trace_lights() {
    std::vector<std::uint32_t> counts;
    for (std::size_t g = 0; g < lamps_.groups(); ++g)
      counts.push_back(!(lamps_.group_share(g) > 0)
                           ? 0
                           : std::bit_ceil(static_cast<std::uint32_t>(16 + kHitsPerPass * lamps_.group_share(g))));
    EmitterSampler::Weights weights;
    pool_.refill(LightTracer(scene_, lamps_, bsdfs_, &images_), mixed(options_.seed, 0x11647), counts, weights);
  }

  /// Adds records where first legs from the surfaces in view end.
  void grow_tails(std::uint32_t index) {
    const std::size_t count = index == 0 ? kFirstPictureRecords : kMoreRecords;
    const SobolSequence samples(mixed(options_.seed, 0x7a113 + index));
    std::vector<Receiver> in_view;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      if (const auto hit = seen_at(u * camera_.width_px, v * camera_.height_px))
        in_view.push_back({hit->position_world_m, hit->normal_world});
    }
    if (in_view.empty()) return;
    const std::vector<LightVertexPlan> plans(
        in_view.size(),
        LightVertexPlan::of(lamps_, by_light_, kPictureHitsPerPath * kPictureRecordPaths, kPictureRecordPaths));
    const std::vector<double> cuts_lx(in_view.size(), 0.0);
    tails_.grow(in_view, in_view.size(), kPictureRecordPaths, {&pool_, 1}, plans, cuts_lx, options_.threads,
                options_.watch);
  }

  struct Scratch {
    PathScratch path;
    EmitterSampler::Weights weights;
    std::vector<double> sums;
    std::vector<LightVertexRange> stretches;
  };

  /// Direct light that leaves towards `out`, and its illuminance, by primary.
  struct Direct {
    Vec3 luminance_cd_m2 = Vec3::Zero(), lux = Vec3::Zero();
  };
  Direct direct(const Hit& hit, const Bsdf& bsdf, const Vec3& out, double select, double u, double v,
                Scratch& scratch) const {
    Direct sum;
    const auto add = [&](const Vec3& lux, const Vec3& from_world) {
      sum.lux += lux;
      sum.luminance_cd_m2 += lux.cwiseProduct(bsdf.value(hit.normal_world, out, from_world));
    };
    point_lamps_.light(&scene_, hit.position_world_m, hit.normal_world, [&](std::size_t e, double lux) {
      const Vec3& at_m = points_[e].world_from_lamp.translation_m;
      add(lux * points_[e].colour_rgb, (at_m - hit.position_world_m).normalized());
    });
    if (!sized_lamps_.any()) return sum;
    const double weight = sized_lamps_.weigh(hit.position_world_m, hit.normal_world, scratch.weights);
    const EmitterChoice choice =
        sized_lamps_.choose(hit.position_world_m, hit.normal_world, scratch.weights, weight, select, u, v);
    if (!(choice.density > 0) || scene_.occluded(hit.position_world_m, hit.normal_world, choice.target_world_m))
      return sum;
    const double through = scene_.has_panes() ? scene_.transmittance(hit.position_world_m, choice.target_world_m) : 1;
    sized_lamps_.light(choice, [&](std::size_t e, double lux, double) {
      add(through * lux * sized_[e].colour_rgb, choice.direction_world);
    });
    return sum;
  }

  /// Light that was already reflected, from one path that starts at `start`, by primary.
  Vec3 reflected(const PathSampler::Vertex& start, const SobolSequence& samples, std::uint32_t index, std::uint64_t key,
                 Scratch& scratch) const {
    std::fill(scratch.sums.begin(), scratch.sums.end(), 0.0);
    TailShare share;
    if (tails_.records(0).size() > 0) share.records = &tails_.records(0);
    const double cut = kPictureCut * mean_reflected_lx_;
    draw_stretches(plan_, pool_, 1, key, scratch.stretches);
    sampler_.join_start(start, pool_, plan_, scratch.stretches, cut, mixed(key, pool_.groups()), {scratch.sums, 3});
    sampler_.add_path(start, samples, index, pool_, plan_, cut, scratch.path, {scratch.sums, 3}, &share);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < scratch.sums.size(); ++i)
      sum[static_cast<Eigen::Index>(i / emitters_.size())] += scratch.sums[i];
    return sum;
  }

  Vec3 sky_cd_m2(const Vec3& direction_world) const {
    Vec3 sum = Vec3::Zero();
    for (const Emitter& e : emitters_)
      if (e.sky) sum += e.sky->luminance_cd_m2(direction_world) * e.colour_rgb;
    return sum;
  }

  /// Returns the reflected lux.
  double sample_pixel(int x, int y, std::uint32_t index, Scratch& scratch) {
    const auto pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width_px) + static_cast<std::size_t>(x);
    const SobolSequence samples(mixed(mixed(options_.seed, 0x91c7), pixel));
    constexpr std::uint32_t kPictureSet = 1u << 18;
    const auto [dx, dy, select, other] = samples.set(index, kPictureSet);
    const auto hit = seen_at(x + dx, y + dy);
    if (!hit) {
      sums_[pixel].luminance_cd_m2 += sky_cd_m2(ray_direction(camera_, x + dx, y + dy)).cast<float>();
      return 0;
    }
    const Bsdf& bsdf = bsdfs_[scene_.material_index_of(hit->triangle)];
    const Vec3 out = (camera_.eye_world_m - hit->position_world_m).normalized();
    PixelSum& sum = sums_[pixel];
    ++sum.seen;
    if (!lamps_.any()) return 0;
    const auto [u, v] = samples.pair(index, kPictureSet + 1, 0);
    const Direct at = direct(*hit, bsdf, out, select, u, v, scratch);
    const std::uint64_t key = mixed(mixed(pixel, index), options_.seed);
    const Vec3 lux =
        reflected({hit->position_world_m, hit->normal_world, hit->normal_world}, samples, index, key, scratch);
    Vec3 luminance_cd_m2 = at.luminance_cd_m2;
    if (bsdf.matt()) {
      luminance_cd_m2 += lux.cwiseProduct(bsdf.body_rgb()) / kPi;
    } else {
      const SobolSequence glossy(mixed(mixed(options_.seed, 0x91c8), pixel));
      luminance_cd_m2 +=
          reflected({hit->position_world_m, hit->normal_world, out, &bsdf, Vec3::Ones()}, glossy, index, key, scratch);
    }
    if (scene_.has_panes()) luminance_cd_m2 *= scene_.transmittance(camera_.eye_world_m, hit->position_world_m);
    const auto all_lx = static_cast<float>(luminance_of_rgb(at.lux + lux));
    sum.luminance_cd_m2 += luminance_cd_m2.cast<float>();
    sum.lux += all_lx;
    sum.squares += all_lx * all_lx;
    return luminance_of_rgb(lux);
  }

  double noise() const {
    double mean_lx = 0, count = 0;
    for (const PixelSum& s : sums_)
      if (s.seen > 0) mean_lx += static_cast<double>(s.lux) / s.seen, ++count;
    if (!(mean_lx > 0)) return 0;
    mean_lx /= count;
    double squares = 0, of = 0;
    for (const PixelSum& s : sums_) {
      if (s.seen < 2) continue;
      const double mean = static_cast<double>(s.lux) / s.seen;
      const double variance = std::max(0.0, static_cast<double>(s.squares) / s.seen - mean * mean) / (s.seen - 1);
      const double scale = std::max(mean, 0.05 * mean_lx);
      squares += variance / (scale * scale), ++of;
    }
    return of > 0 ? std::sqrt(squares / of) : 1;
  }

  void finish() {
    picture_.luminance_cd_m2.assign(sums_.size(), Vec3f::Zero());
    picture_.illuminance_lx.assign(sums_.size(), -1.0f);
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const PixelSum& s = sums_[i];
      // At an edge across the pixel, the rest is sky or black; the lux is that of the surface seen.
      picture_.luminance_cd_m2[i] = s.luminance_cd_m2 / static_cast<float>(picture_.passes);
      if (s.seen > 0) picture_.illuminance_lx[i] = s.lux / static_cast<float>(s.seen);
    }
  }

  const RayScene& scene_;
  std::vector<Emitter> emitters_, points_, sized_;
  std::vector<Bsdf> bsdfs_;
  SkyOpenings openings_;
  EmitterSampler lamps_, point_lamps_, sized_lamps_;
  std::vector<double> importance_;
  std::vector<double> by_light_;  ///< shares of the lamp groups
  LightVertexPlan plan_;
  MirrorImages images_;
  PathSampler sampler_;
  IrradianceCache tails_;
  LightVertexPool pool_;
  const Camera& camera_;
  const PictureOptions& options_;
  std::vector<PixelSum> sums_;
  double mean_reflected_lx_ = 0;
  Picture picture_;
};

}  // namespace

namespace {

struct ViewFrame {
  explicit ViewFrame(const Camera& camera)
      : ahead((camera.target_world_m - camera.eye_world_m).normalized()),
        per_px(2 * std::tan(camera.vertical_fov_rad / 2) / camera.height_px),
        middle_px(camera.width_px / 2.0, camera.height_px / 2.0),
        distortion(camera.distortion) {
    const Vec3 level = ahead.cross(std::abs(ahead.z()) > 0.999 ? Vec3::UnitY() : Vec3::UnitZ()).normalized();
    const Vec3 above = level.cross(ahead);
    right = std::cos(camera.roll_rad) * level - std::sin(camera.roll_rad) * above;
    up = right.cross(ahead);
  }
  /// Of a straight lens from the place in the picture, both from the middle and over the distance ahead.
  [[nodiscard]] Eigen::Vector2d straight(const Eigen::Vector2d& seen) const {
    return seen / (1 + distortion * seen.squaredNorm());
  }
  /// Its inverse. Empty where this lens shows nothing.
  [[nodiscard]] std::optional<Eigen::Vector2d> seen(const Eigen::Vector2d& straight) const {
    const double root = 1 - 4 * distortion * straight.squaredNorm();
    if (root < 0) return std::nullopt;
    return straight * (2 / (1 + std::sqrt(root)));
  }
  Vec3 ahead, right, up;
  double per_px;  ///< of the distance ahead
  Eigen::Vector2d middle_px;
  double distortion;
};

}  // namespace

Vec3 ray_direction(const Camera& camera, double x_px, double y_px) {
  const ViewFrame view(camera);
  const Eigen::Vector2d at = view.straight((Eigen::Vector2d(x_px, y_px) - view.middle_px) * view.per_px);
  return (view.ahead + at.x() * view.right - at.y() * view.up).normalized();
}

std::optional<PixelPlace> pixel_of(const Camera& camera, const Vec3& place_world_m) {
  const ViewFrame view(camera);
  const Vec3 to_m = place_world_m - camera.eye_world_m;
  const double ahead_m = to_m.dot(view.ahead);
  if (!(ahead_m > 0)) return std::nullopt;
  const Eigen::Vector2d straight(to_m.dot(view.right) / ahead_m, -to_m.dot(view.up) / ahead_m);
  const auto seen = view.seen(straight);
  if (!seen) return std::nullopt;
  PixelPlace place;
  const double stretch = straight.norm() > 0 ? seen->norm() / straight.norm() : 1;
  place.px_per_m = stretch / (ahead_m * view.per_px);
  place.x_px = view.middle_px.x() + seen->x() / view.per_px;
  place.y_px = view.middle_px.y() + seen->y() / view.per_px;
  if (!(place.x_px >= 0 && place.x_px < camera.width_px && place.y_px >= 0 && place.y_px < camera.height_px))
    return std::nullopt;
  return place;
}

Result<Picture> render_picture(const RayScene& scene, std::span<const Emitter> emitters, std::span<const double> levels,
                               const Camera& camera, const PictureOptions& options) {
  if (camera.width_px < 1 || camera.height_px < 1 || camera.width_px > 16384 || camera.height_px > 16384)
    return refusal(fmt::format("picture of {} × {} pixels; 1 to 16384 each way", camera.width_px, camera.height_px));
  if (!(camera.vertical_fov_rad > 0 && camera.vertical_fov_rad < kPi))
    return refusal(fmt::format("field of view of {:g}°; above 0 and below 180", deg_from_rad(camera.vertical_fov_rad)));
  if (!std::isfinite(camera.roll_rad) || !std::isfinite(camera.distortion))
    return refusal("the camera's roll or distortion is not finite");
  const double ahead_m = (camera.target_world_m - camera.eye_world_m).norm();
  if (!(ahead_m > 0) || !std::isfinite(ahead_m)) return refusal("camera's target lies in its eye, or is not finite");
  if (options.max_passes < 1) return refusal("passes must be at least 1");
  if (levels.size() != emitters.size())
    return refusal(fmt::format("{} levels for {} emitters", levels.size(), emitters.size()));
  EvaluateOptions checked;
  checked.levels.assign(levels.begin(), levels.end());
  if (auto fine = check_evaluation({}, emitters, checked); !fine) return tl::unexpected(std::move(fine.error()));
  std::vector<Emitter> lit;
  for (std::size_t e = 0; e < emitters.size(); ++e)
    if (levels[e] > 0) {
      lit.push_back(emitters[e]);
      lit.back().colour_rgb *= levels[e];
    }
  return Renderer(scene, std::move(lit), camera, options).run();
}

}  // namespace luxrig
