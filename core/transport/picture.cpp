#include "core/transport/picture.h"

#include <fmt/format.h>

#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "core/transport/direct_light.h"
#include "core/transport/path_sampler.h"
#include "core/transport/progress.h"

namespace luxrig {
namespace {

/// One sparse point where interreflection is known.
struct Gathered {
  bool seen = false;
  Vec3 position_world_m, normal_world;
  Vec3 irradiance_lx = Vec3::Zero();  ///< reflected light, linear Rec. 709
};

class Renderer {
 public:
  Renderer(const RayScene& scene, std::vector<Emitter> emitters, std::vector<double> levels, const Camera& camera,
           const PictureOptions& options)
      : scene_(scene),
        emitters_(std::move(emitters)),
        levels_(std::move(levels)),
        lamps_(emitters_),
        camera_(camera),
        options_(options),
        blocks_x_((camera.width_px + options.indirect_step_px - 1) / options.indirect_step_px),
        blocks_y_((camera.height_px + options.indirect_step_px - 1) / options.indirect_step_px) {}

  Result<Picture> run() {
    gathered_.resize(static_cast<std::size_t>(blocks_x_) * static_cast<std::size_t>(blocks_y_));
    CallingThreadProgress gathering(options_.watch, 0, 0.5, gathered_.size());
    parallel_for(gathered_.size(), options_.threads, [&](std::size_t block) {
      if (options_.watch.stop.stop_requested()) return;
      gather(block);
      gathering.one_done();
    });
    Picture picture;
    picture.width_px = camera_.width_px;
    picture.height_px = camera_.height_px;
    const auto pixels = static_cast<std::size_t>(camera_.width_px) * static_cast<std::size_t>(camera_.height_px);
    picture.luminance_cd_m2.assign(pixels, Vec3f::Zero());
    picture.illuminance_lx.assign(pixels, -1.0f);
    CallingThreadProgress shading(options_.watch, 0.5, 1, static_cast<std::size_t>(camera_.height_px));
    parallel_for(static_cast<std::size_t>(camera_.height_px), options_.threads, [&](std::size_t row) {
      if (options_.watch.stop.stop_requested()) return;
      for (int x = 0; x < camera_.width_px; ++x) shade(x, static_cast<int>(row), picture);
      shading.one_done();
    });
    if (options_.watch.stop.stop_requested())
      return tl::unexpected(Fault{Cause::cancelled, "", "stopped while rendering", {}});
    shading.report_end();
    return picture;
  }

 private:
  std::optional<Hit> seen_at(double x_px, double y_px) const {
    return scene_.nearest(camera_.eye_world_m, ray_direction(camera_, x_px, y_px), Vec3::Zero());
  }

  double direct_lx(const Vec3& position_world_m, const Vec3& normal_world) const {
    double sum_lx = 0;
    lamps_.light(&scene_, position_world_m, normal_world,
                 [&](std::size_t e, double lux) { sum_lx += levels_[e] * lux; });
    return sum_lx;
  }

  void gather(std::size_t block) {
    const auto columns = static_cast<std::size_t>(blocks_x_);
    const double step_px = options_.indirect_step_px;
    const auto hit = seen_at((static_cast<double>(block % columns) + 0.5) * step_px,
                             (static_cast<double>(block / columns) + 0.5) * step_px);
    if (!hit) return;
    gathered_[block] = {true, hit->position_world_m, hit->normal_world,
                        reflected_lx(*hit, mixed(options_.seed, block), options_.indirect_paths)};
  }

  /// As PathSampler, in three channels and with the levels applied.
  Vec3 reflected_lx(const Hit& at, std::uint64_t key, int paths) const {
    const SobolSequence samples(key);
    Vec3 sum_lx = Vec3::Zero();
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(paths); ++i) {
      Vec3 position_world_m = at.position_world_m, normal_world = at.normal_world, throughput = Vec3::Ones();
      for (std::uint32_t bounce = 0; bounce < 64; ++bounce) {
        const auto [u, v] = samples.pair(i, bounce / 2, bounce % 2);
        const auto hit = scene_.nearest(position_world_m, cosine_direction(normal_world, u, v), normal_world);
        if (!hit) break;
        throughput = throughput.cwiseProduct(scene_.material_of(hit->triangle).reflectance_rgb);
        position_world_m = hit->position_world_m;
        normal_world = hit->normal_world;
        sum_lx += throughput * direct_lx(position_world_m, normal_world);
        const double goes_on = std::min(1.0, throughput.maxCoeff() / 0.5);
        if (samples.pair(i, 100 + bounce, 0)[0] >= goes_on) break;
        throughput /= goes_on;
      }
    }
    return sum_lx / paths;
  }

