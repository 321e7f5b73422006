#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/picture/picture.h"
#include "core/transport/bsdf.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

/// Whether something upright crosses the cut near enough to draw a line of about three pixels.
bool wall_at(const RayScene& scene, const Vec3& at_world_m, double metres_per_px) {
  for (const Vec3& direction : {Vec3(Vec3::UnitX()), Vec3(-Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(-Vec3::UnitY())})
    if (scene.occluded(at_world_m, Vec3::Zero(), at_world_m + 1.5 * metres_per_px * direction)) return true;
  return false;
}

/// Cosine-weighted share of the sky that nearby things leave open.
double openness(const RayScene& scene, const Hit& at, std::uint64_t key, double reach_m) {
  constexpr std::uint32_t kRays = 16;
  const SobolSequence samples(key);
  int open = 0;
  for (std::uint32_t i = 0; i < kRays; ++i) {
    const auto [u, v] = samples.pair(i, 0, 0);
    const Vec3 to = at.position_world_m + reach_m * cosine_direction(at.normal_world, u, v);
    open += !scene.occluded(at.position_world_m, at.normal_world, to);
  }
  return open / static_cast<double>(kRays);
}

}  // namespace

PlanView render_plan_view(const RayScene& scene, int longest_edge_px, std::optional<double> cut_z_world_m, int threads,
                          const std::optional<Eigen::AlignedBox3d>& shown_world_m) {
  const Eigen::AlignedBox3d box = shown_world_m.value_or(scene.bounds_world_m());
  PlanView view;
  if (box.isEmpty() || longest_edge_px < 1) {
    view.width_px = view.height_px = 1;
    view.metres_per_px = 1;
    view.shade = {1.0f};
    return view;
  }
  const Vec3 size_m = box.sizes();
  const double longest_m = std::max({size_m.x(), size_m.y(), 1e-9});
  // A border of 2 % so that outer walls are drawn in full.
  view.metres_per_px = 1.04 * longest_m / longest_edge_px;
  view.width_px = std::max(1, static_cast<int>(std::ceil((size_m.x() + 0.04 * longest_m) / view.metres_per_px)));
  view.height_px = std::max(1, static_cast<int>(std::ceil((size_m.y() + 0.04 * longest_m) / view.metres_per_px)));
  view.left_x_world_m = box.center().x() - view.width_px * view.metres_per_px / 2;
  view.top_y_world_m = box.center().y() + view.height_px * view.metres_per_px / 2;
  view.shade.assign(static_cast<std::size_t>(view.width_px) * static_cast<std::size_t>(view.height_px), 1.0f);
  const double cut_m = cut_z_world_m.value_or(box.min().z() + std::min(1.2, 0.6 * size_m.z()));
  const double reach_m = std::min(1.0, 0.15 * longest_m);
  parallel_for(static_cast<std::size_t>(view.height_px), threads, [&](std::size_t row) {
    for (int x = 0; x < view.width_px; ++x) {
      const std::size_t pixel = row * static_cast<std::size_t>(view.width_px) + static_cast<std::size_t>(x);
      const Vec3 at(view.left_x_world_m + (x + 0.5) * view.metres_per_px,
                    view.top_y_world_m - (static_cast<double>(row) + 0.5) * view.metres_per_px, cut_m);
      if (wall_at(scene, at, view.metres_per_px)) {
        view.shade[pixel] = 0.15f;
        continue;
      }
      const auto hit = scene.nearest(at, -Vec3::UnitZ(), Vec3::Zero());
      if (!hit) continue;  // no floor: white, like the paper
      // Things above the floor are a little darker, so that furniture shows even where it stands free.
      const double height = std::clamp((hit->position_world_m.z() - box.min().z()) / (cut_m - box.min().z()), 0.0, 1.0);
      const double light = openness(scene, *hit, mixed(1, pixel), reach_m);
      view.shade[pixel] = static_cast<float>((0.35 + 0.6 * light) * (1 - 0.25 * height));
    }
  });
  return view;
}

}  // namespace luxrig