  /// Mean of the sparse points around, weighted by nearness in the picture and by how well they lie in the same plane.
  Vec3 interpolated_lx(const Hit& at, double x_px, double y_px) const {
    constexpr int kReach = 4;
    const double step_px = options_.indirect_step_px;
    const double bx = x_px / step_px - 0.5, by = y_px / step_px - 0.5;
    const double pixel_m = at.distance_m * 2 * std::tan(camera_.vertical_fov_rad / 2) / camera_.height_px;
    const double out_of_plane_m = 4 * step_px * pixel_m;
    Vec3 sum_lx = Vec3::Zero();
    double weights = 0;
    for (int j = static_cast<int>(std::floor(by)) - kReach + 1; j <= static_cast<int>(std::floor(by)) + kReach; ++j)
      for (int i = static_cast<int>(std::floor(bx)) - kReach + 1; i <= static_cast<int>(std::floor(bx)) + kReach; ++i) {
        if (i < 0 || j < 0 || i >= blocks_x_ || j >= blocks_y_) continue;
        const Gathered& g = gathered_[static_cast<std::size_t>(j * blocks_x_ + i)];
        if (!g.seen) continue;
        const double along = g.normal_world.dot(at.normal_world);
        const Vec3 apart_m = g.position_world_m - at.position_world_m;
        const double height_m = std::abs(at.normal_world.dot(apart_m));
        if (along < 0.7 || height_m > out_of_plane_m) continue;
        const double nearness = (i - bx) * (i - bx) + (j - by) * (j - by);
        const double weight = std::exp(-nearness / 5) * (along - 0.7) * (1 - height_m / out_of_plane_m);
        sum_lx += weight * g.irradiance_lx;
        weights += weight;
      }
    if (weights > 0.01) return sum_lx / weights;
    // A thing too small for the sparse points: its own few paths.
    return reflected_lx(at, mixed(options_.seed ^ 0x5eed, static_cast<std::uint64_t>(y_px * 65536 + x_px)), 16);
  }

  void shade(int x, int y, Picture& picture) const {
    const int edge = options_.samples_per_pixel_edge;
    Vec3 luminance_cd_m2 = Vec3::Zero();
    double illuminance_lx = 0;
    int seen = 0;
    for (int s = 0; s < edge * edge; ++s) {
      const double x_px = x + (s % edge + 0.5) / edge, y_px = y + (s / edge + 0.5) / edge;
      const auto hit = seen_at(x_px, y_px);
      if (!hit) continue;
      const Vec3 lux =
          Vec3::Constant(direct_lx(hit->position_world_m, hit->normal_world)) + interpolated_lx(*hit, x_px, y_px);
      luminance_cd_m2 += scene_.material_of(hit->triangle).reflectance_rgb.cwiseProduct(lux) / kPi;
      illuminance_lx += 0.2126 * lux.x() + 0.7152 * lux.y() + 0.0722 * lux.z();
      ++seen;
    }
    if (seen == 0) return;
    const auto pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width_px) + static_cast<std::size_t>(x);
    picture.luminance_cd_m2[pixel] = (luminance_cd_m2 / (edge * edge)).cast<float>();
    picture.illuminance_lx[pixel] = static_cast<float>(illuminance_lx / seen);
  }

  const RayScene& scene_;
  std::vector<Emitter> emitters_;
  std::vector<double> levels_;
  Lamps lamps_;
  const Camera& camera_;
  const PictureOptions& options_;
  int blocks_x_, blocks_y_;
  std::vector<Gathered> gathered_;
};

tl::unexpected<Fault> refusal(std::string detail) {
  return tl::unexpected(Fault{Cause::invalid, "", std::move(detail), {}});
}

}  // namespace

Vec3 ray_direction(const Camera& camera, double x_px, double y_px) {
  const Vec3 ahead = (camera.target_world_m - camera.eye_world_m).normalized();
  const Vec3 up_hint = std::abs(ahead.z()) > 0.999 ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 right = ahead.cross(up_hint).normalized(), up = right.cross(ahead);
  const double scale = 2 * std::tan(camera.vertical_fov_rad / 2) / camera.height_px;
  return (ahead + (x_px - camera.width_px / 2.0) * scale * right - (y_px - camera.height_px / 2.0) * scale * up)
      .normalized();
}

Result<Picture> render_picture(const RayScene& scene, std::span<const Emitter> emitters, std::span<const double> levels,
                               const Camera& camera, const PictureOptions& options) {
  if (camera.width_px < 1 || camera.height_px < 1 || camera.width_px > 16384 || camera.height_px > 16384)
    return refusal(fmt::format("picture of {} × {} pixels; 1 to 16384 each way", camera.width_px, camera.height_px));
  if (!(camera.vertical_fov_rad > 0 && camera.vertical_fov_rad < kPi))
    return refusal(fmt::format("field of view of {:g}°; above 0 and below 180", deg_from_rad(camera.vertical_fov_rad)));
  const double ahead_m = (camera.target_world_m - camera.eye_world_m).norm();
  if (!(ahead_m > 0) || !std::isfinite(ahead_m)) return refusal("camera's target lies in its eye, or is not finite");
  if (options.samples_per_pixel_edge < 1 || options.indirect_step_px < 1 || options.indirect_paths < 1)
    return refusal("samples, step and paths must be at least 1");
  if (levels.size() != emitters.size())
    return refusal(fmt::format("{} levels for {} emitters", levels.size(), emitters.size()));
  EvaluateOptions checked;
  checked.levels.assign(levels.begin(), levels.end());
  if (auto fine = check_evaluation({}, emitters, checked); !fine) return tl::unexpected(std::move(fine.error()));
  std::vector<Emitter> lit;
  std::vector<double> lit_levels;
  for (std::size_t e = 0; e < emitters.size(); ++e)
    if (levels[e] > 0) {
      lit.push_back(emitters[e]);
      lit_levels.push_back(levels[e]);
    }
  return Renderer(scene, std::move(lit), std::move(lit_levels), camera, options).run();
}

}  // namespace luxrig
